//! Every example runs and prints what its head promises.

use crate::support::scratch::Scratch;
use std::process::{Command, Stdio};

/// Runs an example from the root of the project, as its head describes.
fn example(name: &str, arguments: &[&str]) -> String {
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args(["run", "--quiet", "--example", name])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stdin(Stdio::null());
    if !cfg!(debug_assertions) {
        // The same profile as this test, so that nothing is built twice.
        cargo.arg("--release");
    }
    let output = cargo
        .arg("--")
        .args(arguments)
        .output()
        .expect("cargo must start");
    let [out, err] =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(output.status.success(), "{name}: {err}");
    out
}

/// The first number after `label` in a line that begins with it.
fn number(text: &str, label: &str) -> f64 {
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix(label))
        .unwrap_or_else(|| panic!("no {label:?}: {text}"));
    let word = line
        .split([' ', ','])
        .find(|word| !word.is_empty())
        .unwrap_or_default();
    word.parse()
        .unwrap_or_else(|error| panic!("{error}: {word:?} after {label:?}"))
}

#[test]
fn first_motion_finds_half_of_the_pose() {
    let text = example("first_motion", &[]);
    // Printed with six decimals.
    let scale = number(&text, "scale");
    assert!((scale - std::f64::consts::SQRT_2).abs() < 1e-6, "{text}");
    // A few roundings of numbers below 10.
    assert!(number(&text, "error") < 1e-13, "{text}");
    assert!(number(&text, "steady") < 1e-13, "{text}");
}

#[test]
fn make_bracket_writes_the_part_of_the_repository() {
    let scratch = Scratch::new("make_bracket");
    let path = scratch.path().join("bracket.stl");
    let text = example(
        "make_bracket",
        &[path.to_str().expect("the tests use plain names")],
    );
    assert_eq!(number(&text, "triangles"), 896.0, "{text}");
    // The area of the profile: two rectangles, an inner fillet (radius 8), an outer one (16), four
    // roundings (3), minus the holes. Arcs of 12 chords per quarter change the area of rounded
    // corners and holes by less than 0.3 %.
    let corner = 1.0 - std::f64::consts::FRAC_PI_4;
    let profile = 60.0 * 8.0 + 42.0 * 8.0 + corner * (64.0 - 256.0 - 4.0 * 9.0);
    let holes = std::f64::consts::PI * (2.0 * 4.5 * 4.5 + 9.0 * 9.0) * 8.0;
    let deviation = 0.003 * (40.0 * corner * (64.0 + 256.0 + 36.0) + holes);
    let volume = number(&text, "volume");
    assert!(
        (volume - (40.0 * profile - holes)).abs() < deviation,
        "{volume}"
    );
    let committed = include_bytes!("../../examples/bracket.stl");
    let written = std::fs::read(path).expect("the example has written the file");
    assert!(
        written == committed,
        "the committed file is what the example writes"
    );
}

#[test]
fn make_blank_writes_the_plate_of_the_repository() {
    let scratch = Scratch::new("make_blank");
    let path = scratch.path().join("blank.svg");
    let text = example(
        "make_blank",
        &[path.to_str().expect("the tests use plain names")],
    );
    assert_eq!(number(&text, "holes"), 4.0, "{text}");
    // A rectangle without the corners of a square of 20 that a disc leaves, and without four discs.
    // Curves are approximated within the stated distance, over the whole length of the arcs.
    let arcs = std::f64::consts::TAU * (10.0 + 4.0 * 3.5);
    let corners = 400.0 - 100.0 * std::f64::consts::PI;
    let area = 128.0 * 124.0 - corners - 4.0 * std::f64::consts::PI * 3.5 * 3.5;
    let within = text
        .split_once("within ")
        .and_then(|(_, rest)| rest.split_whitespace().next()?.parse::<f64>().ok())
        .unwrap_or_else(|| panic!("no distance: {text}"));
    assert!(within < 0.02, "1e-4 of the diagonal: {text}");
    let deviation = (number(&text, "area") - area).abs();
    assert!(deviation < arcs * within, "{deviation}: {text}");
    let committed = include_str!("../../examples/blank.svg");
    let written = std::fs::read_to_string(path).expect("the example has written the file");
    assert_eq!(
        written, committed,
        "the committed file is what the example writes"
    );
}

#[test]
fn sweep_solid_sweeps_a_cylinder() {
    let scratch = Scratch::new("sweep_solid");
    let path = scratch.path().join("swept.obj");
    let text = example(
        "sweep_solid",
        &[path.to_str().expect("the tests use plain names")],
    );
    // Distance from the cylinder times its area, 2 pi r h + 2 pi r^2 with r^2 = 1/2, h = 1.
    let off = number(&text, "outside").max(number(&text, "inside")) * 7.6;
    let volume = number(&text, "volume");
    assert!(
        (volume - std::f64::consts::FRAC_PI_2).abs() < off,
        "{volume} is further than {off} from pi/2"
    );
    assert!(off < 0.1, "the bound says something: {text}");
    assert_eq!(number(&text, "genus"), 0.0, "{text}");
    assert_eq!(scratch.files(), ["swept.obj"], "the solid is written");
}

#[test]
fn probe_points_counts_the_visits() {
    let text = example("probe_points", &[]);
    let visits: Vec<f64> = ["[90, 69, 4]:", "[90, 69, 7]:", "[90, 20, 5]:"]
        .map(|label| number(&text, label))
        .into();
    assert_eq!(
        visits,
        [3.0, 6.0, 0.0],
        "holes split a pass into three, and there are two revolutions: {text}"
    );
}

#[test]
fn grazing_points_graze_and_triangles_fill_the_region() {
    let text = example("grazing_points", &[]);
    // A product of numbers below 10, with some roundings.
    assert!(number(&text, "flux") < 1e-13, "{text}");
    assert!(
        number(&text, "points") >= 1.0 && number(&text, "sheets") >= 3.0,
        "{text}"
    );
    // Both are printed with six decimals.
    let (_, areas) = text.split_once("area ").expect("areas");
    let (region, triangles) = areas
        .trim()
        .split_once(", of the triangles ")
        .expect("both");
    assert_eq!(region, triangles, "{text}");
}

#[test]
fn from_files_sweeps_a_chain_of_three_spans() {
    let scratch = Scratch::new("from_files");
    let path = scratch.path().join("swept.stl");
    let text = example(
        "from_files",
        &[path.to_str().expect("the tests use plain names")],
    );
    assert_eq!(
        text.lines()
            .filter(|line| line.starts_with("span "))
            .count(),
        3,
        "{text}"
    );
    assert!(text.contains("closed    true, manifold true"), "{text}");
    assert_eq!(number(&text, "pieces"), 1.0, "{text}");
    assert_eq!(scratch.files(), ["swept.stl"], "the solid is written");
}

#[test]
fn picture_draws_small_files() {
    let scratch = Scratch::new("picture");
    let folder = scratch.path();
    let text = example(
        "picture",
        &[folder.to_str().expect("the tests use plain names")],
    );
    let parts: Vec<&str> = text.split("picture ").skip(1).collect();
    let files = scratch.files();
    assert_eq!(parts.len(), files.len(), "{text}");
    for part in &parts[..3] {
        assert!(number(part, "triangles") > 500.0, "{text}");
        assert!(number(part, "bytes") < 400_000.0, "{text}");
    }
    for file in files {
        let read = |folder: &std::path::Path| std::fs::read_to_string(folder.join(&file));
        let drawing = read(folder).expect("the example has written the file");
        assert!(
            drawing.starts_with("<svg ") && drawing.ends_with("</svg>\n"),
            "one drawing"
        );
        // Some renderers do not know it, others take it from the page around.
        assert!(!drawing.contains("currentColor"), "colours are given");
        // In the pages of the documentation an empty line would end the picture.
        assert!(!drawing.contains("\n\n"), "no empty line");
        assert!(
            read("examples".as_ref()).is_ok(),
            "the repository has {file}"
        );
    }
}

#[test]
fn pairs_writes_brackets() {
    let scratch = Scratch::new("pairs");
    let path = scratch.path().join("brackets.csv");
    let input = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/pairs.csv");
    let text = example(
        "pairs",
        &[input, path.to_str().expect("the tests use plain names")],
    );
    assert_eq!(number(&text, "pairs"), 60.0, "{text}");
    assert!(number(&text, "worst us") > 0.0, "{text}");
    let answers = std::fs::read_to_string(path).expect("the example has written the file");
    let words: Vec<&str> = answers
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').next())
        .collect();
    assert_eq!(words.len(), 60, "one line for each pair: {answers}");
    assert!(!words.contains(&"undecided"), "{answers}");
    let meet = words.iter().filter(|&&word| word != "none").count();
    assert_eq!(number(&text, "meet"), meet as f64, "{text}");
    assert!(
        (15..45).contains(&meet),
        "about half of them meet: {answers}"
    );
}

#[test]
fn rack_gear_has_involute_flanks() {
    let text = example("rack_gear", &[]);
    // Expected: r d^2 / 8 for steps of half a degree at a radius of 24, printed with three digits.
    let step = 0.5_f64.to_radians();
    let chain = number(&text, "chain:");
    assert!(
        (chain / (24.0 * step * step / 8.0) - 1.0).abs() < 0.01,
        "{text}"
    );
    assert!(number(&text, "flank:") < chain, "{text}");
}
