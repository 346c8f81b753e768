//! Snap rounding: the points of the grid through which each segment must pass.
//!
//! A pixel is *hot* if it contains an end of a segment or a crossing of two. A segment is replaced
//! by the chain of the centres of the hot pixels that it meets, in order along the segment. The
//! pieces of all chains then meet only at their ends, or are equal. For suppose that a hot centre c
//! is inside a piece from a to b. Then the point of the segment that corresponds to c lies in the
//! pixel of c (the pixels are equal convex sets), so the segment meets that pixel and is already
//! bent there. And while all points of the segments move straight to their places, no segment
//! sweeps over a hot centre, so none that did not cross before does after. One round is enough.
//! Every point moves by at most half the diagonal of a cell.
//!
//! # Source
//! Hobby (1999), Practical segment intersection with finite precision output; Guibas & Marimont
//! (1998). We differ: a tree of boxes finds the pairs and the pixels, instead of a sweep.

use super::strokes::{Stroke, Strokes, summed};
use crate::bounds::SurfaceTree;
use crate::numeric::exact::planar_grid::{Node, cross, crossing, local, meets_pixel};
use crate::numeric::index;
use crate::watch::{Interrupted, Work};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Segments or points per parallel task: a constant, so that the order does not depend on the
/// number of threads.
const PIECE: usize = 512;

/// Margin of the search for pairs, in cells: a segment is within this distance of the centre of
/// each pixel that it meets, and both move by less.
const REACH: f64 = 2.0;

/// A node through which a stroke must pass.
struct Pass {
    stroke: u32,
    node: Node,
    /// Whether a crossing made the node, so that it need not be the end of a stroke.
    is_crossing: bool,
}

/// Cuts all strokes at the hot pixels that they meet; this may add nodes.
pub(super) fn cut(strokes: Strokes, work: Work) -> Result<Strokes, Interrupted> {
    let [pairing, piercing] = work.parts([3, 1]);
    let Strokes {
        nodes: ends,
        strokes,
        mut cancelled,
    } = strokes;
    let tree = tree(&ends, &strokes);
    let mut passes = passes_of_pairs(&ends, &strokes, &tree, pairing)?;
    let mut fresh: Vec<Node> = passes
        .par_iter()
        .filter(|pass| pass.is_crossing)
        .map(|pass| pass.node)
        .collect();
    fresh.par_sort_unstable();
    fresh.dedup();
    let mut is_end = vec![false; ends.len()];
    for stroke in &strokes {
        stroke
            .ends
            .iter()
            .for_each(|&end| is_end[end as usize] = true);
    }
    let found = |node: &Node| ends.binary_search(node);
    // The pixels of ends were already tested with the pairs.
    fresh.retain(|node| !found(node).is_ok_and(|end| is_end[end]));
    passes.extend(passes_of_pixels(&ends, &strokes, &tree, &fresh, piercing)?);
    drop(tree);
    fresh.retain(|node| found(node).is_err());
    let mut nodes = ends.clone();
    nodes.extend(fresh);
    nodes.par_sort_unstable();
    let number = |node: &Node| index(nodes.binary_search(node).unwrap_or_default());
    let new_number: Vec<u32> = ends.par_iter().map(number).collect();
    let mut stops: Vec<(u32, u32)> = passes
        .par_iter()
        .map(|pass| (pass.stroke, number(&pass.node)))
        .collect();
    drop(passes);
    stops.par_sort_unstable();
    stops.dedup();
    let renumbered = |ends: [u32; 2]| ends.map(|end| new_number[end as usize]);
    work.check()?;
    let mut pieces = Vec::with_capacity(strokes.len() + stops.len());
    let mut rest = stops.as_mut_slice();
    for (stroke, place) in strokes.iter().zip(0_u32..) {
        let count = rest.iter().take_while(|stop| stop.0 == place).count();
        let (mine, others) = rest.split_at_mut(count);
        rest = others;
        let stroke = Stroke {
            ends: renumbered(stroke.ends),
            ..*stroke
        };
        chain(&nodes, stroke, mine, &mut pieces);
    }
    work.check()?;
    let (pieces, more) = summed(pieces);
    cancelled = cancelled.into_iter().map(renumbered).collect();
    cancelled.extend(more);
    Ok(Strokes {
        nodes,
        strokes: pieces,
        cancelled,
    })
}

/// Adds the pieces of a stroke between its stops, which are in ascending order.
fn chain(nodes: &[Node], stroke: Stroke, stops: &mut [(u32, u32)], pieces: &mut Vec<Stroke>) {
    let [first, last] = stroke.ends;
    let place = |number: u32| nodes[number as usize];
    if place(last)[1] < place(first)[1] {
        // The stroke passes the pixels of one column downwards.
        stops.sort_unstable_by_key(|&(_, stop)| (place(stop)[0], -place(stop)[1]));
    }
    let mut from = first;
    for to in stops.iter().map(|stop| stop.1).chain([last]) {
        if from != to {
            let is_ascending = from < to;
            pieces.push(Stroke {
                ends: [from.min(to), from.max(to)],
                weight: if is_ascending {
                    stroke.weight
                } else {
                    -stroke.weight
                },
            });
            from = to;
        }
    }
}

/// A tree over the strokes, in cells.
fn tree(nodes: &[Node], strokes: &[Stroke]) -> SurfaceTree {
    let positions: Vec<DVec2> = nodes.iter().map(|&node| local(node)).collect();
    let segments: Vec<[u32; 2]> = strokes.iter().map(|stroke| stroke.ends).collect();
    SurfaceTree::of_segments(&positions, &segments)
}

fn passes_of_pairs(
    nodes: &[Node],
    strokes: &[Stroke],
    tree: &SurfaceTree,
    work: Work,
) -> Result<Vec<Pass>, Interrupted> {
    let items = work.items(strokes.len());
    let numbers: Vec<u32> = (0..index(strokes.len())).collect();
    let ends_of = |stroke: u32| strokes[stroke as usize].ends.map(|end| nodes[end as usize]);
    let parts: Vec<Vec<Pass>> = numbers
        .par_chunks(PIECE)
        .map(|part| {
            let mut passes = Vec::new();
            for &one in part {
                items.next()?;
                let ends = ends_of(one);
                let [from, to] = ends.map(|end| local(end).extend(0.0));
                tree.for_each_near_segment(from, to, REACH, |other| {
                    if other > one {
                        meet([one, other], [ends, ends_of(other)], &mut passes);
                    }
                });
            }
            Ok(passes)
        })
        .collect::<Result<_, Interrupted>>()?;
    Ok(parts.into_iter().flatten().collect())
}

/// Adds the nodes where two strokes cross, or where one meets the pixel of an end of the other.
fn meet(strokes: [u32; 2], ends: [[Node; 2]; 2], passes: &mut Vec<Pass>) {
    let [[a, b], [c, d]] = ends;
    let sides = [
        [cross(a, b, c).signum(), cross(a, b, d).signum()],
        [cross(c, d, a).signum(), cross(c, d, b).signum()],
    ];
    let is_crossed = |[one, two]: [i128; 2]| one * two < 0;
    if sides.into_iter().all(is_crossed) {
        let node = crossing(ends[0], ends[1]);
        passes.extend(strokes.map(|stroke| Pass {
            stroke,
            node,
            is_crossing: true,
        }));
    }
    for (k, stroke) in strokes.into_iter().enumerate() {
        let mine = ends[k];
        for node in ends[1 - k] {
            if !mine.contains(&node) && meets_pixel(mine, node) {
                passes.push(Pass {
                    stroke,
                    node,
                    is_crossing: false,
                });
            }
        }
    }
}

/// The strokes that meet the pixels of crossings.
fn passes_of_pixels(
    nodes: &[Node],
    strokes: &[Stroke],
    tree: &SurfaceTree,
    hot: &[Node],
    work: Work,
) -> Result<Vec<Pass>, Interrupted> {
    let items = work.items(hot.len());
    let parts: Vec<Vec<Pass>> = hot
        .par_chunks(PIECE)
        .map(|part| {
            let mut passes = Vec::new();
            for &node in part {
                items.next()?;
                let place = local(node).extend(0.0);
                let reach = DVec3::splat(REACH);
                tree.for_each_in_box([place - reach, place + reach], |stroke| {
                    let ends = strokes[stroke as usize].ends.map(|end| nodes[end as usize]);
                    if meets_pixel(ends, node) {
                        passes.push(Pass {
                            stroke,
                            node,
                            is_crossing: true,
                        });
                    }
                });
            }
            Ok(passes)
        })
        .collect::<Result<_, Interrupted>>()?;
    Ok(parts.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random strokes between the points of a small grid, not closed.
    fn strokes(seed: u64, size: u64, count: usize) -> Strokes {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut below = |limit: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            i64::try_from((state >> 33) % limit).unwrap_or_default()
        };
        // Every other case covers a large extent, so that segments are long and pass many pixels at
        // shallow angles.
        let far = if seed.is_multiple_of(2) { 1 } else { 50 };
        let mut ends: Vec<[Node; 2]> = (0..count)
            .map(|_| [0, 1].map(|_| [below(size) * below(far + 1).max(1), below(size)]))
            .filter(|ends| ends[0] != ends[1])
            .collect();
        ends.sort_unstable();
        let mut nodes: Vec<Node> = ends.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let number = |node: &Node| index(nodes.binary_search(node).unwrap_or_default());
        let strokes = ends
            .iter()
            .map(|ends| {
                let [a, b] = [number(&ends[0]), number(&ends[1])];
                Stroke {
                    ends: [a.min(b), a.max(b)],
                    weight: 1,
                }
            })
            .collect();
        let (strokes, cancelled) = summed(strokes);
        Strokes {
            nodes,
            strokes,
            cancelled,
        }
    }

    #[test]
    fn pieces_meet_at_their_ends_only() {
        let mut crossings = 0;
        for seed in 0..600 {
            let given = strokes(seed, 3 + seed % 12, 3 + (seed % 23) as usize);
            let before = given.nodes.len();
            let Strokes { nodes, strokes, .. } =
                cut(given, Work::UNWATCHED).expect("nobody stops it");
            crossings += nodes.len() - before;
            for piece in &strokes {
                let [a, b] = piece.ends.map(|end| nodes[end as usize]);
                for node in &nodes {
                    let is_between = cross(a, b, *node) == 0 && a < *node && *node < b;
                    assert!(!is_between, "case {seed}: {node:?} in {a:?} {b:?}");
                }
                for other in &strokes {
                    let [c, d] = other.ends.map(|end| nodes[end as usize]);
                    let parts = |a, b, c, d| cross(a, b, c).signum() * cross(a, b, d).signum() < 0;
                    let is_crossed = parts(a, b, c, d) && parts(c, d, a, b);
                    assert!(!is_crossed, "case {seed}: {a:?} {b:?} and {c:?} {d:?}");
                }
            }
        }
        assert!(crossings > 1000, "{crossings} crossings off the ends");
    }
}
