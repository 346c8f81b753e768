//! `sweep --grazing` and `sweep --envelope`: what the files hold, against the body and the solid.

use crate::support::command::{CUBE, Scratch};
use glam::{DAffine2, DAffine3, DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;
use steadysweep::body::Surface;
use steadysweep::bounds::SurfaceTree;
use steadysweep::io::{DrawingSettings, read_drawing, read_surface};

const BAR: &str = "<svg xmlns='http://www.w3.org/2000/svg'><rect width='1' height='0.25'/></svg>\n";

fn scratch(name: &str) -> Scratch {
    let scratch = Scratch::new(&format!("grazing_{name}"));
    scratch.write("cube.obj", CUBE);
    scratch.write("bar.svg", BAR);
    scratch
}

#[track_caller]
fn succeeds(scratch: &Scratch, arguments: &str) {
    let run = scratch.run(arguments);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{arguments}");
}

/// The rows of a table, by their columns.
fn table(scratch: &Scratch, name: &str, columns: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(scratch.path().join(name)).expect("the table is there");
    let (head, rows) = text.split_once('\n').expect("a header");
    assert_eq!(head, columns, "the columns of {name}");
    let fields = |row: &str| row.split(',').map(str::to_owned).collect();
    rows.lines().map(fields).collect()
}

fn numbers(fields: &[String]) -> Vec<f64> {
    let number = |field: &String| field.parse().unwrap_or_else(|_| panic!("{field:?}"));
    fields.iter().map(number).collect()
}

fn surface(scratch: &Scratch, name: &str) -> Surface {
    read_surface(&scratch.path().join(name))
        .expect("a surface")
        .0
}

/// A cube that turns about a vertical axis through its middle, seen from the side x = 1/2.
#[test]
fn the_table_in_space_names_edges_and_faces_as_the_file_does() {
    let scratch = scratch("table");
    let turn = "--turn 90 --axis 0,0,1 --through 0.5,-1,0";
    succeeds(
        &scratch,
        &format!("sweep cube.obj {turn} --grazing grazing.csv"),
    );
    let rows = table(
        &scratch,
        "grazing.csv",
        "span,kind,edge,face,fold,x,y,z,end_x,end_y,end_z",
    );
    // The fronts y = 0 (face 2) and y = 1 (face 4) graze at x = 1/2, right above and below the axis;
    // no other face does. A face is two triangles, so that the diagonal is met as well.
    let points: Vec<&Vec<String>> = rows.iter().filter(|row| row[1] == "point").collect();
    assert!(points.len() >= 8, "{rows:?}");
    for row in points {
        assert!(row[3] == "2" || row[3] == "4", "{row:?}");
        let at = numbers(&row[5..8]);
        let front = if row[3] == "2" { 0.0 } else { 1.0 };
        assert_eq!((at[0], at[1]), (0.5, front), "{row:?}");
        assert_eq!(row[8..], ["", "", ""], "a point has no end");
    }
    let mut by_edge = 0;
    for row in rows.iter().filter(|row| row[1] == "segment") {
        let fold = row[4].as_str();
        assert_eq!(row[2].is_empty(), !row[3].is_empty(), "either: {row:?}");
        let ends = numbers(&row[5..]);
        let length =
            (DVec3::new(ends[0], ends[1], ends[2])).distance(DVec3::new(ends[3], ends[4], ends[5]));
        assert!(length > 0.0 && length <= 1.0, "{row:?}");
        if row[3].is_empty() {
            assert_eq!(fold, "outer", "edges of a cube are convex: {row:?}");
            by_edge += 1;
        }
    }
    assert!(by_edge >= 4, "upright edges graze: {rows:?}");

    succeeds(
        &scratch,
        &format!("sweep cube.obj {turn} --grazing grazing.obj"),
    );
    let text = std::fs::read_to_string(scratch.path().join("grazing.obj")).expect("there");
    let lines = |label: &str| text.lines().filter(|line| line.starts_with(label)).count();
    assert_eq!(lines("p ") + lines("l "), rows.len(), "{text}");
    assert_eq!(lines("v "), lines("p ") + 2 * lines("l "), "{text}");
    assert!(
        lines("g span_0_points") == 1 && lines("g span_0_outer") == 1,
        "{text}"
    );
}

/// The boundary of the swept solid is part of the envelope and of the body's poses at both ends.
#[test]
fn the_envelope_in_space_holds_the_boundary_of_the_solid() {
    let scratch = scratch("solid");
    let turn = "--turn 90 --axis 0,0,1 --through 0.5,-1,0 --tolerance 0.01";
    succeeds(
        &scratch,
        &format!("sweep cube.obj {turn} -o solid.ply --simplify off --envelope envelope.obj"),
    );
    succeeds(
        &scratch,
        &format!("sweep cube.obj {turn} --envelope envelope.ply"),
    );
    let solid = surface(&scratch, "solid.ply");
    let cube = surface(&scratch, "cube.obj");
    let about = DAffine3::from_translation(DVec3::new(0.5, -1.0, 0.0));
    let end = about * DAffine3::from_rotation_z(FRAC_PI_2) * about.inverse();
    let mut sizes = Vec::new();
    for name in ["envelope.obj", "envelope.ply"] {
        let envelope = surface(&scratch, name);
        sizes.push((envelope.positions().len(), envelope.triangles().len()));
        let moved: Vec<DVec3> = cube
            .positions()
            .iter()
            .map(|&p| end.transform_point3(p))
            .collect();
        let trees = [
            SurfaceTree::new(envelope.positions(), envelope.triangles()),
            SurfaceTree::new(cube.positions(), cube.triangles()),
            SurfaceTree::new(&moved, cube.triangles()),
        ];
        for &point in solid.positions() {
            let distances = trees.iter().map(|tree| tree.distance_to_surface(point));
            let nearest = distances.fold(f64::INFINITY, f64::min);
            // Both are within the tolerance of the exact envelope.
            assert!(
                nearest <= 0.02,
                "{point} of the solid is {nearest} off {name}"
            );
        }
    }
    assert_eq!(sizes[0], sizes[1], "the same in both formats");
}

/// As in space: corners of the region lie on the curves, or on the body at both ends.
#[test]
fn the_envelope_in_the_plane_holds_the_boundary_of_the_region() {
    let scratch = scratch("region");
    let turn = "--turn 90 --through 0.25,-0.5 --tolerance 0.001";
    succeeds(
        &scratch,
        &format!("sweep bar.svg {turn} -o region.svg --grazing points.csv --envelope curves.csv"),
    );
    let points = table(&scratch, "points.csv", "span,corner,edge,fold,x,y");
    let inside = points.iter().filter(|row| !row[2].is_empty()).count();
    assert_eq!(inside, 2, "both long sides graze at x = 1/4: {points:?}");
    for row in points.iter().filter(|row| !row[2].is_empty()) {
        assert!((numbers(&row[4..])[0] - 0.25).abs() < 1e-15, "{row:?}");
    }
    let curves = table(
        &scratch,
        "curves.csv",
        "curve,span,corner,edge,fold,time,x,y,normal_x,normal_y",
    );
    let mut segments: Vec<[DVec2; 2]> = Vec::new();
    for pair in curves.windows(2).filter(|pair| pair[0][0] == pair[1][0]) {
        let place = |row: &Vec<String>| DVec2::from_slice(&numbers(&row[6..8]));
        segments.push([place(&pair[0]), place(&pair[1])]);
        assert!(numbers(&pair[0][5..6]) < numbers(&pair[1][5..6]), "in time");
        let normal = DVec2::from_slice(&numbers(&pair[0][8..]));
        assert!((normal.length() - 1.0).abs() < 1e-12, "{pair:?}");
    }
    let body = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.25], [0.0, 0.25]].map(DVec2::from_array);
    let about = DAffine2::from_translation(DVec2::new(0.25, -0.5));
    let end = about * DAffine2::from_angle(FRAC_PI_2) * about.inverse();
    for pose in [DAffine2::IDENTITY, end] {
        let corners = body.map(|corner| pose.transform_point2(corner));
        segments.extend((0..4).map(|i| [corners[i], corners[(i + 1) % 4]]));
    }
    let distance = |[a, b]: [DVec2; 2], p: DVec2| {
        let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a.lerp(b, share))
    };
    let path = scratch.path().join("region.svg");
    let region = read_drawing(&path, &DrawingSettings::default()).expect("a region");
    for &corner in region.polygon.positions() {
        let nearest = segments.iter().map(|&segment| distance(segment, corner));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest <= 0.002, "{corner} is {nearest} off");
    }

    succeeds(
        &scratch,
        &format!("sweep bar.svg {turn} --envelope curves.svg --grazing points.obj"),
    );
    let picture = std::fs::read_to_string(scratch.path().join("curves.svg")).expect("there");
    assert!(
        picture.contains("Untrimmed envelope") && !picture.contains("id=\"region\""),
        "{picture}"
    );
}

#[test]
fn files_that_cannot_be_meant_are_refused() {
    let scratch = scratch("refused");
    for (arguments, part) in [
        (
            "sweep cube.obj --translate 1,0,0 --grazing out.stl",
            "out.stl: unknown extension .stl, expected one of .csv .obj",
        ),
        (
            "sweep cube.obj --translate 1,0,0 --envelope out.svg",
            "out.svg: unknown extension .svg, expected one of .obj .ply",
        ),
        (
            "sweep bar.svg --translate 1,0 --envelope out.ply",
            "out.ply: unknown extension .ply, expected one of .svg .csv",
        ),
        (
            "sweep cube.obj --translate 1,0,0 -o out.obj --envelope out.obj",
            "out.obj: -o and --envelope name the same file; give each its own",
        ),
        (
            "sweep cube.obj --translate 1,0,0 --grazing none/out.csv",
            "none/out.csv: there is no directory none; create it first",
        ),
    ] {
        let before = scratch.files();
        let run = scratch.run(arguments);
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{arguments}");
        assert!(run.err.contains(part), "{part:?} in {}", run.err);
        assert_eq!(scratch.files(), before, "no file: {arguments}");
    }
}
