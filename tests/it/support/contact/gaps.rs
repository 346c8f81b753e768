//! Hinges, shafts, slides, cones, screws and gears whose least distance is known in closed form.

use super::super::random::Random;
use super::scene::{Obstacle, Scene, brick, moved, sheet, steady};
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use steadysweep::motion::Generator;

/// A scene and its least distance.
pub(crate) struct Gap {
    pub(crate) scene: Scene,
    pub(crate) least: f64,
}

/// A function that makes a scene.
pub(crate) type Family = fn(&mut Random) -> Gap;

/// The families by name.
pub(crate) const GAPS: [(&str, Family); 10] = [
    ("shaft in a bore", shaft),
    ("shaft turned beside the middle of its bore", eccentric),
    ("cone in a cone", cone),
    ("shaft that advances in its bore", screw),
    ("both turn about one axis", both),
    ("rotor between uprights", rotor),
    ("hinge", hinge),
    ("rod that slides in its sleeve", sleeve),
    ("slide along and towards a face", slide),
    ("growth towards a wall", growth),
];

/// The scene of a family with a seed, in some frame and unit.
pub(crate) fn gap(family: Family, seed: u64) -> Gap {
    let mut random = Random::new(seed);
    let random = &mut random;
    let Gap { scene, least } = family(random);
    let unit = random.one_of(&[1.0, 1.0, 1e-3, 1e6]);
    let frame = DAffine3::from_scale_rotation_translation(
        DVec3::splat(unit),
        random.rotation(),
        random.point(3.0 * unit),
    );
    Gap {
        scene: scene.in_frame(&frame),
        least: least * unit,
    }
}

/// The solid that a counter-clockwise outline of points (r, z) off the axis sweeps in `sides` steps
/// about the z axis, starting at an angle.
pub(crate) fn lathe(outline: &[DVec2], sides: u32, phase: f64) -> Shape {
    let count = outline.len() as u32;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for j in 0..sides {
        let turn = DVec2::from_angle(phase + TAU * f64::from(j) / f64::from(sides));
        positions.extend(outline.iter().map(|p| (turn * p.x).extend(p.y)));
        for k in 0..count {
            let [a, b] = [k, (k + 1) % count].map(|k| j * count + k);
            let [c, d] = [k, (k + 1) % count].map(|k| (j + 1) % sides * count + k);
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    (positions, triangles)
}

/// A tube between two radii and two heights.
pub(crate) fn tube(radii: [f64; 2], heights: [f64; 2], sides: u32, phase: f64) -> Shape {
    let [inner, outer] = radii;
    let [low, high] = heights;
    let outline = [
        DVec2::new(inner, low),
        DVec2::new(outer, low),
        DVec2::new(outer, high),
        DVec2::new(inner, high),
    ];
    lathe(&outline, sides, phase)
}

/// The same surface with every triangle cut into four, `times` times.
fn refined(shape: Shape, times: u32) -> Shape {
    (0..times).fold(shape, |(mut positions, triangles), _| {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |p: u32, q: u32| {
                *middles.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                    positions.push(positions[p as usize].midpoint(positions[q as usize]));
                    positions.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        (positions, finer)
    })
}

fn turning(turn: f64, advance: f64) -> Generator {
    Generator::screw(DVec3::Z, DVec3::ZERO, turn, advance, 1.0)
}

/// At least one full turn, in either sense.
fn whole_turn(random: &mut Random) -> f64 {
    random.sign() * TAU * random.one_of(&[1.0, 1.0, 1.25, 3.1])
}

/// Polygons about one axis: the sides of the bore and of the shaft, the apothem of the bore, the
/// radius of the shaft, and the angles.
struct Bearing {
    bore: Shape,
    shaft: Shape,
    /// Apothem of the bore minus the radius of the shaft.
    gap: f64,
}

fn bearing(random: &mut Random) -> Bearing {
    let sides = [0, 1].map(|_| random.one_of(&[3, 4, 5, 8, 13, 24, 60]));
    let gap = random.magnitude(1e-4, 0.3);
    let radius = 1.0;
    let apothem = radius + gap;
    let circumradius = apothem / (PI / f64::from(sides[0])).cos();
    let outer = circumradius * 1.3;
    Bearing {
        bore: tube([circumradius, outer], [-0.5, 0.5], sides[0], random.unit()),
        shaft: tube([0.3, radius], [-0.8, 0.7], sides[1], random.unit()),
        gap,
    }
}

/// A scene of the two in either order: the one that turns may be the outer one.
fn either(random: &mut Random, shaft: Shape, bore: Shape, generator: Generator) -> Scene {
    if random.chance(0.5) {
        Scene::new(shaft, steady(generator), bore)
    } else {
        Scene::new(bore, steady(generator), shaft)
    }
}

fn shaft(random: &mut Random) -> Gap {
    let Bearing { bore, shaft, gap } = bearing(random);
    let turn = whole_turn(random);
    Gap {
        scene: either(random, shaft, bore, turning(turn, 0.0)),
        least: gap,
    }
}

/// The corners of the shaft move around its own axis, nearest to the side of the bore towards which
/// the shaft is displaced.
fn eccentric(random: &mut Random) -> Gap {
    let Bearing { bore, shaft, gap } = bearing(random);
    // The first corner of the bore is ahead of the middle of its first side by half a step.
    let (first, step) = {
        let [a, b] = [bore.0[0], bore.0[4]].map(|p| DVec2::new(p.x, p.y));
        (a.midpoint(b).normalize(), a.angle_to(b))
    };
    assert!(step > 0.0, "counter-clockwise");
    let away = gap * random.between(0.2, 0.9);
    let middle = first.extend(0.0) * away;
    let turn = whole_turn(random);
    let generator = Generator::screw(DVec3::Z, middle, turn, 0.0, 1.0);
    Gap {
        scene: Scene::new(moved(shaft, middle), steady(generator), bore),
        least: gap - away,
    }
}

fn cone(random: &mut Random) -> Gap {
    let sides = [0, 1].map(|_| random.one_of(&[4, 7, 12, 30]));
    let slope = random.between(0.2, 1.2);
    // Across the slope.
    let gap = random.magnitude(1e-3, 0.1);
    let across = gap * slope.hypot(1.0);
    let cosine = (PI / f64::from(sides[0])).cos();
    let radius = |z: f64| 1.0 + slope * z;
    let outline = |low: f64, high: f64, at: &dyn Fn(f64) -> f64, other: f64| {
        let mut points = vec![
            DVec2::new(at(low), low),
            DVec2::new(other, low),
            DVec2::new(other, high),
            DVec2::new(at(high), high),
        ];
        if other < at(low) {
            points.reverse();
        }
        points
    };
    let bore = outline(0.0, 1.0, &|z| (radius(z) + across) / cosine, 4.0 / cosine);
    let plug = outline(0.0, 1.0, &radius, 0.2);
    let (bore, plug) = (
        lathe(&bore, sides[0], random.unit()),
        lathe(&plug, sides[1], random.unit()),
    );
    let times = random.below(2) as u32;
    let turn = whole_turn(random);
    Gap {
        scene: either(random, refined(plug, times), bore, turning(turn, 0.0)),
        least: gap,
    }
}

fn screw(random: &mut Random) -> Gap {
    let Bearing { bore, shaft, gap } = bearing(random);
    let longer = shapes::mapped(shaft, |p| DVec3::new(p.x, p.y, 4.0 * p.z));
    let generator = turning(whole_turn(random), random.between(-2.0, 2.0));
    Gap {
        scene: either(random, longer, bore, generator),
        least: gap,
    }
}

fn both(random: &mut Random) -> Gap {
    let Bearing { bore, shaft, gap } = bearing(random);
    let rate = whole_turn(random);
    let mut scene = Scene::new(shaft, steady(turning(rate, 0.0)), bore);
    // At least one full turn against each other.
    let other = -rate * random.between(0.1, 2.0);
    scene.obstacles[0].motion = Some(steady(turning(other, 0.0)));
    Gap { scene, least: gap }
}

fn rotor(random: &mut Random) -> Gap {
    let gap = random.magnitude(1e-3, 0.5);
    let sides = random.one_of(&[5, 16, 48]);
    let disc = tube([0.2, 2.0], [-0.2, 0.2], sides, random.unit());
    let times = random.below(2) as u32;
    let upright = |side: f64| {
        moved(
            brick(DVec3::new(0.5, 3.0, 0.3)),
            DVec3::new(1.0, 0.0, side * (0.2 + gap + 0.15)),
        )
    };
    let turn = random.sign() * random.between(0.3, 2.0) * TAU;
    let mut scene = Scene::new(
        refined(disc, times),
        steady(turning(turn, 0.0)),
        upright(1.0),
    );
    scene.obstacles.push(Obstacle {
        shape: moved(upright(-1.0), DVec3::Z * -random.between(0.0, 0.1)),
        motion: None,
    });
    Gap { scene, least: gap }
}

/// A box that turns about an edge or another axis towards a wall: its corners move along circles.
fn hinge(random: &mut Random) -> Gap {
    let size = DVec3::new(random.between(0.5, 2.0), random.between(0.1, 0.6), 1.0);
    let place = DVec3::new(random.between(0.0, 0.5), random.between(-0.3, 0.3), 0.0);
    let body = moved(brick(size), place + DVec3::X * (size.x / 2.0));
    let turn = random.sign() * random.between(0.2, 5.0);
    let mut far = f64::NEG_INFINITY;
    for corner in &body.0 {
        let (radius, start) = (corner.truncate().length(), corner.truncate().to_angle());
        let [low, high] = [start.min(start + turn), start.max(start + turn)];
        // It is farthest along x at a multiple of a full turn, if it gets there, otherwise at an
        // end.
        let passes = (high / TAU).floor() * TAU >= low;
        let cosine = if passes {
            1.0
        } else {
            low.cos().max(high.cos())
        };
        far = far.max(radius * cosine);
    }
    let least = random.magnitude(1e-3, 1.0);
    let wall = shapes::mapped(sheet(20.0, 20.0), |p| DVec3::new(far + least, p.x, p.y));
    Gap {
        scene: Scene::new(body, steady(turning(turn, 0.0)), wall),
        least,
    }
}

/// Polygons of one shape, one inside the other, that move along their axis: the gap is between
/// parallel sides.
fn sleeve(random: &mut Random) -> Gap {
    let sides = random.one_of(&[3, 6, 16]);
    let gap = random.magnitude(1e-3, 0.3);
    let circumradius = 1.0 + gap / (PI / f64::from(sides)).cos();
    let phase = random.unit();
    let bore = tube(
        [circumradius, 2.0 * circumradius],
        [-1.0, 1.0],
        sides,
        phase,
    );
    let rod = tube([0.3, 1.0], [-3.0, 2.0], sides, phase);
    let times = [0, 1].map(|_| random.below(3) as u32);
    let way = DVec3::Z * random.between(-2.0, 2.0);
    Gap {
        scene: Scene::new(
            refined(rod, times[0]),
            steady(Generator::translation(way)),
            refined(bore, times[1]),
        ),
        least: gap,
    }
}

/// A box over a floor: the least gap is at an end.
fn slide(random: &mut Random) -> Gap {
    let gap = random.magnitude(1e-3, 1.0);
    let times = [0, 1].map(|_| random.below(4) as u32);
    let body = moved(
        refined(brick(DVec3::new(1.0, 0.7, 0.5)), times[0]),
        DVec3::Z * (0.25 + gap),
    );
    let rise = random.one_of(&[0.0, 0.0, 0.4, -0.9]) * gap;
    let way = DVec3::new(random.between(-3.0, 3.0), random.between(-3.0, 3.0), rise);
    let floor = refined(sheet(20.0, 20.0), times[1] + 1);
    Gap {
        scene: Scene::new(body, steady(Generator::translation(way)), floor),
        least: gap + rise.min(0.0),
    }
}

/// A body that grows or shrinks about the origin beside a wall.
fn growth(random: &mut Random) -> Gap {
    let body = shapes::icosphere(random.below(2) as u32, 1.0, random.point(0.5));
    let far = body.0.iter().map(|p| p.x).fold(f64::NEG_INFINITY, f64::max);
    let scale = random.magnitude(0.3, 3.0);
    let least = random.magnitude(1e-3, 1.0);
    let reach = far * scale.max(1.0);
    let wall = shapes::mapped(sheet(20.0, 20.0), |p| DVec3::new(reach + least, p.x, p.y));
    let generator = Generator::screw(DVec3::Z, DVec3::ZERO, 0.0, 0.0, scale);
    Gap {
        scene: Scene::new(body, steady(generator), wall),
        least,
    }
}

/// Prisms that turn side by side about parallel axes at two rates: the least distance of their
/// outlines over time.
pub(crate) fn gears(random: &mut Random) -> Gap {
    let sides = [0, 1].map(|_| random.one_of(&[3, 5, 8, 12]));
    let gap = random.magnitude(1e-2, 0.3);
    let radii = [1.0, random.between(0.5, 2.0)];
    let middle = DVec3::X * (radii[0] + radii[1] + gap);
    let phases = [0, 1].map(|_| random.unit());
    let wheel = |k: usize| tube([0.2, radii[k]], [-0.5, 0.5], sides[k], phases[k]);
    let turns = [0, 1].map(|_| random.between(1.0, 6.0) * random.sign());
    let mut scene = Scene::new(
        wheel(0),
        steady(turning(turns[0], 0.0)),
        moved(wheel(1), middle),
    );
    let other = steady(Generator::screw(DVec3::Z, middle, turns[1], 0.0, 1.0));
    scene.obstacles[0].motion = Some(other);
    let corner = |k: usize, number: u32, time: f64| {
        let angle = phases[k] + turns[k] * time + TAU * f64::from(number) / f64::from(sides[k]);
        let centre = if k == 0 {
            DVec2::ZERO
        } else {
            middle.truncate()
        };
        centre + DVec2::from_angle(angle) * radii[k]
    };
    let apart = |time: f64| {
        let mut least = f64::INFINITY;
        for k in [0, 1] {
            for i in 0..sides[k] {
                for j in 0..sides[1 - k] {
                    let [from, to] = [j, j + 1].map(|j| corner(1 - k, j, time));
                    let (point, way) = (corner(k, i, time), to - from);
                    let share = (point - from).dot(way) / way.length_squared();
                    let foot = from + way * share.clamp(0.0, 1.0);
                    least = least.min(foot.distance(point));
                }
            }
        }
        least
    };
    Gap {
        scene,
        least: least_of(apart),
    }
}

/// The least value on [0, 1] of a function with kinks: samples, then smaller steps around the best.
fn least_of(value: impl Fn(f64) -> f64) -> f64 {
    const SAMPLES: u32 = 2_000;
    let step = 1.0 / f64::from(SAMPLES);
    let mut sampled: Vec<(f64, f64)> = (0..=SAMPLES)
        .map(|k| f64::from(k) * step)
        .map(|time| (value(time), time))
        .collect();
    sampled.sort_by(|a, b| a.0.total_cmp(&b.0));
    let refine = |&(first, time): &(f64, f64)| {
        let (mut best, mut place, mut width) = (first, time, step);
        while width > 1e-13 {
            for side in [-1.0, 1.0] {
                let next = (place + side * width).clamp(0.0, 1.0);
                let found = value(next);
                if found < best {
                    (best, place) = (found, next);
                }
            }
            width *= 0.7;
        }
        best
    };
    sampled[..40]
        .iter()
        .map(refine)
        .fold(f64::INFINITY, f64::min)
}
