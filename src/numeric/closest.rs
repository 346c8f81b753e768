//! The nearest point of a segment.

use glam::{DVec2, DVec3};

/// The nearest point of a segment to another point: its parameter on the segment, from 0 to 1, and
/// its position. At an end, the position is exactly that of the end.
///
/// For a segment without length it is the first end.
pub(crate) fn nearest_on_segment([from, to]: [DVec3; 2], point: DVec3) -> (f64, DVec3) {
    let along = to - from;
    let share = nearest_share(along, point - from);
    let foot = if share >= 1.0 {
        to
    } else {
        from + along * share
    };
    (share, foot)
}

/// Distance of a point from a segment, to a few roundings of the largest coordinate.
pub(crate) fn distance_to_segment(ends: [DVec3; 2], point: DVec3) -> f64 {
    point.distance(nearest_on_segment(ends, point).1)
}

/// [`distance_to_segment`] in the plane.
pub(crate) fn distance_in_plane(ends: [DVec2; 2], point: DVec2) -> f64 {
    distance_to_segment(ends.map(|end| end.extend(0.0)), point.extend(0.0))
}

/// Squared distance of the origin from a segment, to a few roundings of the distance of its nearer
/// end. Sharper than [`distance_to_segment`] when coordinates are relative to the point.
pub(crate) fn squared_distance_of_origin([from, to]: [DVec3; 2]) -> f64 {
    let along = to - from;
    let share = nearest_share(along, -from);
    // From the nearer end: a far end would lose the digits of a small distance.
    let foot = if share <= 0.5 {
        from + along * share
    } else {
        to - along * (1.0 - share)
    };
    foot.length_squared()
}

/// The parameter at which the segment from the origin to `along` is nearest to a point.
fn nearest_share(along: DVec3, point: DVec3) -> f64 {
    let length_squared = along.length_squared();
    if length_squared > 0.0 {
        (point.dot(along) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_beside_or_beyond_a_segment_is_nearest_to_its_foot_or_end() {
        let ends = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(5.0, 2.0, 3.0)];
        for (x, expected) in [(-2.0, [0.0, 5.0]), (4.0, [0.75, 4.0]), (8.0, [1.0, 5.0])] {
            let point = DVec3::new(x, 2.0, 7.0);
            let (share, foot) = nearest_on_segment(ends, point);
            let distance = distance_to_segment(ends, point);
            assert_eq!([share, distance], expected, "at x = {x}");
            assert_eq!(foot, ends[0].lerp(ends[1], share), "at x = {x}");
            let squared = squared_distance_of_origin(ends.map(|end| end - point));
            assert_eq!(squared, distance * distance, "at x = {x}");
        }
    }

    #[test]
    fn a_segment_without_length_is_a_point() {
        let (end, point) = (DVec2::new(3.0, 1.0), DVec2::new(0.0, 5.0));
        assert_eq!(distance_in_plane([end; 2], point), 5.0);
        assert_eq!(squared_distance_of_origin([end.extend(2.0); 2]), 14.0);
    }

    #[test]
    fn the_distance_of_the_origin_from_a_long_segment_near_it_keeps_its_digits() {
        // The nearer end is 1e-9 away, the other one 1e9.
        let ends = [DVec3::new(-1e9, 0.0, 1e-9), DVec3::new(0.0, 0.0, 1e-9)];
        for ends in [ends, [ends[1], ends[0]]] {
            let distance = squared_distance_of_origin(ends).sqrt();
            assert!((distance - 1e-9).abs() < 1e-24, "{distance:e}");
        }
    }
}
