//! The command line with bodies in the plane: reports, files, exit codes, refusals.

use crate::support::command::{CUBE, Scratch};
use serde_json::Value;
use std::f64::consts::PI;

const SQUARE: &str = "<svg xmlns='http://www.w3.org/2000/svg'><rect width='1' height='1'/></svg>\n";

/// Both formats hold the same unit square, in millimetres.
const SQUARE_DXF: &str = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n90\n4\n70\n1\n\
                          10\n0\n20\n0\n10\n1\n20\n0\n10\n1\n20\n1\n10\n0\n20\n1\n0\nENDSEC\n0\nEOF\n";

fn json(text: &str) -> Value {
    assert_eq!(text.lines().count(), 1, "one object on one line: {text}");
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn number(report: &Value, path: &str) -> f64 {
    report
        .pointer(path)
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("no number at {path}: {report}"))
}

/// The report of a run that succeeds.
#[track_caller]
fn report(scratch: &Scratch, arguments: &str) -> Value {
    let run = scratch.run(&format!("{arguments} --json"));
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{arguments}");
    json(&run.out)
}

/// Checks that a run is refused, leaves no file and prints nothing on the standard output.
#[track_caller]
fn refused(scratch: &Scratch, arguments: &str, parts: &[&str]) {
    let before = scratch.files();
    let run = scratch.run(arguments);
    assert_eq!(
        (run.code, run.out.as_str()),
        (Some(2), ""),
        "{arguments}: {}",
        run.err
    );
    for part in parts {
        assert!(run.err.contains(part), "no \"{part}\" in: {}", run.err);
    }
    assert_eq!(scratch.files(), before, "no file: {arguments}");
}

fn scratch(name: &str) -> Scratch {
    let scratch = Scratch::new(&format!("planar_{name}"));
    scratch.write("square.svg", SQUARE);
    scratch.write("square.dxf", SQUARE_DXF);
    scratch.write("cube.obj", CUBE);
    scratch
}

#[test]
fn the_report_of_a_region_has_the_keys_of_the_contract() {
    let scratch = scratch("keys");
    let report = report(&scratch, "sweep square.dxf --translate 3,0");
    let keys = |path: &str| {
        let object = report
            .pointer(path)
            .and_then(Value::as_object)
            .unwrap_or_else(|| panic!("no object at {path}"));
        let mut keys: Vec<&str> = object.keys().map(String::as_str).collect();
        keys.sort_unstable();
        keys.join(" ")
    };
    assert_eq!(keys(""), "body motion seconds sweep");
    assert_eq!(
        keys("/body"),
        "area declared_units flattening holes joined notes perimeter pieces units vertices"
    );
    assert_eq!(
        keys("/sweep"),
        "area attempts bounds error_bound flattening holes perimeter pieces vertices"
    );
    assert_eq!(
        keys("/sweep/error_bound"),
        "inside inside_proven outside outside_proven"
    );
    assert_eq!(
        report["sweep"]["bounds"].to_string(),
        "[[0.0,0.0],[4.0,1.0]]"
    );
    assert_eq!(
        (
            number(&report, "/sweep/area"),
            number(&report, "/sweep/perimeter")
        ),
        (4.0, 10.0),
        "a rectangle"
    );
    assert_eq!(report["body"]["units"], "mm");
    assert_eq!(report["body"]["notes"].to_string(), "[]");
    let seconds = report["seconds"].as_object().expect("an object");
    assert_eq!(
        seconds.keys().cloned().collect::<Vec<_>>().join(" "),
        "arrangement boundary cycle read total"
    );
}

#[test]
fn a_square_turned_about_its_corner_has_the_area_of_the_sector() {
    let scratch = scratch("sector");
    // A quarter circle of radius sqrt 2 between two halves of the square.
    let exact = PI / 2.0 + 1.0;
    for tolerance in ["1e-2", "1e-3", "1e-4"] {
        let report = report(
            &scratch,
            &format!("sweep square.svg --turn 90 --tolerance {tolerance}"),
        );
        let bound = number(&report, "/sweep/error_bound/inside")
            .max(number(&report, "/sweep/error_bound/outside"));
        let allowed: f64 = tolerance.parse().expect("a number");
        assert!(bound <= 1.01 * allowed, "bound {bound} at {tolerance}");
        let area = number(&report, "/sweep/area");
        assert!(
            (area - exact).abs() <= bound * number(&report, "/sweep/perimeter"),
            "{area} for {exact} at {tolerance}"
        );
    }
}

#[test]
fn the_text_names_units_notes_and_errors() {
    let scratch = scratch("text");
    let run = scratch.run("sweep square.svg --turn 90");
    assert_eq!(run.code, Some(0), "{}", run.err);
    for part in [
        "body    4 vertices, area 1, 1 piece, 0 holes",
        "note: the file does not say which unit its lengths are in",
        "motion  1 steady span in the plane",
        "sticks out of the true sweep by at most",
    ] {
        assert!(run.out.contains(part), "no \"{part}\" in: {}", run.out);
    }
}

#[test]
fn a_region_is_written_and_read_back_as_itself() {
    let scratch = scratch("back");
    for body in ["square.svg", "square.dxf"] {
        for output in ["out.svg", "out.dxf"] {
            let swept = report(
                &scratch,
                &format!("sweep {body} --turn 200 --through 3,1 -o {output}"),
            );
            let again = report(&scratch, &format!("sweep {output} --translate 0,0"));
            let (area, read) = (number(&swept, "/sweep/area"), number(&again, "/body/area"));
            assert!(
                (area - read).abs() <= 1e-11 * area,
                "{area} is read back as {read}"
            );
            assert_eq!(
                swept["sweep"]["vertices"], again["body"]["vertices"],
                "{body} {output}"
            );
            assert_eq!(
                (&swept["sweep"]["pieces"], &swept["sweep"]["holes"]),
                (&again["body"]["pieces"], &again["body"]["holes"])
            );
            assert_eq!(
                swept["body"]["units"], again["body"]["units"],
                "the unit is kept"
            );
        }
    }
    let text = std::fs::read_to_string(scratch.path().join("out.svg")).expect("written");
    assert!(
        text.contains("id=\"region\"") && text.contains("body at the start"),
        "region and picture"
    );
}

#[test]
fn a_picture_is_written_and_a_file_that_was_there_is_replaced() {
    let scratch = scratch("png");
    scratch.write("out.png", "old");
    report(
        &scratch,
        "sweep square.svg --turn 200 --through 3,1 --scale 0.5 -o out.png",
    );
    let bytes = std::fs::read(scratch.path().join("out.png")).expect("written");
    assert!(bytes.starts_with(b"\x89PNG"), "a PNG");
    assert_eq!(
        scratch.files(),
        ["cube.obj", "out.png", "square.dxf", "square.svg"],
        "nothing else is left"
    );
}

#[test]
fn a_dxf_has_the_same_bytes_whenever_it_is_written() {
    let scratch = scratch("same_bytes");
    let bytes = || {
        report(&scratch, "sweep square.dxf --turn 30 -o out.dxf");
        std::fs::read(scratch.path().join("out.dxf")).expect("the file is there")
    };
    assert!(bytes() == bytes(), "two runs of a process");
}

#[test]
fn units_scale_what_is_declared_only() {
    let scratch = scratch("units");
    let report = report(&scratch, "sweep square.dxf --units cm --translate 0.3,0");
    assert!(
        (number(&report, "/sweep/area") - 0.04).abs() < 1e-12,
        "{report}"
    );
    assert_eq!(
        (&report["body"]["units"], &report["body"]["declared_units"]),
        (&"cm".into(), &"mm".into())
    );
    refused(
        &scratch,
        "sweep square.svg --units cm --translate 1,0",
        &["square.svg", "cannot be changed to cm"],
    );
    refused(
        &scratch,
        "sweep square.dxf --units furlong --translate 1,0",
        &["--units", "um pt mm"],
    );
}

#[test]
fn plane_and_space_are_not_mixed() {
    let scratch = scratch("mixed");
    let cases: [(&str, &[&str]); 9] = [
        (
            "sweep square.svg --translate 1,0,0",
            &["--translate", "three numbers", "X,Y"],
        ),
        (
            "sweep square.svg --turn 9 --axis 0,0,1",
            &["--axis", "space"],
        ),
        (
            "sweep cube.obj --translate 1,0",
            &["--translate", "two numbers"],
        ),
        (
            "sweep square.svg --translate 1,0 -o out.stl",
            &[
                "out.stl",
                "regions of the plane",
                ".svg .dxf .png .obj .ply",
            ],
        ),
        (
            "sweep square.svg --translate 1,0 -o out.xyz",
            &["out.xyz", ".svg .dxf .png .obj .ply"],
        ),
        (
            "sweep cube.obj --translate 1,0,0 -o out.svg",
            &["out.svg", "solids", ".stl .obj .ply"],
        ),
        (
            "sweep cube.obj --translate 1,0,0 --units mm",
            &["--units", "drawings", "cube.obj"],
        ),
        (
            "check square.svg --translate 1,0 --against cube.obj",
            &["square.svg", "bodies in space only"],
        ),
        (
            "check cube.obj --translate 1,0,0 --against square.svg",
            &["square.svg", "drawings", ".stl .obj .ply"],
        ),
    ];
    for (arguments, parts) in cases {
        refused(&scratch, arguments, parts);
    }
}

#[test]
fn a_body_cuts_its_way_out_of_a_blank() {
    let scratch = scratch("cut");
    scratch.write("blank.svg", "<svg xmlns='http://www.w3.org/2000/svg'><rect x='-1' y='-1' width='6' height='3'/></svg>\n");
    let report = report(
        &scratch,
        "sweep square.svg --translate 3,0 --subtract-from blank.svg -o left.svg",
    );
    assert!(
        (number(&report, "/cut/remaining/area") - 14.0).abs() < 1e-9,
        "{report}"
    );
    assert_eq!(
        (
            &report["cut"]["remaining"]["pieces"],
            &report["cut"]["remaining"]["holes"]
        ),
        (&1.into(), &1.into())
    );
    assert_eq!(
        number(&report, "/cut/blank/area"),
        18.0,
        "the blank as it was"
    );
    assert_eq!(number(&report, "/sweep/area"), 4.0, "the region as ever");
    let again = self::report(&scratch, "sweep left.svg --translate 0,0");
    assert!(
        (number(&again, "/body/area") - 14.0).abs() < 1e-9,
        "what is left is written: {again}"
    );
    let run = scratch.run("sweep square.svg --translate 3,0 --subtract-from square.svg");
    assert!(run.out.contains("left    nothing"), "{}", run.out);
    // Where one of the two states no unit, the other's is taken; where both or neither do, there is
    // no note.
    for (body, blank, note) in [
        (
            "square.dxf",
            "blank.svg",
            "the blank is taken to be in mm, as the body",
        ),
        (
            "square.svg",
            "square.dxf",
            "the body is taken to be in mm, as the blank",
        ),
        ("square.dxf", "square.dxf", ""),
        ("square.svg", "blank.svg", ""),
    ] {
        let report = self::report(
            &scratch,
            &format!("sweep {body} --translate 3,0 --subtract-from {blank}"),
        );
        let notes = report["cut"]["blank"]["notes"].to_string();
        let told = notes.contains("is taken to be in");
        assert_eq!(told, !note.is_empty(), "{body} {blank}: {notes}");
        assert!(notes.contains(note), "{body} {blank}: {notes}");
    }
    let tenths = "<svg xmlns='http://www.w3.org/2000/svg' width='5mm' viewBox='0 0 50 50'><rect width='6' height='3'/></svg>";
    scratch.write("tenths.svg", tenths);
    refused(
        &scratch,
        "sweep square.dxf --translate 3,0 --subtract-from tenths.svg",
        &["the blank is in 0.1 mm, the body in mm", "--units mm"],
    );
    scratch.write(
        "inch.dxf",
        SQUARE_DXF.replace("70\n4\n0\nENDSEC", "70\n1\n0\nENDSEC"),
    );
    refused(
        &scratch,
        "sweep square.dxf --translate 3,0 --subtract-from inch.dxf",
        &["the blank is in in", "--units mm"],
    );
    refused(
        &scratch,
        "sweep cube.obj --translate 3,0,0 --subtract-from blank.svg",
        &["--subtract-from", "drawings"],
    );
}

#[test]
fn bad_drawings_are_refused_with_file_and_place() {
    let scratch = scratch("bad");
    let svg =
        |elements: &str| format!("<svg xmlns='http://www.w3.org/2000/svg'>\n{elements}\n</svg>\n");
    scratch.write("bow.svg", svg("<polygon points='0,0 4,4 4,0 0,4'/>"));
    scratch.write("open.svg", svg("<path d='M0 0H4V3'/>"));
    scratch.write("empty.svg", svg(""));
    scratch.write("use.svg", svg("<use href='#a'/>"));
    scratch.write("no.dxf", "");
    let classes = "<style>.a{fill:none}</style><rect class='a' width='4' height='4'/><rect class='a' x='1' y='1' width='2' height='2'/>";
    scratch.write("classes.svg", svg(classes));
    assert_eq!(
        number(
            &report(&scratch, "sweep classes.svg --translate 0,0"),
            "/sweep/area"
        ),
        12.0,
        "a hole by the sheet"
    );
    let cases: [(&str, &[&str]); 6] = [
        (
            "bow.svg",
            &["bow.svg: the outline crosses itself at (2, 2)", "line 2"],
        ),
        (
            "open.svg",
            &[
                "open.svg: the outline is open",
                "ends at (4, 3), 5 from",
                "--close-gaps",
            ],
        ),
        ("empty.svg", &["the drawing is empty"]),
        ("use.svg", &["1 use at line 2"]),
        ("no.dxf", &["no.dxf", "empty"]),
        ("missing.svg", &["missing.svg", "no such file"]),
    ];
    for (name, parts) in cases {
        refused(
            &scratch,
            &format!("sweep {name} --turn 30 -o out.svg"),
            parts,
        );
    }
    refused(
        &scratch,
        "sweep square.svg",
        &[
            "no motion given",
            "--turn DEG (with --through X,Y",
            "--translate X,Y",
        ],
    );
    scratch.write("none.csv", "");
    scratch.write("points.csv", "1;2\n");
    for (name, parts) in [
        ("none.csv", ["expected lines x,y", "found no point"]),
        ("points.csv", ["line 1", "by commas, not by semicolons"]),
    ] {
        let arguments = format!("probe square.svg --turn 30 --points {name}");
        refused(&scratch, &arguments, &parts);
    }
    let report = report(&scratch, "sweep open.svg --translate 0,0 --close-gaps 5");
    assert_eq!(
        number(&report, "/sweep/area"),
        6.0,
        "closed by a straight line"
    );
    refused(
        &scratch,
        "sweep square.svg --turn 30 --tolerance 1e-20",
        &["tolerance", "smallest usable value"],
    );
    refused(
        &scratch,
        "sweep square.svg --turn 30 --close-gaps 0",
        &["--close-gaps", "above 0"],
    );
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let scratch = scratch("threads");
    let region = |threads: u32| {
        let run = scratch.run(&format!(
            "sweep square.svg --turn 400 --through 0.3,0.1 --scale 2 -o out.svg --threads {threads}"
        ));
        assert_eq!(run.code, Some(0), "{}", run.err);
        std::fs::read(scratch.path().join("out.svg")).expect("written")
    };
    assert!(region(1) == region(7), "equal bytes");
}
