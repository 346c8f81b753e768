//! Each reader with changed files: what it accepts is valid, and reads the same once written.

use crate::campaign;
use crate::mutation::mutated;
use crate::random::Random;
use crate::seeds;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use std::path::PathBuf;
use std::thread;
use steadysweep::body::{FillRule, Mesh, Polygon};
use steadysweep::io::{
    AnyMotion, DrawingFormat, DrawingSettings, MeshFormat, PoseLogSettings, RegionPicture,
    parse_any_motion, parse_body, parse_drawing, parse_planar_points, parse_planar_pose_log,
    parse_points, parse_pose_log, parse_surface, read_body, read_drawing, write_mesh, write_region,
};
use steadysweep::motion::{HalfTurns, Keyframe, planar};

/// Runs a target on changes of some files.
fn run(target: &str, seeds: Vec<Vec<u8>>, check: impl Fn(&[u8]) -> bool + Send + Clone + 'static) {
    let make = |number: u64| mutated(&seeds, &mut Random::new(number));
    campaign::run(target, make, check);
}

/// A file of this thread, to write and to read.
fn file(extension: &str) -> PathBuf {
    let name = format!("fuzz-{:?}.{extension}", thread::current().id());
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn bits(positions: &[DVec3]) -> Vec<[u64; 3]> {
    let bits = |p: &DVec3| p.to_array().map(f64::to_bits);
    positions.iter().map(bits).collect()
}

/// Checks a body that was read.
fn check_body(body: &Mesh) {
    let mut uses = HashMap::<[u32; 2], i32>::new();
    for &[a, b, c] in body.triangles() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            assert_ne!(from, to, "a triangle has three corners");
            let sense = if from < to { 1 } else { -1 };
            *uses.entry([from.min(to), from.max(to)]).or_default() += sense;
        }
    }
    assert!(uses.values().all(|&sum| sum == 0), "it is closed");
    let positions = body.positions();
    assert!(positions.iter().all(|p| p.is_finite()), "it is finite");
    let again = Mesh::new(positions.to_vec(), body.triangles().to_vec());
    assert_eq!(
        again.expect("a body").triangles(),
        body.triangles(),
        "it is a body as it is"
    );
    for extension in ["obj", "ply"] {
        let file = file(extension);
        write_mesh(&file, positions, body.triangles()).expect("a body can be written");
        let (again, _) = read_body(&file).expect("what was written can be read");
        // A failure leaves it there.
        std::fs::remove_file(&file).expect("our file");
        assert_eq!(bits(again.positions()), bits(positions), "{extension}");
        assert_eq!(again.triangles(), body.triangles(), "{extension}");
    }
}

fn check_mesh(format: MeshFormat, bytes: &[u8]) -> bool {
    if let Ok((surface, _)) = parse_surface(format, bytes.to_vec()) {
        assert!(
            surface.positions().iter().all(|p| p.is_finite()),
            "a surface is finite"
        );
    }
    let Ok((body, _)) = parse_body(format, bytes.to_vec()) else {
        return false;
    };
    check_body(&body);
    true
}

#[test]
fn reader_stl() {
    run("reader_stl", seeds::stl(), |bytes| {
        check_mesh(MeshFormat::Stl, bytes)
    });
}

#[test]
fn reader_obj() {
    run("reader_obj", seeds::obj(), |bytes| {
        check_mesh(MeshFormat::Obj, bytes)
    });
}

#[test]
fn reader_ply() {
    run("reader_ply", seeds::ply(), |bytes| {
        check_mesh(MeshFormat::Ply, bytes)
    });
}

/// Checks a drawing that was read; a coarse one keeps the number of corners small.
fn check_drawing(format: DrawingFormat, bytes: &[u8]) -> bool {
    let Ok(drawing) = parse_drawing(format, bytes, &DrawingSettings::default()) else {
        return false;
    };
    let polygon = &drawing.polygon;
    let corners = |outline: &Vec<u32>| -> Vec<DVec2> {
        let corners = outline.iter();
        corners.map(|&v| polygon.positions()[v as usize]).collect()
    };
    let loops: Vec<Vec<DVec2>> = polygon.loops().iter().map(corners).collect();
    assert!(polygon.area() > 0.0, "it has an area");
    let again = Polygon::new(loops.clone(), FillRule::NonZero).expect("it is a body");
    let is_near = |area: f64, moved: f64| {
        let rounding = 1e-9 * polygon.area() + 4.0 * moved * polygon.perimeter();
        (area - polygon.area()).abs() <= rounding
    };
    assert!(is_near(again.area(), 0.0), "the same body");
    let file = file("svg");
    let picture = RegionPicture {
        region: loops,
        ..RegionPicture::default()
    };
    write_region(&file, &picture).expect("a region can be written");
    let again = read_drawing(&file, &DrawingSettings::default());
    std::fs::remove_file(&file).expect("our file");
    let again = again.expect("what was written can be read").polygon;
    assert!(
        is_near(again.area(), 0.0),
        "{} is read as {}",
        polygon.area(),
        again.area()
    );
    true
}

#[test]
fn reader_svg() {
    run("reader_svg", seeds::svg(), |bytes| {
        check_drawing(DrawingFormat::Svg, bytes)
    });
}

#[test]
fn reader_dxf() {
    run("reader_dxf", seeds::dxf(), |bytes| {
        check_drawing(DrawingFormat::Dxf, bytes)
    });
}

#[test]
fn reader_motion() {
    run("reader_motion", seeds::motions(), |bytes| {
        match parse_any_motion(bytes, &HalfTurns::default()) {
            Err(_) => return false,
            Ok(AnyMotion::Space(motion)) => {
                let times = motion.joint_times();
                assert!(times.is_sorted_by(|a, b| a < b), "times grow: {times:?}");
                for &time in times {
                    assert!(motion.pose_at_time(time).is_finite(), "a pose at {time}");
                }
            }
            Ok(AnyMotion::Plane(motion)) => {
                let times = motion.joint_times();
                assert!(times.is_sorted_by(|a, b| a < b), "times grow: {times:?}");
                for &time in times {
                    assert!(motion.pose_at_time(time).is_finite(), "a pose at {time}");
                }
            }
        }
        true
    });
}

#[test]
fn reader_pose_log() {
    let named = PoseLogSettings {
        columns: Some("t x y z qx qy qz qw".to_owned()),
        ..PoseLogSettings::default()
    };
    run("reader_pose_log", seeds::pose_logs(), move |bytes| {
        let mut read = false;
        for settings in [&PoseLogSettings::default(), &named] {
            if let Ok(keys) = parse_pose_log(bytes, settings) {
                let finite = |key: &Keyframe| key.time.is_finite() && key.pose.is_finite();
                assert!(keys.iter().all(finite), "finite");
                read = true;
            }
            if let Ok(keys) = parse_planar_pose_log(bytes, settings) {
                let finite = |key: &planar::Keyframe| key.time.is_finite() && key.pose.is_finite();
                assert!(keys.iter().all(finite), "finite");
                read = true;
            }
        }
        read
    });
}

/// Lines of numbers in the form that reads back as the same.
fn lines<const N: usize>(points: impl Iterator<Item = [f64; N]>) -> String {
    let line = |numbers: [f64; N]| numbers.map(|x| format!("{x:?}")).join(",") + "\n";
    points.map(line).collect()
}

#[test]
fn reader_points() {
    run("reader_points", seeds::points(), |bytes| {
        if let Ok(points) = parse_planar_points(bytes) {
            assert!(points.iter().all(|p| p.is_finite()), "finite");
            let written = lines(points.iter().map(DVec2::to_array));
            assert_eq!(parse_planar_points(written.as_bytes()), Ok(points));
        }
        let Ok(points) = parse_points(bytes) else {
            return false;
        };
        assert!(points.iter().all(|p| p.is_finite()), "finite");
        let written = lines(points.iter().map(DVec3::to_array));
        let again = parse_points(written.as_bytes()).expect("what was written can be read");
        assert_eq!(bits(&again), bits(&points));
        true
    });
}
