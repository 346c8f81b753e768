//! When two moving triangles may meet at all: the planes of both trim the time, quickly, before any
//! exact test.
//!
//! Key: w(x) = v_A(x) - v_B(x), the velocity field of the first mover relative to the second; L_A,
//! L_B, L_w = L_A - L_B the linear parts; n the unit normal of a triangle. The height of a corner a
//! of the first over a plane that the second carries has the slope n . w(a), and that of a corner b
//! of the second over a plane of the first has -n . w(b). The second derivatives are n . (L_w v_A -
//! L_B w) and n . (L_A w - L_w v_B): at most |L_w| |v| + |L| |w|, growing by at most e^(2 |L| s). A
//! normal that is carried along changes its length when the motion stretches: a height is a
//! distance times that length.

use crate::motion::Generator;
use glam::DVec3;

/// The result of trimming a stretch of time by the planes of two triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Clipped {
    /// A plane with this unit normal separates them throughout.
    Apart(DVec3),
    /// They may meet in this part of the stretch.
    Open([f64; 2]),
}

/// Bounds on the heights of corners over planes in one window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clipper {
    fields: [Generator; 2],
    relative: Generator,
    /// Bounds on |L_A| and |L_B|.
    sizes: [f64; 2],
    /// A bound on |L_w|.
    relative_size: f64,
    /// Factor by which speeds may grow within the window.
    growth: f64,
    /// Factors by which the normals of planes that either mover carries may grow within the window.
    stretches: [f64; 2],
}

impl Clipper {
    /// - `sizes`: bounds on the norms of the linear parts. `half`: half the width of the window.
    ///   `stretches`: bounds on the norms of exp(sL) within it.
    pub(super) fn new(
        fields: [Generator; 2],
        sizes: [f64; 2],
        half: f64,
        stretches: [f64; 2],
    ) -> Clipper {
        let [a, b] = fields;
        let relative = Generator {
            linear: a.linear - b.linear,
            offset: a.offset - b.offset,
        };
        Clipper {
            fields,
            relative,
            sizes,
            relative_size: if sizes[1] == 0.0 {
                sizes[0]
            } else {
                relative.size()
            },
            growth: (2.0 * half * (sizes[0] + sizes[1])).exp(),
            stretches,
        }
    }

    /// The part of the time [`from`, `to`] from the middle during which the triangles may be closer
    /// than `reach`.
    ///
    /// - `corners`: in the world, in the middle of the window.
    pub(super) fn clip(&self, corners: [&[DVec3; 3]; 2], reach: f64, stretch: [f64; 2]) -> Clipped {
        let mut stretch = stretch;
        for plane in [1, 0] {
            let [p, q, r] = *corners[plane];
            let normal = (q - p).cross(r - p);
            let size = normal.length();
            if size == 0.0 {
                continue;
            }
            let normal = normal / size;
            let sign = if plane == 1 { 1.0 } else { -1.0 };
            let other = 1 - plane;
            let slope_of = self.relative.linear.transpose() * normal * sign;
            let slope_at_origin = sign * normal.dot(self.relative.offset);
            let mut heights = [0.0; 3];
            let mut slopes = [0.0; 3];
            let mut bend: f64 = 0.0;
            for (k, &corner) in corners[other].iter().enumerate() {
                heights[k] = normal.dot(corner - p);
                slopes[k] = slope_of.dot(corner) + slope_at_origin;
                let own = self.fields[other].velocity(corner);
                let relative = self.relative.velocity(corner);
                let square =
                    self.relative_size * own.length() + self.sizes[plane] * relative.length();
                bend = bend.max(square);
            }
            let reach = reach * self.stretches[plane];
            match trim(heights, slopes, 0.5 * bend * self.growth, reach, stretch) {
                Some(left) => stretch = left,
                None => return Clipped::Apart(normal),
            }
        }
        Clipped::Open(stretch)
    }
}

/// Cuts off both ends of a stretch of time as long as all heights are on one side of the plane by
/// more than `reach`.
fn trim(
    heights: [f64; 3],
    slopes: [f64; 3],
    bend: f64,
    reach: f64,
    [mut from, mut to]: [f64; 2],
) -> Option<[f64; 2]> {
    let longest = from.abs().max(to.abs());
    let reach = reach + bend * longest * longest;
    for sign in [1.0, -1.0] {
        let above = |time: f64| {
            (0..3)
                .map(|k| sign * (heights[k] + slopes[k] * time) - reach)
                .fold(f64::INFINITY, f64::min)
        };
        let (first, last) = (above(from) > 0.0, above(to) > 0.0);
        if first && last {
            return None;
        }
        if !first && !last {
            continue;
        }
        // The time at which the first corner crosses.
        let mut cut = if first { to } else { from };
        for k in 0..3 {
            let (height, slope) = (sign * heights[k] - reach, sign * slopes[k]);
            if first && slope < 0.0 {
                cut = cut.min(-height / slope);
            } else if last && slope > 0.0 {
                cut = cut.max(-height / slope);
            }
        }
        if first {
            from = from.max(cut);
        } else {
            to = to.min(cut);
        }
        if from > to {
            return None;
        }
    }
    Some([from, to])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Flow;
    use crate::samples::random;

    #[test]
    fn nothing_meets_in_the_time_that_is_cut_off() {
        use super::super::nearest::nearest;
        let mut next = random(9);
        let mut cut = 0;
        for case in 0..1000 {
            let mut vector = |size: f64| DVec3::new(next(), next(), next()) * size;
            let still = case % 2 == 0;
            let fields = [1.0, if still { 0.0 } else { 1.0 }].map(|size| Generator {
                linear: glam::DMat3::from_cols(vector(size), vector(size), vector(size)),
                offset: vector(size),
            });
            let (half, reach) = (0.1, [0.01, 0.3][case / 2 % 2]);
            let corners =
                [vector(0.0), vector(0.2)].map(|place| [0; 3].map(|_| place + vector(0.4)));
            let sizes = fields.map(|field| field.size());
            let stretches = sizes.map(|size| (size * half).exp());
            let clipper = Clipper::new(fields, sizes, half, stretches);
            let kept = clipper.clip([&corners[0], &corners[1]], reach, [-half, half]);
            cut += usize::from(kept != Clipped::Open([-half, half]));
            let flows = fields.map(Flow::new);
            for i in 0..=200 {
                let time = half * (f64::from(i) / 100.0 - 1.0);
                let placed = [0, 1].map(|which: usize| {
                    let pose = flows[which].pose_at(time);
                    corners[which].map(|corner| pose.transform_point3(corner))
                });
                if nearest(&placed[0], &placed[1]).distance() < reach {
                    assert!(
                        matches!(kept, Clipped::Open([from, to]) if from <= time && time <= to),
                        "case {case} at {time}: {kept:?}"
                    );
                }
            }
        }
        assert!(cut > 100, "most of them are trimmed: {cut}");
    }
}
