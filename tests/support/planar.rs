//! Polygons in motion, and their sweeps the slow way: the body at one pose after the other.

use super::membership::pseudo_random;
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
    let settings = SweepSettings {
        tolerance: Some(relative * body.transformed(motion.start_pose()).diagonal()),
    };
    sweep(body, motion, &settings, &|_| {}).expect("a legal sweep succeeds")
}

/// Where a point lies: distance from the outlines, positive inside.
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

/// A body on its way.
pub(crate) struct Moving {
    loops: Loops,
    /// Generator and pose at the start of each span.
    spans: Vec<(Generator, DAffine2)>,
    /// Bound on the speed of any of its points.
    speed: f64,
}

impl Moving {
    pub(crate) fn new(body: &Polygon, motion: &Motion) -> Moving {
        let positions = body.positions();
        let loops = body
            .loops()
            .iter()
            .map(|outline| outline.iter().map(|&i| positions[i as usize]).collect())
            .collect();
        let mut pose = *motion.start_pose();
        let mut spans = Vec::new();
        for span in motion.spans() {
            let generator = *span.flow().generator();
            spans.push((generator, pose));
            pose = exponential(&generator, 1.0) * pose;
        }
        let mut moving = Moving {
            loops,
            spans,
            speed: 0.0,
        };
        // The speed is largest at a corner; between the samples it grows by less than a tenth.
        const TIMES: usize = 500;
        for span in 0..moving.spans.len() {
            for time in 0..=TIMES {
                let generator = moving.spans[span].0;
                let loops = moving.at(span, time as f64 / TIMES as f64);
                for &p in loops.iter().flatten() {
                    let speed = generator.velocity(p).length();
                    moving.speed = moving.speed.max(1.1 * speed);
                }
            }
        }
        moving
    }

    /// The outlines at a time of a span.
    fn at(&self, span: usize, time: f64) -> Loops {
        let (generator, start) = &self.spans[span];
        let pose = exponential(generator, time) * *start;
        let carried =
            |outline: &Vec<DVec2>| outline.iter().map(|&p| pose.transform_point2(p)).collect();
        self.loops.iter().map(carried).collect()
    }

    /// Whether the point is ever at a depth above `wanted`; unknown where it comes within `close` of that.
    ///
    /// The depth changes no faster than the body moves: what is missing is the way to go at least.
    pub(crate) fn is_ever_deeper(&self, point: DVec2, wanted: f64, close: f64) -> Option<bool> {
        let mut is_known = true;
        for span in 0..self.spans.len() {
            let mut time = 0.0;
            loop {
                let missing = wanted - depth(self.at(span, time).iter(), point);
                if missing < 0.0 {
                    return Some(true);
                }
                is_known &= missing > close;
                if time >= 1.0 {
                    break;
                }
                time = (time + missing.max(close) / self.speed.max(f64::MIN_POSITIVE)).min(1.0);
            }
        }
        is_known.then_some(false)
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

/// What is wrong with a sweep at `count` points, most of them near its boundary; empty if nothing.
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
    let widest = 4.0 * bound.inside.length.max(bound.outside.length);
    // Far above the rounding of both sides, far below all bounds of interest.
    let close = 1e-3 * bound.inside.length.max(1e-9 * size);
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
            // No answer within the bound is the fault of the sweep.
            if moving.is_ever_deeper(point, -bound.outside.length - close, 0.1 * close)
                != Some(true)
            {
                defects.push(format!("{point:?} of the result is too far outside"));
            }
        } else if -found > bound.inside.length + close
            && moving.is_ever_deeper(point, 0.0, 0.1 * close) == Some(true)
        {
            defects.push(format!("{point:?} is missing by {found:e}"));
        }
    }
    defects
}
