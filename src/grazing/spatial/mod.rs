//! Grazing sets of triangle meshes.

mod boundary;
mod exact;
mod following;
mod minimum_cut;
mod parting;
mod projection;
mod shallow;
mod smoothing;
mod wrong;

pub(crate) use super::flux::{Break, FaceFlux};
pub use boundary::{Fold, Source};
pub(crate) use boundary::{Interval, boundary, breaks_on, edge_line, on_line, segment_line};
pub use exact::{GrazingPoint, GrazingSegment, SpanGrazing, of, on_line_in_face};

use super::flux::{is_mixed, snap};
use crate::body::Mesh;
use crate::motion::Generator;
use crate::numeric::tolerance::{FLUX_ROUNDING, UNIT_ROUNDOFF, ZERO_FLUX};
use crate::surface::SurfacePoint;
use crate::watch::{Interrupted, Work};
use following::Following;
use glam::{DMat3, DVec3};
use parting::FaceSide;
use projection::{TranslationSigns, signs};
use shallow::settle;
use wrong::wrong_parts;

/// The grazing set of a mesh for one steady span.
#[derive(Debug, Clone)]
pub(crate) struct GrazingSet {
    /// The sign of the flux per face.
    pub faces: Vec<FaceFlux>,
    /// The unit outward normal per face, at the start of the span.
    pub normals: Vec<DVec3>,
    /// Estimated depth of the deepest dropped fold, at the start of the span; 0 when there is none.
    pub dropped_fold: f64,
    /// Largest distance by which a break point was moved, at the start of the span.
    pub merged: f64,
    /// The parts of faces that count with the wrong sign, at the start of the span.
    pub wrong: Vec<[SurfacePoint; 3]>,
    /// For a translation, the body for which its signs are exact.
    pub translated: Option<Translated>,
}

/// The body for which the signs of a translation are exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Translated {
    /// Whether it is the given body; otherwise some of its vertices are moved.
    pub is_given: bool,
    /// Bound on its distance from the given body, and on the rounding of its projection.
    pub distance: f64,
}

/// How far the exact grazing set may be simplified. Both are lengths; 0 keeps everything.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Simplification {
    /// Faces of mixed sign whose fold is shallower than this may take one sign.
    pub fold: f64,
    /// Break points of an edge closer than this become one; those closer than this to a corner move
    /// to it.
    pub merge: f64,
}

impl GrazingSet {
    /// The grazing set of `mesh` in a field, with vertices `positions` (#V, world at the start of
    /// the span).
    ///
    /// `generator` acts in the same frame as `positions`. O(#F).
    pub(crate) fn new(
        mesh: &Mesh,
        positions: &[DVec3],
        generator: &Generator,
        simplification: Simplification,
        work: Work,
    ) -> Result<GrazingSet, Interrupted> {
        if generator.linear == DMat3::ZERO {
            return Ok(GrazingSet::of_translation(
                mesh,
                positions,
                generator.offset,
            ));
        }
        let velocities: Vec<DVec3> = positions.iter().map(|&p| generator.velocity(p)).collect();
        let top_speed = velocities.iter().map(|v| v.length()).fold(0.0, f64::max);
        let zero = ZERO_FLUX * top_speed;
        let mut normals = Vec::with_capacity(mesh.triangles().len());
        let mut flux = Vec::with_capacity(mesh.triangles().len());
        for triangle in mesh.triangles() {
            let p = triangle.map(|i| positions[i as usize]);
            let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
            let velocity = triangle.map(|i| velocities[i as usize]);
            flux.push(velocity.map(|v| normal.dot(v)));
            normals.push(normal);
        }
        let mut corner_flux: Vec<[f64; 3]> =
            flux.iter().map(|g| g.map(|g| snap(g, zero))).collect();
        let thinness = thinness(mesh, &normals);
        let is_shallow = |face: usize| {
            let triangle = mesh.triangles()[face];
            let p = triangle.map(|i| positions[i as usize]);
            let v = triangle.map(|i| velocities[i as usize]);
            thinness[face] * depth_of_fold(&p, &v, &corner_flux[face], normals[face], generator)
                < simplification.fold
        };
        let sides: Vec<FaceSide> = (0..mesh.triangles().len())
            .map(|face| {
                let g = &corner_flux[face];
                if g.iter().all(|&g| g == 0.0) {
                    FaceSide::Egress
                } else if is_shallow(face) {
                    FaceSide::Free
                } else if is_mixed(g) {
                    FaceSide::Both
                } else if g.iter().all(|&g| g >= 0.0) {
                    FaceSide::Egress
                } else {
                    FaceSide::Ingress
                }
            })
            .collect();
        let body = Following {
            mesh,
            positions,
            normals: &normals,
            generator,
        };
        work.check()?;
        let limit = simplification.fold;
        let (signs, dropped_fold) = settle(
            &body,
            &corner_flux,
            &thinness,
            limit,
            sides,
            work.uncounted(),
        )?;
        // A face that took one sign has no corner of the other.
        for ((g, side), levels) in corner_flux.iter_mut().zip(&signs.sides).zip(&signs.levels) {
            match (side, levels) {
                (_, Some(levels)) => *g = *levels,
                (FaceSide::Egress, None) => *g = g.map(f64::abs),
                (FaceSide::Ingress, None) => *g = g.map(|g| -g.abs()),
                (FaceSide::Both | FaceSide::Free, None) => {}
            }
        }
        let (breaks, merged) = edge_breaks(mesh, positions, &corner_flux, simplification.merge);
        let faces: Vec<FaceFlux> = (0..mesh.triangles().len())
            .map(|face| face_flux(mesh, face, &corner_flux[face], &breaks))
            .collect();
        let rounding = FLUX_ROUNDING * UNIT_ROUNDOFF * top_speed;
        let wrong = wrong_parts(mesh, positions, &normals, &flux, rounding, &faces);
        work.done();
        Ok(GrazingSet {
            faces,
            normals,
            dropped_fold,
            merged,
            wrong,
            translated: None,
        })
    }

    fn of_translation(mesh: &Mesh, positions: &[DVec3], way: DVec3) -> GrazingSet {
        let TranslationSigns {
            is_egress,
            moved,
            distance,
        } = signs(mesh, positions, way);
        let sign = |egress| {
            if egress {
                FaceFlux::Egress
            } else {
                FaceFlux::Ingress
            }
        };
        let normal = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| positions[v as usize]);
            (b - a).cross(c - a).normalize_or_zero()
        };
        let faces: Vec<FaceFlux> = is_egress.into_iter().map(sign).collect();
        let normals: Vec<DVec3> = mesh.triangles().iter().map(normal).collect();
        let flux: Vec<[f64; 3]> = normals.iter().map(|n| [n.dot(way); 3]).collect();
        let rounding = FLUX_ROUNDING * UNIT_ROUNDOFF * way.length();
        GrazingSet {
            wrong: wrong_parts(mesh, positions, &normals, &flux, rounding, &faces),
            faces,
            normals,
            dropped_fold: 0.0,
            merged: 0.0,
            translated: Some(Translated {
                is_given: moved.is_empty(),
                distance,
            }),
        }
    }
}

/// A bound on the depth of the layer that is lost if this face alone takes the wrong sign.
///
/// A face of flux g moves outwards until its flux changes sign, by g^2 / (2 |n.Mv|) as long as n.Mv
/// keeps its own sign; or until the points of space that meet it have passed over it, by |g| / |v|
/// times its length.
fn depth_of_fold(
    p: &[DVec3; 3],
    v: &[DVec3; 3],
    g: &[f64; 3],
    normal: DVec3,
    generator: &Generator,
) -> f64 {
    let turning = v.map(|v| normal.dot(generator.linear * v));
    // g^2 / (2 |n.Mv|) is convex where n.Mv keeps its sign, so the corners bound it.
    let keeps_sign = turning.iter().all(|&k| k >= 0.0) || turning.iter().all(|&k| k <= 0.0);
    let at_corner = |i: usize| {
        if g[i] == 0.0 {
            0.0
        } else {
            g[i] * g[i] / (2.0 * turning[i].abs())
        }
    };
    let by_turning = if keeps_sign && is_mixed(g) {
        (0..3).map(at_corner).fold(0.0, f64::max)
    } else {
        f64::INFINITY
    };
    let middle = (v[0] + v[1] + v[2]) / 3.0;
    let spread = v.iter().map(|v| v.distance(middle)).fold(0.0, f64::max);
    let slowest = (middle.length() - spread).max(0.0);
    let slope = g.iter().map(|g| g.abs()).fold(0.0, f64::max) / slowest;
    let length = (0..3)
        .map(|i| p[i].distance(p[(i + 1) % 3]))
        .fold(0.0, f64::max);
    by_turning.min(slope * length)
}

/// Per face, the distance by which a layer under it reaches beyond the rest of the body at the
/// edges around its corners, relative to the depth of the layer: 1 / sin of half the interior angle
/// where that is sharp, as if the layers of both faces were lost.
fn thinness(mesh: &Mesh, normals: &[DVec3]) -> Vec<f64> {
    let mut thinness = vec![1.0_f64; mesh.positions().len()];
    for edge in mesh.edges() {
        let [first, second] = edge.faces.map(|face| normals[face as usize]);
        if first.dot(second) < 0.0 {
            let factor = (2.0 / (1.0 + first.dot(second))).sqrt();
            for vertex in edge.vertices {
                thinness[vertex as usize] = thinness[vertex as usize].max(factor);
            }
        }
    }
    let of = |triangle: &[u32; 3]| {
        let at = triangle.map(|v| thinness[v as usize]);
        at.into_iter().fold(1.0, f64::max)
    };
    mesh.triangles().iter().map(of).collect()
}

/// Per edge, the break of each of its two faces, as a position on the edge; and the largest
/// distance by which one was moved.
fn edge_breaks(
    mesh: &Mesh,
    positions: &[DVec3],
    corner_flux: &[[f64; 3]],
    merge: f64,
) -> (Vec<[Option<f64>; 2]>, f64) {
    let mut merged: f64 = 0.0;
    let breaks = mesh
        .edges()
        .iter()
        .map(|edge| {
            let [from, to] = edge.vertices;
            let exact = edge.faces.map(|face| {
                let flux = &corner_flux[face as usize];
                let triangle = mesh.triangles()[face as usize];
                let corner = |vertex| {
                    triangle
                        .iter()
                        .position(|&v| v == vertex)
                        .expect("an end of a side is a corner")
                };
                let (start, end) = (flux[corner(from)], flux[corner(to)]);
                let changes = is_mixed(flux) && (start >= 0.0) != (end >= 0.0);
                changes.then(|| (start / (start - end)).clamp(0.0, 1.0))
            });
            let length = positions[from as usize].distance(positions[to as usize]);
            let moved = joined(exact, merge / length);
            for (was, is) in exact.iter().zip(moved) {
                merged = merged.max((was.unwrap_or(0.0) - is.unwrap_or(0.0)).abs() * length);
            }
            moved
        })
        .collect();
    (breaks, merged)
}

/// The breaks of an edge after merging: those closer than `merge` (a share of the edge) to a corner
/// are moved there, and those closer than that to each other become one.
fn joined(breaks: [Option<f64>; 2], merge: f64) -> [Option<f64>; 2] {
    let to_corner = |t: f64| {
        if t < merge {
            0.0
        } else if 1.0 - t < merge {
            1.0
        } else {
            t
        }
    };
    match breaks.map(|t| t.map(to_corner)) {
        [Some(a), Some(b)] if (a - b).abs() < merge => {
            let is_corner = |t: &f64| *t == 0.0 || *t == 1.0;
            let together = [a, b].into_iter().find(is_corner).unwrap_or(0.5 * (a + b));
            [Some(together); 2]
        }
        others => others,
    }
}

fn face_flux(mesh: &Mesh, face: usize, flux: &[f64; 3], breaks: &[[Option<f64>; 2]]) -> FaceFlux {
    if !is_mixed(flux) {
        return if flux.iter().all(|&g| g >= 0.0) {
            FaceFlux::Egress
        } else {
            FaceFlux::Ingress
        };
    }
    let egress_corners = flux.map(|g| g >= 0.0);
    let break_on = |side: usize| {
        let edge = mesh.face_edges()[face][side];
        let which = usize::from(mesh.edges()[edge as usize].faces[0] as usize != face);
        let t = breaks[edge as usize][which].expect("a side with a change of sign has a break");
        Break { side, edge, t }
    };
    let side_where = |here: bool| {
        (0..3)
            .find(|&i| egress_corners[i] == here && egress_corners[(i + 1) % 3] != here)
            .expect("a mixed face changes sign twice")
    };
    let (leave, enter) = (break_on(side_where(true)), break_on(side_where(false)));
    // The corner that is alone with its sign, and that the segment cuts off: either nothing of it
    // is left, or nothing else.
    let lone = (0..3)
        .find(|&i| {
            egress_corners[i] != egress_corners[(i + 1) % 3]
                && egress_corners[i] != egress_corners[(i + 2) % 3]
        })
        .expect("two signs on three corners leave one alone");
    let share = distance_share(mesh, face, lone, &leave) * distance_share(mesh, face, lone, &enter);
    if share == 0.0 || share == 1.0 {
        return if egress_corners[lone] == (share == 1.0) {
            FaceFlux::Egress
        } else {
            FaceFlux::Ingress
        };
    }
    FaceFlux::Cut {
        egress_corners,
        leave,
        enter,
    }
}

/// The position of a break along its side, measured from a corner of that side.
fn distance_share(mesh: &Mesh, face: usize, corner: usize, at: &Break) -> f64 {
    let vertex = mesh.triangles()[face][corner];
    if mesh.edges()[at.edge as usize].vertices[0] == vertex {
        at.t
    } else {
        1.0 - at.t
    }
}
