//! Loose curves, joined end to end into loops.

use super::super::drawing_error::{FigurePlace, OpenEnd};
use super::curve::Curve;
use crate::numeric::index;
use crate::surface::{PointGrid, weld};
use glam::{DVec2, DVec3};
use std::cmp::Ordering;
use std::collections::{HashMap, HashSet};

/// A curve that is not part of a closed path, and the figure to which it belongs.
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

/// The loops that loose curves form.
#[derive(Debug, Default)]
pub(super) struct JoinedLoops {
    pub(super) loops: Vec<Vec<Link>>,
    /// The ends of each curve after joining.
    pub(super) ends: Vec<[DVec2; 2]>,
    /// Largest distance by which an end was moved.
    pub(super) largest_move: f64,
    /// Number of curves left out because they run along another one from end to end.
    pub(super) repeated: usize,
    /// Number of curves left out because they are shorter than the distance.
    pub(super) tiny: usize,
    /// Lines across gaps; they are numbered after the curves.
    pub(super) bridges: Vec<Bridge>,
}

/// A straight line across a gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bridge {
    pub(super) ends: [DVec2; 2],
    /// The figure of the curve that ends at the start of the line.
    pub(super) figure: u32,
}

impl Bridge {
    pub(super) fn length(&self) -> f64 {
        self.ends[0].distance(self.ends[1])
    }
}

/// An end at a place where an odd number of ends meet.
pub(super) struct LooseEnd {
    pub(super) curve: u32,
    pub(super) at: DVec2,
    /// Number of ends that meet there, itself included.
    pub(super) meeting: usize,
    pub(super) gap: Option<f64>,
}

/// Most pairs of open ends that a line could join: they take a few hundred MB.
pub(super) const MOST_PAIRS: usize = 10_000_000;

/// Why curves do not form loops.
pub(super) enum JoinError {
    /// The ends at places where an odd number of ends meet, in the order of the curves.
    Open(Vec<LooseEnd>),
    /// A line could join more than [`MOST_PAIRS`] pairs of open ends.
    TooManyPairs,
}

/// Joins curves whose ends are within `distance` of each other. Then joins open ends by lines of
/// length at most `bridge`, nearest ends first.
///
/// Where more than two ends meet, any two of them are joined, but no loop passes a place twice:
/// what the loops enclose by the even-odd rule is the same for every choice. Of several curves that
/// lie on each other within `distance`, the first is kept.
///
/// # Errors
/// [`JoinError`].
///
/// # Cost
/// O(n) expected, and O(m log m) for m pairs of open ends within `bridge` of each other.
pub(super) fn join(curves: &[Loose], distance: f64, bridge: f64) -> Result<JoinedLoops, JoinError> {
    let ends: Vec<[DVec2; 2]> = curves.iter().map(|loose| loose.curve.ends()).collect();
    let points: Vec<_> = ends.iter().flatten().map(|p| p.extend(0.0)).collect();
    let welded = weld(&points, &[], distance);
    let mut nodes: Vec<[u32; 2]> = welded
        .place_of
        .chunks(2)
        .map(|pair| [pair[0], pair[1]])
        .collect();
    let place = |node: u32| welded.positions[node as usize].truncate();
    let mut joined = JoinedLoops {
        ends: nodes.iter().map(|pair| pair.map(place)).collect(),
        largest_move: welded.largest_move,
        ..JoinedLoops::default()
    };
    let mut kept = kept(curves, &nodes, distance, &mut joined);
    // Per node, the kept curves that end there; a closed curve is listed twice.
    let mut at_node: Vec<Vec<u32>> = vec![Vec::new(); welded.positions.len()];
    for &curve in &kept {
        nodes[curve as usize]
            .iter()
            .for_each(|&node| at_node[node as usize].push(curve));
    }
    let open: Vec<u32> = (0..index(at_node.len()))
        .filter(|&node| at_node[node as usize].len() % 2 == 1)
        .collect();
    for pair in pairs_within(&open, &place, bridge)? {
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
        return Err(JoinError::Open(with_gaps(loose)));
    }
    let mut used = vec![false; nodes.len()];
    // Per node, how many of the curves that end there are known to be used.
    let mut passed = vec![0; at_node.len()];
    // Per node, the step at which the walk leaves it.
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
            // When the walk comes back to a place, it has closed a loop.
            if let Some(start) = left_at[node as usize] {
                let links = walk.split_off(start);
                for link in &links {
                    left_at[end_of(&nodes, link.turned()) as usize] = None;
                }
                joined.loops.push(links);
            }
            let (waiting, passed) = (&at_node[node as usize], &mut passed[node as usize]);
            *passed += waiting[*passed..]
                .iter()
                .take_while(|&&curve| used[curve as usize])
                .count();
            let Some(&next) = waiting.get(*passed) else {
                break;
            };
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

/// The place at which a curve ends, in the sense in which it is run through.
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
fn pairs_within(
    nodes: &[u32],
    place: &impl Fn(u32) -> DVec2,
    length: f64,
) -> Result<Vec<[u32; 2]>, JoinError> {
    let places: Vec<DVec3> = nodes.iter().map(|&node| place(node).extend(0.0)).collect();
    let mut grid = PointGrid::new(&places, length);
    let mut pairs: Vec<(f64, [u32; 2])> = Vec::new();
    for (number, (&other, &at)) in (0u32..).zip(nodes.iter().zip(&places)) {
        let near = grid.near(&places, at).into_iter().map(|one| {
            let gap = places[one as usize].distance(at);
            (gap, [nodes[one as usize], other])
        });
        pairs.extend(near);
        if pairs.len() > MOST_PAIRS {
            return Err(JoinError::TooManyPairs);
        }
        grid.insert(at, number);
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
    Ok(chosen)
}

/// The curves that are neither shorter than `distance` nor run along another one.
fn kept(curves: &[Loose], nodes: &[[u32; 2]], distance: f64, joined: &mut JoinedLoops) -> Vec<u32> {
    let mut kept: Vec<u32> = Vec::with_capacity(curves.len());
    // Curves that may be the same have the same ends, and marks near each other. The marks of each
    // pair of ends go into a layer of their own, far from the next, so that no curve is compared
    // with all others.
    let mut layers: HashMap<[u32; 2], u32> = HashMap::new();
    let mut marks: Vec<DVec3> = Vec::with_capacity(curves.len());
    let mut grid = PointGrid::new(&[], 2.0 * SAME * distance);
    for (number, (loose, &[from, to])) in (0u32..).zip(curves.iter().zip(nodes)) {
        let next_layer = index(layers.len());
        let layer = *layers
            .entry([from.min(to), from.max(to)])
            .or_insert(next_layer);
        let height = f64::from(layer) * 16.0 * SAME * distance;
        marks.push(mark(&loose.curve, from.cmp(&to)).extend(height));
        let [low, high] = loose.curve.bounds();
        if from == to && low.distance(high) <= 2.0 * distance {
            joined.tiny += 1;
            continue;
        }
        let others = grid.near(&marks, marks[number as usize]);
        if others
            .iter()
            .any(|&other| same_course(&loose.curve, &curves[other as usize].curve, distance))
        {
            joined.repeated += 1;
        } else {
            grid.insert(marks[number as usize], number);
            kept.push(number);
        }
    }
    kept
}

/// A point that is the same for curves of the same course, whichever way they run: the sum of the
/// middle and of the point halfway between the middle and the lesser end. Where both ends are one
/// place, the mean of the two halfway points takes its place.
fn mark(curve: &Curve, ends: Ordering) -> DVec2 {
    let [first, middle, last] = [0.25, 0.5, 0.75].map(|share| curve.point_at(share));
    middle
        + match ends {
            Ordering::Less => first,
            Ordering::Equal => first.midpoint(last),
            Ordering::Greater => last,
        }
}

/// Distance up to which points of two curves count as the same, as a multiple of the distance for
/// ends: such points differ by the rounding of digits in both.
const SAME: f64 = 2.0;

/// Whether two curves with the same ends run along each other, judged at three points in between.
fn same_course(one: &Curve, other: &Curve, distance: f64) -> bool {
    let shares = [0.25, 0.5, 0.75];
    let near = |p: DVec2, q: DVec2| p.distance(q) <= SAME * distance;
    shares
        .iter()
        .all(|&s| near(one.point_at(s), other.point_at(s)))
        || shares
            .iter()
            .all(|&s| near(one.point_at(s), other.point_at(1.0 - s)))
}

/// Adds, for each end that meets no other, the distance to the nearest such end. O(n^2) in the
/// number of loose ends, up to a limit.
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
    /// The end as a message names it.
    pub(super) fn named(self, figure: FigurePlace) -> OpenEnd {
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
        let Err(JoinError::Open(ends)) = join(&curves, 1e-6, 0.0) else {
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
        let Err(JoinError::Open(ends)) = join(&curves, 1e-6, 0.0) else {
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

    #[test]
    fn many_curves_between_the_same_ends_are_not_compared_each_with_each() {
        // 2e10 pairs.
        let arcs = |turned: bool| {
            (1..=200_000).map(move |i| {
                let middle = DVec2::new(0.5, f64::from(i) * 1e-3);
                let mut points = [DVec2::ZERO, middle, DVec2::X];
                if turned {
                    points.reverse();
                }
                Loose {
                    curve: Curve::bezier(&points),
                    figure: 0,
                }
            })
        };
        let curves: Vec<Loose> = arcs(false).chain(arcs(true)).collect();
        let joined = join(&curves, 1e-6, 0.0).unwrap_or_else(|_| panic!("closed"));
        assert_eq!((joined.loops.len(), joined.repeated), (100_000, 200_000));
    }

    #[test]
    fn loops_that_meet_in_one_place_are_found_without_a_look_at_all_others() {
        // Petals of two lines and a base: at the centre 400,000 ends meet.
        let petals: Vec<[f64; 4]> = (0..200_000)
            .flat_map(|i| {
                let [x, y] = [f64::from(2 * i), f64::from(2 * i + 1)];
                [[0.0, 0.0, x, 1e6], [x, 1e6, y, 1e6], [y, 1e6, 0.0, 0.0]]
            })
            .collect();
        let joined = join(&lines(&petals), 1e-6, 0.0).unwrap_or_else(|_| panic!("closed"));
        assert_eq!(joined.loops.len(), 200_000);
    }

    #[test]
    fn gaps_between_many_ends_are_found_by_place_and_refused_where_all_are_near() {
        // Triangles with a gap of a tenth, ten apart.
        let open: Vec<[f64; 4]> = (0..50_000)
            .flat_map(|i| {
                let x = 10.0 * f64::from(i);
                [
                    [x, 0.0, x + 1.0, 0.0],
                    [x + 1.0, 0.0, x, 1.0],
                    [x, 1.0, x, 0.1],
                ]
            })
            .collect();
        let curves = lines(&open);
        let joined = join(&curves, 1e-6, 0.1).unwrap_or_else(|_| panic!("closed"));
        assert_eq!((joined.loops.len(), joined.bridges.len()), (50_000, 50_000));
        assert!(
            matches!(join(&curves, 1e-6, 1e9), Err(JoinError::TooManyPairs)),
            "each end is near each other one"
        );
    }
}
