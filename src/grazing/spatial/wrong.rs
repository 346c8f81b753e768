//! The parts of faces that count with the sign opposite to that of their flux.
//!
//! Shallow folds are dropped, break points are merged, and flux near zero counts as zero: then the
//! egress region differs from the exact one. By the formula in [`crate::envelope`] the cycle loses
//! only points that these parts sweep, so it is enough to know them: what they sweep is compared
//! with the result (`solid::spatial::missed`).
//!
//! A part on which the flux is zero up to rounding moves out of its own surface by no more than
//! rounding, and counts as right.

use crate::body::Mesh;
use crate::grazing::flux::{Break, FaceFlux};
use crate::surface::SurfacePoint;
use glam::DVec3;

/// The parts, as triangles on the faces, in the order of the faces. O(#F).
///
/// - `positions`: #V, world at the start of the span. `normals`: #F, unit.
/// - `flux`: the flux at the corners of each face. `rounding`: its rounding.
pub(super) fn wrong_parts(
    mesh: &Mesh,
    positions: &[DVec3],
    normals: &[DVec3],
    flux: &[[f64; 3]],
    rounding: f64,
    faces: &[FaceFlux],
) -> Vec<[SurfacePoint; 3]> {
    let outwards = outward_directions(mesh, positions, normals);
    let mut parts = Parts {
        list: Vec::new(),
        rounding,
    };
    for (face, (signs, flux)) in faces.iter().zip(flux).enumerate() {
        let triangle = mesh.triangles()[face];
        let corners = [0, 1, 2].map(|i| {
            let v = triangle[i] as usize;
            let inwards = -outwards[v].normalize_or_zero();
            let place = positions[v];
            (SurfacePoint { place, inwards }, flux[i])
        });
        match signs {
            FaceFlux::Ingress => parts.add(&corners, 1.0),
            FaceFlux::Egress => parts.add(&corners, -1.0),
            FaceFlux::Cut {
                egress_corners,
                leave,
                enter,
            } => {
                let at = |at: &Break| {
                    let [from, to] = [at.side, (at.side + 1) % 3];
                    let edge = mesh.edges()[at.edge as usize];
                    let runs_along = edge.vertices[0] == triangle[from];
                    let share = if runs_along { at.t } else { 1.0 - at.t };
                    let [(p, g), (q, h)] = [corners[from], corners[to]];
                    (p.lerp(q, share), g + (h - g) * share)
                };
                for (egress, sense) in [(false, 1.0), (true, -1.0)] {
                    let mut part = Vec::with_capacity(4);
                    for side in 0..3 {
                        if egress_corners[side] == egress {
                            part.push(corners[side]);
                        }
                        let on_side = [leave, enter].into_iter().filter(|at| at.side == side);
                        part.extend(on_side.map(at));
                    }
                    parts.add(&part, sense);
                }
            }
        }
    }
    parts.list
}

/// Per vertex, the normals of the faces around it, weighted by their angles there.
///
/// This points outwards, however the faces are divided: Thürmer & Wüthrich, *Computing Vertex
/// Normals from Polygonal Facets*, Journal of Graphics Tools 3 (1998).
fn outward_directions(mesh: &Mesh, positions: &[DVec3], normals: &[DVec3]) -> Vec<DVec3> {
    let mut outwards = vec![DVec3::ZERO; positions.len()];
    for (triangle, &normal) in mesh.triangles().iter().zip(normals) {
        let p = triangle.map(|v| positions[v as usize]);
        let sides = [0, 1, 2].map(|i| (p[(i + 1) % 3] - p[i]).normalize_or_zero());
        for (i, &v) in triangle.iter().enumerate() {
            let cosine = -sides[i].dot(sides[(i + 2) % 3]);
            outwards[v as usize] += normal * cosine.clamp(-1.0, 1.0).acos();
        }
    }
    outwards
}

/// Parts that are being collected.
struct Parts {
    list: Vec<[SurfacePoint; 3]>,
    rounding: f64,
}

impl Parts {
    /// Adds the part of a convex polygon, given with the flux at its corners, where the flux has
    /// the sign of `sense`.
    fn add(&mut self, polygon: &[(SurfacePoint, f64)], sense: f64) {
        let is_right = |&(_, flux): &(SurfacePoint, f64)| sense * flux <= self.rounding;
        if polygon.iter().all(is_right) {
            return;
        }
        let mut rest = Vec::with_capacity(polygon.len() + 1);
        for (i, &(p, g)) in polygon.iter().enumerate() {
            let (q, h) = polygon[(i + 1) % polygon.len()];
            if sense * g > 0.0 {
                rest.push(p);
            }
            if (sense * g > 0.0) != (sense * h > 0.0) {
                rest.push(p.lerp(q, g / (g - h)));
            }
        }
        let fan = rest
            .windows(2)
            .skip(1)
            .map(|pair| [rest[0], pair[0], pair[1]]);
        self.list.extend(fan);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::area::area_vector;

    /// The parts of one face of a tetrahedron with the given flux, and their area.
    fn parts_of(flux: [f64; 3], signs: FaceFlux) -> (Vec<[SurfacePoint; 3]>, f64) {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_Z];
        let faces = vec![[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]];
        let mesh = Mesh::new(corners, faces).expect("a tetrahedron is a body");
        let mut all = vec![FaceFlux::Egress; 4];
        all[0] = signs;
        let mut fluxes = vec![[1.0; 3]; 4];
        fluxes[0] = flux;
        let parts = wrong_parts(&mesh, mesh.positions(), &[DVec3::Z; 4], &fluxes, 1e-9, &all);
        let area = |t: &[SurfacePoint; 3]| area_vector(t.map(|corner| corner.place)).z / 2.0;
        let sum = parts.iter().map(area).sum();
        (parts, sum)
    }

    /// A break on a side of the first face, at a share of it.
    fn at(side: usize, share: f64) -> Break {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_Z];
        let faces = vec![[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]];
        let mesh = Mesh::new(corners, faces).expect("a tetrahedron is a body");
        let edge = mesh.face_edges()[0][side];
        let runs_along = mesh.edges()[edge as usize].vertices[0] == mesh.triangles()[0][side];
        let t = if runs_along { share } else { 1.0 - share };
        Break { side, edge, t }
    }

    #[test]
    fn a_face_against_its_flux_is_wrong_where_the_flux_has_the_other_sign() {
        let wrong = |flux, signs| parts_of(flux, signs).0.len();
        assert_eq!(wrong([1.0, 2.0, 0.0], FaceFlux::Egress), 0, "right");
        assert_eq!(wrong([0.0; 3], FaceFlux::Ingress), 0, "either sign");
        assert_eq!(parts_of([1.0, 2.0, 0.0], FaceFlux::Ingress).1, 0.5, "all");
        // The flux is negative up to half of both sides at the first corner: a quarter of the area.
        let (_, area) = parts_of([-1.0, 1.0, 1.0], FaceFlux::Egress);
        assert!((area - 0.125).abs() < 1e-15, "{area}");
    }

    #[test]
    fn a_cut_at_the_change_of_sign_leaves_nothing_wrong() {
        let cut = FaceFlux::Cut {
            egress_corners: [true, false, false],
            leave: at(0, 0.5),
            enter: at(2, 0.5),
        };
        assert_eq!(parts_of([1.0, -1.0, -1.0], cut).1, 0.0);
    }

    #[test]
    fn a_cut_elsewhere_is_wrong_between_the_two() {
        // It cuts off a quarter of each side instead of a half: triangles of 1/2 (1/4 - 1/16).
        let cut = FaceFlux::Cut {
            egress_corners: [true, false, false],
            leave: at(0, 0.25),
            enter: at(2, 0.75),
        };
        let (_, area) = parts_of([1.0, -1.0, -1.0], cut);
        assert!((area - 0.09375).abs() < 1e-15, "{area}");
    }
}
