//! A plate around a sheet: the body of a surface that is given a small thickness.

use super::defect::BodyError;
use super::mesh::Mesh;
use super::surface::Surface;
use crate::numeric::{DisjointSets, index};
use glam::DVec3;
use std::collections::HashMap;

/// Why a surface cannot be given a thickness.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ThickenError {
    /// An edge through which triangles run in the same sense: more than two share it, or two
    /// neighbours have different sides up.
    #[error(
        "triangles {} and {} run through edge {}-{} in the same sense; each edge needs one triangle or two, with the same \
         side up",
        triangles[0], triangles[1], vertices[0], vertices[1]
    )]
    Edge {
        /// Its ends, in that sense.
        vertices: [u32; 2],
        /// Two of the triangles.
        triangles: [u32; 2],
    },
    /// A triangle without area, or two corners of which are one vertex.
    #[error("triangle {triangle} has no area; leave it out")]
    NoArea {
        /// The triangle.
        triangle: u32,
    },
    /// The surface bends too sharply for the thickness.
    #[error(
        "a plate of thickness {thickness:.3e} would turn inside out at triangle {triangle}, near {place}: the surface is \
         folded there, or its triangles are too small; use a finer tolerance, or remove the fold"
    )]
    TooSharp {
        /// The triangle.
        triangle: u32,
        /// One of its corners.
        place: DVec3,
        /// The thickness.
        thickness: f64,
    },
    /// The plate is no body.
    #[error("the plate around the surface is no body: {0}")]
    Body(#[from] BodyError),
}

impl Surface {
    /// A plate around the surface: a closed body that contains it, and no point of which is farther
    /// from it than half the thickness. A closed surface becomes a hollow shell.
    ///
    /// Each vertex is moved by half the thickness to both sides, along a direction on the outer side of
    /// all its triangles. A triangle then fills a prism whose volume element is checked to
    /// be positive everywhere; so the winding number of the plate is at least 1 on the surface. At
    /// the border of the surface its own edges stay edges of the plate.
    ///
    /// - `thickness`: above 0, small compared with the triangles and with the bends.
    ///
    /// # Errors
    /// [`ThickenError`].
    ///
    /// # Cost
    /// O(n) expected; the plate has two triangles for each one, and four for each border edge.
    ///
    /// # Example
    /// ```
    /// use glam::DVec3;
    /// use steadysweep::body::Surface;
    ///
    /// let sheet = Surface::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).expect("a triangle");
    /// let plate = sheet.thickened(0.01).expect("a plate");
    /// assert!((plate.volume() - 0.005).abs() < 1e-15);
    /// ```
    pub fn thickened(&self, thickness: f64) -> Result<Mesh, ThickenError> {
        let sheet = Sheet::new(self)?;
        let offsets = sheet.offsets(self, thickness)?;
        // Per vertex of the sheet: above, below, and at the border itself.
        let places = self.vertices_of(&sheet);
        let mut positions = Vec::with_capacity(2 * offsets.len());
        for (&place, &offset) in places.iter().zip(&offsets) {
            positions.extend([place + offset, place - offset]);
        }
        let mut at_border: HashMap<u32, u32> = HashMap::new();
        let mut triangles = Vec::with_capacity(2 * sheet.corners.len());
        for (face, &[a, b, c]) in sheet.corners.iter().enumerate() {
            triangles.push([a, b, c].map(|v| 2 * v));
            triangles.push([a, c, b].map(|v| 2 * v + 1));
            for (side, [from, to]) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
                if !sheet.is_border[face][side] {
                    continue;
                }
                let [on_from, on_to] = [from, to].map(|vertex| {
                    *at_border.entry(vertex).or_insert_with(|| {
                        positions.push(places[vertex as usize]);
                        index(positions.len() - 1)
                    })
                });
                let [over_from, over_to] = [2 * from, 2 * to];
                let [under_from, under_to] = [2 * from + 1, 2 * to + 1];
                triangles.extend([
                    [over_to, over_from, on_from],
                    [over_to, on_from, on_to],
                    [on_to, on_from, under_from],
                    [on_to, under_from, under_to],
                ]);
            }
        }
        Ok(Mesh::new(positions, triangles)?)
    }

    /// The place of each vertex of the sheet.
    fn vertices_of(&self, sheet: &Sheet) -> Vec<DVec3> {
        let place = |&vertex: &u32| self.positions()[vertex as usize];
        sheet.vertex_of.iter().map(place).collect()
    }
}

/// The triangles of a surface, joined across edges only: where parts of it meet in a vertex alone,
/// each has a vertex of its own.
struct Sheet {
    /// Vertices of each triangle.
    corners: Vec<[u32; 3]>,
    /// For each vertex, that of the surface.
    vertex_of: Vec<u32>,
    /// Per triangle and side, whether no other triangle is beyond.
    is_border: Vec<[bool; 3]>,
}

impl Sheet {
    fn new(surface: &Surface) -> Result<Sheet, ThickenError> {
        let triangles = surface.triangles();
        // The triangle and side that run through an edge in a sense.
        let mut sides: HashMap<[u32; 2], (u32, usize)> = HashMap::new();
        for (triangle, &[a, b, c]) in (0u32..).zip(triangles) {
            if a == b || b == c || c == a {
                return Err(ThickenError::NoArea { triangle });
            }
            for (side, vertices) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
                if let Some((other, _)) = sides.insert(vertices, (triangle, side)) {
                    let triangles = [other, triangle];
                    return Err(ThickenError::Edge {
                        vertices,
                        triangles,
                    });
                }
            }
        }
        // Corners that are joined across edges are one vertex.
        let mut joined = DisjointSets::new(3 * triangles.len());
        let mut is_border = vec![[false; 3]; triangles.len()];
        for (face, &[a, b, c]) in triangles.iter().enumerate() {
            for (side, [from, to]) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
                match sides.get(&[to, from]) {
                    None => is_border[face][side] = true,
                    Some(&(other, across)) => {
                        // The other triangle runs back through the edge.
                        let corner = |triangle: usize, at: usize| index(3 * triangle + at % 3);
                        let other = other as usize;
                        joined.join(corner(face, side), corner(other, across + 1));
                        joined.join(corner(face, side + 1), corner(other, across));
                    }
                }
            }
        }
        let mut number: HashMap<u32, u32> = HashMap::new();
        let mut vertex_of = Vec::new();
        let mut corners = Vec::with_capacity(triangles.len());
        for (face, triangle) in triangles.iter().enumerate() {
            corners.push([0, 1, 2].map(|at| {
                let set = joined.first(index(3 * face + at));
                *number.entry(set).or_insert_with(|| {
                    vertex_of.push(triangle[at]);
                    index(vertex_of.len() - 1)
                })
            }));
        }
        Ok(Sheet {
            corners,
            vertex_of,
            is_border,
        })
    }

    /// The offset of each vertex, half the thickness long, so that no prism turns inside out.
    fn offsets(&self, surface: &Surface, thickness: f64) -> Result<Vec<DVec3>, ThickenError> {
        let places = surface.vertices_of(self);
        let mut normals: Vec<Vec<DVec3>> = vec![Vec::new(); places.len()];
        for (triangle, corners) in (0u32..).zip(&self.corners) {
            let [a, b, c] = corners.map(|v| places[v as usize]);
            let area = (b - a).cross(c - a);
            let Some(normal) = area.try_normalize() else {
                return Err(ThickenError::NoArea { triangle });
            };
            corners
                .iter()
                .for_each(|&v| normals[v as usize].push(normal));
        }
        let half = 0.5 * thickness;
        let offsets: Vec<DVec3> = normals.iter().map(|n| half * outward(n)).collect();
        for (triangle, corners) in (0u32..).zip(&self.corners) {
            let p = corners.map(|v| places[v as usize]);
            let n = corners.map(|v| offsets[v as usize]);
            // At a share s of the offsets the area vector is N0 + s N1 + s^2 N2, s from -1 to 1; the
            // volume element is its product with a mean of the offsets.
            let [e, f] = [p[1] - p[0], p[2] - p[0]];
            let [d, g] = [n[1] - n[0], n[2] - n[0]];
            let (n0, n1, n2) = (e.cross(f), e.cross(g) + d.cross(f), d.cross(g));
            let is_upright = |n: &DVec3| n0.dot(*n) > n1.dot(*n).abs() + n2.dot(*n).abs();
            if !n.iter().all(is_upright) {
                return Err(ThickenError::TooSharp {
                    triangle,
                    place: p[0],
                    thickness,
                });
            }
        }
        Ok(offsets)
    }
}

/// A unit vector on the outer side of all planes through a vertex, given by their unit normals, if
/// there is one: their mean where that is well outside, or else the direction that is farthest from
/// all of them.
///
/// That is the direction of the point nearest to the origin of the convex hull of the normals; steps
/// towards the normal that is farthest behind, each to the nearest point of its line, approach it.
fn outward(normals: &[DVec3]) -> DVec3 {
    let farthest_behind = |v: DVec3| {
        let order = |a: &&DVec3, b: &&DVec3| v.dot(**a).total_cmp(&v.dot(**b));
        normals.iter().min_by(order).copied().unwrap_or_default()
    };
    let mean = normals.iter().sum::<DVec3>() / normals.len() as f64;
    let is_well_outside = |v: DVec3| v.dot(farthest_behind(v)) >= WELL_OUTSIDE * v.length();
    let mut nearest = mean;
    if !is_well_outside(mean) {
        for _ in 0..STEPS {
            let way = farthest_behind(nearest) - nearest;
            let share = -nearest.dot(way) / way.length_squared();
            // A NaN, at the normal itself, is no step.
            nearest += share.clamp(0.0, 1.0).max(0.0) * way;
        }
    }
    nearest.normalize_or_zero()
}

/// Cosine of the angle to the normals up to which their mean is taken.
const WELL_OUTSIDE: f64 = 0.5;

/// Steps of the search: its error decreases at least as one over their number.
const STEPS: u32 = 200;

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 2 x 2 cells, with the given height of its middle.
    fn square(height: f64) -> Surface {
        let mut positions = Vec::new();
        for y in 0..3 {
            for x in 0..3 {
                let z = if x == 1 && y == 1 { height } else { 0.0 };
                positions.push(DVec3::new(f64::from(x), f64::from(y), z));
            }
        }
        let mut triangles = Vec::new();
        for corner in [0, 1, 3, 4] {
            triangles.push([corner, corner + 1, corner + 4]);
            triangles.push([corner, corner + 4, corner + 3]);
        }
        Surface::new(positions, triangles).expect("a surface")
    }

    #[test]
    fn a_plate_has_the_area_times_the_thickness() {
        let plate = square(0.0).thickened(0.1).expect("a plate");
        assert!((plate.volume() - 0.4).abs() < 1e-14, "{}", plate.volume());
        // Two sides, and the border of length 8.
        assert!(
            (plate.area() - (8.0 + 0.8)).abs() < 1e-13,
            "{}",
            plate.area()
        );
        assert_eq!(plate.triangles().len(), 2 * 8 + 4 * 8, "no more");
    }

    #[test]
    fn a_closed_surface_becomes_a_hollow_shell() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let shell = Surface::new(corners, faces).expect("a surface");
        let plate = shell.thickened(1e-3).expect("a plate");
        assert_eq!(plate.shells().len(), 2, "outside and cavity");
        // At edges and corners, offsets of half the thickness leave less than it between the sides.
        let area = 1.5 + 0.75_f64.sqrt();
        let ratio = plate.volume() / (area * 1e-3);
        assert!((0.1..1.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn sheets_that_meet_in_a_vertex_are_plates_of_their_own() {
        let corners = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
        ];
        let bow_tie = Surface::new(
            corners.map(DVec3::from_array).to_vec(),
            vec![[0, 1, 2], [0, 3, 4]],
        );
        let plate = bow_tie
            .expect("a surface")
            .thickened(0.01)
            .expect("two plates");
        assert_eq!(plate.shells().len(), 2, "joined nowhere");
    }

    #[test]
    fn what_cannot_have_a_thickness_is_refused() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Y];
        let refused = |triangles| {
            let surface = Surface::new(corners.clone(), triangles).expect("a surface");
            surface.thickened(0.01).expect_err("refused").to_string()
        };
        let three = refused(vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        assert!(
            three.starts_with("triangles 0 and 2 run through edge 0-1"),
            "{three}"
        );
        assert!(
            refused(vec![[0, 1, 1]]).contains("no area"),
            "two corners are one"
        );
        assert!(
            square(2.0).thickened(1e-2).is_ok(),
            "a spike has a thin plate"
        );
        assert!(
            square(0.0).thickened(10.0).is_ok(),
            "flat sheets have no limit"
        );
        let bent = square(1.0)
            .thickened(10.0)
            .expect_err("thicker than its bend");
        assert!(matches!(bent, ThickenError::TooSharp { .. }), "{bent}");
    }
}
