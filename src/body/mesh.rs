//! A closed oriented triangle mesh.

use super::defect::BodyError;
use super::edge::Edge;
use super::shell::{Shell, measure};
use super::validate::check;
use crate::numeric::index;
use crate::surface::bounds_of;
use glam::{DAffine3, DVec3};

/// A closed, oriented, finite triangle mesh: the boundary of a body.
///
/// By construction every edge is shared by exactly two triangles that run through it in opposite
/// senses, every vertex is used and finite, every shell encloses volume, and no shell is inside
/// out. It may intersect itself.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::body::Mesh;
///
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let body = Mesh::new(corners.clone(), triangles.clone()).expect("a tetrahedron");
/// assert!((body.volume() - 1.0 / 6.0).abs() < 1e-15);
///
/// // Without its last triangle it is open: refused, with the edges at fault.
/// let error = Mesh::new(corners, triangles[..3].to_vec()).expect_err("a hole");
/// assert_eq!(error.defects().len(), 3);
/// ```
#[derive(Debug, Clone)]
pub struct Mesh {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    face_edges: Vec<[u32; 3]>,
    shells: Vec<Shell>,
    bounds: [DVec3; 2],
    turned: bool,
}

impl Mesh {
    /// Checks a triangle list and makes it a body.
    ///
    /// - `positions`: #V vertices, any unit, finite. Unused ones are dropped; the others keep their
    ///   order, so that indices stay as given when all are used.
    /// - `triangles`: #F index triples, kept in this order; counter-clockwise from outside. When
    ///   the total signed volume is negative, every triangle `[a, b, c]` is turned to `[a, c, b]`
    ///   and [`Mesh::turned`] says so.
    ///
    /// # Errors
    /// [`BodyError`] with every defect that was found; indices in it are those of the input.
    ///
    /// # Cost
    /// O(n log n).
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, BodyError> {
        let checked = match check(&positions, &triangles) {
            Ok(checked) => checked,
            Err(defects) => {
                return Err(BodyError::new(defects).expect("validation fails with a defect"));
            }
        };
        let mut mesh = Mesh {
            bounds: [DVec3::ZERO; 2],
            positions,
            triangles,
            edges: checked.edges,
            face_edges: Vec::new(),
            shells: checked.shells,
            turned: checked.turned,
        };
        if mesh.turned {
            mesh.triangles
                .iter_mut()
                .for_each(|triangle| triangle.swap(1, 2));
            mesh.edges.iter_mut().for_each(|edge| edge.faces.swap(0, 1));
        }
        mesh.drop_unused_vertices();
        mesh.face_edges = face_edges(&mesh.triangles, &mesh.edges);
        mesh.bounds = bounds_of(mesh.positions.iter().copied());
        debug_assert_eq!(
            mesh.edges.len() * 2,
            mesh.triangles.len() * 3,
            "every edge has two triangles"
        );
        Ok(mesh)
    }

    fn drop_unused_vertices(&mut self) {
        let mut used = vec![false; self.positions.len()];
        self.triangles
            .iter()
            .flatten()
            .for_each(|&v| used[v as usize] = true);
        if used.iter().all(|&u| u) {
            return;
        }
        let mut next = 0;
        let new_index: Vec<u32> = used
            .iter()
            .map(|&u| {
                let index = next;
                next += u32::from(u);
                index
            })
            .collect();
        let mut keep = used.into_iter();
        self.positions.retain(|_| keep.next() == Some(true));
        // The order of the vertices does not change, and neither does that of the edges and of
        // their ends.
        let renumber = |v: &mut u32| *v = new_index[*v as usize];
        self.triangles.iter_mut().flatten().for_each(renumber);
        self.edges
            .iter_mut()
            .flat_map(|edge| &mut edge.vertices)
            .for_each(renumber);
    }

    /// #V positions, all used.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }
    /// #F index triples, counter-clockwise from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
    /// Every edge once, sorted by `vertices`.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }
    /// Per triangle, the edges of its sides: side i runs from corner i to corner i + 1 (mod 3).
    pub(crate) fn face_edges(&self) -> &[[u32; 3]] {
        &self.face_edges
    }
    /// The shells, by their first triangles.
    pub fn shells(&self) -> &[Shell] {
        &self.shells
    }
    /// Whether the input was inside out as a whole and all triangles were reversed.
    pub fn turned(&self) -> bool {
        self.turned
    }

    /// The image under an affine map of positive determinant.
    ///
    /// It is not validated again: a pose that flattens the body below rounding gives a flat mesh,
    /// still closed and oriented.
    pub fn transformed(&self, pose: &DAffine3) -> Mesh {
        let determinant = pose.matrix3.determinant();
        debug_assert!(
            determinant > 0.0,
            "a pose of a body keeps orientation, determinant {determinant}"
        );
        let mut mesh = self.clone();
        mesh.positions
            .iter_mut()
            .for_each(|p| *p = pose.transform_point3(*p));
        mesh.shells
            .iter_mut()
            .for_each(|shell| shell.volume *= determinant);
        mesh.bounds = bounds_of(mesh.positions.iter().copied());
        mesh
    }

    /// Signed volume, the sum over the shells: cavities count negative, and nested shells count
    /// once more. O(n).
    pub fn volume(&self) -> f64 {
        measure(
            &self.positions,
            self.triangles.iter().copied(),
            self.bounds[0].midpoint(self.bounds[1]),
        )
        .0
    }
    /// Area of all shells. O(n).
    pub fn area(&self) -> f64 {
        measure(
            &self.positions,
            self.triangles.iter().copied(),
            self.bounds[0],
        )
        .1
    }
    /// The smallest box [min, max] around it.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }
    /// Length of the diagonal of the box.
    pub fn diagonal(&self) -> f64 {
        self.bounds[0].distance(self.bounds[1])
    }
}

/// The edges at the sides of each triangle.
fn face_edges(triangles: &[[u32; 3]], edges: &[Edge]) -> Vec<[u32; 3]> {
    let mut out = vec![[0; 3]; triangles.len()];
    for (number, edge) in edges.iter().enumerate() {
        for (face, start) in edge.faces.iter().zip(edge.vertices) {
            let side = triangles[*face as usize].iter().position(|&v| v == start);
            out[*face as usize][side.expect("an edge joins corners of its faces")] = index(number);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::shell::ShellRole;
    use super::super::shell::tests::{Soup, boxes, sphere};
    use super::*;

    fn mesh(soup: Soup) -> Mesh {
        Mesh::new(soup.0, soup.1).expect("a body")
    }

    fn a_box(low: f64, size: f64, outward: bool) -> Soup {
        let mut soup = (Vec::new(), Vec::new());
        boxes(&mut soup, DVec3::splat(low), DVec3::splat(size), outward);
        soup
    }

    fn roles(mesh: &Mesh) -> Vec<(ShellRole, f64)> {
        mesh.shells()
            .iter()
            .map(|shell| (shell.role, (shell.volume * 1e9).round() / 1e9))
            .collect()
    }

    #[test]
    fn a_cube_has_its_measures_at_any_scale_and_place() {
        for (low, size) in [(0.0, 1.0), (1e6, 1.0), (-5e3, 1e3), (0.0, 1e-3)] {
            let cube = mesh(a_box(low, size, true));
            // Coordinates are rounded by u |low|: relative to the size, per direction, on two
            // sides.
            let error = 8.0 * f64::EPSILON * (1.0 + low.abs() / size);
            assert!(
                (cube.volume() / size.powi(3) - 1.0).abs() < error,
                "volume of {size} at {low}"
            );
            assert!(
                (cube.area() / size.powi(2) / 6.0 - 1.0).abs() < error,
                "area of {size} at {low}"
            );
            assert!(
                (cube.diagonal() / size - 3f64.sqrt()).abs() < 2.0 * error,
                "diagonal of {size} at {low}"
            );
            assert!(!cube.turned(), "outward as given");
        }
    }

    #[test]
    fn edges_are_sorted_and_name_the_forward_triangle_first() {
        let ball = mesh(sphere(9));
        assert!(
            ball.edges().is_sorted_by_key(|edge| edge.vertices),
            "sorted by vertices"
        );
        let runs = |f: u32, [a, b]: [u32; 2]| {
            let t = ball.triangles()[f as usize];
            [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].contains(&[a, b])
        };
        for edge in ball.edges() {
            let [a, b] = edge.vertices;
            assert!(
                a < b && runs(edge.faces[0], [a, b]) && runs(edge.faces[1], [b, a]),
                "{edge:?}"
            );
        }
        assert_eq!(
            ball.positions().len() + ball.triangles().len(),
            ball.edges().len() + 2,
            "Euler's formula"
        );
    }

    #[test]
    fn a_body_inside_out_is_turned_as_a_whole() {
        let mut soup = a_box(0.0, 1.0, false);
        boxes(&mut soup, DVec3::splat(0.25), DVec3::splat(0.5), true);
        let body = mesh(soup);
        assert!(body.turned(), "the outer shell was inward");
        assert_eq!(
            roles(&body),
            [(ShellRole::Outer, 1.0), (ShellRole::Cavity, -0.125)]
        );
        assert!((body.volume() - 0.875).abs() < 1e-15, "{}", body.volume());
        let edge = body.edges()[0];
        let t = body.triangles()[edge.faces[0] as usize];
        let forward = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].contains(&edge.vertices);
        assert!(forward, "edges follow the turned triangles");
    }

    #[test]
    fn nested_shells_and_cavities_are_told_apart() {
        let mut soup = a_box(0.0, 1.0, true);
        boxes(&mut soup, DVec3::splat(0.1), DVec3::splat(0.8), false);
        boxes(&mut soup, DVec3::splat(0.2), DVec3::splat(0.6), true);
        boxes(&mut soup, DVec3::splat(0.3), DVec3::splat(0.2), true);
        boxes(&mut soup, DVec3::splat(2.0), DVec3::splat(0.5), true);
        let body = mesh(soup);
        let expected = [
            (ShellRole::Outer, 1.0),
            (ShellRole::Cavity, -0.512),
            (ShellRole::Outer, 0.216),
            (ShellRole::Nested, 0.008),
            (ShellRole::Outer, 0.125),
        ];
        assert_eq!(
            roles(&body),
            expected,
            "box, cavity, box in the cavity, box in that, box beside"
        );
        assert!(
            body.shells()
                .iter()
                .all(|shell| shell.triangles.len() == 12),
            "twelve triangles each"
        );
    }

    #[test]
    fn a_cavity_that_touches_the_wall_is_a_cavity() {
        let mut soup = a_box(0.0, 1.0, true);
        boxes(&mut soup, DVec3::ZERO, DVec3::splat(0.5), false);
        assert_eq!(
            roles(&mesh(soup)),
            [(ShellRole::Outer, 1.0), (ShellRole::Cavity, -0.125)],
            "three walls shared"
        );
    }

    #[test]
    fn unused_vertices_are_dropped_and_the_others_keep_their_order() {
        let (mut positions, triangles) = a_box(0.0, 1.0, true);
        positions.insert(3, DVec3::splat(77.0));
        positions.push(DVec3::splat(-1.0));
        let shifted = triangles
            .iter()
            .map(|t| t.map(|v| if v >= 3 { v + 1 } else { v }))
            .collect();
        let body = mesh((positions, shifted));
        let plain = mesh(a_box(0.0, 1.0, true));
        assert_eq!(body.positions(), plain.positions());
        assert_eq!(body.triangles(), plain.triangles());
        assert_eq!(body.edges(), plain.edges());
        assert_eq!(
            body.bounds(),
            [DVec3::ZERO, DVec3::ONE],
            "bounds of what is used"
        );
    }

    #[test]
    fn large_bodies_and_many_cavities_are_checked_within_a_second() {
        let ball = sphere(128);
        let start = std::time::Instant::now();
        assert_eq!(
            mesh(ball).triangles().len(),
            4 * 128 * 127,
            "65,024 triangles"
        );
        assert!(
            start.elapsed().as_secs_f64() < 1.0,
            "a ball: {:?}",
            start.elapsed()
        );
        let mut sponge = a_box(-1.0, 22.0, true);
        for i in 0..8000 {
            let cell = DVec3::new(
                f64::from(i % 20),
                f64::from(i / 20 % 20),
                f64::from(i / 400),
            );
            boxes(&mut sponge, cell, DVec3::splat(0.5), false);
        }
        let start = std::time::Instant::now();
        let body = mesh(sponge);
        assert!(
            start.elapsed().as_secs_f64() < 1.0,
            "8,000 cavities: {:?}",
            start.elapsed()
        );
        assert_eq!(
            body.shells()
                .iter()
                .filter(|shell| shell.role == ShellRole::Cavity)
                .count(),
            8000,
            "all of them"
        );
        assert!(
            (body.volume() / (22f64.powi(3) - 1000.0) - 1.0).abs() < 1e-12,
            "{}",
            body.volume()
        );
    }

    #[test]
    fn a_pose_moves_measures_as_its_determinant_says() {
        let mut soup = sphere(10);
        boxes(&mut soup, DVec3::splat(-0.25), DVec3::splat(0.5), false);
        let body = mesh(soup);
        let pose = DAffine3::from_scale_rotation_translation(
            DVec3::new(2.0, 3.0, 0.5),
            glam::DQuat::from_rotation_z(0.4),
            DVec3::new(10.0, -4.0, 7.0),
        );
        let moved = body.transformed(&pose);
        assert!(
            (moved.volume() - 3.0 * body.volume()).abs() < 1e-12,
            "determinant 3"
        );
        assert!(
            (moved.shells()[1].volume + 0.375).abs() < 1e-12,
            "the cavity too"
        );
        assert_eq!(moved.edges(), body.edges(), "same edges");
        assert!(
            (moved.bounds()[0].z - 6.5).abs() < 1e-12,
            "half the radius below 7"
        );
    }
}
