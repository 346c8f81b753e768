//! Entities as curves.

use super::super::drawing::{Curve, Path, Spline, SplineEnds, spline};
use dxf::entities::{self, Ellipse, EntityType, Polyline};
use dxf::{Point, Vector};
use glam::{DAffine2, DMat2, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Largest component of a unit normal across the z axis for which an entity still counts as lying
/// in the plane of the drawing.
const TILT: f64 = 1e-9;

/// Flags of a polyline that is a mesh of polygons or of faces.
const MESH: i32 = 16 | 64;

/// Flags of a spline that is closed or periodic.
const JOINED: i32 = 1 | 2;

/// Flag of a vertex that only guides the curve; other vertices lie on it.
const FRAME: i32 = 16;

/// The curves of an entity, none when it is a point; or what is not supported about it.
pub(super) fn paths(entity: &EntityType) -> Result<Vec<Path>, &'static str> {
    let path = match entity {
        EntityType::Line(line) => path(vec![Curve::Line([flat(&line.p1), flat(&line.p2)])], false),
        EntityType::Arc(arc) => {
            let sweep = positive(arc.end_angle.to_radians() - arc.start_angle.to_radians());
            let curve = Curve::circular(
                flat(&arc.center),
                arc.radius,
                arc.start_angle.to_radians(),
                sweep,
            );
            path(vec![curve.transformed(&seen(&arc.normal)?)], false)
        }
        EntityType::Circle(circle) => {
            let curve = Curve::circular(flat(&circle.center), circle.radius, 0.0, TAU);
            path(vec![curve.transformed(&seen(&circle.normal)?)], true)
        }
        EntityType::Ellipse(ellipse) => path(vec![elliptic(ellipse)?], false),
        EntityType::Spline(spline) => path(splined(spline)?, false),
        EntityType::LwPolyline(polyline) => {
            let map = seen(&polyline.extrusion_direction)?;
            let vertices: Vec<(DVec2, f64)> = polyline
                .vertices
                .iter()
                .map(|v| (DVec2::new(v.x, v.y), v.bulge))
                .collect();
            path(
                with_bulges(&vertices, polyline.is_closed(), &map),
                polyline.is_closed(),
            )
        }
        EntityType::Polyline(polyline) => {
            if polyline.flags & MESH != 0 {
                return Err("that is a mesh");
            }
            path(
                with_bulges(
                    &vertices(polyline),
                    polyline.is_closed(),
                    &seen(&polyline.normal)?,
                ),
                polyline.is_closed(),
            )
        }
        _ => return Err("is not known"),
    };
    let [low, high] = path.curves.iter().map(Curve::bounds).fold(
        [DVec2::INFINITY, DVec2::NEG_INFINITY],
        |[low, high], [a, b]| [low.min(a), high.max(b)],
    );
    Ok(if low == high || path.curves.is_empty() {
        vec![]
    } else {
        vec![path]
    })
}

fn path(curves: Vec<Curve>, closed: bool) -> Path {
    Path { curves, closed }
}

fn flat(point: &Point) -> DVec2 {
    DVec2::new(point.x, point.y)
}

/// The map from the coordinates of an entity with this normal to those of the drawing; it mirrors
/// when the normal points down.
fn seen(normal: &Vector) -> Result<DAffine2, &'static str> {
    let normal = DVec3::new(normal.x, normal.y, normal.z);
    if !(normal.truncate().length() <= TILT * normal.length() && normal.z != 0.0) {
        return Err("that does not lie in a plane parallel to xy");
    }
    Ok(DAffine2::from_scale(DVec2::new(normal.z.signum(), 1.0)))
}

/// The angle in (0, 2 pi] that leads to the same place; a whole turn for an angle of 0.
fn positive(angle: f64) -> f64 {
    let turn = angle.rem_euclid(TAU);
    if turn == 0.0 { TAU } else { turn }
}

fn elliptic(ellipse: &Ellipse) -> Result<Curve, &'static str> {
    // Its axes are given in the coordinates of the drawing; a normal downward turns the sense.
    let sense = seen(&ellipse.normal)?.matrix2.x_axis.x;
    let major = DVec2::new(ellipse.major_axis.x, ellipse.major_axis.y);
    Ok(Curve::Arc {
        centre: flat(&ellipse.center),
        axes: DMat2::from_cols(major, major.perp() * ellipse.minor_axis_ratio * sense),
        start: ellipse.start_parameter,
        sweep: positive(ellipse.end_parameter - ellipse.start_parameter),
    })
}

fn splined(given: &entities::Spline) -> Result<Vec<Curve>, &'static str> {
    if given.control_points.is_empty() && !given.fit_points.is_empty() {
        return Err("given by fit points only");
    }
    // A single weight holds for all control points.
    let weight = match given.weight_values[..] {
        [] | [_] => None,
        _ if given.weight_values.len() == given.control_points.len() => Some(&given.weight_values),
        _ => return Err("with a number of weights that is not that of its control points"),
    };
    let controls: Vec<DVec3> = given
        .control_points
        .iter()
        .enumerate()
        .map(|(i, p)| (flat(p), weight.map_or(1.0, |weights| weights[i])))
        .map(|(place, weight)| (place * weight).extend(weight))
        .collect();
    spline(&Spline {
        // A negative number is no degree, and neither is 0.
        degree: usize::try_from(given.degree_of_curve).unwrap_or_default(),
        knots: &given.knot_values,
        controls: &controls,
        ends: if given.flags & JOINED == 0 {
            SplineEnds::Any
        } else {
            SplineEnds::Joined
        },
    })
}

fn vertices(polyline: &Polyline) -> Vec<(DVec2, f64)> {
    polyline
        .vertices()
        .filter(|vertex| vertex.flags & FRAME == 0)
        .map(|v| (flat(&v.location), v.bulge))
        .collect()
}

/// Lines and arcs between vertices, each given with the bulge of the segment that begins there.
fn with_bulges(vertices: &[(DVec2, f64)], closed: bool, map: &DAffine2) -> Vec<Curve> {
    let edges = vertices.len().saturating_sub(usize::from(!closed));
    (0..edges)
        .map(|i| (vertices[i], vertices[(i + 1) % vertices.len()].0))
        .filter(|((from, _), to)| from != to)
        .map(|((from, bulge), to)| bulged(from, to, bulge).transformed(map))
        .collect()
}

/// An arc; the bulge is the tangent of a quarter of its angle, positive when the arc runs
/// counter-clockwise.
fn bulged(from: DVec2, to: DVec2, bulge: f64) -> Curve {
    if bulge == 0.0 {
        return Curve::Line([from, to]);
    }
    let chord = to - from;
    let centre = from.midpoint(to) + chord.perp() * ((1.0 - bulge * bulge) / (4.0 * bulge));
    let radius = chord.length() * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
    let start = (from - centre).to_angle();
    Curve::circular(
        centre,
        radius,
        start,
        (4.0 * bulge.atan()).clamp(-2.0 * PI, 2.0 * PI),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bulge_of_one_is_half_a_circle() {
        let arc = bulged(DVec2::X, -DVec2::X, 1.0);
        assert!(
            arc.point_at(0.5).distance(DVec2::Y) < 1e-15,
            "counter-clockwise"
        );
        let arc = bulged(DVec2::X, -DVec2::X, -1.0);
        assert!(arc.point_at(0.5).distance(-DVec2::Y) < 1e-15, "clockwise");
    }

    #[test]
    fn a_bulged_arc_runs_from_vertex_to_vertex() {
        for bulge in [-3.0, -0.4, 1e-3, 0.4142, 2.0] {
            let (from, to) = (DVec2::new(1.0, 2.0), DVec2::new(-0.5, 4.0));
            let arc = bulged(from, to, bulge);
            let [start, end] = arc.ends();
            assert!(
                start.distance(from) < 1e-12 && end.distance(to) < 1e-12,
                "{start} {end} at {bulge}"
            );
            // The height of the arc above its chord is the bulge times half the chord, to the right
            // when positive.
            let height = (to - from).normalize().perp_dot(arc.point_at(0.5) - from);
            assert!((height + bulge * 1.25).abs() < 1e-12, "{height} at {bulge}");
        }
    }

    #[test]
    fn entities_that_look_down_are_mirrored() {
        let arc = dxf::entities::Arc {
            center: Point::new(3.0, 1.0, 0.0),
            radius: 1.0,
            normal: Vector::new(0.0, 0.0, -1.0),
            start_angle: 0.0,
            end_angle: 90.0,
            ..dxf::entities::Arc::default()
        };
        let found = paths(&EntityType::Arc(arc)).expect("an arc");
        let [start, end] = found[0].curves[0].ends();
        assert!(
            start.distance(DVec2::new(-4.0, 1.0)) < 1e-15
                && end.distance(DVec2::new(-3.0, 2.0)) < 1e-15
        );
    }
}
