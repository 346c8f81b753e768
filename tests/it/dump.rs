//! `sweep --dump`: the files are there, and show the stages of the sweep.

use crate::support::command::{CUBE, Scratch};
use glam::DVec3;
use serde_json::Value;
use std::path::Path;
use steadysweep::io::{read_body, read_surface};

/// The volume that a closed surface encloses.
fn volume(triangles: impl Iterator<Item = [DVec3; 3]>) -> f64 {
    triangles.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// The number of an element in the head of a PLY.
fn count(ply: &str, element: &str) -> usize {
    let label = format!("element {element} ");
    let line = ply.lines().find_map(|line| line.strip_prefix(&label));
    let number = line.unwrap_or_else(|| panic!("no {element}"));
    number.parse().expect("a number")
}

/// The lines after the head of a PLY, as numbers.
fn lines(ply: &str) -> Vec<Vec<f64>> {
    let (_, body) = ply.split_once("end_header\n").expect("a head");
    let numbers = |line: &str| -> Vec<f64> {
        let words = line.split(' ');
        words.map(|word| word.parse().expect("a number")).collect()
    };
    body.lines().map(numbers).collect()
}

fn text(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).expect("the stage is there")
}

#[test]
fn each_stage_of_a_sweep_is_a_file() {
    let scratch = Scratch::new("dump");
    scratch.write("cube.obj", CUBE);
    let run = scratch
        .run("sweep cube.obj --turn 45 --axis 0,0,1 --simplify off --dump out/stages --json");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let report: Value = serde_json::from_str(&run.out).expect("a report");
    let expected = report["sweep"]["volume"].as_f64().expect("a volume");
    assert_eq!(report["sweep"]["attempts"], 1, "{report}");
    let folder = scratch.path().join("out/stages");
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .expect("the folder is made")
        .map(|file| {
            file.expect("a file")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    let stages = [
        "arrangement-1-1.ply",
        "cycle-1-1.ply",
        "grazing-1.ply",
        "region-1.ply",
        "sources.ply",
    ];
    assert_eq!(names, stages, "and nothing unfinished");

    // A cube that turns about its own corner grazes with whole edges.
    let grazing = text(&folder, "grazing-1.ply");
    let edges = count(&grazing, "edge");
    assert!(
        edges > 4 && count(&grazing, "vertex") == 2 * edges,
        "{edges}"
    );
    assert_eq!(lines(&grazing).len(), 3 * edges, "a line for each");

    let (cycle, _) = read_surface(&folder.join("cycle-1-1.ply")).expect("a surface");
    assert!(cycle.triangles().len() > 100, "sampled");

    // The facets between winding numbers below 1 and at least 1 bound the region.
    let arrangement = text(&folder, "arrangement-1-1.ply");
    let rows = lines(&arrangement);
    let (positions, facets) = rows.split_at(count(&arrangement, "vertex"));
    assert_eq!(facets.len(), count(&arrangement, "face"));
    let corner = |row: &[f64], which: usize| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index"
        )]
        let index = row[which] as usize;
        DVec3::from_slice(&positions[index])
    };
    let outward = facets.iter().filter_map(|row| {
        let [a, b, c] = [1, 2, 3].map(|which| corner(row, which));
        match (row[4] >= 1.0, row[5] >= 1.0) {
            (false, true) => Some([a, b, c]),
            (true, false) => Some([a, c, b]),
            _ => None,
        }
    });
    let arranged = volume(outward);
    assert!((arranged - expected).abs() < 1e-9, "{arranged}, {expected}");

    let (region, _) = read_body(&folder.join("region-1.ply")).expect("a body");
    assert!((region.volume() - expected).abs() < 1e-9);

    // The caps are of the start and of the end; between them, one span was swept.
    let sources = text(&folder, "sources.ply");
    let rows = lines(&sources);
    let (_, facets) = rows.split_at(count(&sources, "vertex"));
    assert_eq!(facets.len(), count(&sources, "face"));
    assert_eq!(report["sweep"]["triangles"], facets.len(), "as written");
    for row in facets {
        let [source, span, start, end] = [4, 6, 7, 8].map(|column| row[column]);
        let is_right = match source {
            0.0 | 1.0 => span == 0.0 && 0.0 <= start && start < end && end <= 1.0,
            2.0 => span == -1.0 && start == end && (start == 0.0 || start == 1.0),
            _ => false,
        };
        assert!(is_right, "{row:?}");
    }
}

#[test]
fn stages_that_cannot_be_written_are_told() {
    let scratch = Scratch::new("dump_refused");
    scratch.write("cube.obj", CUBE);
    scratch.write("taken", "a file");
    let square = r#"<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H1V1H0Z"/></svg>"#;
    scratch.write("square.svg", square);
    let cases = [
        (
            "cube.obj --translate 1,0,0 --dump taken",
            "taken: no folder",
        ),
        (
            "square.svg --translate 1,0 --dump stages",
            "--dump writes the stages of a sweep in space",
        ),
    ];
    for (arguments, part) in cases {
        let run = scratch.run(&format!("sweep {arguments}"));
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{arguments}");
        assert!(run.err.contains(part), "{}", run.err);
    }
    assert_eq!(scratch.files(), ["cube.obj", "square.svg", "taken"]);
}
