//! Bodies beside, in and on obstacles, at rest or moving, and what their checks must satisfy.

use super::Outcome;
use super::space::{self, Scene};
use crate::support::contact::families::{FAMILIES, scene as scene_of_family};
use crate::support::contact::scene;
use crate::support::random::Random;
use crate::support::shapes::{self, Shape};
use glam::DVec3;
use steadysweep::body::{Mesh, Surface};
use steadysweep::collision::{
    CheckSettings, Shape as Prepared, ShapeObstacle, Verdict, check_shapes, distance_at,
};
use steadysweep::motion::{Generator, Motion};

/// An obstacle of a scene.
struct Obstacle {
    shape: Shape,
    motion: Option<Motion>,
}

fn scene(random: &mut Random) -> (Scene, Vec<Obstacle>) {
    let (scene, obstacles) = any_scene(random);
    if super::is_alone() {
        scene.tell();
        for Obstacle { shape, motion } in &obstacles {
            println!("obstacle {shape:?}");
            motion.iter().for_each(space::tell_motion);
        }
    }
    (scene, obstacles)
}

/// A moving body with obstacles that it may hit.
fn any_scene(random: &mut Random) -> (Scene, Vec<Obstacle>) {
    if random.chance(0.3) {
        let family = FAMILIES[random.below(FAMILIES.len())];
        let scene = scene_of_family(family, random.below(1_000_000) as u64);
        let mesh = Mesh::new(scene.body.0.clone(), scene.body.1.clone()).expect("a body");
        let obstacles = scene.obstacles.into_iter().map(|obstacle| Obstacle {
            shape: obstacle.shape,
            motion: obstacle.motion,
        });
        let (shape, motion, unit) = (scene.body, scene.motion, 1.0);
        return (
            Scene {
                shape,
                mesh,
                motion,
                unit,
            },
            obstacles.collect(),
        );
    }
    loop {
        let (body, obstacle, generators) = match random.below(4) {
            0 => fitted(random),
            1 => sliding(random),
            _ => beside(random),
        };
        let frame = space::frame(random);
        let inverse = frame.inverse();
        let placed = |generators: &[Generator]| -> Vec<Generator> {
            generators
                .iter()
                .map(|generator| generator.in_frame(&inverse))
                .collect()
        };
        let in_frame = |shape: Shape| shapes::mapped(shape, |p| frame.transform_point3(p));
        let (shape, obstacle) = (in_frame(body), in_frame(obstacle));
        let mesh = Mesh::new(shape.0.clone(), shape.1.clone());
        let own = match random.below(6) {
            // Together with the body; against it; or with a motion of its own.
            0 => Some(generators.clone()),
            1 => Some(
                generators
                    .iter()
                    .map(|generator| generator.scaled(-1.0))
                    .collect(),
            ),
            2 => Some(space::generators(random, &obstacle)),
            _ => None,
        };
        let (Ok(mesh), Some(motion)) = (mesh, space::motion(random, &placed(&generators))) else {
            continue;
        };
        let own = match own {
            None => None,
            Some(generators) => match space::motion(random, &placed(&generators)) {
                None => continue,
                moving => moving,
            },
        };
        let unit = frame.matrix3.x_axis.length();
        let scene = Scene {
            shape,
            mesh,
            motion,
            unit,
        };
        return (
            scene,
            vec![Obstacle {
                shape: obstacle,
                motion: own,
            }],
        );
    }
}

/// A gap, from none to wide; some are so small that rounding cannot tell them from none.
fn gap(random: &mut Random) -> f64 {
    random.one_of(&[0.0, 0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1])
}

/// Any body with any obstacle beside it, touching or nearly touching.
fn beside(random: &mut Random) -> (Shape, Shape, Vec<Generator>) {
    let body = space::body(random);
    let obstacle = if random.chance(0.3) {
        scene::any_obstacle(random)
    } else {
        space::body(random)
    };
    let axis = random.below(3);
    let high = body
        .0
        .iter()
        .map(|p| p[axis])
        .fold(f64::NEG_INFINITY, f64::max);
    let low = obstacle
        .0
        .iter()
        .map(|p| p[axis])
        .fold(f64::INFINITY, f64::min);
    let mut way = random.one_of(&[DVec3::ZERO, DVec3::splat(0.25), DVec3::splat(1.0)]);
    way[axis] = high - low + gap(random);
    let generators = space::generators(random, &body);
    (body, scene::moved(obstacle, way), generators)
}

/// A square peg in a square hole, a shaft in a round bore, or a block in a cavity.
fn fitted(random: &mut Random) -> (Shape, Shape, Vec<Generator>) {
    let gap = gap(random);
    let half = 0.25 - gap;
    let (inner, outer) = match random.below(3) {
        0 => (
            scene::brick(DVec3::new(2.0 * half, 2.0 * half, 1.0)),
            shapes::box_with_hole(DVec3::new(1.0, 1.0, 0.5), 0.25),
        ),
        1 => {
            let bore = shapes::c_prism(0.25, 0.5, 0.5, 12, 0.5);
            let angles = (0..12).map(|i| f64::from(i) * std::f64::consts::TAU / 12.0);
            let outline: Vec<_> = angles
                .map(|angle| half * glam::DVec2::from_angle(angle))
                .collect();
            (shapes::prism(&outline, 0.5), bore)
        }
        _ => (
            scene::brick(DVec3::splat(2.0 * half)),
            shapes::hollow_box(DVec3::ONE, DVec3::splat(0.5)),
        ),
    };
    let turn = random.one_of(&[0.0, 1e-3, 1.0, std::f64::consts::PI, std::f64::consts::TAU]);
    let advance = random.one_of(&[0.0, 0.5, 2.0]);
    let generator = Generator::screw(DVec3::Z, DVec3::ZERO, turn, advance, 1.0);
    if random.chance(0.5) {
        (inner, outer, vec![generator])
    } else {
        (outer, inner, vec![generator])
    }
}

/// A body that slides over a sheet or a block, at a constant gap, and perhaps comes back or lifts
/// off.
fn sliding(random: &mut Random) -> (Shape, Shape, Vec<Generator>) {
    let body = space::body(random);
    let low = body.0.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let floor = if random.chance(0.5) {
        scene::sheet(4.0, 4.0)
    } else {
        scene::moved(scene::brick(DVec3::new(4.0, 4.0, 1.0)), DVec3::NEG_Z * 0.5)
    };
    let floor = scene::moved(floor, DVec3::Z * (low - gap(random)));
    let slide = match random.below(3) {
        0 => Generator::translation(DVec3::X),
        1 => Generator::screw(DVec3::Z, body.0[0], random.between(-7.0, 7.0), 0.0, 1.0),
        _ => Generator::translation(DVec3::new(0.3, -0.7, 0.0)),
    };
    let generators = match random.below(4) {
        0 => vec![slide, slide.scaled(-1.0)],
        1 => vec![slide, Generator::translation(DVec3::Z * random.sign())],
        _ => vec![slide],
    };
    (body, floor, generators)
}

/// Checks a scene.
pub(crate) fn check(random: &mut Random) -> Outcome {
    let (
        Scene {
            shape,
            mesh,
            motion,
            unit,
        },
        obstacles,
    ) = scene(random);
    let surfaces: Vec<Surface> = obstacles
        .iter()
        .map(|obstacle| {
            Surface::new(obstacle.shape.0.clone(), obstacle.shape.1.clone()).expect("a surface")
        })
        .collect();
    let body = Prepared::from(&mesh);
    let shapes: Vec<Prepared> = surfaces.iter().map(Prepared::new).collect();
    let prepared: Vec<ShapeObstacle<'_>> = shapes
        .iter()
        .zip(&obstacles)
        .map(|(shape, obstacle)| ShapeObstacle {
            shape,
            motion: obstacle.motion.as_ref(),
        })
        .collect();
    let mut settings = CheckSettings::default()
        .with_clearance(unit * random.one_of(&[0.0, 0.0, 0.0, 1e-9, 1e-3, 0.1, 10.0]));
    settings.all_intervals = random.chance(0.5);
    let found = match check_shapes(&body, &motion, &prepared, &settings) {
        Ok(found) => found,
        Err(error) => return Outcome::Wrong(format!("refused: {error}")),
    };
    let joints = motion.joint_times();
    let [start, end] = [joints[0], joints[joints.len() - 1]];
    let distance = |time: f64| distance_at(&body, &motion, &prepared, &[], time).distance;

    // Error of distances: some hundred roundings of the largest coordinates during the motion.
    let reach = |shape: &Shape, motion: Option<&Motion>| {
        let corners = shape.0.iter();
        let placed = corners.flat_map(|&p| match motion {
            None => vec![p],
            Some(motion) => (0..=16)
                .map(|i| start + (end - start) * f64::from(i) / 16.0)
                .map(|time| motion.pose_at_time(time).transform_point3(p))
                .collect(),
        });
        placed.fold(0.0, |largest: f64, p| largest.max(p.abs().max_element()))
    };
    let others = obstacles
        .iter()
        .map(|obstacle| reach(&obstacle.shape, obstacle.motion.as_ref()));
    let slack = 1e-12 * others.fold(reach(&shape, Some(&motion)), f64::max);

    let mut defects = Vec::new();
    let mut law = |is_kept: bool, what: String| {
        if !is_kept {
            defects.push(what);
        }
    };
    let even = (0..=24).map(|i| start + (end - start) * f64::from(i) / 24.0);
    let times: Vec<f64> = even
        .chain(joints.iter().copied())
        .chain((0..8).map(|_| random.between(start, end)))
        .collect();
    let clearance = found.clearance;
    law(
        clearance.lower >= 0.0 && clearance.lower <= clearance.upper,
        format!("{clearance:?}"),
    );
    let apart_until = match found.verdict {
        Verdict::Clear => f64::INFINITY,
        Verdict::Contact(first) | Verdict::Closer(first) => {
            let [from, to] = first.bracket;
            law(
                start <= from && from <= first.time && first.time <= to && to <= end,
                format!("{first:?} within {start} to {end}"),
            );
            law(
                first.point.is_finite() && (first.normal.length() - 1.0).abs() < 1e-9,
                format!("{first:?}"),
            );
            let threshold = match found.verdict {
                Verdict::Closer(_) => settings.clearance,
                _ => 0.0,
            };
            let there = distance(first.time);
            law(
                there <= threshold + slack,
                format!("{first:?}: {there:e} apart"),
            );
            from
        }
        Verdict::Undecided { window, .. } => window[0],
    };
    for &time in &times {
        let seen = distance(time);
        law(
            clearance.lower <= seen + slack,
            format!(
                "{seen:e} apart at {time}, never below {:e}",
                clearance.lower
            ),
        );
        let is_apart = seen > 0.0 && seen >= settings.clearance - slack;
        law(
            is_apart || time >= apart_until - 1e-12 * (end - start),
            format!(
                "{seen:e} apart at {time}, {:?} with clearance {}",
                found.verdict, settings.clearance
            ),
        );
        if let Some(intervals) = &found.intervals {
            let is_listed = intervals.iter().any(|interval| {
                let [from, to] = interval.times;
                let near = 1e-12 * (end - start);
                (from - near..=to + near).contains(&time)
            });
            law(
                is_listed || is_apart,
                format!("{seen:e} apart at {time}, not listed in {intervals:?}"),
            );
        }
    }
    match (found.verdict, defects.is_empty()) {
        (Verdict::Undecided { .. }, true) => Outcome::Undecided,
        _ => Outcome::of(defects),
    }
}
