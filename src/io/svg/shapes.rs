//! The basic shapes of SVG as curves.

use super::super::drawing::{Curve, Path};
use super::super::error::InputProblem;
use super::{Reader, path, point};
use glam::{DMat2, DVec2};
use roxmltree::Node;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use svgtypes::PointsParser;

/// The curves of a shape in its own coordinates; none when it has no size, as SVG requires.
pub(super) fn paths(reader: &Reader<'_>, node: &Node<'_, '_>) -> Result<Vec<Path>, InputProblem> {
    let length = |name: &str| reader.length(node, name);
    let or_zero = |name: &str| Ok::<f64, InputProblem>(length(name)?.unwrap_or(0.0));
    let one = |curves: Vec<Curve>, closed: bool| {
        if curves.is_empty() {
            vec![]
        } else {
            vec![Path { curves, closed }]
        }
    };
    Ok(match node.tag_name().name() {
        "path" => {
            let data = node.attribute("d").unwrap_or_default();
            path::paths(data).map_err(|error| {
                reader.malformed(*node, "path data", &format!("{error} in {data}"))
            })?
        }
        "rect" => {
            let corner = point(or_zero("x")?, or_zero("y")?);
            let size = point(or_zero("width")?, or_zero("height")?);
            let (rx, ry) = (length("rx")?, length("ry")?);
            let radii = point(rx.or(ry).unwrap_or(0.0), ry.or(rx).unwrap_or(0.0)).min(size / 2.0);
            if size.min_element() > 0.0 {
                one(rectangle(corner, size, radii), true)
            } else {
                vec![]
            }
        }
        "circle" => {
            let radius = or_zero("r")?;
            one(
                ellipse(point(or_zero("cx")?, or_zero("cy")?), DVec2::splat(radius)),
                true,
            )
        }
        "ellipse" => {
            let (rx, ry) = (length("rx")?, length("ry")?);
            let radii = point(rx.or(ry).unwrap_or(0.0), ry.or(rx).unwrap_or(0.0));
            one(ellipse(point(or_zero("cx")?, or_zero("cy")?), radii), true)
        }
        "line" => {
            let ends = [
                point(or_zero("x1")?, or_zero("y1")?),
                point(or_zero("x2")?, or_zero("y2")?),
            ];
            one(vec![Curve::Line(ends)], false)
        }
        name => {
            let text = node.attribute("points").unwrap_or_default();
            let points: Vec<DVec2> = PointsParser::from(text).map(|(x, y)| point(x, y)).collect();
            // The parser stops at anything that is not a pair of numbers.
            let numbers = text
                .split([' ', ',', '\t', '\r', '\n'])
                .filter(|word| !word.is_empty())
                .count();
            if numbers > 2 * points.len() {
                return Err(reader.malformed(*node, "pairs of numbers as points", text));
            }
            let lines = points
                .windows(2)
                .map(|ends| Curve::Line([ends[0], ends[1]]))
                .collect();
            one(lines, name == "polygon")
        }
    })
}

fn ellipse(centre: DVec2, radii: DVec2) -> Vec<Curve> {
    if radii.min_element() > 0.0 {
        vec![Curve::Arc {
            centre,
            axes: DMat2::from_diagonal(radii),
            start: 0.0,
            sweep: TAU,
        }]
    } else {
        vec![]
    }
}

fn rectangle(corner: DVec2, size: DVec2, radii: DVec2) -> Vec<Curve> {
    let mut curves = Vec::new();
    let rounded = radii.min_element() > 0.0;
    let radii = if rounded { radii } else { DVec2::ZERO };
    // Corner by corner with increasing angle, each after the side that leads to it.
    let sides = [
        (point(0.0, 0.0), point(1.0, 0.0)),
        (point(1.0, 0.0), point(1.0, 1.0)),
        (point(1.0, 1.0), point(0.0, 1.0)),
        (point(0.0, 1.0), point(0.0, 0.0)),
    ];
    for (side, (from, to)) in (0u32..).zip(sides) {
        let inset = (to - from) * radii;
        let (start, end) = (corner + from * size + inset, corner + to * size - inset);
        if start != end {
            curves.push(Curve::Line([start, end]));
        }
        if rounded {
            let centre = corner + to * size + (DVec2::splat(0.5) - to) * 2.0 * radii;
            curves.push(Curve::Arc {
                centre,
                axes: DMat2::from_diagonal(radii),
                start: f64::from(side) * FRAC_PI_2 - PI / 2.0,
                sweep: FRAC_PI_2,
            });
        }
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rounded_rectangle_is_one_closed_course() {
        for radii in [DVec2::ZERO, DVec2::new(1.0, 0.5), DVec2::new(2.0, 1.0)] {
            let curves = rectangle(DVec2::new(1.0, 2.0), DVec2::new(4.0, 2.0), radii);
            let next = curves.iter().cycle().skip(1);
            for (curve, next) in curves.iter().zip(next) {
                let (end, start) = (curve.ends()[1], next.ends()[0]);
                assert!(
                    end.distance(start) < 1e-15,
                    "{end} and {start} with radii {radii}"
                );
            }
        }
    }
}
