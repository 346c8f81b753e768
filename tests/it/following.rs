//! Motions that are not steady, followed by chains of steady spans: the deviation against a plain
//! evaluation of each scheme, written down from its definition.
//!
//! `FOLLOWED_MOTIONS=200 cargo test --test it following::deviations` does 200 motions of each scheme,
//! at 10,000 points and times each, in minutes; the ordinary run does 40 at fewer times.

use crate::support::random::Random;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use std::f64::consts::PI;
use steadysweep::body::{Mesh, Surface};
use steadysweep::bounds::SurfaceTree;
use steadysweep::collision::{CheckSettings, Obstacle, Verdict, check};
use steadysweep::membership::Membership;
use steadysweep::motion::following::{self, Follow};
use steadysweep::motion::scheme::{Keyed, Scheme};
use steadysweep::motion::{Generator, HalfTurns, Keyframe, Motion, MotionError, Span, planar};
use steadysweep::{SweepSettings, sweep};

/// Number of motions of each scheme in the ordinary run: some seconds.
const ORDINARY: u64 = 40;

/// exp by its Taylor series after halving, and by squaring.
fn exponential(matrix: &DMat4) -> DMat4 {
    let small = *matrix * (0.5_f64).powi(10);
    let (mut term, mut sum) = (DMat4::IDENTITY, DMat4::IDENTITY);
    for k in 1..20 {
        term = term * small * (1.0 / f64::from(k));
        sum += term;
    }
    for _ in 0..10 {
        sum = sum * sum;
    }
    sum
}

/// log by square roots (Denman & Beavers) and a Taylor series.
fn plain_logarithm(matrix: &DMat4) -> DMat4 {
    let mut root = *matrix;
    for _ in 0..12 {
        let (mut y, mut z) = (root, DMat4::IDENTITY);
        for _ in 0..40 {
            (y, z) = ((y + z.inverse()) * 0.5, (z + y.inverse()) * 0.5);
        }
        root = y;
    }
    let small = root - DMat4::IDENTITY;
    let (mut power, mut sum) = (DMat4::IDENTITY, DMat4::ZERO);
    for k in 1..16 {
        power *= small;
        sum += power * (if k % 2 == 1 { 1.0 } else { -1.0 } / f64::from(k));
    }
    sum * 4096.0
}

/// The rotation nearest to a matrix: the limit of the mean of R and its inverse transpose.
fn nearest_rotation(linear: &DMat3) -> DMat3 {
    (0..100).fold(*linear, |r, _| (r + r.inverse().transpose()) * 0.5)
}

fn linear(matrix: &DMat3) -> DMat4 {
    DMat4::from_mat3(*matrix)
}

fn to_matrix(pose: &DAffine3) -> DMat4 {
    DMat4::from(*pose)
}

/// The pose at u between two poses, from the definition of the scheme.
fn plain_pose(scheme: Scheme, ends: &[DAffine3; 2], u: f64) -> DMat4 {
    let mix = |a: DMat4, b: DMat4| a * (1.0 - u) + b * u;
    let poses = ends.map(|pose| to_matrix(&pose));
    let rotations = ends.map(|pose| nearest_rotation(&pose.matrix3));
    let stretches = [0, 1].map(|i| linear(&(rotations[i].transpose() * ends[i].matrix3)));
    let shift = DMat4::from_translation(ends[0].translation.lerp(ends[1].translation, u));
    let turned = || {
        let [from, to] = rotations.map(|rotation| DQuat::from_mat3(&rotation));
        DMat4::from_quat(from.slerp(to, u))
    };
    let both = |found: [DMat4; 2]| exponential(&mix(found[0], found[1]));
    match scheme {
        Scheme::Linear => mix(poses[0], poses[1]),
        Scheme::Polar => shift * turned() * mix(stretches[0], stretches[1]),
        Scheme::Asap => shift * turned() * both(stretches.map(|s| plain_logarithm(&s))),
        Scheme::PolarLog => {
            let turn = both(rotations.map(|r| plain_logarithm(&linear(&r))));
            shift * turn * both(stretches.map(|s| plain_logarithm(&s)))
        }
        Scheme::Log => both(poses.map(|pose| plain_logarithm(&pose))),
        Scheme::Spiral => {
            let similar = [0, 1].map(|i| {
                let scale = ends[i].matrix3.determinant().cbrt();
                DMat4::from_translation(ends[i].translation) * linear(&(rotations[i] * scale))
            });
            let rest = [0, 1].map(|i| similar[i].inverse() * poses[i]);
            let whole = plain_logarithm(&(similar[1] * similar[0].inverse()));
            exponential(&(whole * u)) * similar[0] * mix(rest[0], rest[1])
        }
        _ => exponential(&(plain_logarithm(&(poses[1] * poses[0].inverse())) * u)) * poses[0],
    }
}

/// A pose with a turn below `most`, stretches from 1/2 to 2 in any directions, and an offset.
fn any_pose(random: &mut Random, most: f64) -> DAffine3 {
    let turn = DQuat::from_axis_angle(random.direction(), random.between(0.0, most));
    let along = DMat3::from_quat(DQuat::from_axis_angle(random.direction(), 1.0));
    let sizes = DVec3::from_array([0, 1, 2].map(|_| random.magnitude(0.5, 2.0)));
    let stretch = along * DMat3::from_diagonal(sizes) * along.transpose();
    DAffine3 {
        matrix3: DMat3::from_quat(turn) * stretch,
        translation: random.point(5.0),
    }
}

fn corners(random: &mut Random) -> Vec<DVec3> {
    let (low, size) = (random.point(2.0), random.point(1.0).abs() + 0.1);
    let corner = |i: usize| {
        let side = DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        low + size * side
    };
    (0..8).map(corner).collect()
}

fn key(time: f64, pose: DAffine3) -> Keyframe {
    Keyframe { time, pose }
}

fn follow(
    scheme: Scheme,
    keys: &[Keyframe],
    body: &[DVec3],
    deviation: f64,
) -> Result<Motion, MotionError> {
    let follow = Follow { body, deviation };
    following::keyframes(&Keyed::new(scheme, keys), &HalfTurns::Refused, &follow)
}

/// Largest distance of points of the body from their places by the scheme.
fn seen(motion: &Motion, scheme: Scheme, ends: &[DAffine3; 2], body: &[DVec3], steps: u32) -> f64 {
    let mut seen = 0.0_f64;
    for step in 0..=steps {
        let u = f64::from(step) / f64::from(steps);
        let (given, chain) = (plain_pose(scheme, ends, u), motion.pose_at_time(u));
        for &point in body {
            let gap = given
                .transform_point3(point)
                .distance(chain.transform_point3(point));
            seen = seen.max(gap);
        }
    }
    seen
}

/// Expected before the run: never exceeded, and at most three times the largest distance seen.
#[test]
fn deviations_of_schemes_hold_and_are_not_loose() {
    let schemes = [
        Scheme::Linear,
        Scheme::Polar,
        Scheme::Asap,
        Scheme::PolarLog,
        Scheme::Log,
        Scheme::Spiral,
    ];
    let asked = std::env::var("FOLLOWED_MOTIONS").ok();
    let count: u64 = asked.map_or(ORDINARY, |text| text.parse().expect("a number"));
    let (mut loosest, mut refused) = (0.0_f64, 0);
    for scheme in schemes {
        for number in 0..count {
            let mut random = Random::new(number);
            let poses = [1.4, 1.4].map(|most| any_pose(&mut random, most));
            let body = corners(&mut random);
            let deviation = random.magnitude(1e-4, 0.3);
            let keys = [key(0.0, poses[0]), key(1.0, poses[1])];
            let motion = match follow(scheme, &keys, &body, deviation) {
                Ok(motion) => motion,
                Err(error) => {
                    println!("{scheme:?} {number}: {error}");
                    refused += 1;
                    continue;
                }
            };
            let found = motion.deviation().expect("it stands for another motion");
            assert!(
                found.proven && found.length <= deviation,
                "{scheme:?} {number}"
            );
            // Eight corners at each time.
            let steps = if count > ORDINARY {
                1250
            } else {
                u32::try_from(24 * motion.spans().len())
                    .expect("few")
                    .min(1200)
            };
            let seen = seen(&motion, scheme, &poses, &body, steps);
            let what = format!(
                "{scheme:?} {number}: {seen:e} of {:e}, {} spans within {deviation:e}",
                found.length,
                motion.spans().len()
            );
            assert!(seen <= found.length, "{what}");
            assert!(seen >= found.length / 3.0, "loose: {what}");
            assert!(
                seen >= 0.4 * deviation || motion.spans().len() < 3,
                "too many spans: {what}"
            );
            loosest = loosest.max(found.length / seen);
        }
    }
    println!("at most {loosest} times too large, {refused} refused");
    assert!(refused * 20 <= 6 * count, "{refused} refused");
}

/// The box with the corners of [`corners`].
fn mesh(corners: &[DVec3]) -> Mesh {
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Mesh::new(corners.to_vec(), triangles.collect()).expect("a box")
}

fn wall(x: f64) -> Surface {
    let corners = [[x, -99.0, -99.0], [x, 199.0, -99.0], [x, -99.0, 199.0]];
    let corners = corners.map(DVec3::from_array).to_vec();
    Surface::new(corners, vec![[0, 1, 2]]).expect("a triangle")
}

/// A box that moves by SLERP and LERP towards a wall: the first time at which one of its corners
/// really reaches the wall is in the bracket; a wall beyond its reach is clear, with a lower bound
/// of the distance; and the chain alone decides nothing within its deviation.
#[test]
fn checks_hold_for_the_motion_that_is_followed() {
    let scheme = Scheme::Polar;
    let mut verdicts = [0; 3];
    for number in 0..150 {
        let mut random = Random::new(number);
        let poses = [1.4, 1.4].map(|most| any_pose(&mut random, most));
        let body = corners(&mut random);
        let keys = [key(0.0, poses[0]), key(1.0, poses[1])];
        let deviation = random.magnitude(1e-3, 0.1);
        let motion = follow(scheme, &keys, &body, deviation).expect("legal");
        let reach = |u: f64| {
            let pose = plain_pose(scheme, &poses, u);
            let places = body.iter().map(|&x| pose.transform_point3(x).x);
            places.fold(f64::NEG_INFINITY, f64::max)
        };
        let steps = 2000;
        let times = (0..=steps).map(|step| f64::from(step) / f64::from(steps));
        let farthest = times.clone().map(reach).fold(f64::NEG_INFINITY, f64::max);
        let nearest = times.clone().map(reach).fold(f64::INFINITY, f64::min);
        // Somewhere between: also next to the farthest point.
        let x = match number % 3 {
            0 => random.between(reach(0.0) + 1e-3, farthest.max(reach(0.0) + 2e-3)),
            1 => farthest + deviation * random.between(-1.0, 1.0),
            _ => farthest + random.between(0.0, farthest - nearest + 1.0),
        };
        if x <= reach(0.0) {
            continue;
        }
        let surface = wall(x);
        let obstacle = Obstacle {
            surface: &surface,
            motion: None,
        };
        let found = check(
            &mesh(&body),
            &motion,
            &[obstacle],
            &CheckSettings::default(),
        );
        let found = found.expect("legal");
        let what = format!("{number}: wall at {x}, farthest {farthest}, within {deviation:e}");
        let first = times.clone().find(|&time| reach(time) >= x);
        match found.verdict {
            Verdict::Clear => {
                verdicts[0] += 1;
                assert!(farthest < x, "{what}");
                let gap = x - farthest;
                assert!(
                    found.clearance.lower <= gap,
                    "{what}: {:?}",
                    found.clearance
                );
                assert!(
                    found.clearance.upper >= gap - 1e-5,
                    "{what}: {:?}",
                    found.clearance
                );
                // The least distance of the chain is proven to a thousandth of it.
                let room = found.clearance.upper - found.clearance.lower;
                assert!(
                    room <= 2.01 * deviation + 2e-3 * found.clearance.upper,
                    "{what}"
                );
            }
            Verdict::Contact(contact) => {
                verdicts[1] += 1;
                let [from, to] = contact.bracket;
                let first = first.expect("a contact that is none");
                assert!(
                    from <= first && first - 1.0 / f64::from(steps) <= to,
                    "{what}: {contact:?}"
                );
            }
            Verdict::Undecided { window, .. } => {
                verdicts[2] += 1;
                assert!((farthest - x).abs() <= 2.0 * deviation + 1e-6, "{what}");
                assert!(first.is_none_or(|first| first >= window[0]), "{what}");
            }
            Verdict::Closer(_) => panic!("{what}: no clearance was asked for"),
        }
    }
    println!("clear, contact, undecided: {verdicts:?}");
    assert!(verdicts.iter().all(|&count| count >= 10), "{verdicts:?}");
}

/// Points that are inside under the true motion are in the solid or within its bound, and what
/// `probe` says for certain is true.
#[test]
fn sweeps_and_probes_hold_for_the_motion_that_is_followed() {
    let mut certain = [0; 3];
    let schemes = [Scheme::Linear, Scheme::Polar, Scheme::Log].into_iter();
    for (number, scheme) in (0..24).zip(schemes.cycle()) {
        let mut random = Random::new(100 + number);
        let poses = [0.9, 0.9].map(|most| any_pose(&mut random, most));
        let corners = corners(&mut random);
        let body = mesh(&corners);
        let keys = [key(0.0, poses[0]), key(1.0, poses[1])];
        let deviation = random.magnitude(3e-3, 0.1);
        let motion = follow(scheme, &keys, &corners, deviation).expect("legal");
        let settings = SweepSettings::default().with_tolerance(2.0 * deviation);
        let swept = sweep(&body, &motion, &settings).expect("a sweep");
        let bound = swept.error_bound;
        let length = motion.deviation().expect("followed").length;
        assert!(bound.inside.proven && bound.outside.proven, "{number}");
        assert!(
            bound.inside.length >= length && bound.outside.length >= length,
            "{number}"
        );
        let tree = SurfaceTree::new(swept.solid.positions(), swept.solid.triangles());
        let membership = Membership::new(&body, &motion);
        let poses: Vec<DMat4> = (0..=400)
            .map(|step| plain_pose(scheme, &poses, f64::from(step) / 400.0))
            .collect();
        let [low, high] = [corners[0], corners[7]];
        let is_inside = |place: DVec3, pose: &DMat4| {
            let at_home = pose.inverse().transform_point3(place);
            at_home.cmpge(low).all() && at_home.cmple(high).all()
        };
        for _ in 0..400 {
            let share = DVec3::new(random.unit(), random.unit(), random.unit());
            let pose = poses[random.below(401)];
            let place = pose.transform_point3(low + (high - low) * share);
            let is_in_solid = tree
                .winding_number(place)
                .is_none_or(|winding| winding != 0);
            let off = tree.distance_to_surface(place);
            assert!(
                is_in_solid || off <= bound.inside.length,
                "{number}: {off:e}, {bound:?}"
            );
            // A point nearby, which may be inside or not.
            let place = place + random.point(0.3);
            let truth = poses.iter().any(|pose| is_inside(place, pose));
            match membership.is_inside_for_certain(place, &membership.intervals(place)) {
                Some(true) => {
                    certain[0] += 1;
                    // Samples of the truth are some hundredths apart.
                    let near = poses.iter().any(|pose| {
                        let steps = [-0.03, 0.03].map(DVec3::splat);
                        truth || steps.iter().any(|&step| is_inside(place + step, pose))
                    });
                    assert!(near, "{number}: {place} is not inside");
                }
                Some(false) => {
                    certain[1] += 1;
                    assert!(!truth, "{number}: {place} is inside");
                }
                None => certain[2] += 1,
            }
        }
    }
    println!("inside, outside, open: {certain:?}");
    assert!(certain.iter().all(|&count| count >= 50), "{certain:?}");
}

/// A turn about an axis that moves along itself is a screw, whatever scheme says so.
#[test]
fn what_is_steady_has_one_span_and_no_deviation() {
    let mut random = Random::new(9);
    for _ in 0..50 {
        let (axis, angle) = (random.direction(), random.between(0.1, 3.0));
        let pose = DAffine3::from_rotation_translation(
            DQuat::from_axis_angle(axis, angle),
            axis * random.between(-3.0, 3.0),
        );
        let keys = [key(0.0, DAffine3::IDENTITY), key(2.0, pose)];
        let body = corners(&mut random);
        for scheme in [Scheme::Polar, Scheme::Asap, Scheme::PolarLog, Scheme::Log] {
            let motion = follow(scheme, &keys, &body, 1e-9).expect("legal");
            let deviation = motion.deviation().expect("followed").length;
            assert_eq!(
                motion.spans().len(),
                1,
                "{scheme:?} at {angle}: {deviation:e}"
            );
            assert!(deviation < 1e-11, "{scheme:?} at {angle}: {deviation:e}");
        }
    }
}

/// The law of short spans: m even spans deviate by max |A W' x| / (8 m^2). For SLERP about z with a
/// centre d in its straight path, W = \[theta J, R^-1 (c' - theta J c)\], and |A W' x| = theta |c'|
/// for every point of the body.
#[test]
fn the_law_of_short_spans_holds() {
    let (angle, way) = (1.2_f64, DVec3::new(3.0, 4.0, 0.0));
    let pose = DAffine3::from_rotation_translation(DQuat::from_rotation_z(angle), way);
    let keys = [key(0.0, DAffine3::IDENTITY), key(1.0, pose)];
    let body = [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 2.0, 1.0), DVec3::Z];
    let law = angle * way.length() / 8.0;
    for spans in [4.0, 16.0, 32.0] {
        let asked = law / (spans * spans) * 1.1;
        let motion = follow(Scheme::Polar, &keys, &body, asked).expect("legal");
        let count = motion.spans().len() as f64;
        assert_eq!(count, spans, "within {asked:e}");
        let found = motion.deviation().expect("followed").length;
        let ratio = found * count * count / law;
        assert!((0.99..1.2).contains(&ratio), "{count} spans: {ratio}");
    }
}

/// Ten thousand poses of a smooth path become as few spans as the path needs, and a recorded screw
/// one; the deviation is that from the recorded chain, at the same times.
#[test]
fn recorded_paths_are_thinned() {
    let body: Vec<DVec3> = corners(&mut Random::new(4));
    let pose = |s: f64| {
        let axis = DVec3::new((2.0 * s).sin(), (1.3 * s).cos(), 0.5).normalize();
        let turn = DQuat::from_axis_angle(axis, 2.0 * s);
        DAffine3::from_rotation_translation(turn, DVec3::new(4.0 * s, (3.0 * s).sin(), s * s))
    };
    let path = |count: u32| {
        let times = (0..=count).map(|i| f64::from(i) / f64::from(count));
        let keys: Vec<Keyframe> = times.map(|time| key(time, pose(time))).collect();
        Motion::from_keyframes(&keys).expect("legal")
    };
    let counts = [2_000, 10_000].map(|count| {
        let given = path(count);
        let follow = Follow {
            body: &body,
            deviation: 1e-3,
        };
        let motion = following::thinned(&given, &follow).expect("legal");
        let found = motion.deviation().expect("followed");
        assert!(found.proven && found.length <= 1e-3);
        let mut seen = 0.0_f64;
        for step in 0..=10_000 {
            let time = f64::from(step) / 10_000.0;
            let [a, b] = [&given, &motion].map(|motion| motion.pose_at_time(time));
            for &x in &body {
                seen = seen.max(a.transform_point3(x).distance(b.transform_point3(x)));
            }
        }
        assert!(
            seen <= found.length && found.length <= 3.0 * seen,
            "{seen:e} of {found:?}"
        );
        motion.spans().len()
    });
    println!("{counts:?} spans");
    assert!(
        counts[0].abs_diff(counts[1]) <= 2 && counts[1] < 120,
        "{counts:?}"
    );

    // Of one third of a turn, three whole turns, and the other way round, a spiral.
    let turns = [(2.0, 1.0), (6.0 * PI, 1.0), (-30.0, 2.0)];
    for (turn, scale) in turns {
        let screw = Generator::screw(DVec3::new(0.48, 0.6, 0.64), DVec3::X, turn, 5.0, scale);
        let span = Span::new(screw, 1.0).expect("legal");
        let screw = Motion::from_spans(vec![span]).expect("legal");
        let keys: Vec<Keyframe> = (0..=500)
            .map(|i| f64::from(i) / 500.0)
            .map(|time| key(time, screw.pose_at_time(time)))
            .collect();
        let recorded = Motion::from_keyframes(&keys).expect("legal");
        let follow = Follow {
            body: &body,
            deviation: 1e-9,
        };
        let motion = following::thinned(&recorded, &follow).expect("legal");
        assert_eq!(motion.spans().len(), 1, "a recorded screw by {turn}");
    }
}

/// A function of time is followed, but its deviation is an estimate, and nothing is decided by it.
#[test]
fn a_function_is_followed_by_an_estimate() {
    let body = corners(&mut Random::new(4));
    let pose = |time: f64| {
        let turn = DQuat::from_rotation_y(time.sin());
        DAffine3::from_rotation_translation(turn, DVec3::new(time, time.cos(), 0.0))
    };
    let follow = Follow {
        body: &body,
        deviation: 1e-3,
    };
    let motion: Motion = following::function(pose, [1.0, 4.0], &follow).expect("legal");
    let found = *motion.deviation().expect("followed");
    assert!(!found.proven && found.length <= 1e-3, "{found:?}");
    for step in 0..=3000 {
        let time = 1.0 + f64::from(step) / 1000.0;
        let (given, chain) = (pose(time), motion.pose_at_time(time));
        for &x in &body {
            let gap = given
                .transform_point3(x)
                .distance(chain.transform_point3(x));
            assert!(gap <= found.length, "{gap:e} at {time}");
        }
    }
    let surface = wall(1e3);
    let obstacle = Obstacle {
        surface: &surface,
        motion: None,
    };
    let found = check(
        &mesh(&body),
        &motion,
        &[obstacle],
        &CheckSettings::default(),
    );
    let verdict = found.expect("legal").verdict;
    assert!(matches!(verdict, Verdict::Undecided { .. }), "{verdict:?}");
    let swept = sweep(&mesh(&body), &motion, &SweepSettings::default()).expect("a sweep");
    assert!(!swept.error_bound.inside.proven && !swept.error_bound.outside.proven);
}

/// In the plane as in space.
#[test]
fn motions_of_the_plane_are_followed() {
    use glam::{DAffine2, DVec2};
    let body = [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]].map(DVec2::from_array);
    let ends = [
        DAffine2::IDENTITY,
        DAffine2::from_scale_angle_translation(DVec2::new(1.6, 0.7), 1.4, DVec2::new(4.0, 1.0)),
    ];
    let keys = [0, 1].map(|i| planar::Keyframe {
        time: i as f64,
        pose: ends[i],
    });
    let in_space = ends.map(|pose| {
        let mut matrix = DMat3::IDENTITY;
        matrix.x_axis = pose.matrix2.x_axis.extend(0.0);
        matrix.y_axis = pose.matrix2.y_axis.extend(0.0);
        // In the plane the similarity is the root of the determinant: so it is in space with this.
        matrix.z_axis.z = pose.matrix2.determinant().sqrt();
        DAffine3 {
            matrix3: matrix,
            translation: pose.translation.extend(0.0),
        }
    });
    for scheme in Scheme::ALL {
        let follow = Follow {
            body: &body,
            deviation: 1e-2,
        };
        let keyed = Keyed::new(scheme, &keys);
        let motion: planar::Motion =
            following::keyframes(&keyed, &HalfTurns::Refused, &follow).expect("legal");
        let found = motion.deviation().expect("followed").length;
        let mut seen = 0.0_f64;
        for step in 0..=500 {
            let time = f64::from(step) / 500.0;
            let (given, chain) = (
                plain_pose(scheme, &in_space, time),
                motion.pose_at_time(time),
            );
            for &x in &body {
                let place = given.transform_point3(x.extend(0.0)).truncate();
                seen = seen.max(place.distance(chain.transform_point2(x)));
            }
        }
        let what = format!(
            "{scheme:?}: {seen:e} of {found:e}, {} spans",
            motion.spans().len()
        );
        // The plain logarithm is good to 1e-11.
        assert!(seen <= found + 1e-11 && found <= 1e-2, "{what}");
        assert!(scheme == Scheme::Steady || found <= 3.0 * seen, "{what}");
    }
}

/// What cannot be followed is refused, and says why.
#[test]
fn what_cannot_be_followed_is_refused() {
    let body = corners(&mut Random::new(1));
    let poses = [DAffine3::IDENTITY, DAffine3::from_translation(DVec3::X)];
    let keys = [key(0.0, poses[0]), key(1.0, poses[1])];
    for deviation in [0.0, -1.0, 1e-16, f64::NAN] {
        let error = follow(Scheme::Polar, &keys, &body, deviation).expect_err("refused");
        assert!(
            matches!(error, MotionError::DeviationTooSmall { .. }),
            "{error}"
        );
    }
    // Along straight lines this body is a mirror image of itself from 1/3 to 1/2 of the time.
    let half = DAffine3::from_scale(DVec3::new(-1.0, -2.0, 1.0));
    let error = follow(Scheme::Linear, &[keys[0], key(1.0, half)], &body, 1e-2);
    let error = error.expect_err("refused").to_string();
    assert!(error.contains("flattened near time 0.33333"), "{error}");
    // A half turn from rest has two logarithms.
    let half = DAffine3::from_rotation_z(PI);
    for scheme in [Scheme::Log, Scheme::PolarLog] {
        let error = follow(scheme, &[keys[0], key(1.0, half)], &body, 1e-2).expect_err("refused");
        assert!(error.to_string().contains("--half-turn"), "{error}");
    }
    // A motion that is followed for one body says nothing of a larger one.
    let motion = follow(Scheme::Polar, &keys, &body, 1e-2).expect("legal");
    let larger: Vec<DVec3> = body.iter().map(|&corner| corner * 9.0).collect();
    let error = sweep(&mesh(&larger), &motion, &SweepSettings::default()).expect_err("refused");
    assert!(
        error.to_string().contains("do not contain the body"),
        "{error}"
    );
}
