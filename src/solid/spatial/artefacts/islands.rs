//! Loose pieces that the sampling made: they are found by what they contain, and are dropped.
//!
//! A piece of a swept region contains the whole path of a shell of the body, and so that shell at
//! its start. A piece that contains none was cut off from another one where sheets run closer to
//! each other than their sampling errors.

use super::pockets::{Dropped, depth_bound, interior_points};
use crate::body::{Mesh, ShellRole};
use crate::bounds::SurfaceTree;
use crate::surface::{Shells, volume_and_area};
use crate::watch::{Interrupted, Work};
use glam::DVec3;

/// A point inside each outer shell of the body for which one can be found.
pub(crate) fn anchors(body: &Mesh) -> Vec<DVec3> {
    body.shells()
        .iter()
        .filter(|shell| shell.role == ShellRole::Outer)
        .filter_map(|shell| {
            let inside_out: Vec<[DVec3; 3]> = shell
                .triangles
                .iter()
                .map(|&t| {
                    let [a, b, c] = body.triangles()[t as usize];
                    [a, c, b].map(|v| body.positions()[v as usize])
                })
                .collect();
            interior_points(&inside_out).first().copied()
        })
        .collect()
}

/// Drops the pieces that contain none of `anchors` and are no deeper than `limit`, unless an anchor
/// lies in no piece at all.
pub(crate) fn drop_islands(
    positions: &[DVec3],
    triangles: &mut Vec<[u32; 3]>,
    anchors: &[DVec3],
    limit: f64,
    work: Work,
) -> Result<Dropped, Interrupted> {
    if anchors.is_empty() {
        return Ok(Dropped::default());
    }
    let shells = Shells::new(triangles);
    let mut shell_of = vec![0; triangles.len()];
    for (number, members) in (0..).zip(&shells.members) {
        members.iter().for_each(|&t| shell_of[t as usize] = number);
    }
    work.check()?;
    let tree = SurfaceTree::during(work.uncounted(), positions, triangles)?;
    // Per shell, the number of anchors that it contains. Cavities contain none: they wind around
    // nothing.
    let mut holds = vec![0; shells.members.len()];
    let items = work.items(anchors.len());
    for &anchor in anchors {
        items.next()?;
        for (shell, winding) in tree.winding_numbers(anchor, |t| shell_of[t as usize]) {
            holds[shell as usize] += usize::from(winding.is_none_or(|w| w > 0));
        }
    }
    let mut islands = Vec::new();
    let mut depth: f64 = 0.0;
    let mut held = 0;
    for (number, members) in shells.members.iter().enumerate() {
        work.check()?;
        let piece = || members.iter().map(|&t| triangles[t as usize]);
        let about = positions[triangles[members[0] as usize][0] as usize];
        let (volume, _) = volume_and_area(positions, piece(), about);
        if volume <= 0.0 {
            continue;
        }
        held += holds[number];
        if holds[number] == 0 {
            let corners: Vec<[DVec3; 3]> =
                piece().map(|t| t.map(|v| positions[v as usize])).collect();
            let own_depth = depth_bound(&corners, volume);
            if own_depth <= limit {
                islands.push(number);
                depth = depth.max(own_depth);
            }
        }
    }
    if islands.is_empty() || held < anchors.len() {
        return Ok(Dropped::default());
    }
    let mut is_dropped = vec![false; triangles.len()];
    for &island in &islands {
        shells.members[island]
            .iter()
            .for_each(|&t| is_dropped[t as usize] = true);
    }
    let mut dropped = Vec::new();
    let mut is_dropped = is_dropped.into_iter();
    triangles.retain(|triangle| {
        let keeps = is_dropped.next() == Some(false);
        if !keeps {
            dropped.push(triangle.map(|v| positions[v as usize]));
        }
        keeps
    });
    Ok(Dropped {
        triangles: dropped,
        depth,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::cuboid;

    /// A unit cube, and a small cube at a distance of 0.3.
    fn two_cubes() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (mut positions, mut triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        let corner = DVec3::new(1.3, 0.5, 0.5);
        let (more, others) = cuboid(corner, corner + 0.1);
        positions.extend(more);
        triangles.extend(others.iter().map(|t| t.map(|v| v + 8)));
        (positions, triangles)
    }

    #[test]
    fn a_piece_that_holds_no_body_goes_and_is_returned() {
        let (positions, mut triangles) = two_cubes();
        let dropped = drop_islands(
            &positions,
            &mut triangles,
            &[DVec3::splat(0.5)],
            0.1,
            Work::UNWATCHED,
        )
        .expect("nobody stops it");
        assert_eq!(triangles.len(), 12, "the large cube");
        assert_eq!(dropped.triangles.len(), 12, "the small one");
        let depth = dropped.depth;
        assert!((depth - 0.05).abs() < 1e-9, "half of its height: {depth}");
    }

    #[test]
    fn pieces_that_hold_bodies_stay() {
        let (positions, mut triangles) = two_cubes();
        let anchors = [DVec3::splat(0.5), DVec3::new(1.35, 0.55, 0.55)];
        let dropped = drop_islands(&positions, &mut triangles, &anchors, 0.1, Work::UNWATCHED)
            .expect("nobody stops it");
        assert_eq!(dropped.depth, 0.0, "none");
        assert_eq!(triangles.len(), 24, "both cubes");
    }

    #[test]
    fn deep_pieces_and_doubtful_ones_stay() {
        let (positions, mut triangles) = two_cubes();
        let anchor = DVec3::splat(0.5);
        drop_islands(&positions, &mut triangles, &[anchor], 0.01, Work::UNWATCHED)
            .expect("nobody stops it");
        assert_eq!(triangles.len(), 24, "deeper than .01");
        drop_islands(
            &positions,
            &mut triangles,
            &[anchor, DVec3::splat(9.0)],
            0.1,
            Work::UNWATCHED,
        )
        .expect("nobody stops it");
        assert_eq!(
            triangles.len(),
            24,
            "a body that is in no piece: nothing is known"
        );
    }

    #[test]
    fn a_body_has_an_anchor_in_each_outer_shell() {
        let (positions, triangles) = two_cubes();
        let body = Mesh::new(positions, triangles).expect("two cubes are a body");
        let found = anchors(&body);
        assert_eq!(found.len(), 2, "one each");
        assert!(
            found[0].max_element() < 1.0 && found[1].x > 1.3,
            "inside: {found:?}"
        );
    }
}
