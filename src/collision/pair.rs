//! Two features, one of them carried by a steady motion: the first time at which they meet.

use crate::motion::{Generator, path_bounds};
use glam::DVec3;

/// When two features meet during a window of time, in fractions of the span.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairOutcome {
    /// They do not: a proof.
    None,
    /// They do.
    First {
        /// They are apart before the first of these times, for certain, and within rounding of each other at the
        /// second one.
        bracket: [f64; 2],
        /// Whether rounding leaves open that they only touch; `false` when they cross for certain.
        touch: bool,
    },
    /// Apart for certain before the start of this window; beyond that, the limit on work was reached.
    Undecided {
        /// What is left.
        window: [f64; 2],
    },
}

/// First time at which a vertex that moves by exp(tG) meets a triangle at rest.
pub fn vertex_face(
    generator: &Generator,
    vertex: DVec3,
    face: [DVec3; 3],
    window: [f64; 2],
) -> PairOutcome {
    by_boxes(generator, &[vertex], &face, window)
}

/// First time at which a triangle that moves by exp(tG) meets a point at rest.
pub fn face_vertex(
    generator: &Generator,
    face: [DVec3; 3],
    vertex: DVec3,
    window: [f64; 2],
) -> PairOutcome {
    by_boxes(generator, &face, &[vertex], window)
}

/// First time at which a segment that moves by exp(tG) meets a segment at rest.
pub fn edge_edge(
    generator: &Generator,
    moving: [DVec3; 2],
    resting: [DVec3; 2],
    window: [f64; 2],
) -> PairOutcome {
    by_boxes(generator, &moving, &resting, window)
}

/// First time at which a point that moves by exp(tG) meets the plane through `anchor` with normal `normal` (any length).
pub fn point_plane(
    generator: &Generator,
    point: DVec3,
    anchor: DVec3,
    normal: DVec3,
    window: [f64; 2],
) -> PairOutcome {
    let [low, high] = path_bounds(generator, point, window);
    let far = |corner: usize| {
        let pick = |axis: usize| {
            if corner >> axis & 1 == 0 {
                low[axis]
            } else {
                high[axis]
            }
        };
        normal.dot(DVec3::new(pick(0), pick(1), pick(2)) - anchor)
    };
    let slack = 1e-9 * normal.length() * (low.abs().max(high.abs()) + anchor.abs()).length();
    let heights: [f64; 8] = std::array::from_fn(far);
    if heights.iter().all(|&h| h > slack) || heights.iter().all(|&h| h < -slack) {
        PairOutcome::None
    } else {
        PairOutcome::Undecided { window }
    }
}

/// Decides what boxes around the paths can decide.
fn by_boxes(
    generator: &Generator,
    moving: &[DVec3],
    resting: &[DVec3],
    window: [f64; 2],
) -> PairOutcome {
    let hull = |a: [DVec3; 2], b: [DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let moving = moving.iter().map(|&p| path_bounds(generator, p, window));
    let resting = resting.iter().map(|&p| [p, p]);
    let apart = moving
        .reduce(hull)
        .zip(resting.reduce(hull))
        .is_some_and(|(a, b)| a[0].cmpgt(b[1]).any() || a[1].cmplt(b[0]).any());
    if apart {
        PairOutcome::None
    } else {
        PairOutcome::Undecided { window }
    }
}
