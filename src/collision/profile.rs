//! Rectangles in the plane, in any direction, and the distance between them.

use glam::DVec2;

/// A rectangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rectangle {
    /// Direction of its first side, of length 1.
    axis: DVec2,
    /// The least and the largest coordinate along the axis and across it.
    low: DVec2,
    high: DVec2,
}

impl Rectangle {
    /// The rectangle around something, along an axis of length 1.
    ///
    /// - `support`: how far the thing reaches in a direction.
    pub(super) fn along(axis: DVec2, support: impl Fn(DVec2) -> f64) -> Rectangle {
        let across = axis.perp();
        Rectangle {
            axis,
            low: -DVec2::new(support(-axis), support(-across)),
            high: DVec2::new(support(axis), support(across)),
        }
    }

    /// The length of its diagonal.
    pub(super) fn size(&self) -> f64 {
        (self.high - self.low).length()
    }

    fn corners(&self) -> [DVec2; 4] {
        let Rectangle { axis, low, high } = *self;
        let place = |u: f64, v: f64| axis * u + axis.perp() * v;
        [
            place(low.x, low.y),
            place(high.x, low.y),
            place(high.x, high.y),
            place(low.x, high.y),
        ]
    }

    /// The distance by which a point is outside, along both axes.
    fn beyond(&self, point: DVec2) -> DVec2 {
        let own = DVec2::new(self.axis.dot(point), self.axis.perp().dot(point));
        (self.low - own).max(own - self.high).max(DVec2::ZERO)
    }

    /// Whether all points are beyond the same one of its sides.
    fn is_beside(&self, points: &[DVec2; 4]) -> bool {
        [self.axis, self.axis.perp()]
            .iter()
            .zip([[self.low.x, self.high.x], [self.low.y, self.high.y]])
            .any(|(axis, [low, high])| {
                let heights = points.map(|p| axis.dot(p));
                heights.iter().all(|h| *h > high) || heights.iter().all(|h| *h < low)
            })
    }

    /// The distance of two rectangles; 0 where they meet.
    pub(super) fn distance(&self, other: &Rectangle) -> f64 {
        let (own, theirs) = (self.corners(), other.corners());
        if !self.is_beside(&theirs) && !other.is_beside(&own) {
            return 0.0;
        }
        // The nearest point is a corner of one or the other.
        let squares = (own.iter().map(|p| other.beyond(*p)))
            .chain(theirs.iter().map(|p| self.beyond(*p)))
            .map(DVec2::length_squared);
        squares.fold(f64::INFINITY, f64::min).sqrt()
    }
}

/// The direction along which points scatter most.
pub(super) fn scatter(points: impl Iterator<Item = DVec2> + Clone) -> DVec2 {
    let mut count = 0.0;
    let mut sum = DVec2::ZERO;
    for point in points.clone() {
        count += 1.0;
        sum += point;
    }
    let mean = sum / count;
    let (mut squares, mut product) = (DVec2::ZERO, 0.0);
    for point in points {
        let away = point - mean;
        squares += away * away;
        product += away.x * away.y;
    }
    let angle = 0.5 * (2.0 * product).atan2(squares.x - squares.y);
    DVec2::from_angle(angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random;

    fn around(points: &[DVec2]) -> Rectangle {
        Rectangle::along(scatter(points.iter().copied()), |n| {
            points
                .iter()
                .map(|p| n.dot(*p))
                .fold(f64::NEG_INFINITY, f64::max)
        })
    }

    #[test]
    fn points_on_a_slanted_line_have_a_rectangle_without_width() {
        let slanted = around(&[DVec2::ZERO, DVec2::new(3.0, 4.0)]);
        assert!((slanted.size() - 5.0).abs() < 1e-15, "{slanted:?}");
        let beside = around(&[DVec2::new(-0.8, 0.6), DVec2::new(2.2, 4.6)]);
        assert!((slanted.distance(&beside) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_distance_is_that_of_many_points_of_both() {
        let mut next = random(5);
        for case in 0..200 {
            let mut points = |away: f64| -> Vec<DVec2> {
                (0..3).map(|_| DVec2::new(next() + away, next())).collect()
            };
            let (a, b) = (around(&points(0.0)), around(&points(1.0)));
            let grid = |r: &Rectangle| -> Vec<DVec2> {
                let share = |k: usize| f64::from(u8::try_from(k).expect("small")) / 30.0;
                let place = |k: usize| {
                    let t = DVec2::new(share(k % 31), share(k / 31));
                    let own = r.low + (r.high - r.low) * t;
                    r.axis * own.x + r.axis.perp() * own.y
                };
                (0..31 * 31).map(place).collect()
            };
            let (p, q) = (grid(&a), grid(&b));
            let sampled = p
                .iter()
                .flat_map(|x| q.iter().map(|y| x.distance(*y)))
                .fold(f64::INFINITY, f64::min);
            let found = a.distance(&b);
            let step = (a.size() + b.size()) / 30.0;
            assert!(
                found <= sampled + 1e-12 && sampled <= found + step,
                "case {case}: {found} against {sampled}"
            );
        }
    }
}
