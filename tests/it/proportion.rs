//! Time and memory in proportion to the input, tested without a clock. The sizes are such that work
//! that grows as their square, or faster, would take minutes or hours, while the actual work takes
//! a moment. Input that would still need such growth is refused with the number.

use crate::support::shapes;
use crate::support::sweep::mesh;
use glam::DVec3;
use std::f64::consts::PI;
use std::fmt::Write;
use steadysweep::body::{FillRule, Polygon};
use steadysweep::envelope::spatial::Budget;
use steadysweep::envelope::spatial::{CycleError, sweep_cycle};
use steadysweep::io::{
    Drawing, DrawingFormat, DrawingSettings, InputProblem, MeshFormat, parse_body, parse_drawing,
    parse_points,
};
use steadysweep::motion::{Generator, Motion, Span};

fn svg_with(elements: &str, settings: &DrawingSettings) -> Result<Drawing, InputProblem> {
    let text = format!("<svg xmlns='http://www.w3.org/2000/svg'>{elements}</svg>");
    parse_drawing(DrawingFormat::Svg, text.as_bytes(), settings)
}

fn svg(elements: &str) -> Result<Drawing, InputProblem> {
    svg_with(elements, &DrawingSettings::default())
}

fn dxf(entities: &str) -> Result<Drawing, InputProblem> {
    let text = format!("0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n");
    parse_drawing(
        DrawingFormat::Dxf,
        text.as_bytes(),
        &DrawingSettings::default(),
    )
}

/// A text of `count` parts.
fn many(count: usize, part: impl Fn(usize) -> String) -> String {
    (0..count).map(part).collect()
}

/// Elements in `depth` groups.
fn nested(depth: usize, inside: &str) -> String {
    format!("{}{inside}{}", "<g>".repeat(depth), "</g>".repeat(depth))
}

#[track_caller]
fn area(drawing: Result<Drawing, InputProblem>, expected: f64) {
    let drawing = drawing.unwrap_or_else(|error| panic!("refused: {error}"));
    let area = drawing.polygon.area();
    assert!(
        (area - expected).abs() <= 1e-9 * expected,
        "{area} for {expected}"
    );
}

#[track_caller]
fn refused(drawing: Result<Drawing, InputProblem>, parts: &[&str]) {
    let message = drawing.expect_err("has to be refused").to_string();
    for part in parts {
        assert!(message.contains(part), "no \"{part}\" in: {message}");
    }
}

const SQUARE: &str = "<rect width='4' height='4'/>";

#[test]
fn a_selector_of_many_descendants_ends() {
    // There are 8e8 choices of ten of forty groups.
    let sheet = ".z g g g g g g g g g g rect{fill:none}";
    area(
        svg(&format!("<style>{sheet}</style>{}", nested(40, SQUARE))),
        16.0,
    );
    let shape = format!("<path d='M0 0H4V4H0z'/>{SQUARE}");
    let before = "g ".repeat(11);
    let sheet = format!("<style>.x {before}path{{fill:none}}.x {before}rect{{fill:none}}</style>");
    area(svg(&format!("{sheet}{}", nested(40, &shape))), 16.0);
    // The same with child and sibling combinators.
    let long = format!("a + {}rect", "g > g ".repeat(200));
    let sheet = format!("<style>{long}{{display:none}}</style>");
    area(svg(&format!("{sheet}{}", nested(5_000, SQUARE))), 16.0);
}

#[test]
fn many_rules_and_many_groups_take_no_more_than_what_they_have_in_common() {
    for rule in [
        "g .a%{fill:none}",
        ".a% g rect{fill:none}",
        "#a% > .b + g{display:none}",
    ] {
        let sheet = many(1_000, |i| rule.replace('%', &i.to_string()));
        area(
            svg(&format!("<style>{sheet}</style>{}", nested(500, SQUARE))),
            16.0,
        );
    }
    // As programs write them: a class for each element.
    let sheet = many(50_000, |i| format!(".a{i}{{fill:none;stroke:#000}}\n"));
    let elements = many(50_000, |i| {
        format!("<rect class='a{i}' x='{}' width='1' height='1'/>\n", 2 * i)
    });
    area(svg(&format!("<style>{sheet}</style>{elements}")), 50_000.0);
    // Where every rule applies to every element, no comparison can be saved.
    let sheet = many(10_000, |i| format!("g>rect{{fill:none}}/*{i}*/"));
    let groups = format!("<g>{}</g>", SQUARE.repeat(10_000));
    refused(
        svg(&format!("<style>{sheet}</style>{groups}")),
        &["style sheets", "more than 100000000; write fill"],
    );
}

#[test]
fn long_sheets_and_styles_are_read_once() {
    // No semicolon, and one line per rule: the search for either must not start anew each time.
    let sheet = many(200_000, |_| "a{fill:none}\n".to_owned());
    area(svg(&format!("<style>{sheet}</style>{SQUARE}")), 16.0);
    let list = format!(
        "{}rect{{{}}}",
        "a,".repeat(100_000),
        "fill:none;".repeat(100_000)
    );
    area(svg(&format!("<style>{list}</style>{SQUARE}")), 16.0);
    let style = "fill:none;".repeat(500_000);
    area(
        svg(&format!("<rect style='{style}' width='4' height='4'/>")),
        16.0,
    );
    let sheets = "<style>a{fill:none}</style>\n".repeat(50_000);
    area(svg(&format!("{sheets}{SQUARE}")), 16.0);
}

#[test]
fn deep_groups_and_long_transforms_are_no_burden() {
    area(svg(&nested(200_000, SQUARE)), 16.0);
    let turns = "rotate(90) ".repeat(200_000);
    area(
        svg(&format!("<rect transform='{turns}' width='4' height='4'/>")),
        16.0,
    );
}

#[test]
fn xml_that_the_parser_would_compare_each_with_each_is_refused() {
    let attributes = many(50_000, |i| format!(" a{i}='1'"));
    refused(
        svg(&format!("<rect{attributes}/>")),
        // The extra one is that of the root, with its namespace.
        &["attributes", "2500000001 comparisons, more than 1000000000"],
    );
    let entity = "M0 0H4V4H0z".repeat(10_000);
    let text = format!(
        "<!DOCTYPE svg [<!ENTITY e '{entity}'>]><svg>{}</svg>",
        "<path d='&e;'/>".repeat(10_000)
    );
    let found = parse_drawing(
        DrawingFormat::Svg,
        text.as_bytes(),
        &DrawingSettings::default(),
    );
    refused(found, &["entities", "bytes, more than"]);
}

#[test]
fn many_outlines_are_compared_with_those_that_are_like_them() {
    // 160,000 squares without fill, of four corners each: 1e10 pairs.
    let squares = many(160_000, |i| {
        format!(
            "<rect x='{}' y='{}' width='1' height='1'/>\n",
            i % 400 * 2,
            i / 400 * 2
        )
    });
    area(svg(&format!("<g fill='none'>{squares}</g>")), 160_000.0);
    // Each is drawn twice.
    let twice = "<g fill='none'><rect width='4' height='4'/></g>".repeat(50_000);
    area(svg(&twice), 16.0);
    // They have the same box and the same middle; each is inside another one and touches it in four
    // corners.
    let stars = many(20_000, |i| {
        let reach = 1.0 + f64::from(u32::try_from(i).expect("small")) / 20_000.0;
        let [low, high] = [-reach, reach];
        format!(
            "<path d='M4 0L{high} {high}L0 4L{low} {high}L-4 0L{low} {low}L0 -4L{high} {low}z'/>"
        )
    });
    // A star of reach r has the area 16 r; every second ring between two stars counts.
    let drawing = svg(&format!("<g fill='none'>{stars}</g>")).expect("stars in stars");
    let found = drawing.polygon.area();
    assert!((found - 8.0).abs() < 1e-6, "{found}");
    // Corners of neighbours are 7.1e-5 apart, less than the 1.1e-4 within which a loop counts as
    // drawn twice; those of every second star are farther apart. So half of the stars count, with
    // four needles between each two.
    assert_eq!(drawing.polygon.pieces(), 20_000);
}

#[test]
fn many_circles_in_each_other_are_read_in_no_time() {
    let circles = many(3_000, |i| {
        format!("0\nCIRCLE\n10\n0\n20\n0\n40\n{}\n", i + 1)
    });
    let drawing = dxf(&circles).expect("rings");
    assert_eq!(
        (drawing.polygon.pieces(), drawing.polygon.holes()),
        (1_500, 1_500)
    );
}

#[test]
fn lines_in_any_number_are_joined_by_place() {
    // Triangles of loose lines that all meet in one place.
    let lines = many(20_000, |i| {
        let [x, y] = [4 * i, 4 * i + 2];
        let line = |from: [usize; 2], to: [usize; 2]| {
            let ([a, b], [c, d]) = (from, to);
            format!("0\nLINE\n10\n{a}\n20\n{b}\n11\n{c}\n21\n{d}\n")
        };
        let (base, tip) = (100_000, [0, 0]);
        line(tip, [x, base]) + &line([x, base], [y, base]) + &line([y, base], tip)
    });
    area(dxf(&lines), 20_000.0 * 100_000.0);
    // Triangles with one gap each.
    let open = many(5_000, |i| {
        format!(
            "<path d='M{0} .5V2L{1} 0H{0}' fill='none'/>",
            5 * i,
            5 * i + 2
        )
    });
    let close = |length: f64| DrawingSettings {
        close_gaps: Some(length),
        ..DrawingSettings::default()
    };
    area(svg_with(&open, &close(0.6)), 10_000.0);
    refused(
        svg_with(&open, &close(1e6)),
        &[
            "gaps up to 1000000",
            "more than 10000000 pairs",
            "--close-gaps",
        ],
    );
}

/// A tetrahedron as OBJ, with a text before the indices of its last face.
fn obj(before: &str) -> String {
    format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf {before}2 3 4\n")
}

fn volume(format: MeshFormat, bytes: Vec<u8>) -> f64 {
    let (body, _) = parse_body(format, bytes).unwrap_or_else(|error| panic!("refused: {error}"));
    body.volume()
}

#[test]
fn lines_of_an_obj_that_go_on_in_others_are_read_once() {
    let continued = obj(&"\\\n".repeat(1_000_000));
    assert!((volume(MeshFormat::Obj, continued.into_bytes()) - 1.0 / 6.0).abs() < 1e-15);
    let wrong = obj(&("\\\n".repeat(100_000) + "0 \\\n"));
    let message = parse_body(MeshFormat::Obj, wrong.into_bytes())
        .expect_err("refused")
        .to_string();
    assert!(
        message.starts_with("line 100008: expected indices from 1 to 4")
            && message.contains("found \"0\";"),
        "the line of the index, not the first of all that it goes on from: {message}"
    );
    let long = obj(&" ".repeat(10_000_000));
    assert!(volume(MeshFormat::Obj, long.into_bytes()) > 0.0);
    let mut long = String::from("solid");
    write!(long, "{}", " a".repeat(5_000_000)).expect("a string takes everything");
    let message = parse_body(MeshFormat::Stl, long.into_bytes())
        .expect_err("refused")
        .to_string();
    assert!(message.len() < 500, "{message}");
}

#[test]
fn faces_without_corners_take_no_memory() {
    // 3 million faces of one byte: each took 130 bytes.
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement face 3000004\nproperty list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for position in [
        [0.0f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ] {
        bytes.extend(position.iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes.resize(bytes.len() + 3_000_000, 0);
    for face in [[0i32, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
        bytes.push(3);
        bytes.extend(face.iter().flat_map(|v| v.to_le_bytes()));
    }
    let (body, report) = parse_body(MeshFormat::Ply, bytes).expect("a tetrahedron");
    assert_eq!((body.triangles().len(), report.faces), (4, 3_000_004));
    assert_eq!(report.numbers.face(3), 3_000_003, "the number in the file");
}

#[test]
fn points_in_a_long_line_are_refused_with_its_start() {
    let message = parse_points("1,".repeat(2_000_000).as_bytes())
        .expect_err("refused")
        .to_string();
    assert!(
        message.starts_with("line 1: ") && message.len() < 300,
        "{message}"
    );
}

#[test]
fn outlines_that_run_along_each_other_are_limited_in_number() {
    // Squares in a corner, each larger than the one before: the first stretch of their sides
    // belongs to all of them.
    let squares = |count: u32| {
        let square = |i: u32| {
            let size = f64::from(i);
            [[0.0, 0.0], [size, 0.0], [size, size], [0.0, size]].map(glam::DVec2::from_array)
        };
        let loops = (1..=count).map(|i| square(i).to_vec()).collect();
        Polygon::new(loops, FillRule::NonZero)
    };
    let body = squares(1_000).expect("a square");
    assert_eq!((body.pieces(), body.edge_count()), (1, 4 + 2 * 999));
    let error = squares(10_000).expect_err("5e7 on each side").to_string();
    assert!(
        error.contains("along each other more than 20000000 times"),
        "{error}"
    );
}

#[test]
fn chains_of_many_spans_are_refused_before_they_are_swept() {
    let body = mesh(&shapes::icosphere(1, 1.0, DVec3::new(3.0, 0.0, 0.0)));
    // Nearly half turns, and displacements along their axis: each looks the same to the body.
    let turn = Generator::screw(DVec3::Z, DVec3::ZERO, 0.95 * PI, 0.0, 1.0);
    let way = Generator::translation(DVec3::Z);
    let motion = |spans: usize| {
        let span = |number: usize| Span::new([turn, way][number % 2], 1.0).expect("a span");
        Motion::from_spans((0..spans).map(span).collect()).expect("spans are a motion")
    };
    let budget = Budget::of(1e-3);
    let own = |spans: usize| {
        let cycle = sweep_cycle(&body, &motion(spans), &budget).expect("few spans fit");
        cycle.triangles.len() as f64
    };
    let pair = own(2);
    let pairs = (4e7 / pair).ceil();
    for more in [1.0, 20.0] {
        let spans = 2.0 * more * pairs;
        #[expect(clippy::cast_possible_truncation, reason = "a small number")]
        #[expect(clippy::cast_sign_loss, reason = "positive")]
        let error = sweep_cycle(&body, &motion(spans as usize), &budget).expect_err("too many");
        let CycleError::ManySpans { triangles, .. } = error else {
            panic!("{error}");
        };
        let expected = more * pairs * pair;
        assert!(
            (triangles - expected).abs() < 0.1 * expected,
            "{triangles} for {expected}, of {spans} spans"
        );
        let message = error.to_string();
        for part in ["spans would have about", "more than 2e7; use fewer"] {
            assert!(message.contains(part), "no \"{part}\" in: {message}");
        }
    }
}
