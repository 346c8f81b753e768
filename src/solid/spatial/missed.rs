//! How far the swept region may reach out of the region that was made from its sampled cycle.
//!
//! Let e be the sampling error. Where the exact cycle winds round a point and the sampled one does
//! not, a point of the sampled cycle is within e. If that point bounds the region or is inside it,
//! the region is at most e away. But where a body is thinner than its sampling error, its sheets
//! may pass through each other, and leave pieces of the cycle with w < 1 on both sides: there the
//! region may be farther away, by their distance from it. Pieces that cancel each other exactly are
//! among them.
//!
//! Where the exact cycle does not wind round a point of the sweep, a part of a face with the wrong
//! sign sweeps over it ([`WrongSheet`]). So the distance of what these parts sweep counts as well.
//!
//! Both are found afterwards, from the result: this is a proof, whatever was dropped or simplified
//! on the way to it.

use crate::bounds::{Content, Location, SurfaceTree};
use crate::envelope::spatial::{CycleErrors, WrongSheet};
use crate::numeric::Ordered;
use crate::numeric::area::area_vector;
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use crate::surface::SurfacePoint;
use crate::watch::{Interrupted, Work};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Most prisms that are halved, apart from some for each; after them the largest bound is accepted as
/// it is.
const MOST_HALVED: usize = 10_000;

/// How often each prism may be halved on average, apart from those.
const HALVED_EACH: usize = 8;

/// Largest excess of a bound over the distance, relative to the error to which the distance is
/// added.
const PRECISION: f64 = 0.1;

/// Rounding of the height of a point along a direction, three products and two sums, in units of
/// the sum of the absolute products; for two of them, and with room.
const GAP: f64 = 8.0 * UNIT_ROUNDOFF;

/// A triangle that moves from one place to another, each point straight.
type Prism = [[SurfacePoint; 3]; 2];

/// How far the swept region may reach out of the region inside a closed boundary, apart from the
/// shortfall of the cycle and from rounding.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Missed {
    /// Bound on the distance of the pieces of the cycle that are left outside: finer sampling
    /// brings them nearer.
    pub(crate) left: f64,
    /// Bound on the distance of what wrong signs cut out, beyond that shortfall.
    pub(crate) cut_out: f64,
}

impl Missed {
    /// Both together.
    pub(crate) fn length(&self) -> f64 {
        self.left.max(self.cut_out)
    }
}

/// What the region inside a closed boundary misses.
///
/// - `outside`: pieces of the cycle that are left outside the region.
/// - `wrong`: what parts of faces with the wrong sign sweep.
///
/// # Cost
/// Some microseconds for each piece, and for each part and step; more for those that are farther
/// than expected.
pub(super) fn missed(
    outside: &[[DVec3; 3]],
    wrong: &[WrongSheet],
    errors: &CycleErrors,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    work: Work,
) -> Result<Missed, Interrupted> {
    if outside.is_empty() && wrong.is_empty() {
        return Ok(Missed::default());
    }
    let region = SurfaceTree::during(work.uncounted(), positions, triangles)?;
    let precision = PRECISION * errors.artefact();
    let [leaving, cutting] = work.parts([1, 2]);
    let levels = [0.0, 1e-3, 1e-2, 0.1, 1.0].map(|share| share * precision);
    let pieces = outside.par_iter();
    let pieces = pieces.map(|piece| resting(*piece, &region, precision));
    let left = farthest(pieces, outside.len(), &region, precision, &levels, leaving)?;
    if wrong.is_empty() {
        return Ok(Missed { left, cut_out: 0.0 });
    }
    // What the signs were chosen for is confirmed, and not examined further.
    let expected = errors.artefact().max(errors.shortfall() + left);
    let bend = wrong.iter().map(|sheet| sheet.bend).fold(0.0, f64::max);
    let least = (expected - bend).max(0.0);
    let levels = [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|k| least + 0.25 * f64::from(k) * expected);
    let steps = |sheet: &WrongSheet| sheet.parts.len() * (sheet.poses.len() - 1);
    let count = wrong.iter().map(steps).sum();
    let prisms = wrong.par_iter().flat_map_iter(prisms);
    let cut_out = bend + farthest(prisms, count, &region, precision, &levels, cutting)?;
    let cut_out = expected.max(cut_out) - errors.shortfall();
    Ok(Missed { left, cut_out })
}

/// A piece as a prism that does not move. The faces of the region next to its centre tell where
/// inwards is.
fn resting(piece: [DVec3; 3], region: &SurfaceTree, precision: f64) -> Prism {
    let centre = (piece[0] + piece[1] + piece[2]) / 3.0;
    let near = region.nearest(centre).map_or(0.0, |(_, distance)| distance) + precision;
    let mut inwards = DVec3::ZERO;
    region.for_each_in_box([centre - near, centre + near], |triangle| {
        inwards -= area_vector(region.corners(triangle)).normalize_or_zero();
    });
    let inwards = inwards.normalize_or_zero();
    [piece.map(|place| SurfacePoint { place, inwards }); 2]
}

/// What the parts of a sheet sweep between time steps.
fn prisms(sheet: &WrongSheet) -> impl Iterator<Item = Prism> {
    let at = |pose: &DAffine3, corner: SurfacePoint| SurfacePoint {
        place: pose.transform_point3(corner.place),
        inwards: pose.transform_vector3(corner.inwards).normalize_or_zero(),
    };
    sheet.parts.iter().flat_map(move |part| {
        let steps = sheet.poses.windows(2);
        steps.map(move |poses| [0, 1].map(|i| part.map(|corner| at(&poses[i], corner))))
    })
}

/// The corners of a prism, each moved inwards by a distance.
fn corners(prism: &Prism, distance: f64) -> [[DVec3; 3]; 2] {
    prism.map(|t| t.map(|corner| corner.place + corner.inwards * distance))
}

/// Upper bound of the distance of prisms from the region inside a closed boundary; one of the levels
/// if none is farther than the last of them.
///
/// - `count`: number of the prisms.
/// - `precision`: largest excess over the distance, beyond the last level.
/// - `levels`: distances that are tried for each prism, ascending.
///
/// Of the prisms that are farther, the one with the largest bound is halved first, so that no prism
/// is examined that does not matter. The distance from one triangle is convex, and so is largest at
/// a corner of the prism.
fn farthest(
    prisms: impl ParallelIterator<Item = Prism>,
    count: usize,
    region: &SurfaceTree,
    precision: f64,
    levels: &[f64],
    work: Work,
) -> Result<f64, Interrupted> {
    let items = work.items(count);
    let least = levels.first().copied().unwrap_or(0.0);
    // Those that are farther than the least level: what bounds their distance.
    let beyond: Vec<Beyond> = prisms
        .map(|prism| {
            items.next()?;
            let mut confirming = levels
                .iter()
                .filter(|&&level| is_within(region, &prism, level));
            Ok(match confirming.next() {
                Some(&level) => Beyond::Within(level),
                None => Beyond::Doubtful(Box::new(prism), distances(region, &prism)),
            })
        })
        .filter(|found| !matches!(found, Ok(Beyond::Within(level)) if *level == least))
        .collect::<Result<_, _>>()?;
    // A distance that occurs, and the largest bound that has been accepted.
    let (mut reached, mut accepted) = (0.0_f64, least);
    let mut waiting = BinaryHeap::new();
    let mut list = Vec::new();
    for found in beyond {
        match found {
            Beyond::Within(level) => accepted = accepted.max(level),
            Beyond::Doubtful(prism, [occurs, bound]) => {
                reached = reached.max(occurs);
                waiting.push((Ordered(bound), Reverse(list.len())));
                list.push(*prism);
            }
        }
    }
    let work = work.uncounted();
    let most = 2 * MOST_HALVED + (1 + 2 * HALVED_EACH) * list.len();
    while let Some((Ordered(bound), Reverse(number))) = waiting.pop() {
        work.check()?;
        if bound <= accepted {
            break;
        }
        let prism = list[number];
        let enough = accepted.max(reached + precision);
        if bound <= enough || list.len() > most {
            accepted = bound;
        } else if is_within(region, &prism, enough) {
            accepted = enough;
        } else {
            for half in halves(&prism) {
                let [occurs, bound] = distances(region, &half);
                reached = reached.max(occurs);
                waiting.push((Ordered(bound), Reverse(list.len())));
                list.push(half);
            }
        }
    }
    Ok(accepted)
}

/// A prism that is farther from the region than the least level.
enum Beyond {
    /// Not farther than this level.
    Within(f64),
    /// A distance that occurs, and a bound.
    Doubtful(Box<Prism>, [f64; 2]),
}

/// A distance that a point of a prism has from the region, and a bound for all of its points.
fn distances(region: &SurfaceTree, prism: &Prism) -> [f64; 2] {
    let corners = corners(prism, 0.0);
    let corners = corners.as_flattened();
    let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let Some((triangle, distance)) = region.nearest(centre) else {
        return [f64::INFINITY; 2];
    };
    let to_corners = corners.iter().map(|&p| region.distance_to(triangle, p));
    let bound = to_corners.fold(distance, f64::max);
    let is_inside = region.locate(centre) == Location::Inside;
    [if is_inside { 0.0 } else { distance }, bound]
}

/// Whether a prism is seen to be inside the region, or would be if its corners were moved inwards by
/// this distance, or half of it: then none of its points is farther from the region.
fn is_within(region: &SurfaceTree, prism: &Prism, distance: f64) -> bool {
    [distance, 0.0, 0.5 * distance].into_iter().any(|by| {
        let moved = corners(prism, by);
        region.locate(moved[0][0]) == Location::Inside && is_clear(region, &moved)
    })
}

/// Whether the boundary of the region does not meet the hull of a prism.
///
/// Prisms are flat, and lie along the boundary: seen along their normals, most of what is in the box
/// around them is away from them.
fn is_clear(region: &SurfaceTree, prism: &[[DVec3; 3]; 2]) -> bool {
    let corners = prism.as_flattened();
    let low = corners.iter().copied().fold(corners[0], DVec3::min);
    let high = corners.iter().copied().fold(corners[0], DVec3::max);
    let layers = prism.map(|t| {
        let normal = area_vector(t);
        (normal, extent(corners, normal))
    });
    let may_meet = |[min, max]: [DVec3; 2]| {
        let (middle, half) = (min.midpoint(max), 0.5 * (max - min));
        let largest = min.abs().max(max.abs());
        min.cmple(high).all()
            && max.cmpge(low).all()
            && layers.iter().all(|(normal, [bottom, top])| {
                let reach = normal.abs().dot(half + GAP * largest);
                let height = normal.dot(middle);
                height - reach <= *top && height + reach >= *bottom
            })
    };
    let mut open = vec![0];
    while let Some(node) = open.pop() {
        let Some(node) = region.nodes().get(node as usize) else {
            continue;
        };
        if !may_meet(region.node_bounds(node)) {
            continue;
        }
        match region.content(node) {
            Content::Children(children) => open.extend(children),
            Content::Triangles(triangles) => {
                let apart = |&t: &u32| are_apart(prism, &region.corners(t));
                if !triangles.iter().all(apart) {
                    return false;
                }
            }
        }
    }
    true
}

/// The least and the largest coordinate of points along a direction.
fn extent(points: &[DVec3], direction: DVec3) -> [f64; 2] {
    let heights = points.iter().map(|p| direction.dot(*p));
    heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| {
        [low.min(h), high.max(h)]
    })
}

/// Whether some plane is seen to separate the hull of a prism from a triangle: one parallel to a
/// side of either, or to an edge of each. Such planes exist wherever two convex bodies are apart.
fn are_apart(prism: &[[DVec3; 3]; 2], triangle: &[DVec3; 3]) -> bool {
    let corners = prism.as_flattened().iter().chain(triangle);
    let largest = corners.fold(DVec3::ZERO, |largest, p| largest.max(p.abs()));
    let separates = |direction: DVec3| {
        let one = extent(prism.as_flattened(), direction);
        let other = extent(triangle, direction);
        let gap = GAP * direction.abs().dot(largest);
        one[1] + gap < other[0] || other[1] + gap < one[0]
    };
    let edges = |t: &[DVec3; 3]| [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let [from, to] = prism;
    if [triangle, from, to]
        .into_iter()
        .any(|t| separates(area_vector(*t)))
    {
        return true;
    }
    let walls = [0, 1, 2].map(|i| {
        let next = (i + 1) % 3;
        let [a, b, c, d] = [from[i], from[next], to[next], to[i]];
        [
            (b - a).cross(d - a),
            (c - d).cross(d - a),
            (c - b).cross(b - a),
            (c - b).cross(c - d),
        ]
    });
    if walls.into_iter().flatten().any(separates) {
        return true;
    }
    let moves = [0, 1, 2].map(|i| to[i] - from[i]);
    let own = [edges(from), edges(to), moves];
    own.into_iter().flatten().any(|own| {
        edges(triangle)
            .into_iter()
            .any(|edge| separates(own.cross(edge)))
    })
}

/// The halves of a prism: across its longest side, or in time where it moves farther than that.
fn halves(prism: &Prism) -> [Prism; 2] {
    let [from, to] = *prism;
    let squared = |p: SurfacePoint, q: SurfacePoint| p.place.distance_squared(q.place);
    let side = |i: usize| {
        let length = |t: &[SurfacePoint; 3]| squared(t[i], t[(i + 1) % 3]);
        length(&from).max(length(&to))
    };
    let moved = (0..3).map(|i| squared(from[i], to[i])).fold(0.0, f64::max);
    let longest = (0..3)
        .max_by(|&i, &j| side(i).total_cmp(&side(j)))
        .unwrap_or(0);
    if moved > side(longest) {
        let middle = [0, 1, 2].map(|i| from[i].lerp(to[i], 0.5));
        return [[from, middle], [middle, to]];
    }
    [longest, (longest + 1) % 3].map(|moving| {
        prism.map(|mut t| {
            t[moving] = t[longest].lerp(t[(longest + 1) % 3], 0.5);
            t
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{cuboid, drum};
    use glam::DQuat;
    use std::f64::consts::TAU;

    fn bound_of(pieces: &[[DVec3; 3]], positions: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let region = SurfaceTree::new(positions, triangles);
        let prisms = pieces
            .par_iter()
            .map(|piece| resting(*piece, &region, 0.001));
        let levels = [0.0, 0.001];
        farthest(
            prisms,
            pieces.len(),
            &region,
            0.001,
            &levels,
            Work::UNWATCHED,
        )
        .expect("nobody stops it")
    }

    /// The bound on the distance of a triangle from a cube of size 1.
    fn farthest_from_a_cube(piece: [DVec3; 3]) -> f64 {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        bound_of(&[piece], &positions, &triangles)
    }

    #[test]
    fn the_bound_is_the_distance_but_for_a_part_of_the_error() {
        let place = |z: f64| DVec3::new(0.25, 0.25, z);
        // Parallel to the top, half a unit above it.
        let above = [
            place(1.5),
            place(1.5) + 0.5 * DVec3::X,
            place(1.5) + 0.5 * DVec3::Y,
        ];
        let bound = farthest_from_a_cube(above);
        assert!((0.5..=0.501).contains(&bound), "{bound}");
        // Slanted: the highest corner is the farthest.
        let slanted = [place(1.0), place(2.0), place(1.0) + 0.5 * DVec3::Y];
        let bound = farthest_from_a_cube(slanted);
        assert!((0.99..=1.001).contains(&bound), "{bound}");
    }

    #[test]
    fn what_is_inside_is_not_missed() {
        let inside = [
            DVec3::splat(0.4),
            DVec3::new(0.6, 0.4, 0.4),
            DVec3::new(0.4, 0.6, 0.5),
        ];
        assert_eq!(farthest_from_a_cube(inside), 0.0);
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        assert_eq!(bound_of(&[], &positions, &triangles), 0.0, "nothing");
    }

    /// Each lies over hundreds of triangles, so that a bound from one of them says nothing.
    #[test]
    fn many_long_slivers_along_a_boundary_are_near_it() {
        let drum = drum(6, 300);
        let sliver = |number: u32| {
            // From the bottom to the top of a side, at .866 from the axis, .0001 outside.
            let y = -0.4 + f64::from(number) * 2e-4;
            let at = |y: f64, z: f64| DVec3::new(-(0.75_f64.sqrt() + 1e-4), y, z);
            [at(y, -0.9), at(y, 0.9), at(y + 1e-7, 0.0)]
                .map(|place| DQuat::from_rotation_z(TAU / 12.0) * place)
        };
        let slivers: Vec<_> = (0..4_000).map(sliver).collect();
        let bound = bound_of(&slivers, drum.positions(), drum.triangles());
        assert!((1e-4..=2e-3).contains(&bound), "{bound}");
    }

    #[test]
    fn without_a_region_everything_is_missed() {
        let piece = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(bound_of(&[piece], &[], &[]), f64::INFINITY);
    }

    /// The top of a cube of size 1, moved along x, and up by `rise`.
    fn top(from: f64, to: f64, rise: [f64; 2]) -> WrongSheet {
        let pose = |x: f64, z: f64| DAffine3::from_translation(DVec3::new(x, 0.0, z));
        WrongSheet {
            parts: vec![
                [[0.1, 0.1], [0.3, 0.1], [0.1, 0.3]].map(|[x, y]| SurfacePoint {
                    place: DVec3::new(x, y, 1.0),
                    inwards: DVec3::NEG_Z,
                }),
            ],
            poses: vec![pose(from, rise[0]), pose(to, rise[1])],
            bend: 0.002,
        }
    }

    fn missed_above_a_cube(sheet: WrongSheet) -> f64 {
        let (positions, triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        let errors = CycleErrors {
            sampling: 0.01,
            dropped_fold: 0.02,
            ..CycleErrors::none()
        };
        missed(
            &[],
            &[sheet],
            &errors,
            &positions,
            &triangles,
            Work::UNWATCHED,
        )
        .expect("nobody stops it")
        .cut_out
    }

    #[test]
    fn what_is_swept_within_the_expected_depth_is_confirmed() {
        // Up to .028 above the top, and .002 for the bend: the .03 expected, without the sampling.
        for rise in [[0.0, 0.0], [0.0, 0.0279], [-0.5, 0.0279], [-0.5, -0.2]] {
            let missed = missed_above_a_cube(top(0.0, 0.5, rise));
            assert!((missed - 0.02).abs() < 1e-15, "{rise:?}: {missed}");
        }
    }

    #[test]
    fn what_is_swept_farther_off_counts() {
        // .05 above the top, or .1 beside it, with the bend and without the sampling; the precision
        // is a tenth of the sampling.
        for (sheet, expected) in [
            (top(0.0, 0.5, [0.0, 0.05]), 0.05),
            (top(0.3, 0.8, [-0.5, -0.5]), 0.1),
        ] {
            let missed = missed_above_a_cube(sheet);
            let least = expected + 0.002 - 0.01;
            assert!((least..=least + 0.001).contains(&missed), "{missed}");
        }
    }
}
