//! Polygons in motion, and their sweeps by a slow method: the body at one pose after the other.

use super::random::pseudo_random;
use glam::{DAffine2, DMat2, DMat3, DVec2};
use std::f64::consts::TAU;
use steadysweep::body::{FillRule, Polygon};
use steadysweep::motion::planar::{Generator, Motion, Span};
use steadysweep::planar::{Sweep, SweepSettings, sweep};

/// Closed outlines.
pub(crate) type Loops = Vec<Vec<DVec2>>;

pub(crate) fn polygon(loops: Loops) -> Polygon {
    Polygon::new(loops, FillRule::EvenOdd).expect("the shapes are bodies")
}

pub(crate) fn outline(corners: &[[f64; 2]]) -> Vec<DVec2> {
    corners.iter().copied().map(DVec2::from_array).collect()
}

/// A regular polygon.
pub(crate) fn disc(corners: u32, centre: DVec2, radius: f64) -> Vec<DVec2> {
    (0..corners)
        .map(|i| centre + radius * DVec2::from_angle(f64::from(i) / f64::from(corners) * TAU))
        .collect()
}

/// A star about the origin: corners in all directions, at random distances.
pub(crate) fn star(
    corners: u32,
    spread: f64,
    random: &mut impl Iterator<Item = f64>,
) -> Vec<DVec2> {
    let mut next = || random.next().expect("endless");
    (0..corners)
        .map(|i| {
            let angle = (f64::from(i) + 0.8 * next()) / f64::from(corners) * TAU;
            DVec2::from_angle(angle) * (1.0 - spread * next())
        })
        .collect()
}

/// A chain of spans of duration 1.
pub(crate) fn motion(generators: &[Generator]) -> Motion {
    let spans = generators
        .iter()
        .map(|&generator| Span::new(generator, 1.0).expect("finite"))
        .collect();
    Motion::from_spans(spans).expect("a legal motion")
}

/// The sweep at a tolerance relative to the diagonal of the body at the start.
pub(crate) fn swept(body: &Polygon, motion: &Motion, relative: f64) -> Sweep {
    let settings = SweepSettings::default()
        .with_tolerance(relative * body.transformed(motion.start_pose()).diagonal());
    sweep(body, motion, &settings).expect("a legal sweep succeeds")
}

/// The signed distance of a point from the outlines, positive inside.
pub(crate) fn depth<'a>(loops: impl Iterator<Item = &'a Vec<DVec2>>, point: DVec2) -> f64 {
    let mut nearest_squared = f64::INFINITY;
    let mut is_inside = false;
    for outline in loops {
        let mut from = *outline.last().expect("a loop has corners");
        for &to in outline {
            let way = to - from;
            let t = (point - from).dot(way) / way.length_squared();
            let foot = if t <= 0.0 || t.is_nan() {
                from
            } else if t >= 1.0 {
                to
            } else {
                from + way * t
            };
            nearest_squared = nearest_squared.min(foot.distance_squared(point));
            // Rays to the right.
            if (from.y > point.y) != (to.y > point.y)
                && point.x < from.x + (point.y - from.y) / way.y * way.x
            {
                is_inside = !is_inside;
            }
            from = to;
        }
    }
    if is_inside {
        nearest_squared.sqrt()
    } else {
        -nearest_squared.sqrt()
    }
}

/// A moving body.
pub(crate) struct Moving {
    loops: Loops,
    /// Generator and pose at the start of each span.
    spans: Vec<(Generator, DAffine2)>,
    /// World to body at equal steps of each span.
    inverses: Vec<Vec<DAffine2>>,
    /// Bound on the speed of all its points.
    speed: f64,
}

/// Steps per span.
const STEPS: usize = 300;

impl Moving {
    pub(crate) fn new(body: &Polygon, motion: &Motion) -> Moving {
        let positions = body.positions();
        let loops = body
            .loops()
            .iter()
            .map(|outline| outline.iter().map(|&i| positions[i as usize]).collect())
            .collect();
        let mut moving = Moving {
            loops,
            spans: Vec::new(),
            inverses: Vec::new(),
            speed: 0.0,
        };
        let mut pose = *motion.start_pose();
        for (number, span) in motion.spans().iter().enumerate() {
            let generator = *span.flow().generator();
            moving.spans.push((generator, pose));
            pose = exponential(&generator, 1.0) * pose;
            let times = (0..=STEPS).map(|step| step as f64 / STEPS as f64);
            let inverses = times
                .clone()
                .map(|time| moving.pose(number, time).inverse())
                .collect();
            moving.inverses.push(inverses);
            // The speed is largest at a corner; between steps it grows by less than a tenth.
            for time in times {
                for &p in moving.at(number, time).iter().flatten() {
                    let speed = generator.velocity(p).length();
                    moving.speed = moving.speed.max(1.1 * speed);
                }
            }
        }
        moving
    }

    fn pose(&self, span: usize, time: f64) -> DAffine2 {
        let (generator, start) = &self.spans[span];
        exponential(generator, time) * *start
    }

    /// The outlines at a time of a span.
    fn at(&self, span: usize, time: f64) -> Loops {
        let pose = self.pose(span, time);
        let carried =
            |outline: &Vec<DVec2>| outline.iter().map(|&p| pose.transform_point2(p)).collect();
        self.loops.iter().map(carried).collect()
    }

    /// Whether the point is ever inside, ignoring stays during which it moves less than `close`
    /// relative to the body.
    ///
    /// Relative to the body: between two places outside, the point does not enter if the sum of
    /// their distances from the body exceeds the distance between them (and a twentieth for the
    /// bend of the path). Other steps are halved.
    pub(crate) fn is_ever_inside(&self, point: DVec2, close: f64) -> bool {
        (0..self.spans.len()).any(|span| {
            let seen = |place: DVec2| (place, depth(self.loops.iter(), place));
            let known: Vec<(DVec2, f64)> = self.inverses[span]
                .iter()
                .map(|inverse| seen(inverse.transform_point2(point)))
                .collect();
            known.iter().any(|(_, depth)| *depth > 0.0)
                || (0..STEPS).any(|step| {
                    let mut open = vec![(
                        [step, step + 1].map(|step| step as f64 / STEPS as f64),
                        [known[step], known[step + 1]],
                    )];
                    while let Some(([from, to], [first, last])) = open.pop() {
                        let way = first.0.distance(last.0);
                        if way <= close || -first.1 - last.1 > 1.05 * way {
                            continue;
                        }
                        let time = 0.5 * (from + to);
                        let inverse = self.pose(span, time).inverse();
                        let middle = seen(inverse.transform_point2(point));
                        if middle.1 > 0.0 {
                            return true;
                        }
                        open.push(([from, time], [first, middle]));
                        open.push(([time, to], [middle, last]));
                    }
                    false
                })
        })
    }

    /// Whether the body ever comes as near to the point as `distance`.
    ///
    /// The distance changes no faster than the body moves, so that the body must move at least by
    /// the missing distance.
    pub(crate) fn ever_comes_near(&self, point: DVec2, distance: f64) -> bool {
        let missing = |span: usize, time: f64| -depth(self.at(span, time).iter(), point) - distance;
        let near = |span: usize, step: usize| {
            let seen = self.inverses[span][step].transform_point2(point);
            depth(self.loops.iter(), seen)
        };
        let steps =
            (0..self.spans.len()).flat_map(|span| (0..=STEPS).map(move |step| (span, step)));
        let Some((span, step)) = steps
            .clone()
            .max_by(|a, b| near(a.0, a.1).total_cmp(&near(b.0, b.1)))
        else {
            return false;
        };
        // Most often around the time at which the point is nearest to the body, or inside; found by
        // ternary search.
        let [mut from, mut to] =
            [-1.0, 1.0].map(|part| ((step as f64 + part) / STEPS as f64).clamp(0.0, 1.0));
        let is_found = near(span, step) > 0.0
            || (0..60).any(|_| {
                let [early, late] = [from + (to - from) / 3.0, to - (to - from) / 3.0];
                let [first, last] = [missing(span, early), missing(span, late)];
                if first < last {
                    to = late;
                } else {
                    from = early;
                }
                first.min(last) <= 0.0
            });
        is_found
            || (0..self.spans.len()).any(|span| {
                let mut time = 0.0;
                loop {
                    let missing = missing(span, time);
                    if missing <= 0.0 || time >= 1.0 {
                        return missing <= 0.0;
                    }
                    let step = missing.max(1e-3 * distance) / self.speed.max(f64::MIN_POSITIVE);
                    time = (time + step).min(1.0);
                }
            })
    }
}

/// exp(s [M tau; 0 0]) by scaling, the power series, and squaring.
pub(crate) fn exponential(generator: &Generator, s: f64) -> DAffine2 {
    let linear = generator.linear;
    let matrix = DMat3::from_cols(
        linear.x_axis.extend(0.0),
        linear.y_axis.extend(0.0),
        generator.offset.extend(0.0),
    );
    let largest = linear
        .to_cols_array()
        .iter()
        .fold(0.0, |m: f64, x| m.max(x.abs()));
    let squarings = ((largest * s.abs() * 2.0).log2().ceil().max(-1.0) + 1.0) as i32;
    let small = matrix * (s / 2f64.powi(squarings));
    let (mut sum, mut term) = (DMat3::IDENTITY, DMat3::IDENTITY);
    for k in 1..=20 {
        term = term * small * (1.0 / f64::from(k));
        sum += term;
    }
    for _ in 0..squarings {
        sum = sum * sum;
    }
    DAffine2 {
        matrix2: DMat2::from_cols(sum.x_axis.truncate(), sum.y_axis.truncate()),
        translation: sum.z_axis.truncate(),
    }
}

/// The defects of a sweep at `count` points, most of them near its boundary; empty when there are
/// none.
pub(crate) fn disagreement(
    body: &Polygon,
    motion: &Motion,
    sweep: &Sweep,
    count: usize,
) -> Vec<String> {
    let moving = Moving::new(body, motion);
    let loops: Loops = sweep.loops().collect();
    let [low, high] = sweep.measures.bounds;
    let size = (high - low).max_element();
    let bound = &sweep.error_bound;
    // Exact sweeps are compared to 1e-6 of their size: the slow method takes steps of that length.
    let widest = 4.0
        * bound
            .inside
            .length
            .max(bound.outside.length)
            .max(1e-4 * size);
    let close = (1e-2 * bound.inside.length).max(1e-6 * size);
    let mut random = pseudo_random(0x5eed);
    let mut next = || random.next().expect("endless");
    let mut pick = |count: usize| (next() * count as f64) as usize % count.max(1);
    let places: Vec<(usize, usize)> = (0..count)
        .map(|_| {
            let outline = pick(loops.len());
            (outline, pick(loops[outline].len()))
        })
        .collect();
    let mut defects = Vec::new();
    for (number, (outline, corner)) in places.into_iter().enumerate() {
        let mut signed = || 2.0 * next() - 1.0;
        let point = if number % 4 == 0 {
            low + (high - low) * (DVec2::new(signed(), signed()) * 0.6 + 0.5)
        } else {
            let outline = &loops[outline];
            let [from, to] = [corner, corner + 1].map(|i| outline[i % outline.len()]);
            from.lerp(to, 0.5 + 0.5 * signed()) + DVec2::new(signed(), signed()) * widest
        };
        let found = depth(loops.iter(), point);
        if found >= 0.0 {
            if !moving.ever_comes_near(point, bound.outside.length + close) {
                defects.push(format!("{point:?} of the result is too far outside"));
            }
        } else if -found > bound.inside.length + close && moving.is_ever_inside(point, close) {
            defects.push(format!("{point:?} is missing by {found:e}"));
        }
    }
    defects
}
