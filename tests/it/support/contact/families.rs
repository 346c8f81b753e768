//! Random scenes by family; about half of each come into contact.

use super::super::random::Random;
use super::scene::{self, Known, Obstacle, Scene, chain, is_closed, moved, steady};
use crate::support::membership::winding_number;
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::{PI, TAU};
use steadysweep::motion::{Generator, Motion};

pub(crate) type Family = fn(&mut Random) -> Scene;

/// Every family with its name.
pub(crate) const FAMILIES: [(&str, Family); 25] = [
    ("slow screw", slow_screw),
    ("fast turn", fast_turn),
    ("thin plate", thin_plate),
    ("bullet", bullet),
    ("grazing", super::exact::grazing),
    ("near the start", super::exact::near_the_start),
    ("touching at the start", super::exact::touching_at_the_start),
    ("sliding", super::exact::sliding),
    ("parallel edges", parallel_edges),
    ("parallel faces", super::exact::parallel_faces),
    ("tangent", super::exact::tangent),
    ("spiral to a point", spiral_to_a_point),
    ("spiral", spiral),
    ("shear", shear),
    ("defective", defective),
    ("scaling along axes", scaling_along_axes),
    ("any affine", any_affine),
    ("chain", random_chain),
    ("contact at a joint", super::exact::contact_at_a_joint),
    ("rest", rest),
    ("no area", no_area),
    ("one inside the other", super::exact::one_inside_the_other),
    ("two moving", two_moving),
    ("two moving on one axis", two_moving_on_one_axis),
    ("other units", other_units),
];

/// Scene `seed` of a family, always the same.
pub(crate) fn scene((name, family): (&'static str, Family), seed: u64) -> Scene {
    let salt = name.bytes().fold(7_u64, |sum, byte| {
        sum.wrapping_mul(31).wrapping_add(u64::from(byte))
    });
    let mut random = Random::new(salt.wrapping_add(seed.wrapping_mul(1_000_003)));
    Scene {
        family: name,
        seed,
        ..family(&mut random)
    }
}

pub(crate) fn rigid(random: &mut Random, turn: f64) -> Generator {
    Generator::screw(
        random.direction(),
        random.point(1.0),
        turn * random.sign(),
        random.between(-2.0, 2.0),
        1.0,
    )
}

fn degrees(random: &mut Random, low: f64, high: f64) -> f64 {
    random.between(low, high) * PI / 180.0
}

/// Places an obstacle beside the path of the body's centre, such that the scene does not begin in
/// contact.
pub(crate) fn beside_the_path(
    random: &mut Random,
    body: Shape,
    motion: Motion,
    obstacle: &Shape,
    reach: f64,
) -> Scene {
    let radius = body.0.iter().map(|p| p.length()).fold(0.0, f64::max);
    let start = motion.joint_times()[0];
    let length = motion.joint_times()[motion.spans().len()] - start;
    let mut placed = obstacle.clone();
    for _ in 0..40 {
        let time = start + length * random.between(0.05, 1.0);
        let centre = motion.pose_at_time(time).translation;
        let off = random.direction() * random.between(0.3 * reach, 1.3 * reach) * radius;
        placed = moved(obstacle.clone(), centre + off);
        if starts_apart(&body, &placed) {
            break;
        }
    }
    Scene::new(body, motion, placed)
}

fn starts_apart(body: &Shape, obstacle: &Shape) -> bool {
    scene::gap(body, obstacle) > 1e-3
        && winding_number(body, obstacle.0[0]) == 0
        && !(is_closed(obstacle) && winding_number(obstacle, body.0[0]) != 0)
}

fn with_generator(random: &mut Random, generator: Generator) -> Scene {
    let body = scene::any_body(random);
    let obstacle = scene::any_obstacle(random);
    beside_the_path(random, body, steady(generator), &obstacle, 1.5)
}

fn slow_screw(random: &mut Random) -> Scene {
    let turn = degrees(random, 10.0, 90.0);
    let generator = rigid(random, turn);
    with_generator(random, generator)
}

fn fast_turn(random: &mut Random) -> Scene {
    let turn = degrees(random, 180.0, 1080.0);
    let generator = rigid(random, turn);
    with_generator(random, generator)
}

fn thin_plate(random: &mut Random) -> Scene {
    let plate = |random: &mut Random| {
        let thickness = random.magnitude(1e-4, 2e-2);
        let plate = scene::brick(DVec3::new(random.between(0.5, 2.0), 1.0, thickness));
        scene::turned(random, plate)
    };
    let turn = degrees(random, 10.0, 360.0);
    let motion = steady(rigid(random, turn));
    let body = plate(random);
    let obstacle = match random.below(3) {
        0 => plate(random),
        1 => {
            let sheet = scene::sheet(random.between(0.5, 2.0), 1.0);
            scene::turned(random, sheet)
        }
        _ => scene::any_body(random),
    };
    beside_the_path(random, body, motion, &obstacle, 1.0)
}

/// A small body that moves far in one span.
fn bullet(random: &mut Random) -> Scene {
    let size = random.magnitude(1e-3, 3e-2);
    let body = shapes::mapped(scene::any_body(random), |p| p * size);
    let way = random.direction();
    let spin = Generator::screw(
        way,
        random.point(0.1),
        degrees(random, 90.0, 360.0),
        random.between(2.0, 9.0),
        1.0,
    );
    let obstacle = if random.chance(0.5) {
        scene::sheet(1.0, 1.0)
    } else {
        scene::brick(DVec3::new(1.0, 1.0, 0.01))
    };
    let obstacle = scene::turned(random, obstacle);
    beside_the_path(random, body, steady(spin), &obstacle, 30.0)
}

/// All edges along z stay parallel to z.
fn parallel_edges(random: &mut Random) -> Scene {
    let upright = |random: &mut Random, height: f64| {
        let angle = random.between(0.0, TAU);
        let (shape, exact) = match random.below(3) {
            0 => (
                scene::brick(DVec3::new(0.8, random.between(0.3, 1.0), height)),
                random.chance(0.5),
            ),
            1 => (
                shapes::mapped(shapes::l_prism(0.3, height), |p| {
                    p - DVec3::new(0.4, 0.4, height / 2.0)
                }),
                false,
            ),
            _ => (
                shapes::mapped(shapes::u_prism(0.3, height), |p| {
                    p - DVec3::new(0.5, 0.4, height / 2.0)
                }),
                false,
            ),
        };
        let turn = DMat3::from_rotation_z(if exact { 0.0 } else { angle });
        shapes::mapped(shape, |p| turn * p)
    };
    let generator = Generator::screw(
        DVec3::Z,
        DVec3::new(random.between(-2.0, 2.0), random.between(-2.0, 2.0), 0.0),
        if random.chance(0.2) {
            0.0
        } else {
            degrees(random, -400.0, 400.0)
        },
        if random.chance(0.5) {
            0.0
        } else {
            random.between(-1.0, 1.0)
        },
        random.one_of(&[1.0, 1.0, 0.5, 2.0]),
    );
    let height = random.between(0.5, 1.0);
    let body = upright(random, height);
    let obstacle = if random.chance(0.5) {
        upright(random, height)
    } else {
        let height = random.between(0.5, 1.0);
        upright(random, height)
    };
    let reach = if random.chance(0.5) { 0.0 } else { 1.5 };
    let scene = beside_the_path(random, body, steady(generator), &obstacle, reach);
    // Half of them with tops and bottoms in common planes.
    let level =
        |shape: Shape| shapes::mapped(shape, |p| DVec3::new(p.x, p.y, (p.z * 4.0).round() / 4.0));
    let levelled = Scene {
        body: level(scene.body.clone()),
        obstacles: vec![Obstacle {
            shape: level(scene.obstacles[0].shape.clone()),
            motion: None,
        }],
        ..scene.clone()
    };
    if random.chance(0.5) && starts_apart(&levelled.body, &levelled.obstacles[0].shape) {
        levelled
    } else {
        scene
    }
}

/// The body shrinks to almost nothing at a point that is special to the obstacle.
fn spiral_to_a_point(random: &mut Random) -> Scene {
    let obstacle = scene::any_obstacle(random);
    let [a, b, c] = obstacle.1[random.below(obstacle.1.len())].map(|k| obstacle.0[k as usize]);
    let through = match random.below(5) {
        0 => a,
        1 => a.midpoint(b),
        2 => (a + b + c) / 3.0,
        3 => (a + b + c) / 3.0 + random.direction() * random.magnitude(1e-6, 1e-1),
        _ => random.point(0.5),
    };
    let generator = Generator::screw(
        random.direction(),
        through,
        degrees(random, 0.0, 1080.0),
        0.0,
        random.magnitude(1e-6, 0.3),
    );
    let mut body = scene::any_body(random);
    for _ in 0..40 {
        let at = random.direction() * random.between(1.0, 3.0);
        let placed = moved(body.clone(), at);
        if starts_apart(&placed, &obstacle) {
            body = placed;
            break;
        }
    }
    Scene::new(body, steady(generator), obstacle)
}

fn spiral(random: &mut Random) -> Scene {
    let generator = Generator::screw(
        random.direction(),
        random.point(1.5),
        degrees(random, -600.0, 600.0),
        random.between(-1.0, 1.0),
        random.magnitude(0.2, 3.0),
    );
    with_generator(random, generator)
}

fn shear(random: &mut Random) -> Scene {
    let along = random.direction();
    let across = along.any_orthonormal_vector();
    let size = random.between(0.3, 3.0);
    let linear = DMat3::from_cols(along * across.x, along * across.y, along * across.z) * size;
    let offset = if random.chance(0.5) {
        random.point(2.0)
    } else {
        // Every point moves along a line, and the points of a plane stand still.
        along * random.between(-1.0, 1.0)
    };
    with_generator(random, Generator { linear, offset })
}

/// Jordan blocks of size two and three, in any basis.
fn defective(random: &mut Random) -> Scene {
    let (a, b) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let form = match random.below(4) {
        0 => DMat3::from_cols_array(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
        1 => DMat3::from_cols_array(&[a, 0.0, 0.0, 1.0, a, 0.0, 0.0, 0.0, b]),
        2 => DMat3::from_cols_array(&[a, 0.0, 0.0, 1.0, a, 0.0, 0.0, 1.0, a]),
        _ => DMat3::from_cols_array(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, b]),
    } * random.between(0.3, 2.0);
    let basis = if random.chance(0.3) {
        DMat3::IDENTITY
    } else {
        basis(random)
    };
    let linear = basis * form * basis.inverse();
    let offset = random.point(1.5);
    with_generator(random, Generator { linear, offset })
}

/// An invertible basis that is not too skewed.
fn basis(random: &mut Random) -> DMat3 {
    loop {
        let basis = random.matrix(1.0);
        if basis.determinant().abs() > 0.2 {
            return basis;
        }
    }
}

fn scaling_along_axes(random: &mut Random) -> Scene {
    let rates = DVec3::new(
        random.between(-1.5, 1.5),
        random.between(-1.5, 1.5),
        random.between(-1.5, 1.5),
    );
    let basis = if random.chance(0.5) {
        DMat3::from_quat(random.rotation())
    } else {
        basis(random)
    };
    let linear = basis * DMat3::from_diagonal(rates) * basis.inverse();
    let offset = linear * -random.point(2.0);
    with_generator(random, Generator { linear, offset })
}

fn any_affine(random: &mut Random) -> Scene {
    let generator = Generator {
        linear: random.matrix(2.0),
        offset: random.point(2.0),
    };
    with_generator(random, generator)
}

fn random_chain(random: &mut Random) -> Scene {
    let spans = 2 + random.below(4);
    let generators: Vec<Generator> = (0..spans)
        .map(|_| match random.below(4) {
            0 => Generator::translation(random.point(1.0)),
            1 => Generator {
                linear: random.matrix(0.5),
                offset: random.point(1.0),
            },
            _ => {
                let turn = degrees(random, 20.0, 200.0);
                rigid(random, turn)
            }
        })
        .collect();
    let body = scene::any_body(random);
    let obstacle = scene::any_obstacle(random);
    beside_the_path(random, body, chain(&generators), &obstacle, 1.5)
}

/// The identity motion: a little or far apart, or in contact.
fn rest(random: &mut Random) -> Scene {
    let still = steady(Generator::translation(DVec3::ZERO));
    let (body, obstacle) = (scene::any_body(random), scene::any_obstacle(random));
    let off = random.direction() * random.between(0.0, 2.0);
    Scene::new(body, still, moved(obstacle, off))
}

/// Obstacles with triangles that are segments or points, alone or beside others.
fn no_area(random: &mut Random) -> Scene {
    let mut obstacle: Shape = if random.chance(0.3) {
        scene::sheet(0.5, 0.5)
    } else {
        (Vec::new(), Vec::new())
    };
    for _ in 0..=random.below(3) {
        let first = obstacle.0.len() as u32;
        let (a, b) = (random.point(0.7), random.point(0.7));
        let corners = match random.below(5) {
            // Equal indices, equal positions, corners in a row.
            0 => {
                obstacle.0.push(a);
                obstacle.1.push([first; 3]);
                continue;
            }
            1 => {
                obstacle.0.extend([a, b]);
                obstacle.1.push([first, first + 1, first + 1]);
                continue;
            }
            2 => [a, a, a],
            3 => [a, b, a],
            _ => [a, b, a + (b - a) * 0.5],
        };
        obstacle.0.extend(corners);
        obstacle.1.push([first, first + 1, first + 2]);
    }
    let turn = degrees(random, 10.0, 400.0);
    let motion = steady(rigid(random, turn));
    let body = scene::any_body(random);
    beside_the_path(random, body, motion, &obstacle, 0.8)
}

/// Two bodies whose relative motion is not steady.
fn two_moving(random: &mut Random) -> Scene {
    let turn = degrees(random, 10.0, 300.0);
    let first = rigid(random, turn);
    let second = match random.below(3) {
        0 => Generator {
            linear: random.matrix(0.7),
            offset: random.point(1.0),
        },
        _ => {
            let turn = degrees(random, 10.0, 300.0);
            rigid(random, turn)
        }
    };
    let own = if random.chance(0.5) {
        chain(&[second])
    } else {
        // The joints are at other times than those of the body, and it rests at the end.
        chain(&[second.scaled(0.3), second.scaled(0.2)])
    };
    let first = if random.chance(0.5) {
        chain(&[first])
    } else {
        chain(&[
            first.scaled(0.5),
            Generator::translation(DVec3::X),
            first.scaled(0.3),
        ])
    };
    both_moving(random, first, own)
}

fn two_moving_on_one_axis(random: &mut Random) -> Scene {
    let (axis, through) = (random.direction(), random.point(1.0));
    let about = |random: &mut Random| {
        steady(Generator::screw(
            axis,
            through,
            degrees(random, -500.0, 500.0),
            random.between(-1.0, 1.0),
            1.0,
        ))
    };
    let (first, second) = (about(random), about(random));
    both_moving(random, first, second)
}

fn both_moving(random: &mut Random, first: Motion, second: Motion) -> Scene {
    let (body, obstacle) = (scene::any_body(random), scene::any_body(random));
    let end = first.joint_times()[first.spans().len()];
    let mut placed = obstacle.clone();
    for _ in 0..40 {
        // The place where the obstacle must start to be near the body at some time.
        let time = random.between(0.05, 1.0) * end;
        let centre = first.pose_at_time(time).translation;
        let from = second.pose_at_time(time).inverse().transform_point3(centre);
        placed = moved(obstacle.clone(), from + random.point(2.0));
        if starts_apart(&body, &placed) {
            break;
        }
    }
    let mut scene = Scene::new(body, first, placed);
    scene.obstacles[0].motion = Some(second);
    scene
}

/// Scenes of other families in units of 1e-3 and 1e6, about another origin.
fn other_units(random: &mut Random) -> Scene {
    let family = loop {
        let (name, family) = FAMILIES[random.below(FAMILIES.len() - 1)];
        // Scenes that depend on equal coordinates would not survive the rounding of the change.
        if ![
            "sliding",
            "tangent",
            "parallel faces",
            "touching at the start",
            "contact at a joint",
            "near the start",
            "grazing",
        ]
        .contains(&name)
        {
            break family;
        }
    };
    let unit = random.one_of(&[1e-3, 1e6]);
    let frame = DAffine3::from_scale_rotation_translation(
        DVec3::splat(unit),
        random.rotation(),
        random.point(5.0) * unit,
    );
    let scene = family(random).in_frame(&frame);
    scene.known(Known::Nothing)
}
