//! Path data as curves; arcs stay arcs.

use super::super::drawing::{Curve, Path};
use super::point;
use glam::{DMat2, DVec2};
use svgtypes::{PathParser, PathSegment};

/// The subpaths of path data, without those that are a single point.
///
/// # Errors
/// What the parser found wrong.
pub(super) fn paths(data: &str) -> Result<Vec<Path>, svgtypes::Error> {
    let mut pen = Pen::default();
    for segment in PathParser::from(data) {
        pen.draw(segment?);
    }
    pen.finish(false);
    Ok(pen.paths)
}

#[derive(Default)]
struct Pen {
    paths: Vec<Path>,
    curves: Vec<Curve>,
    start: DVec2,
    at: DVec2,
    /// Last control point of the segment before, when it was a cubic.
    cubic: Option<DVec2>,
    /// Control point of the segment before, when it was a quadratic.
    quadratic: Option<DVec2>,
}

impl Pen {
    fn finish(&mut self, closed: bool) {
        let curves = std::mem::take(&mut self.curves);
        if !curves.is_empty() {
            self.paths.push(Path { curves, closed });
        }
    }

    fn draw(&mut self, segment: PathSegment) {
        let from = self.at;
        let base = if segment.is_abs() { DVec2::ZERO } else { from };
        let (cubic, quadratic) = (self.cubic.take(), self.quadratic.take());
        // When the segment before was of another kind, the reflected control point is the current
        // point.
        let reflected =
            |control: Option<DVec2>| control.map_or(from, |control| 2.0 * from - control);
        match segment {
            PathSegment::MoveTo { x, y, .. } => {
                self.finish(false);
                self.start = base + point(x, y);
                self.at = self.start;
            }
            PathSegment::LineTo { x, y, .. } => self.line(base + point(x, y)),
            PathSegment::HorizontalLineTo { x, .. } => self.line(point(base.x + x, from.y)),
            PathSegment::VerticalLineTo { y, .. } => self.line(point(from.x, base.y + y)),
            PathSegment::CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
                ..
            } => {
                self.cubic([point(x1, y1), point(x2, y2), point(x, y)].map(|p| base + p));
            }
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                self.cubic([reflected(cubic), base + point(x2, y2), base + point(x, y)]);
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => {
                self.quadratic([point(x1, y1), point(x, y)].map(|p| base + p));
            }
            PathSegment::SmoothQuadratic { x, y, .. } => {
                self.quadratic([reflected(quadratic), base + point(x, y)]);
            }
            PathSegment::EllipticalArc {
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                x,
                y,
                ..
            } => {
                let to = base + point(x, y);
                let arc = kurbo::SvgArc {
                    from: kurbo::Point::new(from.x, from.y),
                    to: kurbo::Point::new(to.x, to.y),
                    radii: kurbo::Vec2::new(rx, ry),
                    x_rotation: x_axis_rotation.to_radians(),
                    large_arc,
                    sweep,
                };
                self.arc(&arc, to);
            }
            PathSegment::ClosePath { .. } => {
                self.finish(true);
                self.at = self.start;
            }
        }
    }

    fn line(&mut self, to: DVec2) {
        self.curves.push(Curve::Line([self.at, to]));
        self.at = to;
    }

    fn cubic(&mut self, [one, two, to]: [DVec2; 3]) {
        self.curves.push(Curve::bezier(&[self.at, one, two, to]));
        (self.at, self.cubic) = (to, Some(two));
    }

    fn quadratic(&mut self, [control, to]: [DVec2; 2]) {
        self.curves.push(Curve::bezier(&[self.at, control, to]));
        (self.at, self.quadratic) = (to, Some(control));
    }

    fn arc(&mut self, arc: &kurbo::SvgArc, to: DVec2) {
        // As SVG requires, an arc between equal points is left out, and one without radius is a
        // line.
        if self.at == to {
            return;
        }
        match kurbo::Arc::from_svg_arc(arc) {
            None => self.line(to),
            Some(arc) => {
                let turn = DMat2::from_angle(arc.x_rotation);
                self.curves.push(Curve::Arc {
                    centre: point(arc.center.x, arc.center.y),
                    axes: turn * DMat2::from_diagonal(point(arc.radii.x, arc.radii.y)),
                    start: arc.start_angle,
                    sweep: arc.sweep_angle,
                });
                self.at = to;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(data: &str) -> Vec<(Vec<DVec2>, bool)> {
        let paths = paths(data).expect("path data");
        paths
            .into_iter()
            .map(|path| {
                let mut corners = vec![path.curves[0].ends()[0]];
                corners.extend(path.curves.iter().map(|curve| curve.ends()[1]));
                (corners, path.closed)
            })
            .collect()
    }

    #[test]
    fn relative_and_absolute_segments_lead_to_the_same_places() {
        let expected = [[1.0, 1.0], [3.0, 1.0], [3.0, 4.0], [0.0, 4.0]]
            .map(DVec2::from_array)
            .to_vec();
        assert_eq!(corners("M1 1H3V4L0 4Z"), [(expected.clone(), true)]);
        assert_eq!(corners("m1 1h2v3l-3 0"), [(expected, false)]);
    }

    #[test]
    fn a_subpath_after_a_closed_one_begins_at_its_start() {
        let found = corners("M1 1 2 1 2 2z l1 0 0 1");
        assert_eq!(found.len(), 2);
        assert_eq!(found[1].0[0], DVec2::ONE, "the start of the one before");
        assert_eq!(corners("M1 1 M2 2"), [], "points draw nothing");
    }

    #[test]
    fn smooth_segments_reflect_the_control_point() {
        let found = paths("M0 0C0 1 1 1 1 0S2 -1 2 0 M0 0Q1 1 2 0T4 0").expect("path data");
        assert_eq!(
            found[0].curves[1],
            Curve::bezier(
                &[[1.0, 0.0], [1.0, -1.0], [2.0, -1.0], [2.0, 0.0]].map(DVec2::from_array)
            )
        );
        assert_eq!(
            found[1].curves[1],
            Curve::bezier(&[[2.0, 0.0], [3.0, -1.0], [4.0, 0.0]].map(DVec2::from_array))
        );
    }

    #[test]
    fn arcs_stay_arcs() {
        // Half a circle of radius 2 about (2, 0), through (2, -2): sweep 1 turns from positive x
        // towards positive y.
        let found = paths("M0 0A2 2 0 0 1 4 0").expect("path data");
        let middle = found[0].curves[0].point_at(0.5);
        assert!(middle.distance(DVec2::new(2.0, -2.0)) < 1e-15, "{middle}");
        // Radii that are too small are enlarged; flags need no spaces around them.
        let found = paths("M0 0A1 1 0 00 4 0").expect("path data");
        assert!(
            found[0].curves[0]
                .point_at(0.5)
                .distance(DVec2::new(2.0, 2.0))
                < 1e-15
        );
        let found = paths("M0 0A0 1 0 0 0 4 0").expect("path data");
        assert_eq!(
            found[0].curves[0],
            Curve::Line([DVec2::ZERO, DVec2::X * 4.0]),
            "no radius, a line"
        );
    }

    #[test]
    fn damaged_path_data_is_an_error() {
        for data in ["M0 0L1", "L1 1", "M0 0 X"] {
            assert!(paths(data).is_err(), "{data}");
        }
    }
}
