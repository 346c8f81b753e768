//! From figures to the body that they enclose.

use super::super::drawing_error::{DrawingError, FigurePlace};
use super::curve::Curve;
use super::joining::{Bridge, JoinError, JoinedLoops, Loose, MOST_PAIRS, join};
use super::prepared::{Prepared, note_of_unit};
use super::sketch::{Figure, Path, Sketch};
use super::{Drawing, DrawingFormat, DrawingSettings};
use crate::body::{FillRule, Polygon, PolygonError};
use crate::numeric::tolerance::{JOIN_DISTANCE, WELD_DISTANCE};
use crate::numeric::{Readable, index};
use crate::surface::PointGrid;
use glam::{DVec2, DVec3};

/// Most corners of all polylines together: the work on them takes a few GB of memory.
const MOST_CORNERS: usize = 10_000_000;

/// The body that the figures of a file enclose.
pub(in crate::io) fn drawing(
    format: DrawingFormat,
    mut sketch: Sketch,
    settings: &DrawingSettings,
) -> Result<Drawing, DrawingError> {
    let prepared = Prepared::new(format, &mut sketch, settings)?;
    let mut notes = std::mem::take(&mut sketch.notes);
    let mut assembly = OutlineAssembly {
        figures: &sketch.figures,
        flattening: prepared.flattening,
        distance: JOIN_DISTANCE * prepared.diagonal,
        corners: 0,
        bridge: settings.close_gaps.unwrap_or(0.0),
        joined: 0.0,
        repeated: 0,
        notes: Vec::new(),
    };
    let polygon = assembly.body()?;
    let joined = assembly.joined;
    notes.append(&mut assembly.notes);
    notes.extend(note_of_unit(&sketch));
    Ok(Drawing {
        polygon,
        format,
        declared: sketch.declared,
        unit: prepared.unit,
        flattening: prepared.flattened,
        joined,
        notes,
    })
}

/// A loop of corners, with the figure to which each edge belongs.
#[derive(Default)]
struct Outline {
    corners: Vec<DVec2>,
    figures: Vec<u32>,
}

struct OutlineAssembly<'a> {
    figures: &'a [Figure],
    flattening: f64,
    /// Distance within which ends are joined.
    distance: f64,
    /// Number of corners so far.
    corners: usize,
    /// Longest gap that a line closes.
    bridge: f64,
    /// Largest distance by which an end was moved.
    joined: f64,
    /// Number of curves that are drawn twice.
    repeated: usize,
    notes: Vec<String>,
}

impl OutlineAssembly<'_> {
    fn body(&mut self) -> Result<Polygon, DrawingError> {
        let (mut loose, mut outlines) = (Vec::new(), Vec::new());
        // Bodies with the outlines that bound them.
        let mut bodies: Vec<(Polygon, Vec<Outline>)> = Vec::new();
        for (number, figure) in (0u32..).zip(self.figures) {
            let mut filled = Vec::new();
            for path in &figure.paths {
                let Some(curves) = self.closed(path) else {
                    let curves = path.curves.iter().cloned();
                    loose.extend(curves.map(|curve| Loose {
                        curve,
                        figure: number,
                    }));
                    continue;
                };
                let mut outline = Outline::default();
                for curve in &curves {
                    self.append(&mut outline, curve, number, false)?;
                }
                // The last curve ends where the first begins.
                outline.corners.rotate_right(1);
                if figure.fill.is_some() {
                    filled.push(outline)
                } else {
                    outlines.push(outline)
                }
            }
            if let (Some(fill), false) = (figure.fill, filled.is_empty()) {
                bodies.extend(self.enclosed(filled, fill)?);
            }
        }
        outlines.append(&mut self.join(&loose)?);
        let outlines = self.different(outlines);
        if !outlines.is_empty() {
            bodies.extend(self.enclosed(outlines, FillRule::EvenOdd)?);
        }
        match bodies.len() {
            0 => Err(DrawingError::Polygon(PolygonError::NoArea)),
            1 => Ok(bodies.remove(0).0),
            _ => self.union(&bodies),
        }
    }

    /// The curves of a path that is closed, or counts as closed because its ends are near enough to
    /// each other.
    fn closed(&self, path: &Path) -> Option<Vec<Curve>> {
        let (first, last) = (path.curves.first()?, path.curves.last()?);
        let [start, end] = [first.ends()[0], last.ends()[1]];
        let mut curves = path.curves.clone();
        if path.closed && start != end {
            curves.push(Curve::Line([end, start]));
        }
        (path.closed || start.distance(end) <= self.distance).then_some(curves)
    }

    /// Appends a curve to an outline: from its start to its end without the start, or back from its
    /// end to its start without the end.
    fn append(
        &mut self,
        outline: &mut Outline,
        curve: &Curve,
        figure: u32,
        reversed: bool,
    ) -> Result<(), DrawingError> {
        let before = outline.corners.len();
        let mut corners = Vec::new();
        let room = MOST_CORNERS - self.corners;
        if !curve.flatten(self.flattening, room, &mut corners) {
            return Err(DrawingError::TooFine {
                figure: self.place(figure),
                flattening: self.flattening,
                limit: MOST_CORNERS,
            });
        }
        if reversed {
            corners.pop();
            corners.reverse();
            corners.push(curve.ends()[0]);
        }
        outline.corners.append(&mut corners);
        let added = outline.corners.len() - before;
        self.corners += added;
        outline.figures.extend(std::iter::repeat_n(figure, added));
        Ok(())
    }

    fn place(&self, figure: u32) -> FigurePlace {
        self.figures[figure as usize].place.clone()
    }

    /// The loops that loose curves form.
    fn join(&mut self, loose: &[Loose]) -> Result<Vec<Outline>, DrawingError> {
        let distance = self.distance.max(self.bridge);
        let joined = join(loose, self.distance, self.bridge).map_err(|error| match error {
            JoinError::Open(ends) => DrawingError::Open {
                ends: ends
                    .into_iter()
                    .map(|end| (self.place(loose[end.curve as usize].figure), end))
                    .map(|(figure, end)| end.named(figure))
                    .collect(),
                distance,
            },
            JoinError::TooManyPairs => DrawingError::TooManyGaps {
                length: self.bridge,
                limit: MOST_PAIRS,
            },
        })?;
        let JoinedLoops {
            loops,
            ends,
            largest_move,
            repeated,
            tiny,
            bridges,
        } = joined;
        let mut outlines = Vec::with_capacity(loops.len());
        for links in loops {
            let mut outline = Outline::default();
            for link in links {
                let Some(Loose { curve, figure }) = loose.get(link.curve as usize) else {
                    // A bridge: a straight line that belongs to the figure before it.
                    let bridge = bridges[link.curve as usize - loose.len()];
                    let figure = outline.figures.last().copied().unwrap_or(bridge.figure);
                    outline
                        .corners
                        .push(bridge.ends[usize::from(!link.reversed)]);
                    outline.figures.push(figure);
                    continue;
                };
                self.append(&mut outline, curve, *figure, link.reversed)?;
                let end = ends[link.curve as usize][usize::from(!link.reversed)];
                if let Some(corner) = outline.corners.last_mut() {
                    *corner = end;
                }
            }
            outline.corners.rotate_right(1);
            outlines.push(outline);
        }
        // A move that is only rounding in the file needs no note.
        if largest_move > WELD_DISTANCE / JOIN_DISTANCE * self.distance {
            self.notes.push(format!(
                "ends of curves up to {} apart have been joined",
                Readable(largest_move)
            ));
        }
        self.joined = largest_move;
        if let Some(longest) = bridges.iter().map(Bridge::length).reduce(f64::max) {
            let count = match bridges.len() {
                1 => "1 gap has".to_owned(),
                many => format!("{many} gaps have"),
            };
            self.notes.push(format!(
                "{count} been closed by straight lines, up to {} long",
                Readable(longest)
            ));
        }
        self.repeated += repeated;
        if tiny > 0 {
            let short = Readable(self.distance);
            let curves = if tiny == 1 { "curve" } else { "curves" };
            self.notes
                .push(format!("left out: {tiny} {curves} shorter than {short}"));
        }
        Ok(outlines)
    }

    /// The outlines, each of them once.
    fn different(&mut self, outlines: Vec<Outline>) -> Vec<Outline> {
        // Equal outlines have marks near each other, so that no outline is compared with all
        // others.
        let mut grid = PointGrid::new(&[], 2.0 * self.distance);
        let mut marks: Vec<DVec3> = Vec::new();
        let mut kept: Vec<Outline> = Vec::with_capacity(outlines.len());
        for outline in outlines {
            let mark = mark(&outline.corners);
            let is_there = grid.near(&marks, mark).iter().any(|&other| {
                same_loop(
                    &outline.corners,
                    &kept[other as usize].corners,
                    self.distance,
                )
            });
            if is_there {
                self.repeated += 1;
            } else {
                grid.insert(mark, index(kept.len()));
                marks.push(mark);
                kept.push(outline);
            }
        }
        if self.repeated > 0 {
            self.notes.push(match self.repeated {
                1 => "1 curve is drawn twice and counts once".to_owned(),
                many => format!("{many} curves are drawn twice and count once"),
            });
        }
        kept
    }

    /// The body that outlines enclose by a rule, or a note that they enclose none.
    fn enclosed(
        &mut self,
        outlines: Vec<Outline>,
        fill: FillRule,
    ) -> Result<Option<(Polygon, Vec<Outline>)>, DrawingError> {
        let corners = outlines
            .iter()
            .map(|outline| outline.corners.clone())
            .collect();
        match Polygon::new(corners, fill) {
            Ok(polygon) => {
                let redundant = polygon
                    .redundant()
                    .iter()
                    .map(|&i| outlines[i as usize].figures[0])
                    .collect();
                self.note_redundant(redundant);
                Ok(Some((polygon, outlines)))
            }
            Err(PolygonError::NoArea) => {
                let figures = outlines.iter().map(|outline| outline.figures[0]).collect();
                self.note_redundant(figures);
                Ok(None)
            }
            Err(error) => {
                Err(self.named(error, &|outline, corner| outlines[outline].figures[corner]))
            }
        }
    }

    /// The union of bodies, with oriented loops.
    fn union(&mut self, bodies: &[(Polygon, Vec<Outline>)]) -> Result<Polygon, DrawingError> {
        let mut loops = Vec::new();
        let mut figures: Vec<Vec<u32>> = Vec::new();
        for (polygon, outlines) in bodies {
            let given: Vec<u32> = outlines
                .iter()
                .flat_map(|outline| &outline.figures)
                .copied()
                .collect();
            for outline in polygon.loops() {
                loops.push(
                    outline
                        .iter()
                        .map(|&corner| polygon.positions()[corner as usize])
                        .collect(),
                );
                figures.push(
                    outline
                        .iter()
                        .map(|&edge| given[polygon.given_edge(edge) as usize])
                        .collect(),
                );
            }
        }
        let polygon = Polygon::new(loops, FillRule::NonZero)
            .map_err(|error| self.named(error, &|outline, corner| figures[outline][corner]))?;
        self.note_redundant(
            polygon
                .redundant()
                .iter()
                .map(|&outline| figures[outline as usize][0])
                .collect(),
        );
        Ok(polygon)
    }

    fn note_redundant(&mut self, mut figures: Vec<u32>) {
        const LISTED: usize = 3;
        figures.dedup();
        let names: Vec<String> = figures
            .iter()
            .take(LISTED)
            .map(|&figure| self.place(figure).to_string())
            .collect();
        if names.is_empty() {
            return;
        }
        let more = if figures.len() > LISTED {
            format!(" and {} more", figures.len() - LISTED)
        } else {
            String::new()
        };
        self.notes.push(format!(
            "{}{more}: an outline bounds nothing, because it has no area or lies inside the body; for a hole, draw it in one path with \
             the outline around it, in the opposite sense, or draw both without fill",
            names.join(", ")
        ));
    }

    /// The error in terms of the file; `figure_of` gives the figure of an edge.
    fn named(&self, error: PolygonError, figure_of: &dyn Fn(usize, usize) -> u32) -> DrawingError {
        match error {
            PolygonError::Crossing { edges, at } => {
                let mut figures =
                    edges.map(|edge| figure_of(edge.outline as usize, edge.corner as usize));
                figures.sort_unstable();
                DrawingError::Crossing {
                    figures: Box::new(figures.map(|figure| self.place(figure))),
                    at,
                }
            }
            PolygonError::Overlap { edge, at } => {
                let figure = figure_of(edge.outline as usize, edge.corner as usize);
                DrawingError::Overlap {
                    figure: self.place(figure),
                    at,
                }
            }
            PolygonError::TooFar { place, position }
            | PolygonError::NonFinite { place, position } => {
                let figure = figure_of(place.outline as usize, place.corner as usize);
                DrawingError::Coordinate {
                    figure: self.place(figure),
                    at: position,
                }
            }
            other => DrawingError::Polygon(other),
        }
    }
}

/// A point that is the same for loops with the same corners, wherever they begin and whichever way
/// they run: the mean of the corners, and their mean distance from the origin. Where corresponding
/// corners are at most some distance apart, the marks are within twice that distance of each other.
fn mark(corners: &[DVec2]) -> DVec3 {
    let sum: DVec3 = corners.iter().map(|p| p.extend(p.length())).sum();
    sum / corners.len().max(1) as f64
}

/// Whether two loops are the same, whichever corner and sense they are run through from.
fn same_loop(one: &[DVec2], other: &[DVec2], distance: f64) -> bool {
    let near = |p: DVec2, q: DVec2| p.distance(q) <= distance;
    let count = one.len();
    let is_from = |start: usize| {
        (0..count).all(|i| near(one[i], other[(start + i) % count]))
            || (0..count).all(|i| near(one[i], other[(start + count - i) % count]))
    };
    other.len() == count && (0..count).any(is_from)
}
