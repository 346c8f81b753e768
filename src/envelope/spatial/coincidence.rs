//! Joins vertices of the sampled surface that come to the same place at different times.
//!
//! A corner of a turned part comes to places where its neighbours have been, and a corner beside
//! the axis hardly moves. The rounding of the body keeps such places apart by far less than any
//! tolerance, and sheets that differ only by that cross each other everywhere. Vertices of one pose
//! are never joined, however near: those are details of the body.

use crate::numeric::index;
use crate::surface::PointGrid;
use crate::watch::{Interrupted, Work};
use glam::DVec3;
use std::collections::HashSet;

/// A surface with joined vertices.
pub(super) struct JoinedVertices {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Largest distance between places that were joined.
    pub(super) largest_move: f64,
}

/// Joins vertices within `same` of each other, and those of different poses within `distance` of
/// each other.
///
/// `poses`: number of the pose of each vertex. In the order of the input, each vertex joins the
/// nearest place that it may join, or else becomes a new place. So no vertex moves by more than the
/// larger distance. Triangles that lose a corner are dropped; edges are still run through equally
/// often in both senses.
pub(super) fn join(
    positions: &[DVec3],
    poses: &[u32],
    triangles: &[[u32; 3]],
    same: f64,
    distance: f64,
    work: Work,
) -> Result<JoinedVertices, Interrupted> {
    let mut grid = PointGrid::new(positions, distance.max(same));
    let mut kept: Vec<DVec3> = Vec::new();
    let mut taken = HashSet::<(u32, u32)>::with_capacity(positions.len());
    let mut largest_move: f64 = 0.0;
    let place_of: Vec<u32> = positions
        .iter()
        .zip(poses)
        .map(|(&position, &pose)| {
            work.check()?;
            let gap = |place: u32| kept[place as usize].distance(position);
            let nearest = grid
                .near(&kept, position)
                .into_iter()
                .filter(|&place| gap(place) <= same || !taken.contains(&(place, pose)))
                .min_by(|&a, &b| gap(a).total_cmp(&gap(b)));
            let place = if let Some(place) = nearest {
                largest_move = largest_move.max(gap(place));
                place
            } else {
                let place = index(kept.len());
                kept.push(position);
                grid.insert(position, place);
                place
            };
            taken.insert((place, pose));
            Ok(place)
        })
        .collect::<Result<_, Interrupted>>()?;
    Ok(JoinedVertices {
        positions: kept,
        triangles: triangles
            .iter()
            .map(|triangle| triangle.map(|v| place_of[v as usize]))
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect(),
        largest_move,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn details_of_one_pose_stay_apart_and_meet_their_likes() {
        // Two points a hair apart at pose 0, and the same two, off by less, at pose 1.
        let positions = [0.0, 1e-3, 1e-4, 1.1e-3].map(|x| DVec3::new(x, 0.0, 0.0));
        let far = [5.0, 6.0].map(|x| DVec3::new(x, 1.0, 0.0));
        let all = [&positions[..], &far].concat();
        let triangles = [[0, 1, 4], [3, 2, 5]];
        let joined = join(
            &all,
            &[0, 0, 1, 1, 0, 1],
            &triangles,
            1e-9,
            5e-3,
            Work::UNWATCHED,
        )
        .expect("nobody stops it");
        assert_eq!(joined.positions.len(), 4, "two details and two far points");
        assert_eq!(joined.triangles, [[0, 1, 2], [1, 0, 3]], "like to like");
        assert!(
            (joined.largest_move - 1e-4).abs() < 1e-12,
            "{}",
            joined.largest_move
        );
    }

    #[test]
    fn rounding_is_joined_within_a_pose_and_triangles_that_vanish_are_dropped() {
        let positions = [0.0, 1e-14, 1.0].map(|x| DVec3::new(x, 0.0, 0.0));
        let joined = join(
            &positions,
            &[0, 0, 0],
            &[[0, 1, 2]],
            1e-12,
            1e-12,
            Work::UNWATCHED,
        )
        .expect("nobody stops it");
        assert_eq!(joined.positions.len(), 2, "two places");
        assert!(joined.triangles.is_empty(), "no area left");
    }
}
