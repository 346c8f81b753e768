//! Loose curves, end to end, as loops.

use super::curve::Curve;
use super::error::OpenEnd;
use crate::bounds::weld;
use crate::numeric::index;
use glam::DVec2;
use std::collections::{HashMap, HashSet};

/// A curve that is not part of a closed path, and the figure that it is of.
#[derive(Debug, Clone)]
pub(super) struct Loose {
    pub(super) curve: Curve,
    pub(super) figure: u32,
}

/// A curve of a loop, run through from its start or from its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Link {
    pub(super) curve: u32,
    pub(super) reversed: bool,
}

/// Loops of loose curves.
#[derive(Debug, Default)]
pub(super) struct Joined {
    pub(super) loops: Vec<Vec<Link>>,
    /// Where the ends of each curve are now.
    pub(super) ends: Vec<[DVec2; 2]>,
    /// Largest distance by which an end was moved.
    pub(super) largest_move: f64,
    /// Curves that run along another one from end to end, and are left out.
    pub(super) repeated: usize,
    /// Curves shorter than the distance, left out.
    pub(super) tiny: usize,
    /// Lines across gaps, numbered after the curves.
    pub(super) bridges: Vec<Bridge>,
}

/// A straight line across a gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bridge {
    pub(super) ends: [DVec2; 2],
    /// Of the curve that ends at its start.
    pub(super) figure: u32,
}

impl Bridge {
    pub(super) fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }
}

/// An end at a place where an odd number of them meets.
pub(super) struct LooseEnd {
    pub(super) curve: u32,
    pub(super) at: DVec2,
    /// Number of ends that meet there, itself included.
    pub(super) meeting: usize,
    pub(super) gap: Option<f64>,
}

/// Joins curves whose ends are within `distance` of each other, and then those open ends that a line of length `bridge` joins, nearest
/// ends first.
///
/// Where more than two ends meet, any two of them are joined, such that no loop comes through a place twice: what the loops
/// enclose by the even-odd rule is always the same.
/// Of curves that lie on each other within `distance` the first is kept.
///
/// # Errors
/// The ends at places where an odd number of them meets, in the order of the curves.
///
/// # Cost
/// O(n) expected, and O(m^2) for m open ends.
pub(super) fn join(curves: &[Loose], distance: f64, bridge: f64) -> Result<Joined, Vec<LooseEnd>> {
    let ends: Vec<[DVec2; 2]> = curves.iter().map(|loose| loose.curve.ends()).collect();
    let points: Vec<_> = ends.iter().flatten().map(|p| p.extend(0.0)).collect();
    let welded = weld(&points, &[], distance);
    let mut nodes: Vec<[u32; 2]> = welded
        .place_of
        .chunks(2)
        .map(|pair| [pair[0], pair[1]])
        .collect();
    let place = |node: u32| welded.positions[node as usize].truncate();
    let mut joined = Joined {
        ends: nodes.iter().map(|pair| pair.map(place)).collect(),
        largest_move: welded.largest_move,
        ..Joined::default()
    };
    let mut kept = kept(curves, &nodes, distance, &mut joined);
    // Per node, the kept curves that end there; a curve that closes on itself is there twice.
    let mut at_node: Vec<Vec<u32>> = vec![Vec::new(); welded.positions.len()];
    for &curve in &kept {
        nodes[curve as usize]
            .iter()
            .for_each(|&node| at_node[node as usize].push(curve));
    }
    let open: Vec<u32> = (0..index(at_node.len()))
        .filter(|&node| at_node[node as usize].len() % 2 == 1)
        .collect();
    for pair in pairs_within(&open, &place, bridge) {
        let number = index(nodes.len());
        let figure = curves[at_node[pair[0] as usize][0] as usize].figure;
        joined.bridges.push(Bridge {
            ends: pair.map(place),
            figure,
        });
        nodes.push(pair);
        kept.push(number);
        pair.iter()
            .for_each(|&node| at_node[node as usize].push(number));
    }
    let loose: Vec<LooseEnd> = kept
        .iter()
        .flat_map(|&curve| nodes[curve as usize].map(|node| (curve, node)))
        .filter(|&(_, node)| at_node[node as usize].len() % 2 == 1)
        .map(|(curve, node)| LooseEnd {
            curve,
            at: place(node),
            meeting: at_node[node as usize].len(),
            gap: None,
        })
        .collect();
    if !loose.is_empty() {
        return Err(with_gaps(loose));
    }
    let mut used = vec![false; nodes.len()];
    // Per node, where in the walk it is left.
    let mut left_at: Vec<Option<usize>> = vec![None; at_node.len()];
    for &first in &kept {
        let mut walk: Vec<Link> = Vec::new();
        let mut link = Link {
            curve: first,
            reversed: false,
        };
        while !std::mem::replace(&mut used[link.curve as usize], true) {
            left_at[end_of(&nodes, link.turned()) as usize] = Some(walk.len());
            walk.push(link);
            let node = end_of(&nodes, link);
            // Where the walk comes back to a place, what lies between is a loop.
            if let Some(start) = left_at[node as usize] {
                let links = walk.split_off(start);
                for link in &links {
                    left_at[end_of(&nodes, link.turned()) as usize] = None;
                }
                joined.loops.push(links);
            }
            let waiting = &mut at_node[node as usize];
            waiting.retain(|&curve| !used[curve as usize]);
            let Some(&next) = waiting.first() else { break };
            link = Link {
                curve: next,
                reversed: nodes[next as usize][0] != node,
            };
        }
        debug_assert!(
            walk.is_empty(),
            "an even number of ends meets at each place"
        );
    }
    Ok(joined)
}

/// The place at which a curve ends, as it is run through.
fn end_of(nodes: &[[u32; 2]], link: Link) -> u32 {
    nodes[link.curve as usize][usize::from(!link.reversed)]
}

impl Link {
    /// The same curve in the other sense.
    fn turned(self) -> Link {
        Link {
            reversed: !self.reversed,
            ..self
        }
    }
}

/// Pairs of nodes at most `length` apart, each node in one pair at most, the nearest first.
fn pairs_within(nodes: &[u32], place: &impl Fn(u32) -> DVec2, length: f64) -> Vec<[u32; 2]> {
    let mut pairs: Vec<(f64, [u32; 2])> = Vec::new();
    for (i, &one) in nodes.iter().enumerate() {
        let near = nodes[i + 1..]
            .iter()
            .map(|&other| (place(one).distance(place(other)), [one, other]));
        pairs.extend(near.filter(|(gap, _)| *gap <= length));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut free: HashSet<u32> = nodes.iter().copied().collect();
    let mut chosen = Vec::new();
    for (_, pair) in pairs {
        if pair.iter().all(|node| free.contains(node)) {
            pair.iter().for_each(|node| {
                free.remove(node);
            });
            chosen.push(pair);
        }
    }
    chosen
}

/// The curves without those that are shorter than `distance` or run along another one.
fn kept(curves: &[Loose], nodes: &[[u32; 2]], distance: f64, joined: &mut Joined) -> Vec<u32> {
    let mut kept: Vec<u32> = Vec::with_capacity(curves.len());
    let mut between: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
    for (number, (loose, &[from, to])) in (0u32..).zip(curves.iter().zip(nodes)) {
        let [low, high] = loose.curve.bounds();
        if from == to && low.distance(high) <= 2.0 * distance {
            joined.tiny += 1;
            continue;
        }
        let others = between.entry([from.min(to), from.max(to)]).or_default();
        if others
            .iter()
            .any(|&other| same_course(&loose.curve, &curves[other as usize].curve, distance))
        {
            joined.repeated += 1;
        } else {
            others.push(number);
            kept.push(number);
        }
    }
    kept
}

/// Whether two curves with the same ends run along each other, told at three points between.
fn same_course(one: &Curve, other: &Curve, distance: f64) -> bool {
    let shares = [0.25, 0.5, 0.75];
    // Points that were given twice differ by the rounding of two files' worth of digits.
    let near = |p: DVec2, q: DVec2| p.distance(q) <= 2.0 * distance;
    shares
        .iter()
        .all(|&s| near(one.point_at(s), other.point_at(s)))
        || shares
            .iter()
            .all(|&s| near(one.point_at(s), other.point_at(1.0 - s)))
}

/// The distance from each end that meets no other to the nearest one. O(n^2) in the number of loose ends, up to a limit.
fn with_gaps(mut ends: Vec<LooseEnd>) -> Vec<LooseEnd> {
    const COMPARED: usize = 2000;
    let places: Vec<DVec2> = ends.iter().take(COMPARED).map(|end| end.at).collect();
    for (i, end) in ends.iter_mut().enumerate().take(COMPARED) {
        if end.meeting > 1 {
            continue;
        }
        let others = places.iter().enumerate().filter(|(k, _)| *k != i);
        end.gap = others.map(|(_, p)| p.distance(end.at)).reduce(f64::min);
    }
    ends
}

impl LooseEnd {
    /// The end for a message.
    pub(super) fn named(self, figure: super::FigurePlace) -> OpenEnd {
        OpenEnd {
            figure,
            at: self.at,
            meeting: self.meeting,
            gap: self.gap,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn lines(points: &[[f64; 4]]) -> Vec<Loose> {
        let line = |p: &[f64; 4]| Curve::Line([DVec2::new(p[0], p[1]), DVec2::new(p[2], p[3])]);
        points
            .iter()
            .map(|p| Loose {
                curve: line(p),
                figure: 0,
            })
            .collect()
    }

    #[test]
    fn lines_in_any_order_and_sense_are_joined_to_a_loop() {
        let curves = lines(&[
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 1.0, 1.0, 1.0],
            [1.0, 1.0, 1.0, 1e-7],
        ]);
        let joined = join(&curves, 1e-6, 0.0).unwrap_or_else(|_| panic!("closed"));
        let link = |curve, reversed| Link { curve, reversed };
        assert_eq!(
            joined.loops,
            [vec![
                link(0, false),
                link(3, true),
                link(2, true),
                link(1, false)
            ]]
        );
        assert_eq!(joined.largest_move, 1e-7, "the gap");
        assert_eq!(
            joined.ends[3][1],
            DVec2::X,
            "moved to the end that came first"
        );
    }

    #[test]
    fn ends_that_meet_no_other_are_told_with_the_gap() {
        let curves = lines(&[
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 1.0, 1.0, 1.0],
            [1.0, 1.0, 1.0, 0.125],
        ]);
        let Err(ends) = join(&curves, 1e-6, 0.0) else {
            panic!("open")
        };
        let found: Vec<(u32, DVec2, Option<f64>)> = ends
            .iter()
            .map(|end| (end.curve, end.at, end.gap))
            .collect();
        assert_eq!(
            found,
            [
                (0, DVec2::X, Some(0.125)),
                (3, DVec2::new(1.0, 0.125), Some(0.125))
            ]
        );
    }

    #[test]
    fn a_diagonal_makes_places_where_three_ends_meet() {
        let curves = lines(&[
            [0.0, 0.0, 1.0, 0.0],
            [1.0, 0.0, 1.0, 1.0],
            [1.0, 1.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 1.0],
        ]);
        let Err(ends) = join(&curves, 1e-6, 0.0) else {
            panic!("branches")
        };
        let found: Vec<u32> = ends.iter().map(|end| end.curve).collect();
        assert_eq!(found, [0, 1, 2, 3, 4, 4], "the diagonal with both its ends");
        assert!(
            ends.iter().all(|end| end.meeting == 3 && end.gap.is_none()),
            "three curves, and no gap"
        );
    }

    #[test]
    fn a_gap_is_closed_by_a_line_where_that_is_asked_for() {
        let curves = lines(&[
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 1.0, 1.0, 1.0],
            [1.0, 1.0, 1.0, 0.125],
        ]);
        assert!(join(&curves, 1e-6, 0.124).is_err(), "the gap is longer");
        let joined = join(&curves, 1e-6, 0.125).unwrap_or_else(|_| panic!("closed"));
        let ends = [DVec2::X, DVec2::new(1.0, 0.125)];
        assert_eq!(joined.bridges, [Bridge { ends, figure: 0 }]);
        assert_eq!(joined.loops[0].len(), 5, "four lines and the bridge");
    }

    #[test]
    fn a_line_drawn_twice_counts_once() {
        let curves = lines(&[
            [0.0, 0.0, 1.0, 0.0],
            [1.0, 0.0, 0.0, 1.0],
            [1e-7, 0.0, 1.0, 0.0],
            [0.0, 1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
        ]);
        let joined = join(&curves, 1e-6, 0.0).unwrap_or_else(|_| panic!("closed"));
        assert_eq!((joined.loops.len(), joined.repeated), (1, 2));
        // Two half circles between the same ends are not the same.
        let half = |start| Loose {
            curve: Curve::circular(DVec2::ZERO, 1.0, start, PI),
            figure: 0,
        };
        let joined = join(&[half(0.0), half(PI)], 1e-6, 0.0).unwrap_or_else(|_| panic!("closed"));
        assert_eq!((joined.loops.len(), joined.repeated), (1, 0));
    }

    #[test]
    fn triangles_that_meet_in_a_point_are_closed() {
        let curves = lines(&[
            [0.0, 0.0, 1.0, 0.0],
            [1.0, 0.0, 1.0, 1.0],
            [1.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, -1.0, 0.0],
            [-1.0, 0.0, -1.0, 1.0],
            [-1.0, 1.0, 0.0, 0.0],
        ]);
        let joined = join(&curves, 1e-6, 0.0).unwrap_or_else(|_| panic!("closed"));
        assert_eq!(
            joined.loops.iter().map(Vec::len).sum::<usize>(),
            6,
            "every line is in a loop"
        );
    }
}
