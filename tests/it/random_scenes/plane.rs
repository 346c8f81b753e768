//! Bodies and motions in the plane that aim at trouble, and what their sweeps and probes must
//! satisfy.

use super::{Outcome, is_alone, is_at_joint};
use crate::support::planar::{Loops, depth, disc, outline, star};
use crate::support::random::Random;
use glam::{DAffine2, DMat2, DVec2};
use std::f64::consts::{FRAC_PI_2, PI};
use steadysweep::body::{FillRule, Polygon};
use steadysweep::membership::planar::Membership;
use steadysweep::motion::planar::{Generator, Keyframe, Motion, Span};
use steadysweep::planar::{self, SweepError, SweepSettings};

/// A moving body.
struct Scene {
    loops: Loops,
    body: Polygon,
    motion: Motion,
    /// Length of one unit of the body.
    unit: f64,
}

fn scene(random: &mut Random) -> Scene {
    let scene = any_scene(random);
    if is_alone() {
        let Scene { loops, motion, .. } = &scene;
        println!("body {loops:?}");
        println!(
            "times {:?}, start {:?}",
            motion.joint_times(),
            motion.start_pose()
        );
        for span in motion.spans() {
            println!("span {:?}", span.flow().generator().rows());
        }
    }
    scene
}

fn any_scene(random: &mut Random) -> Scene {
    loop {
        let loops = loops(random);
        let generators = generators(random, &loops);
        let frame = frame(random);
        let inverse = frame.inverse();
        let placed: Vec<Generator> = generators
            .iter()
            .map(|generator| generator.in_frame(&inverse))
            .collect();
        let place =
            |outline: &Vec<DVec2>| outline.iter().map(|&p| frame.transform_point2(p)).collect();
        let given: Loops = loops.iter().map(place).collect();
        // Far from the origin, thin needles are lost in rounding, and some chains grow beyond all
        // bounds.
        let body = Polygon::new(
            given,
            random.one_of(&[FillRule::EvenOdd, FillRule::NonZero]),
        );
        if let (Ok(body), Some(motion)) = (body, motion(random, &placed)) {
            let positions = body.positions();
            let corners =
                |outline: &Vec<u32>| outline.iter().map(|&i| positions[i as usize]).collect();
            return Scene {
                loops: body.loops().iter().map(corners).collect(),
                body,
                motion,
                unit: frame.matrix2.x_axis.length(),
            };
        }
    }
}

fn rectangle(low: [f64; 2], high: [f64; 2]) -> Vec<DVec2> {
    outline(&[low, [high[0], low[1]], high, [low[0], high[1]]])
}

/// A small body about the origin, of size about 1, mostly along the axes.
fn loops(random: &mut Random) -> Loops {
    let square = |half: f64| rectangle([-half; 2], [half; 2]);
    let shape: Loops = match random.below(15) {
        0 | 1 => vec![square(0.5)],
        2 => vec![rectangle([0.0; 2], [1.0, random.magnitude(1e-5, 1e-1)])],
        3 => vec![outline(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])],
        4 => vec![outline(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [0.5, random.magnitude(1e-5, 1e-1)],
        ])],
        // An L, a U, and a bar with corners along its sides.
        5 => vec![outline(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 0.25],
            [0.25, 0.25],
            [0.25, 1.0],
            [0.0, 1.0],
        ])],
        6 => vec![outline(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.75, 1.0],
            [0.75, 0.25],
            [0.25, 0.25],
            [0.25, 1.0],
            [0.0, 1.0],
        ])],
        7 => vec![outline(&[
            [0.0, 0.0],
            [0.25, 0.0],
            [0.5, 0.0],
            [1.0, 0.0],
            [1.0, 0.5],
            [0.5, 0.5],
            [0.0, 0.5],
        ])],
        8 => vec![disc(random.one_of(&[5, 12, 24]), DVec2::ZERO, 0.5)],
        9 => vec![square(0.5), square(random.one_of(&[0.25, 0.49, 0.4999]))],
        // A hole with an island, and pieces that touch in a corner, in a side, or nearly.
        10 => vec![square(0.5), square(0.375), square(0.25)],
        11 => vec![rectangle([0.0; 2], [0.5; 2]), rectangle([0.5; 2], [1.0; 2])],
        12 => vec![
            rectangle([0.0; 2], [0.5; 2]),
            rectangle([0.5 + 1e-12, 0.0], [1.0, 0.5]),
        ],
        _ => {
            let mut unit = std::iter::repeat_with(|| random.unit());
            vec![star(9, 0.7, &mut unit)]
        }
    };
    if random.chance(0.3) {
        let turn = DMat2::from_angle(random.between(0.0, 7.0));
        let turned = |outline: &Vec<DVec2>| outline.iter().map(|&p| turn * p).collect();
        shape.iter().map(turned).collect()
    } else {
        shape
    }
}

/// The place of the body, and its unit. Powers of two and small integers keep degenerate cases
/// degenerate, to the last bit.
fn frame(random: &mut Random) -> DAffine2 {
    let unit = random.one_of(&[1.0, 1.0, 1.0, 1e-3, 1e6, 0.125]);
    let off = match random.below(4) {
        0 | 1 => DVec2::ZERO,
        2 => DVec2::new(3.0, -2.0),
        _ => random.direction().truncate() * random.magnitude(1.0, 1e3),
    };
    DAffine2 {
        matrix2: DMat2::from_diagonal(DVec2::splat(unit)),
        translation: off * unit,
    }
}

fn point(random: &mut Random, size: f64) -> DVec2 {
    random.point(size).truncate()
}

/// The ends of an edge.
fn edge(random: &mut Random, loops: &Loops) -> [DVec2; 2] {
    let outline = &loops[random.below(loops.len())];
    let first = random.below(outline.len());
    [outline[first], outline[(first + 1) % outline.len()]]
}

/// A point that is special to the outlines, or close to such a point.
fn special_point(random: &mut Random, loops: &Loops) -> DVec2 {
    let [a, b] = edge(random, loops);
    match random.below(6) {
        0 => a,
        1 => a.midpoint(b),
        2 => DVec2::ZERO,
        3 => 2.0 * b - a,
        4 => a + 1e-9 * (b - a),
        _ => point(random, 2.0),
    }
}

/// A unit vector along an edge, across one, along an axis, or any.
fn special_direction(random: &mut Random, loops: &Loops) -> DVec2 {
    let [a, b] = edge(random, loops);
    let direction = match random.below(4) {
        0 => b - a,
        1 => (b - a).perp(),
        2 => random.one_of(&[DVec2::X, DVec2::Y, -DVec2::X]),
        _ => DVec2::from_angle(random.between(0.0, 7.0)),
    };
    direction.try_normalize().unwrap_or(DVec2::X)
}

/// A generator that is special to the outlines more often than not.
fn generator(random: &mut Random, loops: &Loops) -> Generator {
    let through = special_point(random, loops);
    let along = special_direction(random, loops);
    let turn = random.sign()
        * random.one_of(&[FRAC_PI_2, PI, 2.0 * PI, 3.0 * PI, 4.0 * PI, 1e-6, 1.0, 2.5]);
    let way = random.sign() * random.one_of(&[1.0, 0.5, 0.1, 3.0, 1e-7]);
    let scale = random.one_of(&[0.5, 2.0, 0.05, 1.0 + 1e-12, 0.999]);
    let about = |linear: DMat2| Generator {
        linear,
        offset: -(linear * through),
    };
    match random.below(14) {
        0 => Generator::translation(DVec2::ZERO),
        1..=3 => Generator::translation(along * way),
        4..=7 => Generator::spiral(through, turn, 1.0),
        8 => Generator::spiral(through, turn, scale),
        9 => Generator::spiral(through, 0.0, scale),
        10 => {
            // Every line along it slides along itself, one stands still.
            let across = along.perp();
            about(DMat2::from_cols(along * across.x, along * across.y) * way)
        }
        11 => {
            let outer = DMat2::from_cols(along * along.x, along * along.y);
            let rates = [random.between(-0.7, 0.7), random.one_of(&[0.0, 0.3, -0.3])];
            about(outer * rates[0] + (DMat2::IDENTITY - outer) * rates[1])
        }
        12 => {
            let rate = random.one_of(&[0.0, 0.4, -0.4]);
            about(DMat2::from_cols(
                DVec2::new(rate, 0.0),
                DVec2::new(0.7, rate),
            ))
        }
        _ => Generator {
            linear: DMat2::from_cols(point(random, 0.6), point(random, 0.6)),
            offset: point(random, 0.6),
        },
    }
}

/// One generator, or several that undo, continue, or interrupt each other.
fn generators(random: &mut Random, loops: &Loops) -> Vec<Generator> {
    let first = generator(random, loops);
    let still = Generator::translation(DVec2::ZERO);
    match random.below(16) {
        0 => vec![first, first.scaled(-1.0)],
        1 => vec![first, first.scaled(-1.0), first],
        2 => vec![first.scaled(0.5), first.scaled(0.5)],
        3 => vec![first, still, generator(random, loops)],
        4 => {
            let [a, b] = [0, 1].map(|_| special_direction(random, loops));
            [a, b, -(a + b)].map(Generator::translation).to_vec()
        }
        5 => {
            let second = generator(random, loops);
            vec![first, second, second.scaled(-1.0), first.scaled(-1.0)]
        }
        6 => vec![first, generator(random, loops)],
        _ => vec![first],
    }
}

/// The motion by spans, or by the keyframes that they pass, in which a pose may recur. `None` when
/// it leaves the range of numbers, or no steady motion leads from one pose to the next.
fn motion(random: &mut Random, generators: &[Generator]) -> Option<Motion> {
    let duration = random.one_of(&[1.0, 1.0, 2.5, 1e-3, 1e6]);
    let spans = generators
        .iter()
        .map(|&generator| Span::new(generator, duration));
    let by_spans = Motion::from_spans(spans.collect::<Result<_, _>>().ok()?).ok()?;
    if random.chance(0.7) {
        return Some(by_spans);
    }
    let joints = by_spans.joints();
    let order: Vec<usize> = match random.below(3) {
        0 => (0..joints.len()).collect(),
        1 => vec![0, 1, 0],
        _ => vec![0, 1, 0, 1],
    };
    let start = random.one_of(&[DAffine2::IDENTITY, joints[1]]);
    let keys: Vec<Keyframe> = order
        .iter()
        .zip(0..)
        .map(|(&joint, number)| Keyframe {
            time: duration * f64::from(number),
            pose: joints[joint] * start,
        })
        .collect();
    Motion::from_keyframes(&keys).ok()
}

/// The outlines at some times of the motion, and the times.
fn at_times(scene: &Scene, random: &mut Random, count: usize) -> Vec<(f64, Loops)> {
    let joints = scene.motion.joint_times();
    let [start, end] = [joints[0], joints[joints.len() - 1]];
    let times = (0..count).map(|_| random.between(start, end));
    let times: Vec<f64> = joints.iter().copied().chain(times).collect();
    let placed = |time: f64| {
        let pose = scene.motion.pose_at_time(time);
        let carried =
            |outline: &Vec<DVec2>| outline.iter().map(|&p| pose.transform_point2(p)).collect();
        scene.loops.iter().map(carried).collect()
    };
    times.into_iter().map(|time| (time, placed(time))).collect()
}

/// Sweeps a scene.
pub(crate) fn sweep(random: &mut Random) -> Outcome {
    let scene = scene(random);
    let size = scene.body.transformed(scene.motion.start_pose()).diagonal();
    let tolerance = match random.below(12) {
        0 => Some(1e-17 * size),
        1 => Some(3.0 * size),
        2 => None,
        3 => Some(1e-5 * size),
        _ => Some(size * random.one_of(&[0.3, 0.1, 0.02, 1e-3])),
    };
    if is_alone() {
        println!("tolerance {tolerance:?}");
    }
    let swept = match planar::sweep(
        &scene.body,
        &scene.motion,
        &SweepSettings::default().with_tolerance(tolerance),
    ) {
        Ok(swept) => swept,
        // The requested tolerance is too small.
        Err(SweepError::BelowRounding { .. }) => return Outcome::Refused,
        Err(error) => return Outcome::Wrong(format!("refused: {error}")),
    };
    let mut defects = Vec::new();
    let mut law = |is_kept: bool, what: String| {
        if !is_kept {
            defects.push(what);
        }
    };
    let measures = &swept.measures;
    let [low, high] = measures.bounds;
    law(
        measures.area.is_finite() && measures.area >= 0.0,
        format!("area {}", measures.area),
    );
    law(
        measures.perimeter.is_finite(),
        format!("perimeter {}", measures.perimeter),
    );
    law(
        low.is_finite() && high.is_finite(),
        format!("from {low} to {high}"),
    );
    let bound = swept.error_bound;
    for bound in [bound.inside, bound.outside] {
        law(
            bound.length.is_finite() && bound.length >= 0.0 && bound.proven,
            format!("{bound:?}"),
        );
    }
    let placed = at_times(&scene, random, 5);
    let corners = placed.iter().flat_map(|(_, loops)| loops.iter().flatten());
    let largest = corners.fold(0.0, |largest: f64, p| largest.max(p.abs().max_element()));
    // Error of positions: some hundred roundings.
    let slack = 1e-13 * largest;
    let [inside, outside] = [bound.inside, bound.outside].map(|bound| bound.length + slack);
    for (time, loops) in &placed {
        for corner in loops.iter().flatten() {
            law(
                (low - inside).cmple(*corner).all() && corner.cmple(high + inside).all(),
                format!("{corner} at {time} is outside of {low} to {high} by more than {inside:e}"),
            );
        }
    }
    let membership = Membership::new(&scene.body, &scene.motion);
    let region: Loops = swept.loops().collect();
    for _ in 0..12 {
        let point = if random.chance(0.5) || region.is_empty() {
            low + (high - low) * (point(random, 0.6) + 0.5)
        } else {
            let corner = edge(random, &region)[0];
            let way = DVec2::from_angle(random.between(0.0, 7.0));
            corner + way * random.between(0.0, 4.0) * inside.max(1e-3 * scene.unit)
        };
        let is_swept = membership.is_ever_inside(point);
        let found = depth(region.iter(), point);
        law(
            !is_swept || -found <= inside,
            format!("{point:?} is missing by {:e}, stated {inside:e}", -found),
        );
        if found > outside && !is_swept {
            // Then it must be near the sweep itself, because a hole was filled.
            let near = (0..1000).any(|_| {
                let way = DVec2::from_angle(random.between(0.0, 7.0));
                membership.is_ever_inside(point + way * random.unit().sqrt() * 1.1 * outside)
            });
            law(
                near,
                format!("{point:?} is too much, {found:e} deep, stated {outside:e}"),
            );
        }
    }
    Outcome::of(defects)
}

/// Probes points that are special to a scene.
pub(crate) fn probe(random: &mut Random) -> Outcome {
    let scene = scene(random);
    let membership = Membership::new(&scene.body, &scene.motion);
    let joints = scene.motion.joint_times();
    let [start, end] = [joints[0], joints[joints.len() - 1]];
    let placed = at_times(&scene, random, 3);
    let corners = placed.iter().flat_map(|(_, loops)| loops.iter().flatten());
    let corners = corners.chain(scene.loops.iter().flatten());
    let largest = corners.fold(0.0, |largest: f64, p| largest.max(p.abs().max_element()));
    let mut defects = Vec::new();
    for _ in 0..16 {
        let (_, loops) = &placed[random.below(placed.len())];
        let point = match random.below(4) {
            0 => edge(random, loops)[0] + point(random, 0.3) * scene.unit,
            _ => special_point(random, loops),
        };
        let intervals = membership.intervals(point);
        let is_ordered = intervals.iter().all(|[from, to]| from <= to)
            && intervals.windows(2).all(|pair| pair[0][1] < pair[1][0])
            && intervals
                .iter()
                .flatten()
                .all(|time| (start..=end).contains(time));
        if !is_ordered {
            defects.push(format!("{point:?}: {intervals:?} within {start} to {end}"));
        }
        // In the middle of the intervals found, between them, and at any time.
        let mut times: Vec<f64> = intervals
            .iter()
            .map(|[from, to]| 0.5 * (from + to))
            .collect();
        times.extend(
            intervals
                .windows(2)
                .map(|pair| 0.5 * (pair[0][1] + pair[1][0])),
        );
        times.extend((0..10).map(|_| random.between(start, end)));
        for time in times {
            let pose = scene.motion.pose_at_time(time);
            let inverse = pose.inverse();
            let seen = inverse.transform_point2(point);
            let found = depth(scene.loops.iter(), seen);
            let is_found = intervals
                .iter()
                .any(|[from, to]| (*from..=*to).contains(&time));
            if is_found && is_at_joint(joints, time) {
                continue;
            }
            // Rounding decides nearer than this: positions relative to the body are accurate to
            // some hundred roundings.
            let growth = inverse.matrix2.x_axis.length() + inverse.matrix2.y_axis.length();
            let largest = growth.max(1.0) * largest.max(point.abs().max_element());
            if (found > 0.0) != is_found && found.abs() > 1e-11 * largest {
                defects.push(format!(
                    "{point:?} at {time}: found inside {is_found}, seen at {seen:?}, {found:e} deep; {intervals:?}"
                ));
            }
        }
    }
    Outcome::of(defects)
}
