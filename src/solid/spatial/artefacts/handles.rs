//! Handles that the sampling made: they are found by the short loops around and through them, and
//! are cut or filled.
//!
//! Where sheets run closer to each other than their sampling errors, they cross to and fro: this
//! leaves bridges of solid across a crevice, or holes in a film of solid. A cavity would be a
//! pocket (`pockets`); these are connected with the outside, and appear as handles. Surgery along a
//! loop that does not separate the boundary removes one: the boundary is cut along the loop, and
//! the same disk closes both sides. A disk inside the solid cuts a bridge, one outside fills a
//! hole, and neither changes the volume.
//!
//! - A loop without width is rounding ([`CRUMB`]): it lies between sheets that differ only by
//!   rounding.
//! - A hole nowhere wider than the sampling error allows cannot be distinguished from a crevice
//!   that the sampling opened, and is filled. So is a hole up to the bound of the shortfall if the
//!   exact sweep contains its disk. The distance of every point of the disk from the loop is at
//!   most half the width of the hole, so the result reaches out of the exact sweep by at most that
//!   much more.
//! - A bridge is cut if it is not part of the exact sweep. This makes the result smaller, by zero
//!   volume.
//!
//! The remaining handles are those of the exact sweep.

use super::loops::{Loop, loops, shortest_near};
use crate::bounds::{SurfaceTree, are_apart};
use crate::membership::Membership;
use crate::numeric::area::area_vector;
use crate::numeric::tolerance::{CRUMB, WELD_DISTANCE};
use crate::surface::{Halves, Shells, bounds_of, genus, next_in};
use crate::watch::{Interrupted, Stop, Work};
use glam::DVec3;
use std::collections::BTreeSet;

/// Most corners of a disk: the number of steps for its best triangulation is their third power.
const MOST_CORNERS: usize = 64;

/// Length of the longest loop that is searched for, in units of the shortfall. Longer ones go
/// around handles of the body, or are so narrow that shorter ones disappear with them.
const LONGEST_LOOP: f64 = 256.0;

/// Most passes over the surface. Surgeries of one pass stay apart from each other, so those that
/// touch wait for the next.
const ROUNDS: usize = 8;

/// Distance by which the two sides of a disk are moved apart, in units of [`WELD_DISTANCE`] of the
/// diagonal: readers then keep them apart.
const APART: f64 = 8.0;

/// Number of points of a disk that are tested against the exact sweep.
const PROBES: usize = 5;

/// The result of the removal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Removed {
    /// Number of removed handles.
    pub(crate) handles: usize,
    /// Bound on the distance of the points of filled holes from the previous boundary.
    pub(crate) depth: f64,
    /// Bound on the distance by which vertices were moved so that the two sides of disks are apart.
    pub(crate) moved: f64,
}

/// Removes the handles that the sampling made.
///
/// # Errors
/// [`Stop`]: a fault when the surface is not closed.
pub(crate) fn remove(
    positions: &mut Vec<DVec3>,
    triangles: &mut Vec<[u32; 3]>,
    sampling: f64,
    shortfall: f64,
    membership: &Membership,
    work: Work,
) -> Result<Removed, Stop> {
    let shells = Shells::new(triangles);
    work.check()?;
    let mut removed = Removed::default();
    if shells.members.iter().all(|m| genus(triangles, m) == 0) {
        return Ok(removed);
    }
    let [low, high] = bounds_of(positions.iter().copied());
    let judge = Judge {
        crumb: CRUMB * low.abs().max(high.abs()).max_element(),
        apart: APART * WELD_DISTANCE * low.distance(high),
        sampling,
        shortfall,
        membership,
        work: work.uncounted(),
    };
    work.check()?;
    let mut surface = Halves::new(positions, triangles)?;
    for number in 0..ROUNDS {
        // Each leaves less to the next.
        let done = round(&mut surface, &judge, work.part(1, 2 << number))?;
        if done.handles == 0 {
            break;
        }
        removed.handles += done.handles;
        // Later loops may pass over the disks of earlier ones.
        removed.depth += done.depth;
        removed.moved += judge.apart;
    }
    (*positions, *triangles) = (surface.positions, surface.triangles);
    Ok(removed)
}

/// One pass of surgeries that stay apart from each other: each loop is found and judged on a part
/// of the surface that has not changed.
fn round(surface: &mut Halves, judge: &Judge, work: Work) -> Result<Removed, Interrupted> {
    let mut done = Removed::default();
    let places = loops(surface, work)?;
    if places.is_empty() {
        return Ok(done);
    }
    let tree = SurfaceTree::during(work.uncounted(), &surface.positions, &surface.triangles)?;
    let mut touched = BTreeSet::new();
    let items = work.items(places.len());
    for first in &places {
        items.next()?;
        if touched.contains(&first.middle(surface)) {
            continue;
        }
        let is_whole = |found: &Loop| {
            !found
                .path
                .iter()
                .any(|&h| touched.contains(&surface.from(h)))
        };
        let Some((found, disk)) = judge.best(surface, &tree, first, is_whole) else {
            continue;
        };
        // Loops found at different places may go around the same handle.
        if done.handles > 0 && !surface.stays_connected(&found.path) {
            continue;
        }
        for &half in &found.path {
            touched.extend(
                surface
                    .around(surface.from(half))
                    .map(|spoke| surface.to(spoke)),
            );
        }
        let copies = surface.operate(&found.path, &disk.triangles);
        for &copy in &copies {
            surface.positions[copy as usize] += disk.apart;
        }
        touched.extend(copies);
        done.handles += 1;
        if disk.kind == DiskKind::Hole {
            done.depth = done.depth.max(disk.half_width);
        }
    }
    Ok(done)
}

/// The kind of a disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DiskKind {
    /// It has no width.
    Flat,
    /// It lies outside.
    Hole,
    /// It lies inside.
    Bridge,
}

/// Whether the exact sweep was tested, and agrees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Doubt {
    None,
    Some,
}

/// A surface that a loop bounds.
struct Disk {
    /// Triples of places on the loop, in its sense.
    triangles: Vec<[usize; 3]>,
    kind: DiskKind,
    doubt: Doubt,
    half_width: f64,
    /// Displacement by which the two copies come apart, on the right side of the loop.
    apart: DVec3,
}

/// Decides about loops.
struct Judge<'a> {
    /// When it is stopped, no more loops are found.
    work: Work<'a>,
    crumb: f64,
    apart: f64,
    sampling: f64,
    shortfall: f64,
    membership: &'a Membership,
}

impl Judge<'_> {
    /// The best loop at a place, with its disk.
    fn best(
        &self,
        surface: &Halves,
        tree: &SurfaceTree,
        first: &Loop,
        is_whole: impl Fn(&Loop) -> bool,
    ) -> Option<(Loop, Disk)> {
        let limit = LONGEST_LOOP * self.shortfall.max(self.apart);
        shortest_near(surface, first, limit, self.work)
            .chain([vec![first.clone()]])
            .find_map(|choice| {
                choice
                    .into_iter()
                    .filter(|found| is_whole(found))
                    .filter_map(|found| self.disk(surface, tree, &found).map(|disk| (found, disk)))
                    .min_by_key(|(_, disk)| disk.doubt)
            })
    }

    /// The disk of a loop, if surgery along it is warranted.
    fn disk(&self, surface: &Halves, tree: &SurfaceTree, found: &Loop) -> Option<Disk> {
        let corners: Vec<DVec3> = found
            .path
            .iter()
            .map(|&h| surface.at(surface.from(h)))
            .collect();
        if corners.len() > MOST_CORNERS {
            return None;
        }
        let half_width = half_width(&corners);
        if half_width > self.shortfall.max(self.crumb) {
            return None;
        }
        let triangles = triangulated(&corners);
        let normal: DVec3 = triangles
            .iter()
            .map(|t| area_vector(t.map(|i| corners[i])))
            .sum();
        if half_width <= self.crumb {
            return Some(Disk {
                triangles,
                kind: DiskKind::Flat,
                doubt: Doubt::None,
                half_width,
                apart: DVec3::ZERO,
            });
        }
        let is_outside = lies_outside(surface, found, &triangles, &corners);
        let mut faces: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(|i| corners[i])).collect();
        faces.sort_by(|a, b| {
            area_vector(*b)
                .length_squared()
                .total_cmp(&area_vector(*a).length_squared())
        });
        let swept = faces
            .iter()
            .take(PROBES)
            .filter(|[a, b, c]| self.membership.is_ever_inside((*a + *b + *c) / 3.0))
            .count();
        let probes = faces.len().min(PROBES);
        let (kind, doubt, sense) = if is_outside {
            let doubt = if swept == probes {
                Doubt::None
            } else if half_width <= self.sampling {
                Doubt::Some
            } else {
                return None;
            };
            (DiskKind::Hole, doubt, 1.0)
        } else if swept == 0 {
            (DiskKind::Bridge, Doubt::None, -1.0)
        } else {
            return None;
        };
        if !self.is_clear(tree, &faces, &corners) {
            return None;
        }
        // The disk of the right side has the sense of the loop and faces away from the solid.
        let apart = normal.normalize_or_zero() * (sense * self.apart);
        Some(Disk {
            triangles,
            kind,
            doubt,
            half_width,
            apart,
        })
    }
}

impl Judge<'_> {
    /// Whether no triangle of the surface passes through a disk, except those that it touches at
    /// its corners.
    fn is_clear(&self, tree: &SurfaceTree, disk: &[[DVec3; 3]], corners: &[DVec3]) -> bool {
        let is_corner = |p: &DVec3| corners.iter().any(|c| c.distance(*p) <= 2.0 * self.apart);
        disk.iter().all(|face| {
            let [a, b, c] = *face;
            let mut clear = true;
            tree.for_each_in_box([a.min(b).min(c), a.max(b).max(c)], |triangle| {
                let other = tree.corners(triangle);
                clear = clear && (other.iter().any(is_corner) || are_apart(face, &other));
            });
            clear
        })
    }
}

/// Whether a disk starts from its loop on the outside of the surface, along most of the loop's
/// length.
fn lies_outside(surface: &Halves, found: &Loop, disk: &[[usize; 3]], corners: &[DVec3]) -> bool {
    let count = corners.len();
    let mut outside = 0.0;
    for triangle in disk {
        for k in 0..3 {
            let [from, to, apex] = [0, 1, 2].map(|i| triangle[(k + i) % 3]);
            if (from + 1) % count != to {
                continue;
            }
            let half = found.path[from];
            let way = (corners[to] - corners[from]).normalize_or_zero();
            let across = |p: DVec3| (p - corners[from]).reject_from(way).normalize_or_zero();
            let apex_of = |half: u32| surface.at(surface.to(next_in(half)));
            let left = across(apex_of(half));
            let right = across(apex_of(surface.mate(half)));
            // The triangle on the left of the edge faces this side.
            let up = way.cross(left);
            let turn = |p: DVec3| {
                p.dot(up)
                    .atan2(p.dot(left))
                    .rem_euclid(std::f64::consts::TAU)
            };
            let length = corners[from].distance(corners[to]);
            if turn(across(corners[apex])) < turn(right) {
                outside += length;
            } else {
                outside -= length;
            }
        }
    }
    outside > 0.0
}

/// A bound on the distance of any point of a disk from the loop: half of its width in the plane of
/// its area, across the diagonal for which it is narrowest, plus its height over that plane; or
/// twice the largest distance of a corner from the longest diagonal.
fn half_width(corners: &[DVec3]) -> f64 {
    let normal = corners
        .iter()
        .zip(corners.iter().cycle().skip(1))
        .map(|(a, b)| (*a - corners[0]).cross(*b - corners[0]))
        .sum::<DVec3>()
        .normalize_or_zero();
    let extent = |way: DVec3| {
        let heights = corners.iter().map(|p| DVec3::X * way.dot(*p - corners[0]));
        let [low, high] = bounds_of(heights);
        high.x - low.x
    };
    let mut bound = f64::INFINITY;
    let mut longest = DVec3::ZERO;
    for (i, a) in corners.iter().enumerate() {
        for b in &corners[i + 1..] {
            let diagonal = *b - *a;
            if diagonal.length_squared() > longest.length_squared() {
                longest = diagonal;
            }
            let across = diagonal.cross(normal).normalize_or_zero();
            if across != DVec3::ZERO {
                bound = bound.min(extent(across) / 2.0 + extent(normal));
            }
        }
    }
    let from_line = corners
        .iter()
        .map(|p| {
            (*p - corners[0])
                .reject_from(longest.normalize_or(DVec3::X))
                .length()
        })
        .fold(0.0, f64::max);
    bound.min(2.0 * from_line)
}

/// The triangulation of a polygon in space with the least area, as places on it in its sense.
fn triangulated(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let count = corners.len();
    let mut least = vec![vec![(0.0, 0); count]; count];
    for span in 2..count {
        for i in 0..count - span {
            let j = i + span;
            least[i][j] = (i + 1..j)
                .map(|k| {
                    let area = area_vector([corners[i], corners[k], corners[j]]).length();
                    (least[i][k].0 + least[k][j].0 + area, k)
                })
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or_default();
        }
    }
    let mut out = Vec::new();
    let mut open = vec![(0, count - 1)];
    while let Some((i, j)) = open.pop() {
        if j - i >= 2 {
            let k = least[i][j].1;
            out.push([i, k, j]);
            open.extend([(i, k), (k, j)]);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Mesh;
    use crate::motion::{Generator, Motion, Span};

    /// The prism between the squares [0, 1]^2 and [low, high]^2, of height 1.
    fn frame(low: DVec3, high: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let square =
            |a: DVec3, b: DVec3| [a, DVec3::new(b.x, a.y, 0.0), b, DVec3::new(a.x, b.y, 0.0)];
        let outline = square(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0))
            .into_iter()
            .chain(square(low, high));
        let positions = outline.flat_map(|p| [p, p + DVec3::Z]).collect();
        let at = |ring: u32, corner: u32, top: u32| 8 * ring + 2 * (corner % 4) + top;
        let quads = (0..4).flat_map(|i| {
            [
                [at(0, i, 0), at(0, i + 1, 0), at(0, i + 1, 1), at(0, i, 1)],
                [at(1, i + 1, 0), at(1, i, 0), at(1, i, 1), at(1, i + 1, 1)],
                [at(0, i, 1), at(0, i + 1, 1), at(1, i + 1, 1), at(1, i, 1)],
                [at(0, i + 1, 0), at(0, i, 0), at(1, i, 0), at(1, i + 1, 0)],
            ]
        });
        let triangles = quads
            .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        (positions, triangles)
    }

    /// A frame around a hole of some width in its middle.
    fn with_hole(width: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let middle = DVec3::new(0.5, 0.5, 0.0);
        let half = DVec3::new(0.3, width / 2.0, 0.0);
        frame(middle - half, middle + half)
    }

    /// Membership in a body at rest.
    fn standing((positions, triangles): (Vec<DVec3>, Vec<[u32; 3]>)) -> Membership {
        let body = Mesh::new(positions, triangles).expect("a body");
        let span = Span::new(Generator::translation(DVec3::ZERO), 1.0).expect("finite");
        let motion = Motion::from_spans(vec![span]).expect("a motion");
        Membership::new(&body, &motion)
    }

    /// Membership in a cuboid with a corner at the origin.
    fn cuboid(size: DVec3) -> Membership {
        let (mut positions, mut triangles) = with_hole(0.5);
        positions.truncate(8);
        triangles.retain(|t| t.iter().all(|&v| v < 8));
        triangles.extend([[1, 3, 5], [1, 5, 7], [0, 4, 2], [0, 6, 4]]);
        positions.iter_mut().for_each(|p| *p *= size);
        standing((positions, triangles))
    }

    fn after(
        (mut positions, mut triangles): (Vec<DVec3>, Vec<[u32; 3]>),
        errors: [f64; 2],
        membership: &Membership,
    ) -> (Removed, usize) {
        let removed = remove(
            &mut positions,
            &mut triangles,
            errors[0],
            errors[1],
            membership,
            Work::UNWATCHED,
        )
        .expect("closed");
        let shells = Shells::new(&triangles);
        assert_eq!(shells.members.len(), 1, "still one piece");
        (removed, genus(&triangles, &shells.members[0]))
    }

    #[test]
    fn a_hole_that_is_swept_is_filled() {
        let (removed, genus) = after(with_hole(0.02), [0.001, 0.02], &cuboid(DVec3::ONE));
        assert_eq!((removed.handles, genus), (1, 0), "closed");
        assert!(
            (removed.depth - 0.01).abs() < 1e-12,
            "half of its width, not {}",
            removed.depth
        );
    }

    #[test]
    fn a_hole_of_the_exact_sweep_stays() {
        let hole = with_hole(0.02);
        let (removed, genus) = after(hole.clone(), [0.001, 0.02], &standing(hole));
        assert_eq!((removed.handles, genus), (0, 1), "it is there");
    }

    #[test]
    fn a_hole_within_the_sampling_error_is_filled() {
        let hole = with_hole(0.02);
        let (removed, genus) = after(hole.clone(), [0.011, 0.011], &standing(hole));
        assert_eq!((removed.handles, genus), (1, 0), "no one can tell");
    }

    #[test]
    fn a_hole_wider_than_the_shortfall_stays() {
        let (removed, genus) = after(with_hole(0.1), [0.001, 0.02], &cuboid(DVec3::ONE));
        assert_eq!((removed.handles, genus), (0, 1), "not within the error");
    }

    #[test]
    fn a_bridge_is_cut_unless_it_is_swept() {
        // The wall at y = 1 is 0.02 thick, next to a hole of 0.5.
        let thin = || frame(DVec3::new(0.01, 0.48, 0.0), DVec3::new(0.99, 0.98, 0.0));
        let errors = [0.001, 0.02];
        let (removed, genus) = after(thin(), errors, &cuboid(DVec3::new(1.0, 0.5, 1.0)));
        assert_eq!(
            (removed.handles, genus),
            (1, 0),
            "only the half below y = 0.5 is swept"
        );
        assert_eq!(removed.depth, 0.0, "nothing is added");
        let (removed, genus) = after(thin(), errors, &standing(thin()));
        assert_eq!((removed.handles, genus), (0, 1), "it is there");
    }
}
