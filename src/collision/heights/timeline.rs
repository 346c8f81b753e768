//! When the vertices of a shape are in a plane, to rounding, during a chain of windows.

use super::Side;
use super::window::{Window, windows_in};
use crate::collision::mover::Mover;
use crate::collision::plane::Plane;
use crate::collision::shape::Shape;
use crate::collision::steady_stage::SteadyStage;
use crate::numeric::index;
use crate::numeric::roots::Zero;
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use crate::watch::{Interrupted, Work};
use glam::DVec3;

/// Most windows of one plane: some hundred megabytes, and more than two thousand turns.
const MOST_WINDOWS: f64 = 100_000.0;

/// A shape over a plane during its whole motion.
pub(super) struct Timeline<'a> {
    pub(super) shape: &'a Shape,
    pub(super) stages: &'a [SteadyStage],
    /// All windows, in the order of time.
    pub(super) windows: Vec<Window>,
    /// Per vertex, the first triangle that has it.
    owners: Vec<u32>,
}

/// A time during which a vertex is in the plane to rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stay {
    /// The vertex, and its position in the frame of the body.
    pub(super) vertex: u32,
    pub(super) position: DVec3,
    /// Number of the stage in which it starts.
    pub(super) stage: usize,
    /// The first and the last time on the clock at which it is in the plane.
    pub(super) times: [f64; 2],
    /// Times on the clock: right before the first and right after the last one, the vertex is
    /// certainly not in the plane.
    pub(super) bracket: [f64; 2],
}

/// A stay, and the sides of the plane on which the vertex is right before and after it; `None` where
/// nothing is before or after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sided {
    pub(super) stay: Stay,
    pub(super) sides: [Option<Side>; 2],
}

impl<'a> Timeline<'a> {
    /// - `movers`: of the shape and of the plane, stage by stage.
    /// - `level`: the height that counts as 0.
    ///
    /// `None` where the motion is too long: no height is bounded then.
    pub(super) fn new(
        shape: &'a Shape,
        stages: &'a [SteadyStage],
        movers: impl Fn(usize) -> [Mover; 2],
        plane: &Plane,
        level: f64,
    ) -> Option<Timeline<'a>> {
        let mut windows = Vec::new();
        for stage in 0..stages.len() {
            let movers = movers(stage);
            // Where both move alike, heights are the same in the frame of the plane.
            let movers = Mover::relative(&movers).unwrap_or(movers);
            let count = windows_in(&movers);
            if count + windows.len() as f64 > MOST_WINDOWS {
                return None;
            }
            let mut number = 0.0;
            while number < count {
                windows.push(Window::new(&movers, plane, level, stage, (number, count)));
                number += 1.0;
            }
        }
        Some(Timeline {
            shape,
            stages,
            windows,
            owners: owners(shape),
        })
    }

    /// The clock at a local time of a window's stage.
    fn clock(&self, window: &Window, time: f64) -> f64 {
        self.stages[window.stage].clock(time)
    }

    /// The stays during the first `count` windows, each with the sides before and after it.
    ///
    /// Between two stays the height is nowhere within its error of 0: its sign in the middle is that
    /// of the whole time between.
    pub(super) fn sided(&self, count: usize, work: Work) -> Result<Vec<Sided>, Interrupted> {
        let stays = self.stays(count, work)?;
        let start = self.stages[0].times[0];
        let end = self.end_of(count);
        let side = |position: DVec3, [from, to]: [f64; 2]| {
            (from < to).then(|| {
                if self.height_at(position, from.midpoint(to)) > 0.0 {
                    Side::Front
                } else {
                    Side::Behind
                }
            })
        };
        let mut all = Vec::with_capacity(stays.len());
        for own in stays.chunk_by(|a, b| a.vertex == b.vertex) {
            let mut from = start;
            for (number, &stay) in own.iter().enumerate() {
                let [first, last] = stay.bracket;
                let to = own.get(number + 1).map_or(end, |next| next.bracket[0]);
                let gaps = [[from, first], [last, to]];
                all.push(Sided {
                    stay,
                    sides: gaps.map(|gap| side(stay.position, gap)),
                });
                from = last;
            }
        }
        Ok(all)
    }

    /// The first stay that counts, and the times between which the first one starts to count.
    ///
    /// - `moment`: the time at which a stay starts to count; `None` where it does not.
    ///
    /// The first windows are searched, and each time twice as many, until a stay ends in them.
    pub(super) fn first(
        &self,
        moment: impl Fn(&Sided) -> Option<f64>,
        work: Work,
    ) -> Result<Option<(Sided, [f64; 2])>, Interrupted> {
        let whole = self.windows.len();
        let mut count = 1;
        loop {
            let mut first: Option<(Sided, [f64; 2])> = None;
            for sided in self.sided(count, work)? {
                let Some(time) = moment(&sided) else {
                    continue;
                };
                let after = sided.stay.bracket[0];
                first = Some(match first {
                    Some((best, [from, by])) => {
                        let from = from.min(after);
                        let vertices = (sided.stay.vertex, best.stay.vertex);
                        if time < by || time == by && vertices.0 < vertices.1 {
                            (sided, [from, time])
                        } else {
                            (best, [from, by])
                        }
                    }
                    None => (sided, [after, time]),
                });
            }
            let end = self.end_of(count);
            let ends = first.is_some_and(|(sided, _)| sided.stay.bracket[1] < end);
            if ends || count == whole {
                return Ok(first);
            }
            count = (2 * count).min(whole);
        }
    }

    /// The time on the clock at which the first `count` windows end.
    fn end_of(&self, count: usize) -> f64 {
        let last = &self.windows[count - 1];
        self.clock(last, last.times()[1])
    }

    /// All stays in the plane during the first `count` windows, vertex by vertex in an order that
    /// depends on the shape only, and for each vertex in the order of time.
    pub(super) fn stays(&self, count: usize, work: Work) -> Result<Vec<Stay>, Interrupted> {
        let windows: Vec<u32> = (0..index(count)).collect();
        self.below(0, &windows, work)
    }

    fn below(&self, node: u32, windows: &[u32], work: Work) -> Result<Vec<Stay>, Interrupted> {
        work.check()?;
        let node = &self.shape.nodes[node as usize];
        let meets = |&number: &u32| {
            let [low, high] = self.windows[number as usize].heights(self.shape, node);
            // Not `low <= 0 && high >= 0`, which would leave out what is not a number.
            !(low > 0.0 || high < 0.0)
        };
        let met: Vec<u32> = windows.iter().copied().filter(meets).collect();
        if met.is_empty() {
            return Ok(Vec::new());
        }
        if !node.is_leaf() {
            let [left, right] = [node.children, node.children + 1];
            let (left, right) = rayon::join(
                || self.below(left, &met, work),
                || self.below(right, &met, work),
            );
            let mut all = left?;
            all.extend(right?);
            return Ok(all);
        }
        let mut all = Vec::new();
        for (vertex, position) in self.own_corners(node.triangle) {
            self.stays_of(vertex, position, &met, &mut all);
        }
        Ok(all)
    }

    /// The vertices of a triangle that no triangle before it has.
    pub(super) fn own_corners(&self, triangle: u32) -> impl Iterator<Item = (u32, DVec3)> {
        let indices = self.shape.indices(triangle);
        let corners = (0..3).map(move |k| (indices[k], self.shape.corners(triangle)[k]));
        let first = move |k: usize| !indices[..k].contains(&indices[k]);
        corners
            .enumerate()
            .filter(move |&(k, (vertex, _))| self.owners[vertex as usize] == triangle && first(k))
            .map(|(_, corner)| corner)
    }

    fn stays_of(&self, vertex: u32, position: DVec3, windows: &[u32], all: &mut Vec<Stay>) {
        let before = all.len();
        for &number in windows {
            let window = &self.windows[number as usize];
            let stage = &self.stages[window.stage];
            let [first, last] = window.times();
            let clock = |time: f64| stage.clock((window.middle + time).clamp(first, last));
            // Rounding of a time on the clock.
            let [start, end] = stage.times;
            let pad = CLOCK_ROUNDING * start.abs().max(end.abs());
            let mut found: Vec<Stay> = Vec::new();
            window.height(position).zeros(|zero| {
                let (times, [from, to]) = match zero {
                    Zero::Crossing { time, window, .. } => ([time; 2], window),
                    Zero::Flat { times, window } => (times, window),
                };
                let bracket = [clock(from) - pad, clock(to) + pad];
                found.push(Stay {
                    vertex,
                    position,
                    stage: window.stage,
                    times: times.map(clock),
                    bracket: bracket.map(|time| time.clamp(start, end)),
                });
            });
            found.sort_by(|a, b| a.bracket[0].total_cmp(&b.bracket[0]));
            for stay in found {
                match all[before..].last_mut() {
                    Some(last) if stay.bracket[0] <= last.bracket[1] => {
                        last.times[1] = last.times[1].max(stay.times[1]);
                        last.bracket[1] = last.bracket[1].max(stay.bracket[1]);
                    }
                    _ => all.push(stay),
                }
            }
        }
    }

    /// The height of a position in the frame of the body at a time on the clock.
    fn height_at(&self, position: DVec3, time: f64) -> f64 {
        let window = self.window_at(time);
        let local = self.stages[window.stage].local(time);
        window.height(position).at(local - window.middle)
    }

    /// The window that contains a time on the clock.
    fn window_at(&self, time: f64) -> &Window {
        let ends_before = |window: &Window| self.clock(window, window.times()[1]) < time;
        let number = self.windows.partition_point(ends_before);
        &self.windows[number.min(self.windows.len() - 1)]
    }
}

/// Rounding of a time on the clock, relative to the largest one of its stage: a product and a sum,
/// and as much again for the local time.
const CLOCK_ROUNDING: f64 = 4.0 * UNIT_ROUNDOFF;

/// Per vertex, the first triangle that has it; any number for those that no triangle has.
fn owners(shape: &Shape) -> Vec<u32> {
    let triangles = 0..index(shape.len());
    let mut owners: Vec<u32> = Vec::new();
    for triangle in triangles {
        for vertex in shape.indices(triangle) {
            let vertex = vertex as usize;
            if owners.len() <= vertex {
                owners.resize(vertex + 1, u32::MAX);
            }
            owners[vertex] = owners[vertex].min(triangle);
        }
    }
    owners
}
