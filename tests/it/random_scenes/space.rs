//! Bodies and motions in space that aim at trouble, and what their sweeps and probes must satisfy.

use super::{Outcome, is_alone, is_at_joint};
use crate::support::contact::scene;
use crate::support::membership::{distance, winding_number};
use crate::support::random::Random;
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};
use steadysweep::body::Mesh;
use steadysweep::bounds::SurfaceTree;
use steadysweep::membership::Membership;
use steadysweep::motion::{Generator, Keyframe, Motion, Span};
use steadysweep::{Precision, SweepError, SweepSettings};

/// A moving body.
pub(crate) struct Scene {
    pub(crate) shape: Shape,
    pub(crate) mesh: Mesh,
    pub(crate) motion: Motion,
    /// Length of one unit of the body.
    pub(crate) unit: f64,
}

impl Scene {
    /// Prints what is needed to repeat the scene.
    pub(crate) fn tell(&self) {
        println!("body {:?}", self.shape);
        tell_motion(&self.motion);
    }
}

/// Prints what is needed to repeat a motion.
pub(crate) fn tell_motion(motion: &Motion) {
    println!(
        "times {:?}, start {:?}",
        motion.joint_times(),
        motion.start_pose()
    );
    for span in motion.spans() {
        println!("span {:?}", span.flow().generator().rows());
    }
}

pub(crate) fn scene(random: &mut Random) -> Scene {
    let scene = any_scene(random);
    if is_alone() {
        scene.tell();
    }
    scene
}

pub(crate) fn any_scene(random: &mut Random) -> Scene {
    loop {
        let shape = body(random);
        let generators = generators(random, &shape);
        let frame = frame(random);
        let inverse = frame.inverse();
        let placed: Vec<Generator> = generators
            .iter()
            .map(|generator| generator.in_frame(&inverse))
            .collect();
        let shape = shapes::mapped(shape, |p| frame.transform_point3(p));
        let mesh = Mesh::new(shape.0.clone(), shape.1.clone());
        // A needle far from the origin is flat in f64, and some chains grow beyond all bounds.
        if let (Ok(mesh), Some(motion)) = (mesh, motion(random, &placed)) {
            return Scene {
                shape,
                mesh,
                motion,
                unit: frame.matrix3.x_axis.length(),
            };
        }
    }
}

/// A small body about the origin, of size about 1, mostly along the axes.
pub(crate) fn body(random: &mut Random) -> Shape {
    let half = DVec3::splat(0.5);
    let unit_box = || shapes::cuboid(-half, half);
    let shape = match random.below(18) {
        0..=2 => unit_box(),
        3 => scene::brick(DVec3::new(
            1.0,
            random.magnitude(1e-4, 1e-1),
            random.magnitude(1e-4, 1e-1),
        )),
        4 => scene::brick(DVec3::new(1.0, 1.0, random.magnitude(1e-4, 1e-1))),
        5 => scene::tetrahedron(),
        6 => scene::octahedron(),
        7 => shapes::l_prism(0.25, 0.5),
        8 => shapes::u_prism(0.25, 0.5),
        9 => shapes::hollow_box(DVec3::ONE, DVec3::splat(random.one_of(&[0.5, 0.9, 0.999]))),
        10 => shapes::box_with_hole(DVec3::new(1.0, 1.0, 0.5), 0.25),
        // A shell within a shell, both outward.
        11 => shapes::united(&[unit_box(), shapes::cuboid(-0.5 * half, 0.5 * half)]),
        // Two that touch in a face, an edge or a corner, or share a face up to rounding, or
        // overlap.
        12 | 13 => {
            let ways = [
                DVec3::X,
                DVec3::X + DVec3::Y,
                DVec3::ONE,
                DVec3::X * (1.0 + 1e-15),
                DVec3::X * 0.5,
            ];
            let way = random.one_of(&ways);
            shapes::united(&[unit_box(), shapes::cuboid(way - half, way + half)])
        }
        14 => shapes::cone(0.5, 1.0, 5),
        15 => shapes::torus(0.6, 0.2, 6, 4),
        16 => shapes::icosphere(0, 0.5, DVec3::ZERO),
        _ => scene::star(random, 0),
    };
    if random.chance(0.3) {
        scene::turned(random, shape)
    } else {
        shape
    }
}

/// The place of the body, and its unit. Powers of two and small integers keep degenerate cases
/// degenerate, to the last bit.
pub(crate) fn frame(random: &mut Random) -> DAffine3 {
    let unit = random.one_of(&[1.0, 1.0, 1.0, 1e-3, 1e6, 0.125]);
    let off = match random.below(4) {
        0 | 1 => DVec3::ZERO,
        2 => DVec3::new(3.0, -2.0, 7.0),
        _ => random.direction() * random.magnitude(1.0, 1e3),
    };
    DAffine3 {
        matrix3: DMat3::from_diagonal(DVec3::splat(unit)),
        translation: off * unit,
    }
}

/// A point that is special to the shape, or close to such a point.
fn special_point(random: &mut Random, (positions, triangles): &Shape) -> DVec3 {
    let triangle = triangles[random.below(triangles.len())];
    let [a, b, c] = triangle.map(|corner| positions[corner as usize]);
    match random.below(7) {
        0 => a,
        1 => a.midpoint(b),
        2 => (a + b + c) / 3.0,
        3 => DVec3::ZERO,
        4 => 2.0 * b - a,
        5 => a + 1e-9 * (b - a),
        _ => random.point(2.0),
    }
}

/// A unit vector along an edge or a face, across one, along an axis, or any.
fn special_direction(random: &mut Random, (positions, triangles): &Shape) -> DVec3 {
    let triangle = triangles[random.below(triangles.len())];
    let [a, b, c] = triangle.map(|corner| positions[corner as usize]);
    let direction = match random.below(6) {
        0 => b - a,
        1 => (b - a).cross(c - a),
        2 => a + b - 2.0 * c,
        3 => random.one_of(&[DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Z]),
        _ => random.direction(),
    };
    direction.try_normalize().unwrap_or(DVec3::Z)
}

/// A generator that is special to the shape more often than not.
fn generator(random: &mut Random, shape: &Shape) -> Generator {
    let through = special_point(random, shape);
    let axis = special_direction(random, shape);
    let turn = random.sign()
        * random.one_of(&[FRAC_PI_2, PI, 2.0 * PI, 3.0 * PI, 4.0 * PI, 1e-6, 1.0, 2.5]);
    let way = random.sign() * random.one_of(&[1.0, 0.5, 0.1, 3.0, 1e-7]);
    let scale = random.one_of(&[0.5, 2.0, 0.05, 1.0 + 1e-12, 0.999]);
    let about = |linear: DMat3| Generator {
        linear,
        offset: -(linear * through),
    };
    match random.below(16) {
        0 => Generator::translation(DVec3::ZERO),
        1..=3 => Generator::translation(axis * way),
        4..=7 => Generator::screw(axis, through, turn, 0.0, 1.0),
        8 | 9 => Generator::screw(axis, through, turn, way, 1.0),
        10 => Generator::screw(axis, through, turn, 0.0, scale),
        11 => Generator::screw(axis, through, 0.0, 0.0, scale),
        12 => {
            // A plane through the point stands still, all others slide along themselves.
            let along = axis.any_orthonormal_vector() * way;
            about(DMat3::from_cols(
                along * axis.x,
                along * axis.y,
                along * axis.z,
            ))
        }
        13 => {
            // One stretch along the axis, another one across it.
            let outer = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
            let rates = [random.between(-0.7, 0.7), random.one_of(&[0.0, 0.3, -0.3])];
            about(outer * rates[0] + (DMat3::IDENTITY - outer) * rates[1])
        }
        14 => {
            // One eigenvalue, with a chain of vectors.
            let rate = random.one_of(&[0.0, 0.4, -0.4]);
            let columns = [
                0.0,
                0.0,
                0.0,
                1.0,
                0.0,
                0.0,
                0.0,
                random.one_of(&[0.0, 1.0]),
                0.0,
            ];
            about(DMat3::from_cols_array(&columns) * 0.7 + DMat3::IDENTITY * rate)
        }
        _ => Generator {
            linear: random.matrix(0.6),
            offset: random.point(0.6),
        },
    }
}

/// One generator, or several that undo, continue, or interrupt each other.
pub(crate) fn generators(random: &mut Random, shape: &Shape) -> Vec<Generator> {
    let first = generator(random, shape);
    let still = Generator::translation(DVec3::ZERO);
    match random.below(16) {
        0 => vec![first, first.scaled(-1.0)],
        1 => vec![first, first.scaled(-1.0), first],
        2 => vec![first.scaled(0.5), first.scaled(0.5)],
        3 => vec![first, still, generator(random, shape)],
        4 => {
            let [a, b] = [0, 1].map(|_| special_direction(random, shape));
            [a, b, -(a + b)].map(Generator::translation).to_vec()
        }
        5 => {
            let second = generator(random, shape);
            vec![first, second, second.scaled(-1.0), first.scaled(-1.0)]
        }
        6 => vec![first, generator(random, shape)],
        _ => vec![first],
    }
}

/// The motion by spans, or by the keyframes that they pass, in which a pose may recur. `None` when
/// it leaves the range of numbers, or no steady motion leads from one pose to the next.
pub(crate) fn motion(random: &mut Random, generators: &[Generator]) -> Option<Motion> {
    let duration = random.one_of(&[1.0, 1.0, 2.5, 1e-3, 1e6]);
    let spans = generators
        .iter()
        .map(|&generator| Span::new(generator, duration));
    let by_spans = Motion::from_spans(spans.collect::<Result<_, _>>().ok()?).ok()?;
    if random.chance(0.7) {
        return Some(by_spans);
    }
    // There, and perhaps back, and there again: the same pose to the last bit.
    let joints = by_spans.joints();
    let order: Vec<usize> = match random.below(3) {
        0 => (0..joints.len()).collect(),
        1 => vec![0, 1, 0],
        _ => vec![0, 1, 0, 1],
    };
    let start = random.one_of(&[DAffine3::IDENTITY, joints[1]]);
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

/// Corners of the body at some times of the motion, and the times.
fn at_times(scene: &Scene, random: &mut Random, count: usize) -> Vec<(f64, Vec<DVec3>)> {
    let joints = scene.motion.joint_times();
    let [start, end] = [joints[0], joints[joints.len() - 1]];
    let times = (0..count).map(|_| random.between(start, end));
    let times: Vec<f64> = joints.iter().copied().chain(times).collect();
    let placed = |time: f64| {
        let pose = scene.motion.pose_at_time(time);
        let corners = scene.shape.0.iter();
        corners.map(|&p| pose.transform_point3(p)).collect()
    };
    times.into_iter().map(|time| (time, placed(time))).collect()
}

/// Sweeps a scene.
pub(crate) fn sweep(random: &mut Random) -> Outcome {
    let scene = scene(random);
    let size = scene.mesh.transformed(scene.motion.start_pose()).diagonal();
    let tolerance = match random.below(24) {
        0 => Some(1e-17 * size),
        1 => Some(3.0 * size),
        2 => None,
        _ => Some(size * random.one_of(&[0.3, 0.1, 0.05, 0.02])),
    };
    let settings = SweepSettings::default()
        .with_tolerance(tolerance)
        .with_precision(random.one_of(&[Precision::Double, Precision::Single]));
    if is_alone() {
        println!("{settings:?}");
    }
    let swept = match steadysweep::sweep(&scene.mesh, &scene.motion, &settings) {
        Ok(swept) => swept,
        // The requested tolerance is too small, or single precision is used far from the origin.
        Err(SweepError::BelowRounding { .. }) => return Outcome::Refused,
        Err(error) => return Outcome::Wrong(format!("refused: {error}")),
    };
    let mut defects = Vec::new();
    let mut law = |is_kept: bool, what: String| {
        if !is_kept {
            defects.push(what);
        }
    };
    let measures = swept.solid.measures();
    let [low, high] = measures.bounds;
    law(
        measures.volume.is_finite() && measures.volume >= 0.0,
        format!("volume {}", measures.volume),
    );
    law(measures.area.is_finite(), format!("area {}", measures.area));
    law(
        low.is_finite() && high.is_finite(),
        format!("from {low} to {high}"),
    );
    law(
        measures.watertight && measures.manifold,
        format!("{measures:?}"),
    );
    let meetings = SurfaceTree::new(swept.solid.positions(), swept.solid.triangles()).meetings();
    law(
        meetings.is_empty() && swept.crossings == 0,
        format!("{} pairs of triangles cross or touch", meetings.len()),
    );
    let bound = swept.error_bound;
    for bound in [bound.inside, bound.outside] {
        law(
            bound.length.is_finite() && bound.length >= 0.0,
            format!("{bound:?}"),
        );
    }
    let corners = at_times(&scene, random, 5);
    let reach = corners.iter().flat_map(|(_, corners)| corners);
    let largest = reach.fold(0.0, |largest: f64, p| largest.max(p.abs().max_element()));
    // Error of positions: some hundred roundings.
    let slack = 1e-13 * largest;
    let inside = bound.inside.length + slack;
    for (time, corners) in &corners {
        for corner in corners {
            law(
                (low - inside).cmple(*corner).all() && corner.cmple(high + inside).all(),
                format!("{corner} at {time} is outside of {low} to {high} by more than {inside:e}"),
            );
        }
    }
    let membership = Membership::new(&scene.mesh, &scene.motion);
    let solid: Shape = (
        swept.solid.positions().to_vec(),
        swept.solid.triangles().to_vec(),
    );
    for _ in 0..6 {
        let point = if random.chance(0.5) || solid.1.is_empty() {
            low + (high - low) * (random.point(0.6) + 0.5)
        } else {
            let corner = solid.0[random.below(solid.0.len())];
            corner + random.direction() * random.between(0.0, 4.0) * inside.max(1e-3 * scene.unit)
        };
        let is_swept = membership.is_ever_inside(point);
        let is_found = winding_number(&solid, point) != 0;
        let off = distance(&solid, point);
        if is_swept && !is_found {
            law(
                off <= inside,
                format!("{point:?} is missing by {off:e}, stated {inside:e}"),
            );
        }
        let outside = bound.outside.length + slack;
        if is_found && !is_swept && off > outside {
            // Then it must be near the sweep itself, because a void was filled.
            let near = (0..2000).any(|_| {
                let ball = random.direction() * random.unit().cbrt() * 1.1 * outside;
                membership.is_ever_inside(point + ball)
            });
            law(
                near,
                format!("{point:?} is too much, {off:e} deep, stated {outside:e}"),
            );
        }
    }
    Outcome::of(defects)
}

/// Probes points that are special to a scene.
pub(crate) fn probe(random: &mut Random) -> Outcome {
    let scene = scene(random);
    let membership = Membership::new(&scene.mesh, &scene.motion);
    let joints = scene.motion.joint_times();
    let [start, end] = [joints[0], joints[joints.len() - 1]];
    let placed = at_times(&scene, random, 3);
    let corners = placed.iter().flat_map(|(_, corners)| corners);
    let corners = corners.chain(&scene.shape.0);
    let largest = corners.fold(0.0, |largest: f64, p| largest.max(p.abs().max_element()));
    let mut defects = Vec::new();
    for _ in 0..12 {
        let (_, corners) = &placed[random.below(placed.len())];
        let shape = (corners.clone(), scene.shape.1.clone());
        let point = match random.below(4) {
            0 => corners[random.below(corners.len())] + random.direction() * 0.3 * scene.unit,
            _ => special_point(random, &shape),
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
            let seen = inverse.transform_point3(point);
            let is_inside = winding_number(&scene.shape, seen) >= 1;
            let is_found = intervals
                .iter()
                .any(|[from, to]| (*from..=*to).contains(&time));
            let off = distance(&scene.shape, seen);
            if is_found && is_at_joint(joints, time) {
                continue;
            }
            // Rounding decides nearer than this: positions relative to the body are accurate to
            // some hundred roundings.
            let columns = [0, 1, 2].map(|axis| inverse.matrix3.col(axis).length());
            let growth = columns.iter().sum::<f64>().max(1.0);
            let largest = growth * largest.max(point.abs().max_element());
            if is_inside != is_found && off > 1e-11 * largest {
                defects.push(format!(
                    "{point:?} at {time}: found inside {is_found}, seen at {seen:?}, {off:e} from the surface; {intervals:?}"
                ));
            }
        }
    }
    Outcome::of(defects)
}
