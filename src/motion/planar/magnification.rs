//! How much a motion magnifies a body.

use super::Motion;
use super::trajectory::stretch;
use glam::DMat2;

/// Upper bound of the factor by which the motion stretches lengths in the body, in any direction
/// and at any time.
///
/// The bound of each span by [`stretch`], times the stretch of the pose at its start.
pub fn magnification(motion: &Motion) -> f64 {
    let start = motion.start_pose().matrix2;
    let spans = motion.spans().iter().zip(motion.joints());
    spans
        .map(|(span, joint)| {
            let linear = span.flow().generator().linear;
            norm(joint.matrix2 * start) * stretch(&linear, [0.0, 1.0])
        })
        .fold(0.0, f64::max)
}

/// The largest singular value.
fn norm(matrix: DMat2) -> f64 {
    let [x, y] = [matrix.x_axis, matrix.y_axis];
    let (sum, difference) = (
        x.length_squared() + y.length_squared(),
        x.length_squared() - y.length_squared(),
    );
    ((sum + difference.hypot(2.0 * x.dot(y))) / 2.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::{Generator, Motion, Span};
    use super::*;
    use glam::DVec2;

    fn motion(generators: &[Generator]) -> Motion {
        let spans = generators
            .iter()
            .map(|&generator| Span::new(generator, 1.0).expect("legal"))
            .collect();
        Motion::from_spans(spans).expect("legal")
    }

    #[test]
    fn the_largest_scale_on_the_way_counts() {
        let grow = |scale: f64| Generator::spiral(DVec2::new(3.0, 1.0), 2.0, scale);
        for (scales, expected) in [
            (vec![1.0], 1.0),
            (vec![0.5], 1.0),
            (vec![3.0, 0.1], 3.0),
            (vec![0.5, 4.0], 2.0),
        ] {
            let generators: Vec<Generator> = scales.iter().map(|&scale| grow(scale)).collect();
            let found = magnification(&motion(&generators));
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{found} for {expected} of {scales:?}"
            );
        }
    }

    #[test]
    fn a_stretch_counts_by_its_largest_direction() {
        let matrix = DMat2::from_cols(DVec2::new(0.0, 3.0), DVec2::new(-2.0, 0.0));
        assert!((norm(matrix) - 3.0).abs() < 1e-15);
        assert!((norm(DMat2::from_cols(DVec2::ONE, DVec2::ONE)) - 2.0).abs() < 1e-15);
    }
}
