//! A boundary that stays a manifold for a reader that joins nearby positions.
//!
//! Rounding makes corners of the arrangement coincide, or leaves them so close that readers take
//! them for one (our own reader: within [`WELD_DISTANCE`] of the diagonal). Where an edge joins
//! them, it is collapsed if the surface stays a manifold of the same topology. Otherwise, and where
//! the region touches itself, one of them moves into the solid by a few times that distance.

use crate::numeric::index;
use crate::numeric::tolerance::WELD_DISTANCE;
use crate::surface::{Collapsing, PointGrid, bounds_of};
use crate::watch::{Interrupted, Work};
use glam::DVec3;

/// How coordinates of a result are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// As `f64`: OBJ, PLY, or further computation.
    #[default]
    Double,
    /// As `f32`: binary STL.
    Single,
}

impl Precision {
    /// The nearest position that can be stored.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the rounding is what is wanted"
    )]
    pub(crate) fn round(self, p: DVec3) -> DVec3 {
        match self {
            Precision::Double => p,
            Precision::Single => p.map(|x| f64::from(x as f32)),
        }
    }
}

/// A surface whose positions are rounded as stored, and apart from each other.
pub(crate) struct Joined {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Largest distance by which a vertex moved.
    pub(crate) largest_move: f64,
}

/// Rounds all positions, and joins or separates those that are then near each other.
pub(crate) fn join_near(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    precision: Precision,
    work: Work,
) -> Result<Joined, Interrupted> {
    let items = work.items(positions.len());
    let mut places = Places::free(positions, precision);
    let mut stored: Vec<DVec3> = positions.iter().map(|&p| precision.round(p)).collect();
    let mut surface = Collapsing::new(triangles.to_vec(), positions.len());
    let mut largest_move: f64 = 0.0;
    for vertex in 0..index(positions.len()) {
        items.next()?;
        let [was, place] = [positions[vertex as usize], stored[vertex as usize]];
        let near = places.grid.near(&stored, place);
        if let Some(&kept) = near
            .iter()
            .find(|&&kept| surface.may_collapse(kept, vertex))
        {
            surface.collapse(kept, vertex);
            largest_move = largest_move.max(was.distance(stored[kept as usize]));
            continue;
        }
        if !near.is_empty() {
            // Into the solid: touching parts come apart, and nothing passes through anything else.
            let inwards = -normal(&surface, vertex, positions);
            stored[vertex as usize] = places.free_near(place, inwards, &stored);
        }
        places.grid.insert(stored[vertex as usize], vertex);
        largest_move = largest_move.max(was.distance(stored[vertex as usize]));
    }
    Ok(Joined {
        positions: stored,
        triangles: surface.triangles().collect(),
        largest_move,
    })
}

/// The places of vertices, and places that are free for others.
pub(crate) struct Places {
    grid: PointGrid,
    distance: f64,
    precision: Precision,
}

impl Places {
    /// Without any vertex yet; `positions` are approximately where they will be.
    fn free(positions: &[DVec3], precision: Precision) -> Places {
        let [low, high] = bounds_of(positions.iter().copied());
        let distance = 2.0 * WELD_DISTANCE * low.distance(high);
        Places {
            grid: PointGrid::new(positions, distance),
            distance,
            precision,
        }
    }

    /// With vertices at all `positions`, as they are stored.
    pub(crate) fn taken_by(positions: &[DVec3], precision: Precision) -> Places {
        let mut places = Places::free(positions, precision);
        (0..)
            .zip(positions)
            .for_each(|(vertex, &place)| places.grid.insert(place, vertex));
        places
    }

    /// Takes a place for the vertex that comes after `positions`: a point as it is stored, or one
    /// displaced from it in a direction, near no other vertex.
    pub(crate) fn take(&mut self, p: DVec3, way: DVec3, positions: &[DVec3]) -> DVec3 {
        let mut place = self.precision.round(p);
        if !self.grid.near(positions, place).is_empty() {
            place = self.free_near(place, way, positions);
        }
        self.grid.insert(place, index(positions.len()));
        place
    }

    /// A position that can be stored and is near no other vertex: in a direction or else along the
    /// axes, at increasing distances.
    fn free_near(&self, p: DVec3, way: DVec3, positions: &[DVec3]) -> DVec3 {
        let unit = match self.precision {
            Precision::Double => f64::EPSILON,
            Precision::Single => f64::from(f32::EPSILON),
        };
        let step = 1.5 * self.distance.max(unit * p.abs().max_element());
        let ways = [
            way.normalize_or(DVec3::X),
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            -DVec3::X,
            -DVec3::Y,
            -DVec3::Z,
        ];
        (1_u32..)
            .flat_map(|reach| ways.map(|way| way * (step * f64::from(reach))))
            .map(|by| self.precision.round(p + by))
            .find(|&place| self.grid.near(positions, place).is_empty())
            .expect("a mesh has fewer vertices than there are positions")
    }
}

/// The sum of the area vectors of the triangles around a vertex.
fn normal(surface: &Collapsing, vertex: u32, positions: &[DVec3]) -> DVec3 {
    let area = |(_, corners): (u32, [u32; 3])| {
        let [a, b, c] = corners.map(|v| positions[v as usize]);
        (b - a).cross(c - a)
    };
    surface.around(vertex).map(area).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An octahedron with the given north pole.
    fn octahedron(north: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let ring = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
        let positions = ring.into_iter().chain([north, DVec3::NEG_Z]).collect();
        let triangles = (0..4)
            .flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]])
            .collect();
        (positions, triangles)
    }

    #[test]
    fn vertices_that_round_together_are_joined_along_their_edge() {
        let (positions, triangles) = octahedron(DVec3::X * (1.0 + 1e-12));
        let rounded = join_near(&positions, &triangles, Precision::Single, Work::UNWATCHED)
            .expect("nobody stops it");
        assert_eq!(
            rounded.triangles.len(),
            6,
            "the edge takes its two triangles along"
        );
        assert!(
            rounded.largest_move <= 1e-12 + f64::EPSILON,
            "moved by {}",
            rounded.largest_move
        );
    }

    #[test]
    fn vertices_that_round_together_without_an_edge_stay_apart() {
        let (mut positions, triangles) = octahedron(DVec3::Z);
        let (again, more) = octahedron(DVec3::Z);
        positions.extend(again.iter().map(|p| *p * (1.0 + 1e-12)));
        let both: Vec<[u32; 3]> = triangles
            .iter()
            .copied()
            .chain(more.iter().map(|t| t.map(|v| v + 6)))
            .collect();
        let rounded = join_near(&positions, &both, Precision::Single, Work::UNWATCHED)
            .expect("nobody stops it");
        assert_eq!(rounded.triangles.len(), 16, "nothing is lost");
        for (i, p) in rounded.positions.iter().enumerate() {
            let others = &rounded.positions[..i];
            assert!(
                others.iter().all(|q| p.distance(*q) > 2e-9),
                "vertex {i} is alone at {p}"
            );
        }
        assert!(
            rounded.largest_move < 1e-6,
            "moved by {}",
            rounded.largest_move
        );
    }

    #[test]
    fn what_touches_comes_apart_inwards() {
        let (mut positions, triangles) = octahedron(DVec3::Z);
        positions.extend(positions.clone().iter().map(|p| *p + DVec3::X * 2.0));
        let both: Vec<[u32; 3]> = triangles
            .iter()
            .copied()
            .chain(triangles.iter().map(|t| t.map(|v| v + 6)))
            .collect();
        let joined = join_near(&positions, &both, Precision::Double, Work::UNWATCHED)
            .expect("nobody stops it");
        let [left, right] = [joined.positions[0], joined.positions[8]];
        assert!(
            left == DVec3::X && right.x > 1.0,
            "they touched at (1, 0, 0): {left} {right}"
        );
        assert!(
            joined.largest_move < 1e-7,
            "moved by {}",
            joined.largest_move
        );
    }

    #[test]
    fn representable_coordinates_stay_exactly() {
        let (positions, triangles) = octahedron(DVec3::Z * 0.5);
        let rounded = join_near(&positions, &triangles, Precision::Single, Work::UNWATCHED)
            .expect("nobody stops it");
        assert_eq!(rounded.positions, positions, "all are representable");
        assert_eq!(rounded.largest_move, 0.0, "nothing moved");
    }
}
