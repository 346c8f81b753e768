//! Cavities that the sampling made: they are found by their thickness, and are filled.
//!
//! Farther than the sampling error from its sheets, the winding number of the sampled cycle is
//! right. A cavity nowhere deeper than that cannot be distinguished from a crevice that the
//! sampling closed, and is filled: the boundary moves out by at most its depth, and no gap is left
//! where there may be none. A cavity up to the bound of the shortfall may be what the dropped folds
//! cut out; it is filled if the exact sweep contains every one of several points inside it. A
//! deeper one is real.

use crate::membership::Membership;
use crate::numeric::area::area_vector;
use crate::numeric::tolerance::CRUMB;
use crate::surface::{Shells, bounds_of, volume_and_area};
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

/// The remaining surface, what was filled, and the triangles of the removed crumbs.
type Cleaned = (Vec<[u32; 3]>, Filled, Vec<[DVec3; 3]>);

/// Drops the shells of crumbs of rounding ([`CRUMB`]), of cavities no deeper than `sampling`, and
/// of those no deeper than `shortfall` that are inside the exact sweep.
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
    let mut crumbs = Vec::new();
    let mut keep = vec![true; triangles.len()];
    let items = work.items(triangles.len());
    for members in &shells.members {
        items.advance(members.len())?;
        let pocket: Vec<[DVec3; 3]> = members
            .iter()
            .map(|&t| triangles[t as usize].map(|v| positions[v as usize]))
            .collect();
        let centre = pocket[0][0];
        let (volume, _) = volume_and_area(
            positions,
            members.iter().map(|&t| triangles[t as usize]),
            centre,
        );
        let depth = depth_bound(&pocket, volume.abs());
        if volume > 0.0 {
            if depth <= crumb {
                members.iter().for_each(|&t| keep[t as usize] = false);
                crumbs.extend(pocket);
            }
            continue;
        }
        let is_swept = || {
            let points = interior_points(&pocket);
            !points.is_empty() && points.iter().all(|&p| membership.is_ever_inside(p))
        };
        if depth <= sampling || (depth <= shortfall && is_swept()) {
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
