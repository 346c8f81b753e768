//! First contact by halving time over all pairs of triangles: slow, and simple enough to be
//! believed.
//!
//! In a window [m - h, m + h], the position of a moving point is given by its Taylor series up to
//! the third order, within h^4/24 times the largest fourth derivative, which is exp((t - m) M)
//! times the one at m. A direction n separates two triangles over the window if n . (x - y) stays
//! above the required offset for all corners x of one and y of the other. The line between the
//! nearest points at the middle serves as n, and, where the triangles are a hair apart, directions
//! that turn with them. Windows without a separating direction are halved, with the earlier half
//! first.
//!
//! It uses no tree, no root search, and nothing of the crate except the numbers that describe a
//! motion: generators, joints, clock.

use super::distance::{self, Triangle};
use super::scene::is_closed;
use crate::support::membership::{exponential, winding_number};
use crate::support::shapes::Shape;
use glam::{DAffine3, DVec3};
use steadysweep::motion::{Generator, Motion};

/// Smallest window, as a share of the whole time.
const SMALLEST: f64 = 1e-12;
/// Distances below this share of the largest coordinate are not distinguished from contact.
pub(crate) const DOUBTFUL: f64 = 1e-12;
/// A computed distance below this share of the largest coordinate is contact: no positions in f64
/// distinguish it from 0.
pub(crate) const CERTAIN: f64 = 4.0 * f64::EPSILON / 2.0;
/// Nearest points closer than this share of the largest coordinate may give too inaccurate a
/// direction.
const FINE: f64 = 1e-4;
/// Most tests of a pair in a window before a search is given up.
const MOST_TESTS: u64 = 2_000_000;

/// The result of the slow search, with times on the clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Slow {
    /// Proven clear, with a margin for rounding.
    Clear,
    /// Proven clear up to `clear_until`, and certainly in contact at `by`, not necessarily the
    /// first time.
    Contact { clear_until: f64, by: f64 },
    /// Proven clear up to `clear_until`; then, about up to `until`, so close that rounding decides
    /// whether there is contact.
    Doubt { clear_until: f64, until: f64 },
    /// There were too many windows.
    GivenUp,
}

/// A surface that moves or rests.
#[derive(Clone, Copy)]
pub(crate) struct Mover<'a> {
    pub(crate) shape: &'a Shape,
    pub(crate) motion: Option<&'a Motion>,
}

/// A surface during a time in which it moves steadily.
struct Carried<'a> {
    shape: &'a Shape,
    positions: Vec<DVec3>,
    generator: Generator,
    from: f64,
    duration: f64,
    /// |M| per unit of the clock.
    growth: f64,
}

/// Positions at an instant, and their first four derivatives by the clock.
struct State {
    positions: Vec<DVec3>,
    derivatives: Vec<[DVec3; 4]>,
}

impl<'a> Mover<'a> {
    /// The steady motion between `start` and `end`, with no joint in between.
    fn carried(&self, start: f64, end: f64) -> Carried<'a> {
        let still = Generator::translation(DVec3::ZERO);
        let (pose, generator, from, duration) = match self.motion {
            None => (DAffine3::IDENTITY, still, start, 1.0),
            Some(motion) => {
                let (times, joints) = (motion.joint_times(), motion.joints());
                let middle = start.midpoint(end);
                let pose = |k: usize| joints[k] * *motion.start_pose();
                let span = times
                    .windows(2)
                    .position(|span| span[0] <= middle && middle <= span[1]);
                match span {
                    Some(k) => {
                        let generator = *motion.spans()[k].flow().generator();
                        (pose(k), generator, times[k], times[k + 1] - times[k])
                    }
                    None if middle < times[0] => (pose(0), still, start, 1.0),
                    None => (pose(joints.len() - 1), still, start, 1.0),
                }
            }
        };
        let entries = generator.linear.to_cols_array();
        Carried {
            shape: self.shape,
            positions: self
                .shape
                .0
                .iter()
                .map(|&p| pose.transform_point3(p))
                .collect(),
            generator,
            from,
            duration,
            growth: entries.iter().map(|x| x * x).sum::<f64>().sqrt() / duration,
        }
    }

    fn joint_times(&self) -> Vec<f64> {
        self.motion
            .map_or(Vec::new(), |motion| motion.joint_times().to_vec())
    }
}

impl Carried<'_> {
    fn at(&self, time: f64) -> State {
        let Generator { linear, offset } = self.generator;
        let pose = exponential(&linear, offset, (time - self.from) / self.duration);
        let positions: Vec<DVec3> = self
            .positions
            .iter()
            .map(|&p| pose.transform_point3(p))
            .collect();
        let derivatives = positions
            .iter()
            .map(|&p| {
                let velocity = (linear * p + offset) / self.duration;
                let next = |x: DVec3| linear * x / self.duration;
                let second = next(velocity);
                let third = next(second);
                [velocity, second, third, next(third)]
            })
            .collect();
        State {
            positions,
            derivatives,
        }
    }

    fn triangle(&self, state: &State, index: u32) -> Triangle {
        self.shape.1[index as usize].map(|corner| state.positions[corner as usize])
    }

    /// The smallest n . x of a triangle at both ends of the window, minus the error of the linear
    /// motion.
    fn support(&self, state: &State, index: u32, n: DVec3, half: f64) -> [f64; 2] {
        let rest = half.powi(4) / 24.0 * (self.growth * half).exp();
        let mut least = [f64::INFINITY; 2];
        for corner in self.shape.1[index as usize] {
            let [first, second, third, fourth] = state.derivatives[corner as usize];
            let (x, v) = (n.dot(state.positions[corner as usize]), n.dot(first) * half);
            let missed = half * half / 2.0 * (-n.dot(second)).max(0.0)
                + half.powi(3) / 6.0 * n.dot(third).abs()
                + rest * fourth.length();
            least[0] = least[0].min(x - v - missed);
            least[1] = least[1].min(x + v - missed);
        }
        least
    }
}

/// Two surfaces during a time in which both move steadily.
struct Piece<'a> {
    sides: [Carried<'a>; 2],
    start: f64,
    end: f64,
}

impl Piece<'_> {
    fn at(&self, time: f64) -> [State; 2] {
        [self.sides[0].at(time), self.sides[1].at(time)]
    }
}

/// A search for the first time at which two surfaces are no further apart than `offset`.
pub(crate) struct Search<'a> {
    pieces: Vec<Piece<'a>>,
    offset: f64,
    closed: [bool; 2],
    /// The largest coordinate that is reached, approximately.
    largest: f64,
    smallest_window: f64,
    tests: u64,
}

impl<'a> Search<'a> {
    /// A search over `window` on the clock.
    pub(crate) fn new(sides: [Mover<'a>; 2], window: [f64; 2], offset: f64) -> Search<'a> {
        let mut times: Vec<f64> = sides.iter().flat_map(Mover::joint_times).collect();
        times.retain(|&time| window[0] < time && time < window[1]);
        times.extend(window);
        times.sort_by(f64::total_cmp);
        times.dedup();
        if times.len() == 1 {
            times.push(times[0]);
        }
        let pieces: Vec<Piece> = times
            .windows(2)
            .map(|ends| Piece {
                sides: sides.map(|side| side.carried(ends[0], ends[1])),
                start: ends[0],
                end: ends[1],
            })
            .collect();
        let mut largest = 0.0_f64;
        for piece in &pieces {
            for step in 0..=32 {
                let time = piece.start + (piece.end - piece.start) * f64::from(step) / 32.0;
                for point in piece.at(time).iter().flat_map(|state| &state.positions) {
                    largest = largest.max(point.abs().max_element());
                }
            }
        }
        Search {
            pieces,
            offset,
            closed: sides.map(|side| is_closed(side.shape)),
            largest,
            smallest_window: SMALLEST * (window[1] - window[0]),
            tests: 0,
        }
    }

    /// Examines triangles only: one surface may still lie inside the other.
    pub(crate) fn run(&mut self) -> Slow {
        let start = self.pieces[0].start;
        if self.is_certain(start) {
            return Slow::Contact {
                clear_until: start,
                by: start,
            };
        }
        let unclear = self.first_doubt();
        if self.has_given_up() {
            return Slow::GivenUp;
        }
        match unclear {
            None => Slow::Clear,
            Some(clear_until) => match self.certain_after(clear_until) {
                Some(by) => Slow::Contact { clear_until, by },
                None => Slow::Doubt {
                    clear_until,
                    until: self.doubt_ends(clear_until),
                },
            },
        }
    }

    /// The time until which the triangles are proven apart; `None` for always.
    pub(crate) fn first_doubt(&mut self) -> Option<f64> {
        (0..self.pieces.len()).find_map(|k| {
            let [a, b] = [0, 1].map(|side| self.pieces[k].sides[side].shape.1.len() as u32);
            let pairs: Vec<[u32; 2]> = (0..a).flat_map(|i| (0..b).map(move |j| [i, j])).collect();
            let ends = [self.pieces[k].start, self.pieces[k].end];
            self.first_unclear(k, ends, &pairs)
        })
    }

    /// The first time, in growing steps from `start`, at which the distance is no longer doubtful
    /// and grows.
    pub(crate) fn doubt_ends(&self, start: f64) -> f64 {
        let end = self.pieces[self.pieces.len() - 1].end;
        let mut step = self.smallest_window;
        let mut before = self.closest_at(start).0;
        while start + step < end {
            let distance = self.closest_at(start + step).0;
            let doubtful = distance <= self.offset + 2.0 * DOUBTFUL * self.largest;
            if !doubtful && distance > before {
                return start + step;
            }
            before = distance;
            step *= 1.5;
        }
        end
    }

    pub(crate) fn has_given_up(&self) -> bool {
        self.tests > MOST_TESTS
    }

    /// The start of the first window of smallest width in which some pair is not proven apart.
    fn first_unclear(&mut self, k: usize, [from, to]: [f64; 2], pairs: &[[u32; 2]]) -> Option<f64> {
        let (middle, half) = (from.midpoint(to), (to - from) / 2.0);
        let states = self.pieces[k].at(middle);
        let mut left: Vec<[u32; 2]> = pairs
            .iter()
            .copied()
            .filter(|&pair| !self.is_apart(k, &states, pair, half))
            .collect();
        if !left.is_empty() {
            let ends = [self.pieces[k].at(from), self.pieces[k].at(to)];
            left.retain(|&pair| !self.is_a_hair_apart(k, &states, &ends, pair, half));
        }
        self.tests += pairs.len() as u64;
        if left.is_empty() {
            return None;
        }
        if to - from <= self.smallest_window || middle <= from || self.tests > MOST_TESTS {
            return Some(from);
        }
        self.first_unclear(k, [from, middle], &left)
            .or_else(|| self.first_unclear(k, [middle, to], &left))
    }

    fn is_apart(&self, k: usize, states: &[State; 2], [i, j]: [u32; 2], half: f64) -> bool {
        let [a, b] = &self.pieces[k].sides;
        let (triangle, other) = (a.triangle(&states[0], i), b.triangle(&states[1], j));
        let needed = self.offset + DOUBTFUL * self.largest;
        let separates = |n: DVec3| {
            let [p, q] = a.support(&states[0], i, n, half);
            let [r, s] = b.support(&states[1], j, -n, half);
            p + r > needed && q + s > needed
        };
        let centre = |[a, b, c]: Triangle| (a + b + c) / 3.0;
        // Cheap directions first; the nearest points decide.
        let apart = (centre(triangle) - centre(other)).normalize_or_zero();
        if separates(apart) {
            return true;
        }
        let [p, q] = distance::nearest(&triangle, &other);
        separates((p - q).normalize_or_zero())
    }

    /// The same with directions that turn: between those of two touching triangles at the ends of
    /// the window.
    fn is_a_hair_apart(
        &self,
        k: usize,
        states: &[State; 2],
        ends: &[[State; 2]; 2],
        [i, j]: [u32; 2],
        half: f64,
    ) -> bool {
        let [a, b] = &self.pieces[k].sides;
        let triangles =
            |states: &[State; 2]| (a.triangle(&states[0], i), b.triangle(&states[1], j));
        let (triangle, other) = triangles(states);
        let [p, q] = distance::nearest(&triangle, &other);
        if p.distance(q) > FINE * self.largest {
            return false;
        }
        let directions = [0, 1].map(|end| {
            let (triangle, other) = triangles(&ends[end]);
            distance::touching_directions(&triangle, &other)
        });
        let needed = self.offset + DOUBTFUL * self.largest;
        let corners = |side: &Carried, state: &State, index: u32| {
            side.shape.1[index as usize].map(|corner| {
                let corner = corner as usize;
                let [first, second, third, fourth] = state.derivatives[corner];
                let rest = half.powi(4) / 24.0 * (side.growth * half).exp() * fourth.length();
                ([state.positions[corner], first, second, third], rest)
            })
        };
        let (xs, ys) = (corners(a, &states[0], i), corners(b, &states[1], j));
        directions[0]
            .iter()
            .zip(&directions[1])
            .any(|(&from, &to)| {
                // Between unit vectors, hence always of length at most 1.
                let (n, turn) = ((from + to) / 2.0, (to - from) / (2.0 * half));
                [1.0, -1.0].into_iter().any(|sign| {
                    xs.iter().all(|(x, x_rest)| {
                        ys.iter().all(|(y, y_rest)| {
                            let w = [0, 1, 2, 3].map(|k| sign * (x[k] - y[k]));
                            let [c1, c2, c3, c4] = [
                                n.dot(w[1]) + turn.dot(w[0]),
                                n.dot(w[2]) / 2.0 + turn.dot(w[1]),
                                n.dot(w[3]) / 6.0 + turn.dot(w[2]) / 2.0,
                                turn.dot(w[3]) / 6.0,
                            ];
                            n.dot(w[0]) - c1.abs() * half + c2.min(0.0) * half.powi(2)
                                - c3.abs() * half.powi(3)
                                - c4.abs() * half.powi(4)
                                - x_rest
                                - y_rest
                                > needed
                        })
                    })
                })
            })
    }

    /// Whether, at an instant, some pair certainly crosses or is practically in contact, or one
    /// surface reaches into the other, closed one; with an offset, whether the surfaces are
    /// certainly closer.
    pub(crate) fn is_certain(&self, time: f64) -> bool {
        let (smallest, crossing) = self.closest_at(time);
        let rounding = CERTAIN * self.largest;
        let limit = if self.offset > 0.0 {
            self.offset - rounding
        } else {
            rounding
        };
        crossing || smallest <= limit || (smallest > 8.0 * rounding && self.reaches_inside(time))
    }

    /// Whether a vertex of one surface is inside the other, closed one.
    pub(crate) fn reaches_inside(&self, time: f64) -> bool {
        is_one_inside(&self.shapes_at(time), self.closed)
    }

    /// Both surfaces at an instant, in the world.
    pub(crate) fn shapes_at(&self, time: f64) -> [Shape; 2] {
        let piece = self.piece_at(time);
        let shapes = piece.at(time).map(|state| state.positions);
        [0, 1].map(|k| (shapes[k].clone(), piece.sides[k].shape.1.clone()))
    }

    /// The largest coordinate that is reached, approximately.
    pub(crate) fn largest(&self) -> f64 {
        self.largest
    }

    fn piece_at(&self, time: f64) -> &Piece<'a> {
        let last = &self.pieces[self.pieces.len() - 1];
        self.pieces
            .iter()
            .find(|piece| time <= piece.end)
            .unwrap_or(last)
    }

    /// The smallest distance of the triangles at an instant, and whether some certainly cross.
    pub(crate) fn closest_at(&self, time: f64) -> (f64, bool) {
        let piece = self.piece_at(time);
        let states = piece.at(time);
        let [a, b] = &piece.sides;
        let bounded = |side: &Carried, state: &State| -> Vec<(Triangle, DVec3, f64)> {
            let triangles = (0..side.shape.1.len() as u32).map(|k| side.triangle(state, k));
            triangles
                .map(|triangle| {
                    let centre = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
                    let radius = triangle.iter().map(|p| p.distance(centre));
                    (triangle, centre, radius.fold(0.0, f64::max))
                })
                .collect()
        };
        let (a, b) = (bounded(a, &states[0]), bounded(b, &states[1]));
        let mut smallest = f64::INFINITY;
        for (triangle, centre, radius) in &a {
            for (other, other_centre, other_radius) in &b {
                if centre.distance(*other_centre) - radius - other_radius > smallest {
                    continue;
                }
                let distance = distance::distance(triangle, other);
                smallest = smallest.min(distance);
                if distance <= DOUBTFUL * self.largest
                    && distance::crosses(triangle, other, 2.0 * CERTAIN * self.largest)
                {
                    return (0.0, true);
                }
            }
        }
        (smallest, false)
    }

    /// The earliest certain time that a search in growing steps from `start` finds, refined by
    /// halving. Where the distance has a minimum between three steps, and at joints, the search
    /// examines more times.
    fn certain_after(&self, start: f64) -> Option<f64> {
        let end = self.pieces[self.pieces.len() - 1].end;
        let mut times = vec![start];
        let mut step = self.smallest_window;
        while start + step < end {
            times.push(start + step);
            step *= 1.5;
        }
        times.extend(
            self.pieces
                .iter()
                .map(|piece| piece.end)
                .filter(|&joint| joint > start),
        );
        times.sort_by(f64::total_cmp);
        let mut distances = Vec::new();
        for (index, &time) in times.iter().enumerate() {
            if self.is_certain(time) {
                return Some(self.drawn_in(times[index.saturating_sub(1)], time));
            }
            distances.push(self.closest_at(time).0);
            if index >= 2
                && distances[index - 1] <= distances[index - 2]
                && distances[index - 1] <= distances[index]
            {
                let lowest = self.lowest_between([times[index - 2], time]);
                if self.is_certain(lowest) {
                    return Some(self.drawn_in(times[index - 2], lowest));
                }
            }
        }
        None
    }

    fn drawn_in(&self, mut before: f64, mut by: f64) -> f64 {
        for _ in 0..8 {
            let middle = before.midpoint(by);
            if self.is_certain(middle) {
                by = middle;
            } else {
                before = middle;
            }
        }
        by
    }

    /// The time of the least distance, if it first decreases and then increases.
    fn lowest_between(&self, [mut from, mut to]: [f64; 2]) -> f64 {
        for _ in 0..60 {
            let third = (to - from) / 3.0;
            if self.closest_at(from + third).0 <= self.closest_at(to - third).0 {
                to -= third;
            } else {
                from += third;
            }
        }
        from.midpoint(to)
    }
}

/// Whether some vertex of one surface lies inside the other one, which is closed, at the start of
/// `window`.
pub(crate) fn starts_inside(sides: [Mover; 2], closed: [bool; 2], start: f64) -> bool {
    let shapes = sides.map(|side| {
        let carried = side.carried(start, start);
        (carried.at(start).positions, side.shape.1.clone())
    });
    is_one_inside(&shapes, closed)
}

fn is_one_inside(shapes: &[Shape; 2], closed: [bool; 2]) -> bool {
    (0..2).any(|k| {
        closed[k]
            && shapes[1 - k]
                .0
                .iter()
                .any(|&point| winding_number(&shapes[k], point) >= 1)
    })
}
