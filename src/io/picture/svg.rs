//! The picture of a swept region as SVG.
//!
//! The region is one path; everything else is in groups marked as picture, which the reader leaves
//! out. Coordinates are those of the region in all their digits. Where y is up, another marked
//! group turns the picture upright.

use super::super::svg::{MARK, PICTURE, UPRIGHT};
use super::{Look, MARGIN, Paint, PathKind, RegionPicture, VerticalAxis, layers};
use glam::DVec2;
use std::io::{self, Write};

/// Longer side of the picture on the screen where lengths have no unit, in pixels.
const PIXELS: f64 = 960.0;

/// Height of the letters in the legend, as a share of the diagonal.
const LETTERS: f64 = 0.016;

/// Their colour: a grey that is read on white and on black, since a picture does not know its page.
const LETTERS_COLOUR: &str = "#767676";

pub(super) fn write(out: &mut impl Write, picture: &RegionPicture) -> io::Result<()> {
    let [low, high] = picture.bounds();
    let diagonal = low.distance(high);
    let corner = low - MARGIN * diagonal;
    let layers = layers(picture);
    let region = picture.subject.look();
    // From top to bottom, with the region first.
    let upper = layers.iter().rev().map(|(look, ..)| *look);
    let legend: Vec<Look> = region.into_iter().chain(upper).collect();
    let line = 1.6 * LETTERS * diagonal;
    // The legend is short, so that its length is exact as `f64`.
    let room = line * (legend.len() as f64 + 0.5);
    let size = high + MARGIN * diagonal - corner + DVec2::new(0.0, room);
    let (width, height) = match picture.unit {
        Some(unit) => (format!("{}{unit}", size.x), format!("{}{unit}", size.y)),
        None => {
            let scale = PIXELS / size.max_element();
            (
                format!("{}", (size.x * scale).round()),
                format!("{}", (size.y * scale).round()),
            )
        }
    };
    let [x, y] = corner.to_array();
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"{x} {y} {} {}\">",
        size.x, size.y
    )?;
    writeln!(out, "<title>{}</title>", picture.subject.title())?;
    match picture.vertical {
        VerticalAxis::Down => writeln!(out, "<g>")?,
        VerticalAxis::Up => {
            writeln!(
                out,
                "<g {MARK}=\"{UPRIGHT}\" transform=\"matrix(1 0 0 -1 0 {})\">",
                low.y + high.y
            )?;
        }
    }
    if let Some(region) = region {
        write!(
            out,
            "<path id=\"region\" fill-rule=\"evenodd\" {} d=\"",
            style(&region, diagonal)
        )?;
        // The shortest form that reads back as the same number.
        let exact = |coordinate: f64| coordinate.to_string();
        for outline in &picture.region {
            course(out, outline, PathKind::Closed, &exact)?;
        }
        writeln!(out, "\"/>")?;
    }
    let decimals = decimals(diagonal);
    let rounded = |coordinate: f64| format!("{coordinate:.decimals$}");
    for (look, loops, kind) in &layers {
        write!(out, "<g {MARK}=\"{PICTURE}\"><title>{}</title>", look.name)?;
        write!(
            out,
            "<path fill-rule=\"evenodd\" {} d=\"",
            style(look, diagonal)
        )?;
        for points in loops {
            course(out, points, *kind, &rounded)?;
        }
        writeln!(out, "\"/></g>")?;
    }
    writeln!(out, "</g>")?;
    let at = DVec2::new(low.x, high.y + MARGIN * diagonal);
    write_legend(out, &legend, at, line, diagonal)?;
    writeln!(out, "</svg>")
}

/// Decimals of coordinates that are only for the eye: a hundred-thousandth of the diagonal.
fn decimals(diagonal: f64) -> usize {
    let wanted = 5.0 - diagonal.log10().floor();
    // At most as many as a picture of size 1e-12 needs; this bound also holds where the diagonal is
    // 0 or not finite.
    (0..=17)
        .take_while(|&count| f64::from(count) < wanted)
        .count()
}

fn course(
    out: &mut impl Write,
    points: &[DVec2],
    kind: PathKind,
    form: &impl Fn(f64) -> String,
) -> io::Result<()> {
    for (i, point) in points.iter().enumerate() {
        let letter = if i == 0 { "M" } else { " " };
        write!(out, "{letter}{} {}", form(point.x), form(point.y))?;
    }
    write!(out, "{}", if kind == PathKind::Closed { "Z" } else { "" })
}

fn write_legend(
    out: &mut impl Write,
    looks: &[Look],
    at: DVec2,
    line: f64,
    diagonal: f64,
) -> io::Result<()> {
    writeln!(
        out,
        "<g {MARK}=\"{PICTURE}\" fill=\"{LETTERS_COLOUR}\" font-family=\"sans-serif\" font-size=\"{}\">",
        LETTERS * diagonal
    )?;
    for (i, look) in looks.iter().enumerate() {
        let y = at.y + line * i as f64;
        let side = 0.7 * line;
        writeln!(
            out,
            "<rect x=\"{}\" y=\"{y}\" width=\"{}\" height=\"{side}\" {}/><text x=\"{}\" y=\"{}\">{}</text>",
            at.x,
            2.0 * side,
            style(look, diagonal),
            at.x + 2.8 * side,
            y + 0.75 * line * 0.8,
            look.name
        )?;
    }
    writeln!(out, "</g>")
}

fn style(look: &Look, diagonal: f64) -> String {
    let fill = match look.fill {
        Some(paint) => format!(
            "fill=\"{}\" fill-opacity=\"{}\"",
            colour(paint),
            paint.opacity
        ),
        None => "fill=\"none\"".to_owned(),
    };
    format!(
        "{fill} stroke=\"{}\" stroke-opacity=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"",
        colour(look.line),
        look.line.opacity,
        look.width * diagonal
    )
}

fn colour(paint: Paint) -> String {
    format!("#{:02x}{:02x}{:02x}", paint.red, paint.green, paint.blue)
}

#[cfg(test)]
mod tests {
    use super::super::super::drawing::{DrawingFormat, DrawingSettings};
    use super::super::super::drawing_file::parse_drawing;
    use super::super::RegionSubject;
    use super::super::tests::picture;
    use super::*;

    fn text(picture: &RegionPicture) -> String {
        let mut bytes = Vec::new();
        write(&mut bytes, picture).expect("memory");
        String::from_utf8(bytes).expect("text")
    }

    #[test]
    fn the_region_reads_back_to_the_last_bit() {
        for vertical in [VerticalAxis::Up, VerticalAxis::Down] {
            let mut picture = RegionPicture {
                vertical,
                ..picture()
            };
            picture.region[0][2].x = 3.0 + 1.0 / 3.0;
            let read = parse_drawing(
                DrawingFormat::Svg,
                text(&picture).as_bytes(),
                &DrawingSettings::default(),
            );
            let read = read.expect("a drawing");
            let expected: Vec<DVec2> = picture.region.iter().flatten().copied().collect();
            assert_eq!(read.polygon.positions(), expected, "{vertical:?}");
            assert_eq!((read.polygon.pieces(), read.polygon.holes()), (1, 1));
            assert_eq!(read.unit, picture.unit, "the viewBox is in the unit");
            assert!(
                read.notes[0].contains("the picture that steadysweep drew"),
                "{:?}",
                read.notes
            );
        }
    }

    #[test]
    fn what_is_only_looked_at_has_few_digits() {
        assert_eq!([1e-3, 0.5, 3.0, 1e6].map(decimals), [8, 6, 5, 0]);
        let picture = RegionPicture {
            paths: vec![vec![DVec2::splat(1.0 / 3.0), DVec2::X]],
            ..picture()
        };
        assert!(
            text(&picture).contains("M0.33333 0.33333 1.00000 0.00000"),
            "{}",
            text(&picture)
        );
    }

    #[test]
    fn what_is_left_of_a_blank_is_called_so() {
        let picture = RegionPicture {
            subject: RegionSubject::Left,
            ..picture()
        };
        let text = text(&picture);
        for part in [
            "<title>What a moving body leaves of a blank</title>",
            ">what is left of the blank</text>",
            "id=\"region\"",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn a_picture_without_poses_is_the_region_alone() {
        let picture = RegionPicture {
            poses: vec![],
            paths: vec![],
            unit: None,
            ..picture()
        };
        let text = text(&picture);
        assert!(!text.contains("body at"), "{text}");
        assert!(
            text.contains("width=\"960\""),
            "pixels where there is no unit: {text}"
        );
    }
}
