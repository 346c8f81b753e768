//! A surface of triangles that need not be closed: an obstacle.

use super::defect::{BodyError, Defect};
use super::mesh::Mesh;
use super::validate::damaged_numbers;
use crate::surface::{Sides, edges};
use glam::DVec3;

/// A finite triangle surface, open or closed. It may have triangles without area, which are
/// segments and points.
///
/// When every edge is run through equally often in both senses, the surface is *closed* and bounds
/// a solid; its triangles then run counter-clockwise seen from outside. Otherwise it is a sheet
/// without an interior.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::body::Surface;
///
/// let wall = Surface::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]);
/// assert!(!wall.expect("a triangle").closed());
/// ```
#[derive(Debug, Clone)]
pub struct Surface {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    closed: bool,
}

impl Surface {
    /// Makes a triangle list a surface.
    ///
    /// - `positions`: #V points, any unit, finite, at most 1e18 in each coordinate. They are kept
    ///   as they are, used or not.
    /// - `triangles`: #F index triples, kept in this order. A closed surface of negative volume is
    ///   turned: every `[a, b, c]` becomes `[a, c, b]`.
    ///
    /// # Errors
    /// [`BodyError`] with every defect: no triangles, indices out of range, coordinates that are
    /// not finite or too large.
    ///
    /// # Cost
    /// O(n).
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Surface, BodyError> {
        if let Some(error) = BodyError::new(damage(&positions, &triangles)) {
            return Err(error);
        }
        let closed = is_closed(&triangles);
        let mut surface = Surface {
            positions,
            triangles,
            closed,
        };
        if closed && surface.volume() < 0.0 {
            surface.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Ok(surface)
    }

    /// A cloud of points: each is a triangle whose corners are all that point, in their order.
    ///
    /// # Errors
    /// As [`Surface::new`].
    pub fn of_points(points: Vec<DVec3>) -> Result<Surface, BodyError> {
        let triangles = (0u32..).take(points.len()).map(|i| [i; 3]).collect();
        Surface::new(points, triangles)
    }

    /// #V positions.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }
    /// #F index triples.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
    /// Whether it bounds a solid.
    pub fn closed(&self) -> bool {
        self.closed
    }
    /// The smallest box [min, max] around the triangles.
    pub fn bounds(&self) -> [DVec3; 2] {
        let corners = self.triangles.iter().flatten();
        corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], &v| {
            let p = self.positions[v as usize];
            [low.min(p), high.max(p)]
        })
    }

    /// Signed volume, meaningful for a closed surface.
    fn volume(&self) -> f64 {
        let [low, high] = self.bounds();
        let origin = low.midpoint(high);
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.positions[v as usize] - origin);
            a.dot(b.cross(c)) / 6.0
        };
        self.triangles.iter().map(of).sum()
    }
}

impl From<&Mesh> for Surface {
    fn from(mesh: &Mesh) -> Surface {
        Surface {
            positions: mesh.positions().to_vec(),
            triangles: mesh.triangles().to_vec(),
            closed: true,
        }
    }
}

/// The defects of a triangle list that may have triangles without area.
fn damage(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Defect> {
    let mut found = damaged_numbers(positions, triangles);
    found.retain(|defect| !matches!(defect, Defect::RepeatedVertex { .. }));
    found
}

/// Whether every edge is run through equally often in both senses. Sides from a vertex to itself do
/// not count.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let sides = (0..).zip(triangles.iter().flat_map(edges));
    let sides = Sides::of(sides.filter(|(_, [from, to])| from != to));
    sides.edges().next().is_some() && sides.edges().all(|edge| edge.is_closed())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        (positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    }

    #[test]
    fn a_surface_is_closed_when_its_edges_match_and_a_wall_is_not() {
        let (positions, triangles) = tetrahedron();
        let whole = Surface::new(positions.clone(), triangles.clone()).expect("a surface");
        assert!(whole.closed(), "four faces");
        assert_eq!(whole.triangles(), triangles, "outward as given");
        let wall = Surface::new(positions, triangles[..3].to_vec()).expect("a surface");
        assert!(!wall.closed(), "three faces");
    }

    #[test]
    fn a_closed_surface_inside_out_is_turned_and_a_wall_stays() {
        let (positions, mut triangles) = tetrahedron();
        let outward = triangles.clone();
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
        let turned = Surface::new(positions.clone(), triangles.clone()).expect("a surface");
        assert_eq!(turned.triangles(), outward, "turned");
        let wall = Surface::new(positions, triangles[..1].to_vec()).expect("a surface");
        assert_eq!(wall.triangles(), &triangles[..1], "a wall has no outside");
    }

    #[test]
    fn triangles_without_area_are_taken_and_damage_is_refused() {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        let flat = Surface::new(points.clone(), vec![[0, 1, 2], [1, 1, 1]]).expect("a surface");
        assert!(!flat.closed(), "a segment and a point have no inside");
        let defects = |points: &[DVec3], triangles: &[[u32; 3]]| {
            Surface::new(points.to_vec(), triangles.to_vec())
                .expect_err("must be refused")
                .into_defects()
        };
        assert_eq!(defects(&points, &[]), [Defect::Empty]);
        assert!(
            matches!(
                defects(&points, &[[0, 1, 2], [0, 1, 7]])[..],
                [Defect::IndexOutOfRange {
                    triangle: 1,
                    index: 7,
                    vertices: 3
                }]
            ),
            "no vertex 7"
        );
        let infinite = [DVec3::ZERO, DVec3::X, DVec3::INFINITY];
        assert!(
            matches!(
                defects(&infinite, &[[0, 1, 2]])[..],
                [Defect::NonFinite { vertex: 2, .. }]
            ),
            "not finite"
        );
        let far = [DVec3::ZERO, DVec3::X * 1e19, DVec3::Y];
        assert!(
            matches!(
                defects(&far, &[[0, 1, 2]])[..],
                [Defect::TooFar { vertex: 1, .. }]
            ),
            "too far"
        );
    }
}
