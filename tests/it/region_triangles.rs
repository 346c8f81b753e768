//! The region of the plane as triangles: they fill it, once, in the library and as files.

use crate::support::command::Scratch;
use crate::support::planar::{depth, motion, polygon, star, swept};
use crate::support::random::pseudo_random;
use glam::{DVec2, Vec3Swizzles};
use serde_json::Value;
use steadysweep::io::read_surface;
use steadysweep::planar::Generator;

fn area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a) / 2.0
}

/// Whether a point is inside a triangle that runs counter-clockwise.
fn holds([a, b, c]: [DVec2; 3], p: DVec2) -> bool {
    [[a, b], [b, c], [c, a]]
        .iter()
        .all(|[from, to]| (*to - *from).perp_dot(p - *from) > 0.0)
}

#[test]
fn triangles_fill_the_region_once() {
    let mut random = pseudo_random(21);
    for case in 0..6 {
        // Stars around a far centre, and around one so near that the region closes around a hole.
        let body = polygon(vec![star(9, 0.7, &mut random)]);
        let centre = DVec2::new(if case % 2 == 0 { 3.0 } else { 1.4 }, 0.2);
        let spiral = Generator::spiral(centre, 5.9, 1.0 + 0.1 * f64::from(case));
        let motion = motion(&[spiral, Generator::translation(DVec2::new(0.3, 0.8))]);
        let sweep = swept(&body, &motion, 1e-3);
        let found = sweep
            .arrangement
            .region_triangles(&sweep.outlines)
            .expect("no fault");
        assert_eq!(found.positions.len(), {
            let mut corners: Vec<u32> = sweep
                .outlines
                .loops()
                .flat_map(|l| l.vertices.clone())
                .collect();
            corners.sort_unstable();
            corners.dedup();
            corners.len()
        });
        let triangles: Vec<[DVec2; 3]> = found
            .triangles
            .iter()
            .map(|triangle| triangle.map(|v| found.positions[v as usize]))
            .collect();
        assert!(
            triangles.iter().all(|&t| area(t) > 0.0),
            "all run one way round"
        );
        let total: f64 = triangles.iter().map(|&t| area(t)).sum();
        let difference = (total - sweep.measures.area).abs();
        assert!(difference < 1e-12 * sweep.measures.area, "{difference:e}");
        let [low, high] = sweep.measures.bounds;
        let loops: Vec<Vec<DVec2>> = sweep.loops().collect();
        for _ in 0..500 {
            let [x, y] = [(); 2].map(|()| random.next().expect("endless"));
            let point = low + (high - low) * DVec2::new(x, y);
            let count = triangles.iter().filter(|&&t| holds(t, point)).count();
            let inside = depth(loops.iter(), point);
            // On an edge between two triangles it is in neither.
            assert!(count <= 1 && (count == 0 || inside > 0.0), "{point}");
            assert!(count == 1 || inside < 1e-9, "{point} is missed");
        }
    }
}

#[test]
fn triangles_are_written_as_meshes() {
    let scratch = Scratch::new("region_triangles");
    let rect =
        |size: &str| format!("<svg xmlns='http://www.w3.org/2000/svg'><rect {size}/></svg>\n");
    scratch.write("tool.svg", rect("width='1' height='1'"));
    scratch.write("blank.svg", rect("x='-2' y='-2' width='6' height='6'"));
    for (arguments, key) in [
        ("-o out.obj", "/sweep/area"),
        ("-o out.ply", "/sweep/area"),
        (
            "--subtract-from blank.svg -o out.obj",
            "/cut/remaining/area",
        ),
    ] {
        let arguments = format!("sweep tool.svg --turn 200 --through 0.5,-1 --json {arguments}");
        let run = scratch.run(&arguments);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{arguments}");
        let report: Value = serde_json::from_str(&run.out).expect("a report");
        let expected = report
            .pointer(key)
            .and_then(Value::as_f64)
            .expect("an area");
        let name = if arguments.contains("ply") {
            "out.ply"
        } else {
            "out.obj"
        };
        let (mesh, _) = read_surface(&scratch.path().join(name)).expect("a mesh");
        assert!(mesh.positions().iter().all(|p| p.z == 0.0), "flat");
        let total: f64 = mesh
            .triangles()
            .iter()
            .map(|t| area(t.map(|v| mesh.positions()[v as usize].xy())))
            .sum();
        assert!(
            (total - expected).abs() < 1e-12 * expected,
            "{total} {expected}"
        );
    }
}
