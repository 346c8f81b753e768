//! The words of the subject, one after the other: velocity field, grazing points, envelope, swept
//! region and its triangles.
//!
//! You learn where a moving body grazes: that these points and segments are fixed on it while a span
//! lasts, that the envelope is what they sweep, and that the boundary of the swept region is a part
//! of the envelope and of the body's poses. A planar chain of two steady motions then becomes a
//! region, and triangles.
//!
//! Run: `cargo run --example grazing_points`.
//!
//! You should see that the velocity is tangent to the faces at the grazing points, at all times, up
//! to a few roundings, and that the triangles fill the whole region.

use std::error::Error;
use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use steadysweep::body::Mesh;
use steadysweep::envelope::spatial::envelope;
use steadysweep::motion::{Motion, Screw, Span};
use steadysweep::{grazing, planar};

fn main() -> Result<(), Box<dyn Error>> {
    // A tetrahedron that screws once about an axis through it, and grows by a half.
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let body = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
    let screw = Screw {
        axis: DVec3::new(0.2, 0.1, 1.0),
        through: DVec3::new(0.3, -0.2, 0.0),
        turn: 2.0 * PI,
        advance: 2.0,
        scale: 1.5,
    };
    let motion = Motion::from_spans(vec![Span::new(screw.generator()?, 1.0)?])?;

    // The velocity field is steady: it depends on the place only.
    let field = motion.spans()[0].flow().generator();
    println!("velocity of the origin {:.4}", field.velocity(DVec3::ZERO));

    // Where it is tangent to a face: points of edges, and segments of edges and faces.
    let grazing = &grazing::of(&body, &motion)[0];
    println!(
        "points {}, segments {}",
        grazing.points.len(),
        grazing.segments.len()
    );
    let mut largest: f64 = 0.0;
    for at in &grazing.points {
        // The face and the velocity there, some time later.
        let path = motion.trajectory(at.point);
        let pose = motion.pose_at_time(0.7);
        let [a, b, c] = body.triangles()[at.face as usize]
            .map(|v| pose.transform_point3(body.positions()[v as usize]));
        let normal = (b - a).cross(c - a).normalize();
        largest = largest.max(normal.dot(path.velocity(0.7)).abs());
    }
    println!("flux {largest:.1e} at the grazing points at time 0.7");

    // The envelope: each segment sweeps a sheet.
    let sheets = envelope(&body, &motion);
    let normal = sheets[0]
        .normal(&motion, 0.5, 0.5)
        .ok_or("a sheet with a normal")?;
    println!("sheets {}, the first with normal {normal:.4}", sheets.len());

    // In the plane: a chain of a spiral and a slide, its region, and the triangles of that.
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [0.0, 0.3]].map(DVec2::from_array);
    let bar = planar::Polygon::new(vec![corners.to_vec()], planar::FillRule::EvenOdd)?;
    let spiral = planar::Generator::spiral(DVec2::new(-0.5, 0.0), PI, 0.5);
    let slide = planar::Generator::translation(DVec2::new(0.0, 1.0));
    let spans = [spiral, slide].map(|generator| planar::Span::new(generator, 1.0));
    let motion = planar::Motion::from_spans(spans.into_iter().collect::<Result<_, _>>()?)?;
    let points: usize = grazing::planar::of(&bar, &motion)
        .iter()
        .map(|g| g.points.len())
        .sum();
    println!("points in the plane {points}");

    let swept = planar::sweep(&bar, &motion, &planar::SweepSettings::default())?;
    let found = swept.arrangement.region_triangles(&swept.outlines)?;
    let area: f64 = found
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|v| found.positions[v as usize]);
            (b - a).perp_dot(c - a) / 2.0
        })
        .sum();
    println!(
        "area {:.6}, of the triangles {area:.6}",
        swept.measures.area
    );
    Ok(())
}
