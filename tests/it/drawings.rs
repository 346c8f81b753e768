//! Drawings as planar bodies: how SVG and DXF files are read, and how they are refused.

use crate::support::data;
use crate::support::random::Random;
use glam::DVec2;
use std::f64::consts::{FRAC_PI_4, PI};
use steadysweep::io::{
    Drawing, DrawingError, DrawingFormat, DrawingSettings, InputProblem, Unit, parse_drawing,
    read_drawing,
};

fn svg(text: &str) -> Result<Drawing, InputProblem> {
    parse_drawing(
        DrawingFormat::Svg,
        text.as_bytes(),
        &DrawingSettings::default(),
    )
}

/// An SVG with these elements, the first of them in line 2.
fn svg_text(elements: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 100\">\n{elements}\n</svg>\n"
    )
}

fn shapes(elements: &str) -> Result<Drawing, InputProblem> {
    svg(&svg_text(elements))
}

/// A DXF with these entities, each as group codes and values separated by blanks; the first begins
/// in line 19.
fn dxf_text(entities: &[&str]) -> String {
    let header =
        "0 SECTION 2 HEADER 9 $ACADVER 1 AC1015 9 $INSUNITS 70 4 0 ENDSEC 0 SECTION 2 ENTITIES";
    let words = header
        .split(' ')
        .chain(entities.iter().flat_map(|entity| entity.split(' ')));
    let lines: Vec<&str> = words.chain("0 ENDSEC 0 EOF".split(' ')).collect();
    lines.join("\n") + "\n"
}

fn dxf(entities: &[&str]) -> Result<Drawing, InputProblem> {
    parse_drawing(
        DrawingFormat::Dxf,
        dxf_text(entities).as_bytes(),
        &DrawingSettings::default(),
    )
}

/// Checks the area, up to the error of flattening, and the pieces and holes.
#[track_caller]
fn check(
    drawing: Result<Drawing, InputProblem>,
    area: f64,
    pieces: usize,
    holes: usize,
) -> Drawing {
    let drawing = drawing.unwrap_or_else(|error| panic!("refused: {error}"));
    let body = &drawing.polygon;
    let error = drawing.flattening * body.perimeter() + 1e-12 * area;
    assert!(
        (body.area() - area).abs() <= error,
        "area {} for {area}",
        body.area()
    );
    assert_eq!(
        (body.pieces(), body.holes()),
        (pieces, holes),
        "pieces and holes"
    );
    drawing
}

#[track_caller]
fn refused(drawing: Result<Drawing, InputProblem>, parts: &[&str]) -> InputProblem {
    let error = drawing.expect_err("has to be refused");
    for part in parts {
        assert!(
            error.to_string().contains(part),
            "no \"{part}\" in: {error}"
        );
    }
    error
}

#[test]
fn every_shape_of_svg_has_its_area() {
    check(
        shapes("<rect x='1' y='2' width='3' height='4'/>"),
        12.0,
        1,
        0,
    );
    check(
        shapes("<rect width='10' height='6' rx='2' ry='1'/>"),
        60.0 - (4.0 - PI) * 2.0,
        1,
        0,
    );
    check(shapes("<circle cx='5' cy='5' r='2'/>"), 4.0 * PI, 1, 0);
    check(
        shapes("<ellipse cx='5' cy='5' rx='3' ry='1'/>"),
        3.0 * PI,
        1,
        0,
    );
    check(shapes("<polygon points='0,0 4,0 4 3'/>"), 6.0, 1, 0);
    check(shapes("<polyline points='0,0 4,0 4,3 0,0'/>"), 6.0, 1, 0);
    check(shapes("<path d='M0 0H4V3z'/>"), 6.0, 1, 0);
    // A quadratic cuts off two thirds of its triangle, and so does the cubic of the same course.
    check(shapes("<path d='M0 0Q2 3 4 0z'/>"), 4.0, 1, 0);
    check(
        shapes("<path d='M0 0C1.333333333333333333 2 2.6666666666666666 2 4 0z'/>"),
        4.0,
        1,
        0,
    );
    check(shapes("<path d='M2 0A2 2 0 0 1 0 2L0 0z'/>"), PI, 1, 0);
    let lines = "<line x1='0' y1='0' x2='3' y2='0'/><line x1='3' y1='4' x2='3' y2='0'/><line x1='3' y1='4' x2='0' y2='0'/>";
    check(shapes(lines), 6.0, 1, 0);
}

#[test]
fn coordinates_are_those_of_the_file_inside_the_viewbox() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' width='50mm' height='50mm' viewBox='10 20 100 100'>\
                <polygon points='10.1,20.2 30.3,20.2 30.3,40.4'/></svg>";
    let drawing = svg(text).expect("a triangle");
    let expected = [[10.1, 20.2], [30.3, 20.2], [30.3, 40.4]].map(DVec2::from_array);
    assert_eq!(
        drawing.polygon.positions(),
        expected,
        "every bit, y as in the file"
    );
    let declared = drawing.declared.expect("millimetres");
    assert_eq!(
        (declared.unit, declared.factor),
        (Unit::Millimetre, 0.5),
        "half a millimetre per unit"
    );
    assert_eq!(drawing.unit, None, "lengths are in no unit that has a name");
    let settings = DrawingSettings {
        unit: Some(Unit::Centimetre),
        ..DrawingSettings::default()
    };
    let scaled = parse_drawing(DrawingFormat::Svg, text.as_bytes(), &settings).expect("scaled");
    assert!(
        (scaled.polygon.positions()[1] - 0.05 * expected[1]).length() < 1e-15,
        "in centimetres"
    );
    assert_eq!(scaled.unit, Some(Unit::Centimetre));
}

#[test]
fn transforms_of_groups_act_from_the_inside_out() {
    let nested = "<g transform='translate(10 0)'><g transform='rotate(90)'><rect transform='scale(2 1)' width='3' height='1'/></g></g>";
    let drawing = check(shapes(nested), 6.0, 1, 0);
    let [low, high] = drawing.polygon.bounds();
    // 6 x 1, turned from x to y: x from -1 to 0, then moved by 10.
    assert!(
        low.distance(DVec2::new(9.0, 0.0)) < 1e-14 && high.distance(DVec2::new(10.0, 6.0)) < 1e-14,
        "{low} {high}"
    );
    check(
        shapes("<circle transform='matrix(-1 0 1 2 0 0)' r='1'/>"),
        2.0 * PI,
        1,
        0,
    );
}

#[test]
fn holes_follow_the_fill_rule_of_the_element() {
    let same_sense = "M0 0H6V6H0z M1 1H3V3H1z";
    check(shapes(&format!("<path d='{same_sense}'/>")), 36.0, 1, 0);
    check(
        shapes(&format!("<path fill-rule='evenodd' d='{same_sense}'/>")),
        32.0,
        1,
        1,
    );
    check(
        shapes(&format!(
            "<g style='fill-rule: evenodd'><path d='{same_sense}'/></g>"
        )),
        32.0,
        1,
        1,
    );
    check(shapes("<path d='M0 0H6V6H0z M1 1V3H3V1z'/>"), 32.0, 1, 1);
    check(
        shapes(&format!(
            "<path fill='none' stroke='#000' d='{same_sense}'/>"
        )),
        32.0,
        1,
        1,
    );
}

#[test]
fn filled_elements_are_united_and_one_inside_another_is_told() {
    let drawing = check(
        shapes("<rect width='6' height='6'/>\n<circle id='bore' cx='3' cy='3' r='1'/>"),
        36.0,
        1,
        0,
    );
    assert!(
        drawing
            .notes
            .iter()
            .any(|note| note.contains("circle \"bore\" at line 3") && note.contains("for a hole"))
    );
    check(
        shapes("<g fill='none'><rect width='6' height='6'/><circle cx='3' cy='3' r='1'/></g>"),
        36.0 - PI,
        1,
        1,
    );
    // The second runs the other way round, and still counts as filled.
    check(
        shapes("<path d='M0 0H2V2H0z'/><path d='M2 0V2H4V0z'/>"),
        8.0,
        1,
        0,
    );
}

#[test]
fn what_is_no_outline_is_left_out_with_a_note() {
    let drawing = check(
        shapes(
            "<title>plate</title><metadata/><defs><circle r='9'/></defs><rect width='2' height='2'/>\
             <text x='1'>plate</text><g display='none'><path d='M0 0L50 50'/></g><image/>",
        ),
        4.0,
        1,
        0,
    );
    let expected = [
        "left out: 1 element that is not displayed",
        "left out: 1 image",
        "left out: 1 text element",
        "the file does not say which unit its lengths are in",
    ];
    assert_eq!(drawing.notes, expected);
}

#[test]
fn style_sheets_say_what_is_filled_and_shown() {
    // As drawing programs write it: classes, with the sheet in the definitions.
    let in_definitions = "<defs><style>.line-1{fill:none;stroke:#000}.off{display:none}</style></defs>\
        <rect class='line-1' width='20' height='20'/><circle class='line-1' cx='10' cy='10' r='6'/>\
        <rect class='off' x='100' width='50' height='50'/>";
    let drawing = check(shapes(in_definitions), 400.0 - 36.0 * PI, 1, 1);
    assert!(
        drawing
            .notes
            .contains(&"left out: 1 element that is not displayed".to_owned()),
        "{:?}",
        drawing.notes
    );
    let beside = "<rect class='a' width='10' height='10'/><rect class='a' x='2' y='2' width='3' height='3'/>\
        <rect class='b' x='20' width='10' height='10'/><style><![CDATA[ .a{fill:none} .b{display:none} ]]></style>";
    check(shapes(beside), 91.0, 1, 1);
    // The same winding rule by name, by group and by id: two squares of the same sense, a hole by
    // evenodd only.
    let squares = "M0 0H4V4H0z M1 1H3V3H1z";
    for (sheet, element) in [
        (
            "path { fill-rule: evenodd }",
            format!("<path d='{squares}'/>"),
        ),
        (
            "g > #p, .q { FILL-RULE: EvenOdd; }",
            format!("<g><path id='p' d='{squares}'/></g>"),
        ),
        (
            ".g{fill-rule:evenodd}",
            format!("<g class='f g'><path d='{squares}'/></g>"),
        ),
    ] {
        check(
            shapes(&format!("<style>{sheet}</style>{element}")),
            12.0,
            1,
            1,
        );
    }
    let hidden = "<style>.h{visibility:hidden}</style><rect width='2' height='2'/><rect class='h' x='9' width='2' height='2'/>";
    check(shapes(hidden), 4.0, 1, 0);
}

#[test]
fn of_two_styles_the_one_that_css_puts_first_counts() {
    // A square with another one in it, which is a hole when neither is filled: 12; otherwise the
    // area of the larger one.
    let cases = [
        // A sheet takes precedence over the attribute.
        ("rect{fill:none}", "fill='red'", 12.0),
        // A style takes precedence over the sheet, except over important declarations in it.
        ("rect{fill:none}", "style='fill:red'", 16.0),
        ("rect{fill:none!important}", "style='fill:red'", 12.0),
        (
            "rect{fill:none!important}",
            "style='fill:red !important'",
            16.0,
        ),
        // Among rules, the more specific selector counts, then the later one.
        (".a{fill:none} rect{fill:red}", "class='a'", 12.0),
        (".a{fill:red} .b{fill:none}", "class='b a'", 12.0),
        (".b{fill:none} .a{fill:red}", "class='b a'", 16.0),
        ("/* rect{fill:none} */", "", 16.0),
        // Nobody hovers over a drawing that is read from a file.
        ("rect:hover{fill:none}", "", 16.0),
    ];
    for (sheet, attributes, area) in cases {
        let text = format!(
            "<style>{sheet}</style><rect {attributes} width='4' height='4'/><rect {attributes} x='1' y='1' width='2' height='2'/>"
        );
        let drawing = shapes(&text).unwrap_or_else(|error| panic!("{sheet}: {error}"));
        assert_eq!(drawing.polygon.area(), area, "{sheet} with {attributes}");
    }
}

#[test]
fn style_that_cannot_be_taken_into_account_is_refused_with_its_line() {
    let square = "<rect class='a' width='4' height='4'/>";
    for sheet in [
        "@media print { .a { display: none } }",
        "@import url(other.css);",
        ".a:nth-child(2) { fill: none }",
    ] {
        let text = format!("<style>\n{sheet}</style>{square}");
        refused(
            shapes(&text),
            &["line 3: expected a style sheet", "presentation attributes"],
        );
    }
    refused(
        svg(&format!(
            "<?xml-stylesheet href='a.css'?>\n{}",
            svg_text(square)
        )),
        &["line 1", "a style sheet in another file"],
    );
    refused(
        shapes(&format!("<style>.a{{transform: scale(2)}}</style>{square}")),
        &["rect with transform in its style at line 2"],
    );
    refused(
        shapes("<rect style='width:9px' width='4' height='4'/>"),
        &["rect with width in its style"],
    );
    // Rules that change no outline may be of any kind.
    let harmless =
        "<style>@media print{text{color:red}} text::selection{color:red} .a~b{stroke:red}</style>";
    check(shapes(&format!("{harmless}{square}")), 16.0, 1, 0);
}

#[test]
fn an_outline_that_branches_is_refused_with_the_places_and_what_is_too_much() {
    let square = [
        "0 LINE 10 0 20 0 11 10 21 0",
        "0 LINE 10 10 20 10 11 10 21 0",
        "0 LINE 10 10 20 10 11 0 21 10",
        "0 LINE 10 0 20 0 11 0 21 10",
    ];
    let diagonal = [&square[..], &["0 LINE 10 0 20 0 11 10 21 10"]].concat();
    let error = refused(
        dxf(&diagonal),
        &[
            "the outline branches",
            "3 at (0, 0): LINE at line 19, LINE at line 49, LINE at line 59",
            "3 at (10, 10): LINE at line 29, LINE at line 39, LINE at line 59",
            "perhaps LINE at line 59",
        ],
    );
    assert!(
        !error.to_string().contains("meet no other"),
        "nothing is open: {error}"
    );
    // A line that sticks out, with one branch and one free end.
    let tail = [&square[..], &["0 LINE 10 10 20 10 11 12 21 12"]].concat();
    refused(
        dxf(&tail),
        &[
            "3 at (10, 10): ",
            "perhaps LINE at line 59",
            "one end meets no other",
            "LINE at line 59 ends at (12, 12)",
        ],
    );
}

#[test]
fn unsupported_elements_are_all_listed() {
    let text = "<use href='#a'/>\n<rect width='2' height='2'/>\n<use href='#b'/>\n<foreignObject/><rect clip-path='url(#c)'/>";
    let error = refused(
        shapes(text),
        &[
            "2 use at lines 2, 4",
            "1 foreignObject at line 5",
            "1 rect with clip-path at line 5",
        ],
    );
    let InputProblem::Drawing(DrawingError::Unsupported(kinds)) = error else {
        panic!("{error:?}")
    };
    assert_eq!(kinds.len(), 3);
    refused(
        dxf(&[
            "0 LINE 10 0 20 0 11 1 21 1",
            "0 HATCH 8 0",
            "0 INSERT 2 part",
            "0 HATCH 8 0",
        ]),
        &["2 HATCH at lines 29, 37", "1 INSERT at line 33"],
    );
}

#[test]
fn an_open_outline_is_refused_with_its_ends_and_the_gap() {
    let open = "<path id='rim' d='M0 0H4V3L0.5 0.375'/>";
    refused(
        shapes(open),
        &[
            "the outline is open",
            "path \"rim\" at line 2 ends at (0, 0), 0.625 from",
            "(0.5, 0.375)",
            "--close-gaps",
        ],
    );
    let settings = DrawingSettings {
        close_gaps: Some(0.7),
        ..DrawingSettings::default()
    };
    let closed = parse_drawing(DrawingFormat::Svg, svg_text(open).as_bytes(), &settings);
    let drawing = check(closed, 6.0, 1, 0);
    assert!(
        drawing
            .notes
            .contains(&"1 gap has been closed by straight lines, up to 0.625 long".to_owned())
    );
    refused(
        dxf(&[
            "0 LINE 5 2F 10 0 20 0 11 4 21 0",
            "0 ARC 10 0 20 0 40 4 50 0 51 90",
        ]),
        &[
            "2 ends meet no other",
            "LINE (handle 2F) at line 19 ends at (0, 0)",
            "ARC at line 31 ends at (",
            ", 4)",
        ],
    );
}

#[test]
fn an_empty_drawing_is_refused_with_what_it_holds() {
    refused(shapes(""), &["the drawing is empty", "path, rect"]);
    refused(shapes("<text>none</text>"), &["left out: 1 text element;"]);
    refused(dxf(&[]), &["the drawing is empty", "LINE, ARC"]);
    refused(dxf(&["0 TEXT 1 none"]), &["left out: 1 TEXT"]);
    refused(shapes("<path d='M0 0L5 5z'/>"), &["enclose no area"]);
}

#[test]
fn an_outline_that_crosses_itself_is_refused_with_the_place() {
    refused(
        shapes("<polygon id='bow' points='0,0 4,4 4,0 0,4'/>"),
        &[
            "crosses itself at (2, 2)",
            "polygon \"bow\" at line 2 crosses itself",
        ],
    );
    refused(
        shapes("<rect width='4' height='4'/>\n<circle cx='4.01' cy='2' r='1'/>"),
        &[
            "crosses itself at (4, ",
            "rect at line 2 crosses circle at line 3",
            "unite",
        ],
    );
    refused(
        dxf(&["0 CIRCLE 10 0 20 0 40 1", "0 CIRCLE 5 A7 10 1 20 0 40 1"]),
        &["CIRCLE at line 19 crosses CIRCLE (handle A7) at line 27"],
    );
}

#[test]
fn outlines_that_overlap_are_refused() {
    // The two share parts of their sides, so that no edges cross.
    refused(
        dxf(&[
            "0 LWPOLYLINE 90 4 70 1 10 0 20 0 10 4 20 0 10 4 20 4 10 0 20 4",
            "0 LWPOLYLINE 5 A7 90 4 70 1 10 2 20 0 10 6 20 0 10 6 20 4 10 2 20 4",
        ]),
        &["the outlines overlap", "LWPOLYLINE", "unite"],
    );
    // Filled areas that share sides are united.
    check(
        shapes("<rect width='4' height='4'/><rect x='2' width='4' height='4'/>"),
        24.0,
        1,
        0,
    );
}

#[test]
fn damaged_files_are_refused_with_the_place() {
    refused(
        shapes("<path d='M0 0L1'/>"),
        &["line 2", "path data", "M0 0L1"],
    );
    refused(
        shapes("<rect width='3em' height='2'/>"),
        &["line 2", "a length", "3em", "not supported"],
    );
    let error = refused(
        shapes("<rect width='50%' height='2'/>"),
        &["line 2", "50%", "(%, em, ex) are not supported"],
    );
    assert!(!error.to_string().contains("damaged"), "{error}");
    refused(
        shapes("<rect width='-4' height='3'/>"),
        &[
            "line 2: expected a length that is not negative as width",
            "-4",
        ],
    );
    let error = refused(shapes("<path d='M0 0H1e300V1z'/>"), &["reaches (1e300, "]);
    assert!(error.to_string().len() < 200, "{error}");
    refused(
        shapes("<rect transform='turn(3)' width='3' height='2'/>"),
        &["line 2", "transform"],
    );
    refused(
        shapes("<polygon points='0,0 1'/>"),
        &["line 2", "pairs of numbers"],
    );
    refused(shapes("<rect width='3' height='2'"), &["XML"]);
    refused(svg("<html/>"), &["an svg element"]);
    refused(svg("\u{1f}\u{8b}"), &[]);
    refused(
        shapes("<rect width='1e300' height='1e300'/>"),
        &["must be finite and not exceed 1e18"],
    );
    let parse =
        |bytes: &[u8]| parse_drawing(DrawingFormat::Dxf, bytes, &DrawingSettings::default());
    refused(
        parse(b"AutoCAD Binary DXF\r\n\x1a\0"),
        &["a binary one", "ASCII"],
    );
    for wrong in ["zero", "nan", "1e999", "1,5"] {
        let text = dxf_text(&[&format!("0 LINE 10 3 20 {wrong} 11 0 21 0")]);
        refused(
            parse(text.as_bytes()),
            &["line 24: expected a finite number in LINE", wrong],
        );
    }
    refused(
        dxf(&["0 SPLINE 71 3 10 0 20 0"]),
        &["SPLINE with knots", "line 19"],
    );
    refused(
        dxf(&["0 ARC 10 0 20 0 40 4 50 0 51 90 210 1 220 0 230 1"]),
        &["ARC that does not lie in a plane parallel to xy"],
    );
}

#[test]
fn every_entity_of_dxf_has_its_area() {
    let square = [
        "0 LINE 10 0 20 0 11 2 21 0",
        "0 LINE 10 2 20 2 11 2 21 0",
        "0 LINE 10 0 20 2 11 2 21 2",
        "0 LINE 10 0 20 2 11 0 21 0",
    ];
    check(dxf(&square), 4.0, 1, 0);
    check(
        dxf(&["0 CIRCLE 10 1 20 2 40 3", "0 CIRCLE 10 1 20 2 40 1"]),
        8.0 * PI,
        1,
        1,
    );
    check(
        dxf(&[
            "0 ARC 10 0 20 0 40 2 50 270 51 90",
            "0 LINE 10 0 20 2 11 0 21 -2",
        ]),
        2.0 * PI,
        1,
        0,
    );
    // Two half circles by bulges of 1, and a rectangle with a quarter circle at one end.
    check(
        dxf(&["0 LWPOLYLINE 90 2 70 1 10 -1 20 0 42 1 10 1 20 0 42 1"]),
        PI,
        1,
        0,
    );
    let bulge = (FRAC_PI_4 / 2.0).tan();
    let corner = format!("0 LWPOLYLINE 90 3 70 1 10 0 20 0 10 2 20 0 42 {bulge} 10 0 20 2");
    check(dxf(&[&corner]), PI, 1, 0);
    let polyline =
        "0 POLYLINE 66 1 70 1 0 VERTEX 10 0 20 0 0 VERTEX 10 3 20 0 0 VERTEX 10 3 20 4 0 SEQEND";
    check(dxf(&[polyline]), 6.0, 1, 0);
    check(
        dxf(&["0 ELLIPSE 10 0 20 0 11 0 21 3 40 0.5 41 0 42 6.283185307179586"]),
        4.5 * PI,
        1,
        0,
    );
    let half = "0 ELLIPSE 10 0 20 0 11 3 21 0 40 0.5 41 0 42 3.141592653589793";
    check(dxf(&[half, "0 LINE 10 -3 20 0 11 3 21 0"]), 2.25 * PI, 1, 0);
    // A parabola over [-1, 1] as a spline of degree 2, and its chord.
    let spline =
        "0 SPLINE 71 2 40 0 40 0 40 0 40 1 40 1 40 1 10 -1 20 0 30 0 10 0 20 2 30 0 10 1 20 0 30 0";
    let drawing = check(
        dxf(&[spline, "0 LINE 10 -1 20 0 11 1 21 0"]),
        4.0 / 3.0,
        1,
        0,
    );
    assert_eq!(
        drawing.unit,
        Some(Unit::Millimetre),
        "declared by the header"
    );
}

#[test]
fn curves_are_within_the_flattening_and_corners_follow_its_root() {
    let disc = svg_text("<circle r='10'/>");
    for flattening in [1.0, 1e-2, 1e-4, 1e-6] {
        let settings = DrawingSettings {
            flattening: Some(flattening),
            ..DrawingSettings::default()
        };
        let drawing =
            parse_drawing(DrawingFormat::Svg, disc.as_bytes(), &settings).expect("a disc");
        assert_eq!(drawing.flattening, flattening, "stated");
        // Sagitta r (1 - cos(pi / n)).
        let sagitta = |corners: usize| 10.0 * (1.0 - (PI / corners as f64).cos());
        let corners = drawing.polygon.edge_count();
        assert!(
            sagitta(corners) <= flattening * (1.0 + 1e-9),
            "{corners} corners for {flattening}"
        );
        assert!(
            corners == 8 || sagitta(corners - 1) > flattening * (1.0 - 1e-6),
            "{corners} corners are too many for {flattening}"
        );
    }
    let settings = DrawingSettings {
        flattening: Some(1e-14),
        ..DrawingSettings::default()
    };
    refused(
        parse_drawing(DrawingFormat::Svg, disc.as_bytes(), &settings),
        &["more than 10000000 corners", "circle at line 2"],
    );
    assert_eq!(
        shapes("<rect width='1' height='1'/>")
            .expect("a square")
            .flattening,
        0.0,
        "nothing is curved"
    );
}

#[test]
fn curves_drawn_twice_count_once() {
    let twice = "<path fill='none' d='M0 0H4 M4 0H0 M4 0V3 M4 3L0 0'/><g fill='none'><circle cx='3' cy='1' r='.5'/><circle cx='3' cy='1' r='.5'/></g>";
    let drawing = check(shapes(twice), 6.0 - PI / 4.0, 1, 1);
    assert!(
        drawing
            .notes
            .contains(&"2 curves are drawn twice and count once".to_owned()),
        "{:?}",
        drawing.notes
    );
    let once = check(
        shapes("<path fill='none' d='M0 0H4 M4 0H0 M4 0V3 M4 3L0 0'/>"),
        6.0,
        1,
        0,
    );
    assert!(
        once.notes
            .contains(&"1 curve is drawn twice and counts once".to_owned()),
        "{:?}",
        once.notes
    );
}

#[test]
fn layers_that_are_off_and_sheets_of_paper_are_left_out() {
    let text = dxf_text(&[
        "0 CIRCLE 8 0 10 0 20 0 40 1",
        "0 LINE 8 0 67 1 10 0 20 0 11 9 21 9",
        "0 LINE 8 marks 60 1 10 0 20 0 11 9 21 9",
    ]);
    let drawing = check(
        parse_drawing(
            DrawingFormat::Dxf,
            text.as_bytes(),
            &DrawingSettings::default(),
        ),
        PI,
        1,
        0,
    );
    assert!(
        drawing
            .notes
            .iter()
            .any(|note| note.contains("on a sheet of paper")),
        "{:?}",
        drawing.notes
    );
    assert!(
        drawing.notes.iter().any(|note| note.contains("invisible")),
        "{:?}",
        drawing.notes
    );
}

#[test]
fn a_unit_that_the_file_does_not_declare_cannot_be_changed() {
    let settings = DrawingSettings {
        unit: Some(Unit::Inch),
        ..DrawingSettings::default()
    };
    let text = svg_text("<rect width='1' height='1'/>");
    refused(
        parse_drawing(DrawingFormat::Svg, text.as_bytes(), &settings),
        &["cannot be changed to in", "does not say which unit"],
    );
    let text = dxf_text(&["0 CIRCLE 10 0 20 0 40 25.4"]);
    check(
        parse_drawing(DrawingFormat::Dxf, text.as_bytes(), &settings),
        PI,
        1,
        0,
    );
}

/// Damage of all kinds: changed bytes, lost lines, a missing end, invalid numbers. No reader may
/// panic.
#[test]
fn damaged_drawings_never_make_a_reader_panic() {
    let svg = svg_text(
        "<style>.a, g > path:first-child{fill:red!important}/* \u{e9} */[id~='b'] + .c{display:none}</style>\
         <g transform='translate(1 2) rotate(30 4 5)'><path class='a' style='fill: none' d='M0 0C1 2 3 4 5 0A3 2 10 0 0 0 0z'/><ellipse cx='20' rx='3' ry='1'/></g>\
         <polyline fill='none' points='0,50 4,50 4,53 0,50'/>",
    );
    let dxf = dxf_text(&[
        "0 LWPOLYLINE 90 3 70 1 10 0 20 0 10 2 20 0 42 0.5 10 0 20 2",
        "0 POLYLINE 66 1 70 1 0 VERTEX 10 10 20 0 0 VERTEX 10 13 20 0 0 VERTEX 10 13 20 4 0 SEQEND",
        "0 ELLIPSE 10 20 20 0 11 0 21 3 40 0.5 41 0 42 6.283185307179586",
        "0 SPLINE 71 2 40 0 40 0 40 0 40 1 40 1 40 1 10 39 20 0 30 0 10 40 20 2 30 0 10 41 20 0 30 0",
        "0 LINE 10 39 20 0 11 41 21 0",
        "0 DIMENSION 70 1",
        "0 MTEXT 1 a",
        "0 INSERT 67 1 66 1 2 b",
        "0 ATTRIB 67 1 1 c",
        "0 SEQEND 8 0",
    ]);
    for (format, text) in [(DrawingFormat::Svg, &svg), (DrawingFormat::Dxf, &dxf)] {
        let whole = parse_drawing(format, text.as_bytes(), &DrawingSettings::default());
        assert!(whole.is_ok(), "undamaged: {whole:?}");
    }
    let mut random = Random::from_state(7);
    let words: [&[u8]; 8] = [
        b"1e400",
        b"-",
        b"NaN",
        b"99999999999999999999",
        b"1e17",
        b"0",
        b"\n",
        b"-1",
    ];
    const BYTES: &[u8] = b"0123456789.-+eMLCAZz<>/=\"' \n\xff{}[]:;*#@!~";
    let mut readable = 0;
    for round in 0..6000 {
        let (format, text) = if round % 2 == 0 {
            (DrawingFormat::Svg, &svg)
        } else {
            (DrawingFormat::Dxf, &dxf)
        };
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..=random.below(3) {
            let at = random.below(bytes.len());
            match random.below(4) {
                0 => bytes[at] = BYTES[random.below(BYTES.len())],
                1 => bytes.truncate(at.max(1)),
                2 => drop(bytes.splice(at..at + random.below(bytes.len() - at).min(12), [])),
                _ => drop(bytes.splice(at..at, words[random.below(words.len())].iter().copied())),
            }
        }
        readable += usize::from(parse_drawing(format, &bytes, &DrawingSettings::default()).is_ok());
    }
    assert!(readable > 50, "some of the damage does no harm: {readable}");
}

#[test]
fn published_drawings_are_bodies() {
    let Some(folder) = data::folder("cad2d") else {
        return;
    };
    // Pieces and holes as seen in the drawings; the plate has a slot that was left open by 11.808.
    let files = [
        ("gear.dxf", None, [1, 1], None),
        ("wrench.dxf", None, [1, 1], Some(Unit::Inch)),
        ("125_cycloidal.DXF", None, [4, 19], Some(Unit::Inch)),
        ("MIL.svg", Some(12.0), [1, 9], None),
    ];
    for (name, close_gaps, [pieces, holes], unit) in files {
        let path = folder.join(name);
        let settings = DrawingSettings {
            close_gaps,
            ..DrawingSettings::default()
        };
        let drawing = read_drawing(&path, &settings).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            (drawing.polygon.pieces(), drawing.polygon.holes()),
            (pieces, holes),
            "{name}"
        );
        assert_eq!(drawing.unit, unit, "{name}");
        assert!(
            drawing.joined < 1e-5 * drawing.polygon.diagonal(),
            "{name}: {}",
            drawing.joined
        );
    }
    let open =
        read_drawing(&folder.join("MIL.svg"), &DrawingSettings::default()).expect_err("open");
    assert!(
        open.to_string()
            .contains("path \"path90\" at line 170 ends at (964.77, 232.676), 11.808 from"),
        "{open}"
    );
}
