//! Scenes that are barely decided: their first contact is known, for most of them without any
//! rounding.

use super::super::random::Random;
use super::families::rigid;
use super::scene::{self, Known, Obstacle, Scene, chain, moved, steady};
use crate::support::shapes;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};
use steadysweep::motion::Generator;

/// A box turns about the z axis; its farthest edge passes a wall, which is parallel to a tangent
/// plane of its circle, at some distance or depth.
pub(crate) fn grazing(random: &mut Random) -> Scene {
    let gap = random.one_of(&[1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-9]) * random.sign();
    let (turn, angle) = (random.between(0.3, 1.0), random.between(2.0, 12.0));
    let body = if random.chance(0.5) {
        moved(scene::brick(DVec3::new(0.4, 0.3, 0.5)), DVec3::X)
    } else {
        shapes::mapped(scene::octahedron(), |p| p * 0.3 + DVec3::X)
    };
    let radius = body
        .0
        .iter()
        .map(|p| p.truncate().length())
        .fold(0.0, f64::max);
    // The farthest points are less than a right angle from the x axis: they pass the direction of
    // the wall.
    let advance = if random.chance(0.5) {
        0.0
    } else {
        random.between(-0.2, 0.2)
    };
    let generator = Generator::screw(DVec3::Z, DVec3::ZERO, angle, advance, 1.0);
    let way = DVec3::new((turn * angle).cos(), (turn * angle).sin(), 0.0);
    let wall = shapes::mapped(scene::sheet(3.0, 3.0), |p| {
        // Its x axis along z, its y axis across.
        DVec3::Z * p.x + DVec3::Z.cross(way) * p.y + way * (radius + gap)
    });
    let scene = Scene::new(body, steady(generator), wall);
    if gap > 0.0 {
        scene.known(Known::Clear)
    } else {
        scene
    }
}

/// A gap of 1e-9 to 1e-4 at the start, towards the obstacle or away from it.
pub(crate) fn near_the_start(random: &mut Random) -> Scene {
    let gap = random.one_of(&[1e-9, 1e-6, 1e-4]);
    let body = match random.below(3) {
        0 => moved(scene::brick(DVec3::ONE), DVec3::Z * (0.5 + gap)),
        1 => moved(scene::octahedron(), DVec3::Z * (1.0 + gap)),
        // An edge that crosses the edge of the obstacle.
        _ => {
            let turn = DMat3::from_rotation_x(PI / 4.0);
            let bar = scene::brick(DVec3::new(2.0, 0.5, 0.5));
            moved(
                shapes::mapped(bar, |p| turn * p),
                DVec3::Z * (0.5_f64.sqrt() / 2.0 + gap),
            )
        }
    };
    let leaving = random.chance(0.5);
    let speed = random.between(0.5, 2.0);
    let way = DVec3::new(
        random.between(-0.3, 0.3),
        random.between(-0.3, 0.3),
        if leaving { speed } else { -speed },
    );
    let obstacle = scene::sheet(2.5, 2.5);
    let scene = Scene::new(body, steady(Generator::translation(way)), obstacle);
    if leaving {
        scene.known(Known::Clear)
    } else {
        let time = gap / speed * scene.duration();
        scene.known(Known::Contact {
            time,
            early: 1e-11 * (1.0 + 1.0 / speed),
        })
    }
}

/// Contact at the first instant, which then ends, stays or becomes deeper.
pub(crate) fn touching_at_the_start(random: &mut Random) -> Scene {
    let body = match random.below(4) {
        // Face on face, corner on face, edge on edge, corner on corner.
        0 => moved(scene::brick(DVec3::ONE), DVec3::Z * 0.5),
        1 => moved(scene::octahedron(), DVec3::Z),
        2 => moved(scene::brick(DVec3::ONE), DVec3::new(1.75, 0.0, 0.5)),
        _ => moved(scene::brick(DVec3::ONE), DVec3::new(1.75, 1.75, 0.5)),
    };
    let generator = match random.below(4) {
        0 => Generator::translation(random.direction()),
        1 => Generator::translation(DVec3::Z),
        2 => Generator::translation(-DVec3::Z),
        _ => rigid(random, 1.0),
    };
    let contact = Known::Contact {
        time: 0.0,
        early: 0.0,
    };
    Scene::new(body, steady(generator), scene::sheet(2.5, 2.5)).known(contact)
}

/// A box over a sheet, with its lower face always parallel to it: in its plane, or a hair above; it
/// may come over the sheet's edge only later.
pub(crate) fn sliding(random: &mut Random) -> Scene {
    let gap = random.one_of(&[0.0, 0.0, 1e-3, 1e-6, 1e-9]);
    let outside = random.chance(0.5);
    let across = if outside { -2.0 } else { 0.0 };
    let lowest = if random.chance(0.5) { 0.0 } else { 0.25 };
    let body = moved(
        scene::brick(DVec3::new(0.5, 0.5, 0.5)),
        DVec3::new(across, 0.25, lowest + 0.25),
    );
    let sheet = moved(scene::sheet(2.0, 2.0), DVec3::Z * (lowest - gap));
    // Dyadic speeds and positions: a translation meets the edge x = -1 of the sheet without
    // rounding.
    let speed = random.one_of(&[1.0, 2.0, 4.0]);
    let turning = random.chance(0.4);
    let generator = if turning {
        Generator::screw(
            DVec3::Z,
            DVec3::new(0.0, 1.0, 0.0),
            random.between(0.2, 6.0) * random.sign(),
            0.0,
            1.0,
        )
    } else {
        Generator::translation(DVec3::new(speed, 0.0, 0.0))
    };
    let scene = Scene::new(body, steady(generator), sheet);
    if gap > 0.0 {
        return scene.known(Known::Clear);
    }
    match (outside, turning) {
        (false, _) => scene.known(Known::Contact {
            time: 0.0,
            early: 0.0,
        }),
        // From x = -1.75 to -1.
        (true, false) => {
            let time = 0.75 / speed * scene.duration();
            scene.known(Known::Contact { time, early: 1e-11 })
        }
        (true, true) => scene,
    }
}

/// Faces that stay parallel and meet as a whole.
pub(crate) fn parallel_faces(random: &mut Random) -> Scene {
    let gap = random.one_of(&[0.5, 0.25, 0.125]);
    let speed = random.one_of(&[0.25, 1.0, 2.0]);
    let size = random.one_of(&[0.5, 1.0, 2.0]);
    let body = moved(scene::brick(DVec3::ONE), DVec3::new(0.0, 0.0, 0.5 + gap));
    let obstacle = if random.chance(0.5) {
        scene::sheet(size, size)
    } else {
        moved(scene::brick(DVec3::splat(size)), DVec3::Z * (-size / 2.0))
    };
    // A screw about z keeps them parallel as well.
    let turn = if random.chance(0.5) {
        0.0
    } else {
        random.between(-6.0, 6.0)
    };
    let generator = Generator::screw(DVec3::Z, DVec3::ZERO, turn, -speed, 1.0);
    let scene = Scene::new(body, steady(generator), obstacle);
    let time = gap / speed * scene.duration();
    if gap > speed {
        scene.known(Known::Clear)
    } else {
        scene.known(Known::Contact {
            time,
            early: 1e-11 / speed,
        })
    }
}

/// A ball touches a plane without crossing it, at the lowest point of a parabola or of a circle.
pub(crate) fn tangent(random: &mut Random) -> Scene {
    let ball = scene::octahedron();
    if random.chance(0.5) {
        // x' = 1, z' = 2 x: the point that starts at x = -1/2 falls by 1/4 until x = 0, then rises.
        let linear = DMat3::from_cols(DVec3::new(0.0, 0.0, 2.0), DVec3::ZERO, DVec3::ZERO);
        let generator = Generator {
            linear,
            offset: DVec3::X,
        };
        // Vertices at x = -5/8 fall by 25/64; they start higher by 1/2.
        let size = DVec3::new(0.125, 0.125, 0.5);
        let body = shapes::mapped(ball, |p| p * size + DVec3::new(-0.5, 0.0, 0.75));
        let time = chain(&[generator]).joint_times()[1] / 2.0;
        let lift = random.one_of(&[0.0, 0.0, 1e-9, 1e-6]);
        let plane = moved(scene::sheet(4.0, 4.0), DVec3::Z * -lift);
        let known = if lift > 0.0 {
            Known::Clear
        } else {
            // It is within 1e-12 of the plane for a time of 1e-6 before and after.
            Known::Contact { time, early: 4e-6 }
        };
        Scene::new(body, steady(generator), plane).known(known)
    } else {
        // A quarter turn about y brings the corner at distance 1 down to the plane halfway.
        let corner = DQuat::from_rotation_y(-PI / 4.0);
        let body = shapes::mapped(ball, |p| corner * (p * 0.25 - DVec3::Z * 0.75));
        let lift = random.one_of(&[1e-9, 1e-6, 1e-3]);
        let plane = moved(scene::sheet(4.0, 4.0), DVec3::Z * (-1.0 - lift));
        let generator = Generator::screw(DVec3::Y, DVec3::ZERO, FRAC_PI_2, 0.0, 1.0);
        Scene::new(body, steady(generator), plane).known(Known::Clear)
    }
}

/// The body comes to touch exactly where a span ends, and then leaves, slides, rests or goes on.
pub(crate) fn contact_at_a_joint(random: &mut Random) -> Scene {
    let gap = random.one_of(&[0.25, 0.5, 1.0]);
    let body = if random.chance(0.5) {
        moved(scene::brick(DVec3::ONE), DVec3::Z * (0.5 + gap))
    } else {
        moved(scene::octahedron(), DVec3::Z * (1.0 + gap))
    };
    let down = Generator::translation(DVec3::Z * -gap);
    let after = match random.below(5) {
        0 => Generator::translation(DVec3::Z * gap),
        1 => Generator::translation(DVec3::X * 0.5),
        2 => Generator::translation(DVec3::ZERO),
        3 => down,
        _ => Generator::screw(DVec3::Z, DVec3::ZERO, 1.0, 0.0, 1.0),
    };
    let before = Generator::translation(DVec3::X * 0.25);
    let (generators, joint): (Vec<Generator>, usize) = if random.chance(0.5) {
        (vec![down, after], 1)
    } else {
        (vec![before, down, after], 2)
    };
    let motion = chain(&generators);
    let time = motion.joint_times()[joint];
    Scene::new(body, motion, scene::sheet(4.0, 4.0)).known(Known::Contact { time, early: 1e-10 })
}

/// A body inside a closed obstacle or around it; or inside its cavity, which is no contact.
pub(crate) fn one_inside_the_other(random: &mut Random) -> Scene {
    let turn = random.between(0.1, 1.0);
    let motion = steady(rigid(random, turn));
    let small = shapes::mapped(scene::any_body(random), |p| p * 0.2);
    let large = scene::brick(DVec3::splat(4.0));
    let touching = Known::Contact {
        time: 0.0,
        early: 0.0,
    };
    match random.below(5) {
        0 => Scene::new(small, motion, large).known(touching),
        1 => Scene::new(large, motion, small).known(touching),
        // An open surface inside the body.
        2 => Scene::new(large, motion, scene::sheet(0.5, 0.5)).known(touching),
        // A second obstacle far away, and one of two parts inside.
        3 => {
            let far = moved(scene::octahedron(), DVec3::X * 50.0);
            let parts = shapes::united(&[far.clone(), small]);
            let mut scene = Scene::new(large, motion, far).known(touching);
            scene.obstacles.push(Obstacle {
                shape: parts,
                motion: None,
            });
            scene
        }
        _ => {
            let cavity =
                shapes::hollow_box(DVec3::splat(4.0), DVec3::splat(random.between(1.0, 3.0)));
            Scene::new(small, motion, cavity)
        }
    }
}
