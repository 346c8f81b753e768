//! Fills dents of the egress boundary: places where, seen along the motion, it runs back on itself
//! by less than the tolerance.
//!
//! Such a boundary sweeps sheets that lie on each other, closer than their sampling error: layers
//! with gaps between them that no point of the exact sweep has. A dent is a corner b of the
//! boundary a - b - c that lies on the egress side of the chord a - c. The fin (a, c, b), added to
//! E, moves the boundary to the chord. Its flux is nonnegative at its corners, so it lowers the
//! winding number nowhere (see [`super::sinking`]), and nothing of the swept region is lost. The
//! distance of what it adds from the swept region is at most the distance of its points from the
//! body: this is proven.

use super::lines::BoundaryPiece;
use super::points::BodyPoints;
use super::sampling::Sampling;
use super::sinking::{Carried, Fin};
use crate::motion::Generator;
use crate::numeric::closest::distance_to_segment;
use crate::numeric::tolerance::Budget;
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

/// The boundary with fewer dents.
#[derive(Debug, Default)]
pub(crate) struct Straightened {
    /// Per piece, whether a fin has replaced it.
    pub(crate) absorbed: Vec<bool>,
    pub(crate) chords: Vec<Carried>,
    pub(crate) fins: Vec<Fin>,
    /// Bound on the distance of the points of the fins from the body, over the span.
    pub(crate) reach: f64,
}

/// A straight part of the boundary in its loop: a piece or a chord.
#[derive(Debug, Clone, Copy)]
struct BoundaryLink {
    ends: [u32; 2],
    piece: Option<usize>,
    /// Bound on the distance of its points from the body, at the start of the span.
    reach: f64,
    next: Option<usize>,
    previous: Option<usize>,
    alive: bool,
}

/// Fills the dents that stay within the budget.
///
/// `frame`: pose of the start of the span relative to the start of the motion. O(n log n) for n
/// pieces.
pub(crate) fn straighten(
    pieces: &[BoundaryPiece],
    frame: &DAffine3,
    sampling: &Sampling,
    budget: &Budget,
    points: &BodyPoints,
) -> Straightened {
    let mut filled = Straightened {
        absorbed: vec![false; pieces.len()],
        ..Straightened::default()
    };
    if sampling.generator().moves_straight() {
        return filled;
    }
    let mut links = links(pieces);
    let mut waiting: Vec<usize> = (0..links.len()).rev().collect();
    while let Some(first) = waiting.pop() {
        let Some(second) = links[first].next.filter(|_| links[first].alive) else {
            continue;
        };
        let ([a, b], c) = (links[first].ends, links[second].ends[1]);
        if a == c || !links[second].alive {
            continue;
        }
        let corners = [a, b, c].map(|point| frame.transform_point3(points.at(point)));
        if !runs_back(corners, sampling.generator()) {
            continue;
        }
        let reach = links[first].reach.max(links[second].reach) + depth(corners);
        let over_the_span = sampling.growth() * reach;
        if over_the_span > budget.dent || sampling.twist(corners[0], corners[2]) > budget.twist {
            continue;
        }
        filled.reach = filled.reach.max(over_the_span);
        filled.fins.push(Fin {
            corners: [a, c, b],
            pieces: [None, links[second].piece, links[first].piece],
        });
        let (previous, next) = (links[first].previous, links[second].next);
        for link in [first, second] {
            links[link].alive = false;
            if let Some(piece) = links[link].piece {
                filled.absorbed[piece] = true;
            }
        }
        let chord = links.len();
        links.push(BoundaryLink {
            ends: [a, c],
            piece: None,
            reach,
            next,
            previous,
            alive: true,
        });
        if let Some(next) = next {
            links[next].previous = Some(chord);
        }
        waiting.push(chord);
        if let Some(previous) = previous {
            links[previous].next = Some(chord);
            waiting.push(previous);
        }
    }
    filled.chords = links
        .iter()
        .filter(|link| link.alive && link.piece.is_none())
        .map(|link| Carried {
            ends: link.ends,
            piece: None,
        })
        .collect();
    filled
}

/// The pieces, each with the ones before and after it, except where several meet.
fn links(pieces: &[BoundaryPiece]) -> Vec<BoundaryLink> {
    let mut meeting = BTreeMap::<u32, [Vec<usize>; 2]>::new();
    for (index, piece) in pieces.iter().enumerate() {
        meeting.entry(piece.ends[0]).or_default()[1].push(index);
        meeting.entry(piece.ends[1]).or_default()[0].push(index);
    }
    let mut links: Vec<BoundaryLink> = (0..pieces.len())
        .map(|index| BoundaryLink {
            ends: pieces[index].ends,
            piece: Some(index),
            reach: 0.0,
            next: None,
            previous: None,
            alive: true,
        })
        .collect();
    for [arriving, leaving] in meeting.values() {
        if let ([before], [after]) = (arriving.as_slice(), leaving.as_slice())
            && before != after
        {
            links[*before].next = Some(*after);
            links[*after].previous = Some(*before);
        }
    }
    links
}

/// Whether the path a - b - c (world, start of the span) runs back on itself at b, on the egress
/// side of its chord, and the fin between them has no negative flux.
fn runs_back([a, b, c]: [DVec3; 3], generator: &Generator) -> bool {
    let velocity = generator.velocity(b);
    let across = |d: DVec3| d * velocity.length_squared() - velocity * velocity.dot(d);
    let normal = (c - a).cross(b - a);
    (b - a).dot(across(c - b)) < 0.0
        && normal != DVec3::ZERO
        && [a, b, c]
            .iter()
            .all(|&p| normal.dot(generator.velocity(p)) >= 0.0)
}

/// Bound on the distance of the triangle from the path a - b - c.
fn depth([a, b, c]: [DVec3; 3]) -> f64 {
    // The distance from a - b starts at 0 at a and is convex along the chord; so is that from b -
    // c, from 0 at c.
    let [rising, falling] = [
        distance_to_segment([a, b], c),
        distance_to_segment([b, c], a),
    ];
    rising * falling / (rising + falling)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grazing::spatial::{Fold, Source};
    use crate::motion::Flow;

    /// A boundary through `path` in the xz plane, which a turn about a far axis carries along y:
    /// seen from +y, egress lies on its left.
    fn filled(path: &[[f64; 2]], generator: Generator, dent: f64) -> Straightened {
        let mut points = BodyPoints::default();
        let ends: Vec<u32> = path
            .iter()
            .map(|&[x, z]| points.intern(DVec3::new(x, 0.0, z)))
            .collect();
        let pieces: Vec<BoundaryPiece> = ends
            .windows(2)
            .enumerate()
            .map(|(place, pair)| BoundaryPiece {
                ends: [pair[0], pair[1]],
                source: Source::Edge(0),
                place,
                reversed: false,
                fold: Fold::Outer,
            })
            .collect();
        let budget = Budget {
            dent,
            ..Budget::of(1.0)
        };
        let places = path.iter().map(|&[x, z]| DVec3::new(x, 0.0, z));
        let sampling = Sampling::new(&Flow::new(generator), places, &budget);
        straighten(&pieces, &DAffine3::IDENTITY, &sampling, &budget, &points)
    }

    /// A turn that moves points near the origin along +y.
    fn along_y() -> Generator {
        Generator::screw(DVec3::Z, DVec3::new(-100.0, 0.0, 0.0), 0.01, 0.0, 1.0)
    }

    /// Seen from +y with z up, x grows to the left: the path runs to the right, back above itself,
    /// and to the right again, with egress above.
    const TO_AND_FRO: [[f64; 2]; 4] = [[0.0, 0.0], [-10.0, 0.0], [-4.0, 0.1], [-14.0, 0.2]];

    #[test]
    fn a_path_that_runs_to_and_fro_is_cut_short() {
        let filled = filled(&TO_AND_FRO, along_y(), 0.2);
        assert_eq!(
            filled.absorbed,
            [false, true, true],
            "the second corner is a dent"
        );
        assert_eq!((filled.chords.len(), filled.fins.len()), (1, 1), "one fin");
        // Ends of the chord from (-10, 0) to (-14, .2): .16 from the third piece, which passes at
        // z = .16, and 4.005 from the second.
        assert!(
            filled.reach > 0.153 && filled.reach < 0.155,
            "near the third piece all along: {}",
            filled.reach
        );
    }

    #[test]
    fn dents_deeper_than_the_limit_stay() {
        assert!(
            filled(&TO_AND_FRO, along_y(), 0.05).fins.is_empty(),
            ".15 deep"
        );
    }

    #[test]
    fn a_corner_that_sticks_out_stays() {
        let filled = filled(&TO_AND_FRO[..3], along_y(), 0.2);
        assert!(
            filled.fins.is_empty(),
            "the corner lies off the egress side"
        );
    }

    #[test]
    fn nothing_is_filled_where_paths_are_straight() {
        let translation = Generator::translation(DVec3::Y);
        assert!(
            filled(&TO_AND_FRO, translation, 0.2).fins.is_empty(),
            "exact already"
        );
    }
}
