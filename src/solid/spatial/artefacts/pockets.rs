//! Cavities that the sampling made: they are found by their thickness, and are filled.
//!
//! Farther than the sampling error from its sheets, the winding number of the sampled cycle is
//! right. A cavity nowhere deeper than that cannot be distinguished from a crevice that the
//! sampling closed, and is filled: the boundary moves out by at most its depth, and no gap is left
//! where there may be none. A cavity up to the bound of the shortfall may be what the dropped folds
//! cut out; it is filled if the exact sweep contains every one of several points inside it. A
//! deeper one is real.
//!
//! Shells so flat that no body may have them go, of cavities and of pieces: sheets that differ by
//! rounding lie between them, or vertices that were moved to be apart.

use crate::body::Thickness;
use crate::membership::Membership;
use crate::numeric::area::area_vector;
use crate::numeric::tolerance::CRUMB;
use crate::surface::{Shells, bounds_of};
use crate::watch::{Interrupted, Work};
use glam::DVec3;

/// Number of points that are tested in a cavity before it is filled.
///
/// One is not enough: some 6 % of the points of the sampled cavity of a hollow torus lie in the
/// true sweep.
const PROBES: usize = 5;

/// The filled cavities.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Filled {
    /// Number of cavities.
    pub(crate) pockets: usize,
    /// Bound on the depth of the deepest cavity.
    pub(crate) depth: f64,
}

/// Dropped pieces.
#[derive(Debug, Clone, Default)]
pub(crate) struct Dropped {
    /// Their boundaries.
    pub(crate) triangles: Vec<[DVec3; 3]>,
    /// Bound on the depth of the deepest: so far from these triangles a point of a piece may be.
    pub(crate) depth: f64,
}

impl Dropped {
    /// Those and these.
    pub(crate) fn extend(&mut self, more: Dropped) {
        self.triangles.extend(more.triangles);
        self.depth = self.depth.max(more.depth);
    }
}

/// The remaining surface, what was filled, and what was dropped.
type Cleaned = (Vec<[u32; 3]>, Filled, Dropped);

/// Drops the shells of crumbs of rounding ([`CRUMB`]), of cavities no deeper than `sampling`, of
/// those no deeper than `shortfall` that are inside the exact sweep, and flat ones. Where all pieces
/// are flat, they stay.
pub(crate) fn fill(
    positions: &[DVec3],
    mut triangles: Vec<[u32; 3]>,
    sampling: f64,
    shortfall: f64,
    membership: &Membership,
    work: Work,
) -> Result<Cleaned, Interrupted> {
    let shells = Shells::new(&triangles);
    let [low, high] = bounds_of(positions.iter().copied());
    let crumb = CRUMB * low.abs().max(high.abs()).max_element();
    let mut filled = Filled::default();
    let mut crumbs = Dropped::default();
    let thicknesses: Vec<Thickness> = shells
        .members
        .iter()
        .map(|members| Thickness::of(positions, members.iter().map(|&t| triangles[t as usize])))
        .collect();
    let has_body = thicknesses.iter().any(|t| t.volume > 0.0 && !t.is_flat());
    let mut keep = vec![true; triangles.len()];
    let items = work.items(triangles.len());
    for (members, thickness) in shells.members.iter().zip(&thicknesses) {
        items.advance(members.len())?;
        let pocket: Vec<[DVec3; 3]> = members
            .iter()
            .map(|&t| triangles[t as usize].map(|v| positions[v as usize]))
            .collect();
        let volume = thickness.volume;
        let depth = depth_bound(&pocket, volume.abs());
        if volume > 0.0 {
            if depth <= crumb || (has_body && thickness.is_flat()) {
                members.iter().for_each(|&t| keep[t as usize] = false);
                crumbs.extend(Dropped {
                    triangles: pocket,
                    depth,
                });
            }
            continue;
        }
        let is_swept = || {
            let points = interior_points(&pocket);
            !points.is_empty() && points.iter().all(|&p| membership.is_ever_inside(p))
        };
        if depth <= sampling || thickness.is_flat() || (depth <= shortfall && is_swept()) {
            filled.pockets += 1;
            filled.depth = filled.depth.max(depth);
            members.iter().for_each(|&t| keep[t as usize] = false);
        }
    }
    let mut kept = keep.into_iter();
    triangles.retain(|_| kept.next() == Some(true));
    Ok((triangles, filled, crumbs))
}

/// Upper bound on the radius of a ball inside a closed shell: the ball has at most the volume of
/// the shell, and fits between the extremes of the shell in every direction; the normals of its
/// faces are tried.
pub(crate) fn depth_bound(pocket: &[[DVec3; 3]], volume: f64) -> f64 {
    let by_volume = (volume * 3.0 / (4.0 * std::f64::consts::PI)).cbrt();
    largest_faces(pocket)
        .iter()
        .map(|face| {
            let normal = area_vector(**face).normalize_or_zero();
            let heights = pocket.iter().flatten().map(|p| DVec3::X * normal.dot(*p));
            let [low, high] = bounds_of(heights);
            if normal == DVec3::ZERO {
                f64::INFINITY
            } else {
                (high.x - low.x) / 2.0
            }
        })
        .fold(by_volume, f64::min)
}

/// The largest faces of a shell, [`PROBES`] of them.
fn largest_faces(shell: &[[DVec3; 3]]) -> Vec<&[DVec3; 3]> {
    let size = |face: &[DVec3; 3]| area_vector(*face).length_squared();
    let mut faces: Vec<_> = shell.iter().map(|face| (size(face), face)).collect();
    faces.sort_by(|a, b| b.0.total_cmp(&a.0));
    faces.truncate(PROBES);
    faces.into_iter().map(|(_, face)| face).collect()
}

/// Points inside a closed shell whose faces point inwards: from the centres of its largest faces
/// halfway to the opposite side of the shell.
pub(crate) fn interior_points(pocket: &[[DVec3; 3]]) -> Vec<DVec3> {
    largest_faces(pocket)
        .iter()
        .filter_map(|face| {
            let start = (face[0] + face[1] + face[2]) / 3.0;
            let way = area_vector(**face).normalize_or_zero();
            let across = pocket
                .iter()
                .filter(|other| *other != *face)
                .filter_map(|other| hit(start, way, other))
                .fold(f64::INFINITY, f64::min);
            across.is_finite().then(|| start + way * (across / 2.0))
        })
        .collect()
}

/// The distance along a ray at which it meets a triangle.
fn hit(start: DVec3, way: DVec3, [a, b, c]: &[DVec3; 3]) -> Option<f64> {
    let (u, v) = (*b - *a, *c - *a);
    let p = way.cross(v);
    let determinant = u.dot(p);
    let from = start - *a;
    let q = from.cross(u);
    let (s, t, along) = (
        from.dot(p) / determinant,
        way.dot(q) / determinant,
        v.dot(q) / determinant,
    );
    (s >= 0.0 && t >= 0.0 && s + t <= 1.0 && along > 0.0).then_some(along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Mesh;
    use crate::motion::{Generator, Motion, Span};
    use crate::samples::cuboid;

    /// Cuboids from corner to corner, the boundary of each outwards or, with a negative height,
    /// inwards.
    fn cuboids(corners: &[[DVec3; 2]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for (first, &[low, high]) in (0..).step_by(8).zip(corners) {
            let (more, others) = cuboid(low, high);
            positions.extend(more);
            triangles.extend(others.iter().map(|t| t.map(|v| v + first)));
        }
        (positions, triangles)
    }

    fn filled(corners: &[[DVec3; 2]]) -> Cleaned {
        let (positions, triangles) = cuboids(corners);
        let (points, faces) = cuboid(DVec3::ZERO, DVec3::ONE);
        let cube = Mesh::new(points, faces).expect("a cube is a body");
        let still = Span::new(Generator::translation(DVec3::ZERO), 1.0).expect("a span");
        let motion = Motion::from_spans(vec![still]).expect("a motion");
        let membership = Membership::new(&cube, &motion);
        fill(
            &positions,
            triangles,
            0.0,
            0.0,
            &membership,
            Work::UNWATCHED,
        )
        .expect("nobody stops it")
    }

    const CUBE: [DVec3; 2] = [DVec3::ZERO, DVec3::ONE];
    /// As flat as a shell may not be, but twenty times as thick as a crumb.
    const HEIGHT: f64 = 4e-10;

    #[test]
    fn flat_pieces_go_and_are_returned() {
        let plate = [DVec3::splat(2.0), DVec3::new(3.0, 3.0, 2.0 + HEIGHT)];
        let (left, filled, dropped) = filled(&[CUBE, plate]);
        assert_eq!((left.len(), filled.pockets), (12, 0), "the cube");
        assert_eq!(dropped.triangles.len(), 12, "the plate");
        let half = HEIGHT / 2.0;
        assert!(
            (dropped.depth - half).abs() < 1e-3 * half,
            "{}",
            dropped.depth
        );
    }

    #[test]
    fn flat_cavities_are_filled() {
        let slit = [
            DVec3::new(0.2, 0.2, 0.5),
            DVec3::new(0.8, 0.8, 0.5 - HEIGHT),
        ];
        let (left, filled, dropped) = filled(&[CUBE, slit]);
        assert_eq!((left.len(), filled.pockets), (12, 1), "the cube");
        assert!(dropped.triangles.is_empty(), "nothing is lost");
        let half = HEIGHT / 2.0;
        assert!(
            (filled.depth - half).abs() < 1e-3 * half,
            "{}",
            filled.depth
        );
    }

    #[test]
    fn what_is_flat_as_a_whole_stays() {
        let plate = [DVec3::ZERO, DVec3::new(1.0, 1.0, HEIGHT)];
        let (left, _, dropped) = filled(&[plate]);
        assert_eq!((left.len(), dropped.depth), (12, 0.0));
    }
}
