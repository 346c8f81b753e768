//! How long does a first contact take, and which method misses it: this crate against
//! `parry3d-f64`, with its `cast_shapes_nonlinear` and with conservative advancement by its
//! `distance`, on the same scenes in the same run?
//!
//! A table of medians, 99th percentiles and worst cases over many scenes, with misses, is printed
//! first; rows of `benches/record` come from it. Then criterion times some typical scenes, with ids
//! `contact/<scene>/<method>`. For all methods, trees are built before the clock starts. Both
//! rivals get rigid motions only, since they support no others.

#[path = "../tests/it/support/mod.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod support;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec3;
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::{NonlinearRigidMotion, cast_shapes_nonlinear, distance};
use parry3d_f64::shape::TriMesh;
use std::hint::black_box;
use std::time::{Duration, Instant};
use steadysweep::body::{Mesh, Surface};
use steadysweep::collision::{CheckSettings, Measure, Shape, ShapeObstacle, Verdict, check_shapes};
use steadysweep::motion::{Generator, Motion};
use support::contact::pairs::{Kind, Pair, any_pair};
use support::contact::percentile;
use support::contact::reference::Slow;
use support::contact::scene::{self, Scene, moved, steady};
use support::random::Random;
use support::shapes;

/// Most triangles for which a rival is run: above, it would take longer than 20 s for a scene.
const CAST_UP_TO: usize = 1_000;
const ADVANCE_UP_TO: usize = 10_000;
/// Distance that the advancing loop takes for contact, and the number of steps after which it gives
/// up.
const CLOSE: f64 = 1e-7;
const STEPS: usize = 200_000;
/// Share of the time by which an answer may be late before it counts as such.
const LATE: f64 = 1e-3;

/// A scene with all that the methods need, prepared.
struct Prepared {
    motion: Motion,
    shapes: [Shape; 2],
    meshes: [TriMesh; 2],
    /// Motion of the body in the time from 0 to 1.
    rigid: NonlinearRigidMotion,
    fastest: f64,
    triangles: usize,
}

fn vector(v: DVec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

/// A screw: its axis, a point on it, the turn and the advance.
struct Screw {
    axis: DVec3,
    through: DVec3,
    turn: f64,
    advance: f64,
}

impl Screw {
    fn random(random: &mut Random, low: f64, high: f64) -> Screw {
        Screw {
            axis: random.direction(),
            through: random.point(1.0),
            turn: random.between(low, high).to_radians() * random.sign(),
            advance: random.between(-2.0, 2.0),
        }
    }

    fn motion(&self) -> Motion {
        let Screw {
            axis,
            through,
            turn,
            advance,
        } = *self;
        steady(Generator::screw(axis, through, turn, advance, 1.0))
    }
}

impl Prepared {
    fn new(scene: &Scene, screw: &Screw) -> Prepared {
        let obstacle = &scene.obstacles[0].shape;
        let mesh = |shape: &shapes::Shape| {
            TriMesh::new(
                shape.0.iter().map(|&p| vector(p)).collect(),
                shape.1.clone(),
            )
            .expect("a mesh")
        };
        let body = Mesh::new(scene.body.0.clone(), scene.body.1.clone()).expect("closed");
        let surface = Surface::new(obstacle.0.clone(), obstacle.1.clone()).expect("a surface");
        let reach = scene.body.0.iter().map(|p| {
            (*p - screw.through)
                .reject_from_normalized(screw.axis)
                .length()
        });
        Prepared {
            motion: scene.motion.clone(),
            shapes: [Shape::from(&body), Shape::new(&surface)],
            meshes: [mesh(&scene.body), mesh(obstacle)],
            rigid: NonlinearRigidMotion::new(
                Pose::IDENTITY,
                vector(screw.through),
                vector(screw.axis * screw.advance),
                vector(screw.axis * screw.turn),
            ),
            fastest: (reach.fold(0.0, f64::max) * screw.turn).hypot(screw.advance),
            triangles: scene.body.1.len().max(obstacle.1.len()),
        }
    }
}

/// The first contact in the time from 0 to 1; an error where a method gives up or is not run.
type Answer = Result<Option<f64>, ()>;
type Method = (&'static str, fn(&Prepared) -> Answer);

fn ours(scene: &Prepared, measure: Measure) -> Answer {
    let obstacles = [ShapeObstacle {
        shape: &scene.shapes[1],
        motion: None,
    }];
    let settings = CheckSettings::default().with_measure(measure);
    let check = check_shapes(&scene.shapes[0], &scene.motion, &obstacles, &settings);
    let duration = scene.motion.spans()[0].duration();
    match check.map_err(|_| ())?.verdict {
        Verdict::Clear => Ok(None),
        Verdict::Contact(found) => Ok(Some(found.time / duration)),
        _ => Err(()),
    }
}

fn cast(scene: &Prepared) -> Answer {
    if scene.triangles > CAST_UP_TO {
        return Err(());
    }
    let still = NonlinearRigidMotion::constant_position(Pose::IDENTITY);
    let [a, b] = &scene.meshes;
    cast_shapes_nonlinear(&scene.rigid, a, &still, b, 0.0, 1.0, true)
        .map(|hit| hit.map(|hit| hit.time_of_impact))
        .map_err(|_| ())
}

/// No point moves faster than the fastest one: within the distance divided by that speed there is
/// no contact.
fn advance(scene: &Prepared) -> Answer {
    if scene.triangles > ADVANCE_UP_TO {
        return Err(());
    }
    let [a, b] = &scene.meshes;
    let mut time = 0.0;
    for _ in 0..STEPS {
        let pose = scene.rigid.position_at_time(time);
        let apart = distance(&pose, a, &Pose::IDENTITY, b)
            .map_err(|_| ())?
            .distance;
        if apart <= CLOSE {
            return Ok(Some(time));
        }
        time += apart / scene.fastest;
        if time > 1.0 {
            return Ok(None);
        }
    }
    Err(())
}

const METHODS: [Method; 4] = [
    ("steadysweep", |scene| ours(scene, Measure::Verdict)),
    ("steadysweep with distance", |scene| {
        ours(scene, Measure::Distance)
    }),
    ("parry cast_shapes_nonlinear", cast),
    ("advancing by parry distance", advance),
];

/// Scenes of up to 120 x 120 triangles in the families of the published ones.
fn small_scenes() -> Vec<(Scene, Screw)> {
    let mut scenes = Vec::new();
    for seed in 0..120_u64 {
        let mut random = Random::new(4_000_000 + seed);
        let random = &mut random;
        let mesh = |random: &mut Random| {
            let shape = match random.below(6) {
                0 => scene::brick(DVec3::new(1.0, 0.7, 0.5)),
                1 => scene::brick(DVec3::new(2.0, 0.3, 0.02)),
                2 => shapes::icosphere(1, 0.7, DVec3::ZERO),
                3 => scene::star(random, 1),
                4 => shapes::torus(0.7, 0.25, 10, 6),
                _ => scene::comb(5),
            };
            scene::turned(random, shape)
        };
        let body = mesh(random);
        if seed % 6 == 5 {
            // The farthest edge passes a wall that is tangent to its circle, by +-1e-3 to 1e-5.
            let turn = random.between(2.0, 12.0);
            let screw = Screw {
                axis: DVec3::Z,
                through: DVec3::ZERO,
                turn,
                advance: random.between(-0.2, 0.2),
            };
            let body = moved(body, DVec3::X * 2.0);
            let radius = body
                .0
                .iter()
                .map(|p| p.truncate().length())
                .fold(0.0, f64::max);
            let gap = random.one_of(&[1e-3, 1e-4, 1e-5]) * random.sign();
            let angle = turn * random.between(0.3, 1.0);
            let way = DVec3::new(angle.cos(), angle.sin(), 0.0);
            let wall = shapes::mapped(scene::sheet(4.0, 4.0), |p| {
                DVec3::Z * p.x + DVec3::Z.cross(way) * p.y + way * (radius + gap)
            });
            if scene::gap(&body, &wall) > 0.0 {
                scenes.push((Scene::new(body, screw.motion(), wall), screw));
            }
            continue;
        }
        let (low, high) = match seed % 3 {
            0 => (10.0, 90.0),
            1 => (180.0, 1080.0),
            _ => (45.0, 200.0),
        };
        let screw = Screw::random(random, low, high);
        let obstacle = if seed % 3 == 2 {
            let sheet = scene::sheet(2.0, 2.0);
            scene::turned(random, sheet)
        } else {
            mesh(random)
        };
        let placed = support::contact::families::beside_the_path(
            random,
            body,
            screw.motion(),
            &obstacle,
            1.5,
        );
        scenes.push((placed, screw));
    }
    scenes
}

/// Bumpy spheres of radius up to 1.2, farther apart than that at the start; every other pair only
/// passes.
fn large_scenes(triangles: u32, count: u64) -> Vec<(Scene, Screw)> {
    let scene = |seed: u64| {
        let mut random = Random::new(5_000_000 + seed);
        let random = &mut random;
        let screw = Screw::random(random, 48.0, 836.0);
        let motion = screw.motion();
        let ball = shapes::bumpy_sphere(triangles);
        let (body, obstacle) = (
            scene::turned(random, ball.clone()),
            scene::turned(random, ball),
        );
        let end = motion.joint_times()[1];
        let mut place = DVec3::X * 10.0;
        let centre = |time: f64| motion.pose_at_time(time).translation;
        for _ in 0..2_000 {
            let time = random.between(0.1, 1.0) * end;
            let passes = seed % 2 == 1;
            let away = if passes { 2.45 } else { 1.5 };
            place = centre(time) + random.direction() * random.between(away, away + 0.5);
            let steps = (0..=400).map(|k| centre(end * f64::from(k) / 400.0));
            let least = steps
                .map(|p| p.distance(place))
                .fold(f64::INFINITY, f64::min);
            if place.length() > 2.5 && (!passes || least > 2.42) {
                break;
            }
        }
        (Scene::new(body, motion, moved(obstacle, place)), screw)
    };
    (0..count).map(scene).collect()
}

/// Runs a method on all scenes and prints a row: times, and a comparison of the answers with the
/// truth.
fn row(set: &str, method: &Method, scenes: &[Prepared], truth: &[Option<Option<[f64; 2]>>]) {
    let (name, run) = method;
    let mut seconds = Vec::new();
    let [
        mut missed,
        mut late,
        mut early,
        mut false_contacts,
        mut gave_up,
    ] = [0; 5];
    for (scene, truth) in scenes.iter().zip(truth) {
        let clock = Instant::now();
        let mut answer = run(scene);
        let mut best = clock.elapsed().as_secs_f64();
        // The best of three runs where that is cheap: other work on the machine should not count.
        for _ in 0..if best < 0.1 { 2 } else { 0 } {
            let clock = Instant::now();
            answer = black_box(run(scene));
            best = best.min(clock.elapsed().as_secs_f64());
        }
        seconds.push(best);
        match (answer, truth) {
            (Err(()), _) => gave_up += 1,
            (Ok(None), Some(Some(_))) => missed += 1,
            (Ok(Some(_)), Some(None)) => false_contacts += 1,
            (Ok(Some(time)), Some(Some([from, to]))) => {
                late += usize::from(time > to + LATE);
                early += usize::from(time < from - LATE);
            }
            _ => {}
        }
    }
    if gave_up == scenes.len() {
        println!("{set},{name},{},,,,,,,,not run", scenes.len());
        return;
    }
    seconds.sort_by(f64::total_cmp);
    println!(
        "{set},{name},{},{:.4},{:.4},{:.4},{missed},{late},{early},{false_contacts},{gave_up}",
        scenes.len(),
        percentile(&seconds, 0.5) * 1e3,
        percentile(&seconds, 0.99) * 1e3,
        percentile(&seconds, 1.0) * 1e3
    );
}

fn prepared(scenes: &[(Scene, Screw)]) -> Vec<Prepared> {
    scenes
        .iter()
        .map(|(scene, screw)| Prepared::new(scene, screw))
        .collect()
}

/// Time of contact from 0 to 1 by the slow search: `None` where it is in doubt, otherwise no
/// contact or two times between which it lies.
fn certified(scene: &Scene) -> Option<Option<[f64; 2]>> {
    let duration = scene.duration();
    match scene.search(0, 0.0).run() {
        Slow::Clear => Some(None),
        Slow::Contact { clear_until, by } => Some(Some([clear_until / duration, by / duration])),
        Slow::Doubt { .. } | Slow::GivenUp => None,
    }
}

fn table() {
    println!("scenes,method,count,median_ms,p99_ms,worst_ms,missed,late,early,false,gave_up");
    let small = small_scenes();
    let truth: Vec<_> = small.iter().map(|(scene, _)| certified(scene)).collect();
    let scenes = prepared(&small);
    let contacts = truth
        .iter()
        .filter(|truth| matches!(truth, Some(Some(_))))
        .count();
    println!(
        "# small: {contacts} of {} in contact by the slow search",
        truth.len()
    );
    for method in &METHODS {
        row("small", method, &scenes, &truth);
    }
    for (triangles, count) in [(1_000, 6), (10_000, 4), (70_000, 4)] {
        let scenes = prepared(&large_scenes(triangles, count));
        // There are too many pairs for the slow search: the other methods are compared with our
        // answer, and ours thus with theirs.
        let truth: Vec<_> = scenes
            .iter()
            .map(|scene| {
                let answer = ours(scene, Measure::Verdict).ok()?;
                Some(answer.map(|time| [time, time]))
            })
            .collect();
        let contacts = truth
            .iter()
            .filter(|truth| matches!(truth, Some(Some(_))))
            .count();
        println!(
            "# {triangles} triangles: {contacts} of {} in contact",
            truth.len()
        );
        for method in &METHODS {
            row(
                &format!("{triangles} x {triangles}"),
                method,
                &scenes,
                &truth,
            );
        }
    }
    for kind in [Kind::VertexFace, Kind::FaceVertex, Kind::EdgeEdge] {
        let mut seconds: Vec<f64> = (0..10_000)
            .map(|seed| {
                let pair = any_pair(&mut Random::new(1_000_000 + seed), kind);
                (0..3).map(|_| timed(&pair)).fold(f64::INFINITY, f64::min)
            })
            .collect();
        seconds.sort_by(f64::total_cmp);
        println!(
            "one pair {kind:?},steadysweep,10000,{:.5},{:.5},{:.5},,,,,",
            percentile(&seconds, 0.5) * 1e3,
            percentile(&seconds, 0.99) * 1e3,
            percentile(&seconds, 1.0) * 1e3
        );
    }
}

fn timed(pair: &Pair) -> f64 {
    let clock = Instant::now();
    black_box(pair.outcome());
    clock.elapsed().as_secs_f64()
}

fn contact(criterion: &mut Criterion) {
    table();
    let mut group = criterion.benchmark_group("contact");
    group.sample_size(10);
    group.warm_up_time(Duration::from_millis(10));
    let small = small_scenes();
    let picked = small.into_iter().step_by(20).collect::<Vec<_>>();
    let sets = [
        ("small", prepared(&picked)),
        ("1000", prepared(&large_scenes(1_000, 2))),
        ("10000", prepared(&large_scenes(10_000, 2))),
    ];
    for (set, scenes) in &sets {
        for (name, run) in &METHODS {
            // Methods that are not run for such sizes, or would take minutes, are in the table
            // only.
            let clock = Instant::now();
            let fails = scenes.iter().any(|scene| run(scene).is_err());
            if fails || clock.elapsed() > Duration::from_secs(1) {
                continue;
            }
            group.bench_function(format!("{set}/{name}"), |bencher| {
                bencher.iter(|| scenes.iter().filter(|scene| run(scene).is_ok()).count());
            });
        }
    }
    for kind in [Kind::VertexFace, Kind::EdgeEdge] {
        let pairs: Vec<Pair> = (0..1_000)
            .map(|seed| any_pair(&mut Random::new(1_000_000 + seed), kind))
            .collect();
        group.bench_function(format!("1000 pairs/{kind:?}"), |bencher| {
            bencher.iter(|| {
                pairs.iter().for_each(|pair| {
                    black_box(pair.outcome());
                })
            });
        });
    }
    group.finish();
}

criterion_group!(benches, contact);
criterion_main!(benches);
