//! Half-spaces as obstacles: against dense samples of the least height, closed forms, and the
//! command line.

use crate::support::command::{CUBE, Run, Scratch};
use crate::support::random::Random;
use crate::support::shapes::icosphere;
use crate::support::sweep::{mesh, screw};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::PI;
use steadysweep::body::Mesh;
use steadysweep::collision::{
    Check, CheckError, CheckSettings, ContactRule, Feature, FirstContact, Plane, Shape,
    ShapeObstacle, Touch, Verdict, check_shapes, distance_at,
};
use steadysweep::motion::following::{self, Follow};
use steadysweep::motion::scheme::{Keyed, Scheme};
use steadysweep::motion::{Generator, HalfTurns, Keyframe, Motion, Span};

fn chain(spans: &[Generator]) -> Motion {
    let spans = spans
        .iter()
        .map(|&generator| Span::new(generator, 1.0).expect("a span"));
    Motion::from_spans(spans.collect()).expect("a motion")
}

fn plane(point: [f64; 3], normal: [f64; 3]) -> Plane {
    Plane::new(DVec3::from_array(point), DVec3::from_array(normal)).expect("a plane")
}

/// A half-space with its motion.
struct Ground {
    plane: Plane,
    motion: Option<Motion>,
}

impl Ground {
    /// The least height of the vertices of a body at a time: the slow reference.
    fn least_height(&self, body: &Mesh, motion: &Motion, time: f64) -> f64 {
        let pose = motion.pose_at_time(time);
        let (point, normal) = match &self.motion {
            // A rigid motion turns the normal.
            Some(own) => {
                let own = own.pose_at_time(time);
                (
                    own.transform_point3(self.plane.point()),
                    own.transform_vector3(self.plane.normal()),
                )
            }
            None => (self.plane.point(), self.plane.normal()),
        };
        let heights = body
            .positions()
            .iter()
            .map(|&p| normal.dot(pose.transform_point3(p) - point));
        heights.fold(f64::INFINITY, f64::min)
    }

    fn check(&self, body: &Mesh, motion: &Motion, settings: &CheckSettings) -> Check {
        let shape = Shape::half_space(&self.plane);
        let obstacle = ShapeObstacle {
            shape: &shape,
            motion: self.motion.as_ref(),
        };
        check_shapes(&Shape::from(body), motion, &[obstacle], settings).expect("a check")
    }
}

/// Heights nearer to the level than this are not compared.
const ROUNDING: f64 = 1e-11;

/// Compares a check with samples of the least height over `level`. Returns a letter for the verdict.
fn compare(
    ground: &Ground,
    body: &Mesh,
    motion: &Motion,
    rule: ContactRule,
    clearance: f64,
) -> char {
    let settings = CheckSettings::default()
        .with_clearance(clearance)
        .with_rules(vec![rule])
        .with_all_intervals();
    let found = ground.check(body, motion, &settings);
    let level = match rule {
        ContactRule::Enter { depth } => -depth.expect("a depth"),
        _ => clearance,
    };
    let times = motion.joint_times();
    let [start, end] = [times[0], times[times.len() - 1]];
    let samples: Vec<(f64, f64)> = (0..=2000)
        .map(|i| start + (end - start) * f64::from(i) / 2000.0)
        .map(|time| (time, ground.least_height(body, motion, time)))
        .collect();
    let least = samples.iter().map(|s| s.1).fold(f64::INFINITY, f64::min);
    let intervals = found.intervals.as_deref().expect("they were asked for");
    for &(time, height) in samples.iter().filter(|s| (s.1 - level).abs() > ROUNDING) {
        let near = |t: f64| (t - time).abs() < 1e-9;
        if intervals.iter().any(|i| i.times.into_iter().any(near)) {
            continue;
        }
        let within = intervals
            .iter()
            .any(|i| i.times[0] <= time && time <= i.times[1]);
        assert_eq!(
            within,
            height < level,
            "at {time}: {height} of {level}, {intervals:?}"
        );
    }
    let first = |first: &FirstContact| {
        let [from, by] = first.bracket;
        assert!(
            from <= first.time && first.time <= by && by - from < 1e-6,
            "{first:?}"
        );
        for &(_, height) in samples.iter().filter(|s| s.0 < from) {
            assert!(height > level - ROUNDING, "{height} before {first:?}");
        }
        let height = ground.least_height(body, motion, first.time);
        if first.touch != Touch::Inside {
            assert!(
                (height - level).abs() < 1e-9,
                "{height} of {level}: {first:?}"
            );
        }
        let Feature::Vertex(vertex) = first.features[0] else {
            panic!("{first:?}")
        };
        let place = motion.pose_at_time(first.time);
        let place = place.transform_point3(body.positions()[vertex as usize]);
        let foot = first.point + first.normal * height;
        assert!(foot.distance(place) < 1e-9, "{first:?}");
    };
    match &found.verdict {
        Verdict::Clear => {
            assert!(least > level - ROUNDING, "{least} of {level}");
            if rule == ContactRule::Touch {
                let clearance = &found.clearance;
                assert!(
                    clearance.lower <= least && clearance.upper <= 1.0011 * least + ROUNDING,
                    "{clearance:?} of {least}"
                );
                assert!(clearance.lower >= 0.9989 * clearance.upper, "{clearance:?}");
                let seen = ground.least_height(body, motion, clearance.time);
                assert!(
                    (seen - clearance.upper).abs() < 1e-9,
                    "{clearance:?}: {seen}"
                );
                let [a, b] = clearance.points;
                assert!(
                    (a.distance(b) - clearance.upper).abs() < 1e-9,
                    "{clearance:?}"
                );
            }
            'c'
        }
        Verdict::Contact(contact) => {
            assert!(least < level + ROUNDING, "{least} of {level}");
            first(contact);
            if contact.touch == Touch::Inside {
                'i'
            } else {
                'h'
            }
        }
        Verdict::Closer(contact) => {
            assert!(
                least < level + ROUNDING && clearance > 0.0,
                "{least} of {level}"
            );
            first(contact);
            assert!(
                found.clearance.lower <= least.max(0.0),
                "{:?}",
                found.clearance
            );
            'n'
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn random_scenes_agree_with_dense_samples_of_the_least_height() {
    let verdicts: String = (0..120_u64)
        .into_par_iter()
        .map(|seed| {
            let mut random = Random::new(400 + seed);
            let (positions, triangles) = icosphere(1, 1.0, DVec3::ZERO);
            let squeeze = random.point(1.0).abs() + DVec3::splat(0.2);
            let body = mesh(&(
                positions.into_iter().map(|p| p * squeeze).collect(),
                triangles,
            ));
            let rigid = |random: &mut Random, speed: f64| {
                let turn = random.matrix(speed);
                Generator {
                    linear: turn - turn.transpose(),
                    offset: random.point(speed),
                }
            };
            let spans: Vec<Generator> = (0..1 + random.below(3))
                .map(|_| {
                    let mut generator = rigid(&mut random, 2.0);
                    if random.chance(0.4) {
                        generator.linear += random.matrix(0.3);
                    }
                    generator
                })
                .collect();
            let motion = chain(&spans);
            let normal = random.direction();
            let distance = random.between(-0.5, 8.0);
            let plane = Plane::new(-normal * distance, normal).expect("a plane");
            let own = random
                .chance(0.5)
                .then(|| chain(&[rigid(&mut random, 1.0), rigid(&mut random, 0.5)]));
            let ground = Ground { plane, motion: own };
            let depth = Some(random.between(0.05, 0.8));
            let clearance = random.between(0.1, 1.0);
            [
                compare(&ground, &body, &motion, ContactRule::Touch, 0.0),
                compare(&ground, &body, &motion, ContactRule::Touch, clearance),
                compare(&ground, &body, &motion, ContactRule::Enter { depth }, 0.0),
            ]
        })
        .flatten_iter()
        .collect();
    for verdict in "cihn".chars() {
        let count = verdicts.matches(verdict).count();
        assert!(count >= 10, "{count} of {verdict} in {verdicts}");
    }
}

#[test]
fn a_ball_that_falls_turns_and_slides_meets_the_floor_as_formulas_say() {
    let (positions, triangles) = icosphere(3, 1.0, DVec3::Z * 3.0);
    let body = mesh(&(positions, triangles));
    let ground = |z: f64| Ground {
        plane: plane([5.0, 7.0, z], [0.0, 0.0, 2.0]),
        motion: None,
    };
    let settings = CheckSettings::default();
    let down = Generator::translation(-4.0 * DVec3::Z);
    // The lowest vertex of this ball is at z = 2.
    let found = ground(0.0).check(&body, &chain(&[down]), &settings);
    let Verdict::Contact(first) = found.verdict else {
        panic!("{found:?}")
    };
    assert!(
        (first.time - 0.5).abs() < 1e-13 && first.touch == Touch::Enter,
        "{first:?}"
    );
    assert!(
        (first.point - DVec3::ZERO).length() < 1e-13 && first.normal == DVec3::Z,
        "{first:?}"
    );
    // It slides, touches and rests.
    for (spans, touch) in [
        (vec![Generator::translation(DVec3::X)], Touch::Slide),
        (vec![Generator::translation(DVec3::Z)], Touch::Touch),
        (vec![Generator::translation(-DVec3::Z)], Touch::Enter),
        (vec![Generator::translation(DVec3::ZERO)], Touch::Touch),
    ] {
        let found = ground(2.0).check(&body, &chain(&spans), &settings);
        let Verdict::Contact(first) = found.verdict else {
            panic!("{found:?}")
        };
        assert_eq!(
            (first.time, first.bracket, first.touch),
            (0.0, [0.0; 2], touch)
        );
    }
    // A pendulum about the y axis through the origin, straight up at first, and back: the distance
    // from the plane z = 0 is that of its lowest vertex, and 1e6 below it is 1e6 more.
    let swing = screw(DVec3::Y, DVec3::ZERO, 0.3, 0.0, 1.0);
    let motion = chain(&[swing, swing.scaled(-1.0)]);
    let lowest = |body: &Mesh| {
        (0..=1000)
            .map(|i| ground(0.0).least_height(body, &motion, f64::from(i) / 1000.0))
            .fold(f64::INFINITY, f64::min)
    };
    for far in [0.0, 1e6] {
        let found = ground(-far).check(&body, &motion, &settings);
        assert_eq!(found.verdict, Verdict::Clear);
        let expected = lowest(&body) + far;
        let clearance = found.clearance;
        assert!(
            clearance.lower <= expected && expected <= clearance.upper * (1.0 + 1e-6),
            "{clearance:?}"
        );
        assert!(
            clearance.lower >= 0.9989 * expected && clearance.limited.is_none(),
            "{clearance:?}"
        );
    }
    // A hundred turns beside a wall: the radius of the circle of the farthest vertex.
    let spin = screw(DVec3::Z, DVec3::X * 2.0, 200.0 * PI, 0.0, 1.0);
    let wall = |x: f64| Ground {
        plane: plane([x, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        motion: None,
    };
    let farthest = body
        .positions()
        .iter()
        .map(|p| (p.x - 2.0).hypot(p.y))
        .fold(0.0, f64::max);
    let found = wall(2.0 + farthest + 1e-9).check(&body, &chain(&[spin]), &settings);
    assert_eq!(found.verdict, Verdict::Clear, "by 1e-9");
    let found = wall(2.0 + farthest - 1e-9).check(&body, &chain(&[spin]), &settings);
    assert!(matches!(found.verdict, Verdict::Contact(_)), "{found:?}");
    let found = wall(2.0 + farthest + 0.5).check(&body, &chain(&[spin]), &settings);
    assert!(
        (found.clearance.lower - 0.5).abs() < 6e-4,
        "{:?}",
        found.clearance
    );
    // More turns than are searched at once: undecided, never clear.
    let spin = screw(DVec3::Z, DVec3::X * 2.0, 1e5, 0.0, 1.0);
    let found = wall(50.0).check(&body, &chain(&[spin]), &settings);
    assert!(
        matches!(found.verdict, Verdict::Undecided { .. }),
        "{found:?}"
    );
}

#[test]
fn half_spaces_and_surfaces_are_obstacles_side_by_side() {
    let body = mesh(&icosphere(2, 1.0, DVec3::ZERO));
    let wall = mesh(&icosphere(2, 1.0, DVec3::X * 5.0));
    let along = chain(&[Generator::translation(DVec3::X * 10.0)]);
    let [near, far] =
        [2.0, 8.0].map(|x| Shape::half_space(&plane([x, 0.0, 0.0], [-1.0, 0.0, 0.0])));
    let (body, wall) = (Shape::from(&body), Shape::from(&wall));
    let obstacle = |shape| ShapeObstacle {
        shape,
        motion: None,
    };
    let check = |obstacles: &[ShapeObstacle]| {
        let settings = CheckSettings::default().with_all_intervals();
        check_shapes(&body, &along, obstacles, &settings).expect("a check")
    };
    for (obstacles, first, time) in [
        (vec![obstacle(&wall), obstacle(&near)], 1, 0.1),
        (vec![obstacle(&far), obstacle(&wall)], 1, 0.3),
        (
            vec![obstacle(&far), obstacle(&near), obstacle(&wall)],
            1,
            0.1,
        ),
    ] {
        let found = check(&obstacles);
        let Verdict::Contact(contact) = found.verdict else {
            panic!("{found:?}")
        };
        assert_eq!(contact.obstacle, first);
        assert!((contact.time - time).abs() < 1e-9, "{contact:?}");
        let intervals = found.intervals.expect("asked for");
        let all: Vec<usize> = intervals.iter().map(|interval| interval.obstacle).collect();
        assert_eq!(all, (0..obstacles.len()).collect::<Vec<_>>(), "each once");
    }
    let closest = distance_at(
        &body,
        &along,
        &[obstacle(&wall), obstacle(&near)],
        &[],
        0.05,
    );
    assert!(
        (closest.distance - 0.5).abs() < 1e-12 && closest.obstacle == 1,
        "{closest:?}"
    );
    // A plane that is stretched is refused.
    let grows = chain(&[Generator {
        linear: DMat3::from_diagonal(DVec3::X),
        offset: DVec3::ZERO,
    }]);
    let obstacle = ShapeObstacle {
        shape: &near,
        motion: Some(&grows),
    };
    let refused = check_shapes(&body, &along, &[obstacle], &CheckSettings::default());
    assert_eq!(
        refused.err(),
        Some(CheckError::StretchedHalfSpace { obstacle: 0 })
    );
}

#[test]
fn motions_that_deviate_are_decided_where_that_changes_nothing() {
    // Between two poses every point moves along a straight line at constant speed.
    let turned = DAffine3::from_rotation_translation(DQuat::from_rotation_y(1.2), -4.0 * DVec3::Z);
    let keys =
        [(0.0, DAffine3::IDENTITY), (1.0, turned)].map(|(time, pose)| Keyframe { time, pose });
    let ball = icosphere(2, 1.0, DVec3::Z * 3.0);
    let follow = Follow {
        body: &ball.0,
        deviation: 1e-3,
    };
    let linear = Keyed::new(Scheme::Linear, &keys);
    let motion: Motion =
        following::keyframes(&linear, &HalfTurns::Refused, &follow).expect("a motion");
    let off = motion.deviation().expect("it deviates").length;
    let heights = |time: f64| {
        let height = |p: &DVec3| (1.0 - time) * p.z + time * turned.transform_point3(*p).z;
        ball.0.iter().map(height).fold(f64::INFINITY, f64::min)
    };
    let least = (0..=1000)
        .map(|i| heights(f64::from(i) / 1000.0))
        .fold(f64::INFINITY, f64::min);
    let floor = |z: f64| Ground {
        plane: plane([0.0, 0.0, z], [0.0, 0.0, 1.0]),
        motion: None,
    };
    let body = mesh(&ball);
    let settings = CheckSettings::default();
    let found = floor(least - 3.0 * off).check(&body, &motion, &settings);
    assert_eq!(found.verdict, Verdict::Clear);
    assert!(
        found.clearance.lower <= 3.0 * off && found.clearance.lower > 0.5 * off,
        "{found:?}"
    );
    let found = floor(least - 0.1 * off).check(&body, &motion, &settings);
    assert!(
        matches!(found.verdict, Verdict::Undecided { .. }),
        "{found:?}"
    );
    let found = floor(0.0).check(&body, &motion, &settings);
    let Verdict::Contact(first) = found.verdict else {
        panic!("{found:?}")
    };
    let [from, by] = first.bracket;
    assert!(heights(from) > 0.0 && heights(by) < 0.0, "{first:?}");
    assert!(by - from < 3.0 * off, "{first:?}");
    // The motion of a half-space must not deviate.
    let shape = Shape::half_space(&plane([0.0; 3], [0.0, 0.0, 1.0]));
    let obstacle = ShapeObstacle {
        shape: &shape,
        motion: Some(&motion),
    };
    let refused = check_shapes(&Shape::from(&body), &motion, &[obstacle], &settings);
    assert_eq!(refused.err(), Some(CheckError::DeviatingHalfSpace));
}

/// Runs a check of the unit cube with `--json`.
fn checked(scratch: &Scratch, arguments: &str) -> (Value, Option<i32>) {
    let Run { code, out, err } = scratch.run(&format!("check cube.obj {arguments} --json"));
    assert_eq!(err, "", "{arguments}: nothing on stderr");
    let report = serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}"));
    (report, code)
}

#[test]
fn planes_on_the_command_line_are_obstacles_like_any_other() {
    let scratch = Scratch::new("half_spaces");
    scratch.write("cube.obj", CUBE);
    scratch.write("wall.obj", "v 3 -1 -1\nv 3 2 -1\nv 3 2 2\nf 1 2 3\n");
    let up = r#"{"keyframes": [{"time": 0, "translation": [0, 0, 0]}, {"time": 1, "translation": [0, 0, 1]}]}"#;
    scratch.write("up.json", up);
    // The cube falls by 4 from 0 to 1 onto a floor at z = -1.
    let (report, code) = checked(&scratch, "--translate 0,0,-4 --plane 0,0,-1,0,0,3");
    assert_eq!((&report["verdict"], code), (&json!("contact"), Some(1)));
    assert!(
        (report["time"].as_f64().expect("a time") - 0.25).abs() < 1e-12,
        "{report}"
    );
    assert_eq!(
        report["obstacle"],
        json!({"file": null, "plane": 0, "index": 0})
    );
    assert_eq!(report["features"]["obstacle"], json!({"plane": 0}));
    let vertex = report["features"]["body"]["vertex"].as_u64();
    assert!(vertex.is_some_and(|vertex| vertex < 8), "{report}");
    assert_eq!(report["normal"], json!([0.0, 0.0, 1.0]));
    assert_eq!(report["touch"], "enter");
    let obstacle = &report["obstacles"][0];
    let expected = json!({"number": 0, "point": [0.0, 0.0, -1.0], "normal": [0.0, 0.0, 1.0]});
    assert_eq!(
        (&obstacle["plane"], &obstacle["file"]),
        (&expected, &Value::Null)
    );
    // Beside a wall, and with a motion of the plane that it meets half way: -4 t = -1 + t.
    let (report, _) = checked(
        &scratch,
        "--translate 0,0,-4 --plane 0,0,-1,0,0,1 --against-motion up.json --against wall.obj --intervals",
    );
    assert!(
        (report["time"].as_f64().expect("a time") - 0.2).abs() < 1e-12,
        "{report}"
    );
    assert_eq!(report["obstacles"][0]["motion"], "up.json");
    let end = &report["obstacles"][0]["intervals"][0][1];
    assert_eq!(
        (end, &report["obstacles"][1]["intervals"]),
        (&json!(1.0), &json!([]))
    );
    assert!(report["obstacle_pose"].is_array(), "{report}");
    // Clear, with a clearance and a table.
    let (report, code) = checked(
        &scratch,
        "--translate 0,0,-4 --plane 0,0,-5,0,0,1 --plane 9,0,0,-1,0,0 --clearance 0.5 --csv d.csv",
    );
    assert_eq!((&report["verdict"], code), (&json!("clear"), Some(0)));
    let clearance = &report["clearance"];
    assert_eq!(clearance["upper"], json!(1.0), "{report}");
    assert!(
        clearance["lower"].as_f64().is_some_and(|x| x > 0.999),
        "{report}"
    );
    assert_eq!(
        clearance["obstacle"],
        json!({"file": null, "plane": 0, "index": 0})
    );
    let table = std::fs::read_to_string(scratch.path().join("d.csv")).expect("a table");
    let last = table.lines().last().expect("lines");
    assert!(last.starts_with("1.0,1.0,plane0,"), "{last}");
    // Closer than a clearance: 5 - 4 t = 3.
    let (report, code) = checked(
        &scratch,
        "--translate 0,0,-4 --plane 0,0,-5,0,0,1 --clearance 3",
    );
    assert_eq!((&report["verdict"], code), (&json!("closer"), Some(1)));
    assert!(
        (report["time"].as_f64().expect("a time") - 0.5).abs() < 1e-12,
        "{report}"
    );
    // It stands on the floor, and enters it by 0.5 at half time.
    let (report, _) = checked(
        &scratch,
        "--translate 0,0,-1 --plane 0,0,0,0,0,1 --touching plane0 --depth 0.5",
    );
    assert_eq!(
        (&report["verdict"], &report["depth"]),
        (&json!("contact"), &json!(0.5))
    );
    assert!(
        (report["time"].as_f64().expect("a time") - 0.5).abs() < 1e-12,
        "{report}"
    );
    let (report, code) = checked(
        &scratch,
        "--translate 1,0,0 --plane 0,0,0,0,0,1 --contact enter",
    );
    assert_eq!((&report["verdict"], code), (&json!("clear"), Some(0)));
    let (report, _) = checked(&scratch, "--translate 1,0,0 --plane 0,0,0,0,0,1");
    assert_eq!(
        (&report["touch"], &report["time"]),
        (&json!("slide"), &json!(0.0))
    );
    let text = scratch
        .run("check cube.obj --translate 0,0,-4 --plane 0,0,-1,0,0,1")
        .out;
    for part in [
        "against plane0: through (0, 0, -1), normal (0, 0, 1), solid behind it\n",
        "CONTACT with plane0 at time 0.25\n",
        " of the body meets plane0 (as the file counts, from 0)\n",
    ] {
        assert!(text.contains(part), "{part:?} is missing: {text}");
    }
    for (arguments, expected) in [
        ("--plane 0,0,0,0,0,0", "has no direction"),
        ("--plane 0,0,0,0,1", "six numbers X,Y,Z,NX,NY,NZ"),
        (
            "--plane 0,0,0,0,0,1 --allow plane0",
            "nothing is left to check",
        ),
        ("--plane 0,0,0,0,0,1 --touching plane1", "known is plane0"),
        ("", "--against"),
    ] {
        let run = scratch.run(&format!("check cube.obj --translate 0,0,1 {arguments}"));
        assert_eq!(run.code, Some(2), "{arguments}: {}", run.out);
        assert!(run.err.contains(expected), "{arguments}: {}", run.err);
    }
}
