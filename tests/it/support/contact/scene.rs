//! A scene: a body, its motion, obstacles at rest or moving, and the answer of the slow method.

use super::super::random::Random;
use super::distance;
use super::reference::{Mover, Search, Slow, starts_inside};
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DVec3};
use std::collections::HashMap;
use steadysweep::motion::{Generator, Motion, Span};

#[derive(Clone)]
pub(crate) struct Obstacle {
    pub(crate) shape: Shape,
    /// `None` when it rests.
    pub(crate) motion: Option<Motion>,
}

/// What is known about a scene without a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Known {
    Nothing,
    Clear,
    /// The first contact, and how much earlier rounding may see it.
    Contact {
        time: f64,
        early: f64,
    },
}

#[derive(Clone)]
pub(crate) struct Scene {
    pub(crate) family: &'static str,
    pub(crate) seed: u64,
    pub(crate) body: Shape,
    pub(crate) motion: Motion,
    pub(crate) obstacles: Vec<Obstacle>,
    pub(crate) known: Known,
}

impl Scene {
    pub(crate) fn new(body: Shape, motion: Motion, obstacle: Shape) -> Scene {
        Scene {
            family: "",
            seed: 0,
            body,
            motion,
            obstacles: vec![Obstacle {
                shape: obstacle,
                motion: None,
            }],
            known: Known::Nothing,
        }
    }

    pub(crate) fn known(self, known: Known) -> Scene {
        Scene { known, ..self }
    }

    pub(crate) fn start(&self) -> f64 {
        self.motion.joint_times()[0]
    }

    pub(crate) fn end(&self) -> f64 {
        self.motion.joint_times()[self.motion.spans().len()]
    }

    pub(crate) fn duration(&self) -> f64 {
        self.end() - self.start()
    }

    pub(crate) fn sides(&self, obstacle: usize) -> [Mover<'_>; 2] {
        [
            Mover {
                shape: &self.body,
                motion: Some(&self.motion),
            },
            Mover {
                shape: &self.obstacles[obstacle].shape,
                motion: self.obstacles[obstacle].motion.as_ref(),
            },
        ]
    }

    pub(crate) fn search(&self, obstacle: usize, offset: f64) -> Search<'_> {
        Search::new(self.sides(obstacle), [self.start(), self.end()], offset)
    }

    /// The slow answer for one obstacle, with containment where a surface is closed.
    pub(crate) fn slow(&self, obstacle: usize, offset: f64) -> Slow {
        let sides = self.sides(obstacle);
        let closed = [true, is_closed(&self.obstacles[obstacle].shape)];
        let start = self.start();
        if starts_inside(sides, closed, start) {
            return Slow::Contact {
                clear_until: start,
                by: start,
            };
        }
        self.search(obstacle, offset).run()
    }

    /// The scene in a frame with another unit and origin; generators and poses follow.
    pub(crate) fn in_frame(&self, frame: &DAffine3) -> Scene {
        let place = |shape: &Shape| shapes::mapped(shape.clone(), |p| frame.transform_point3(p));
        let carried = |motion: &Motion| mapped_motion(motion, frame);
        Scene {
            body: place(&self.body),
            motion: carried(&self.motion),
            obstacles: self
                .obstacles
                .iter()
                .map(|obstacle| Obstacle {
                    shape: place(&obstacle.shape),
                    motion: obstacle.motion.as_ref().map(carried),
                })
                .collect(),
            ..self.clone()
        }
    }
}

/// The same motion of a body that is given in another frame. For motions from spans.
pub(crate) fn mapped_motion(motion: &Motion, frame: &DAffine3) -> Motion {
    let inverse = frame.inverse();
    let spans = motion.spans().iter().map(|span| {
        Span::new(span.flow().generator().in_frame(&inverse), span.duration()).expect("finite")
    });
    Motion::from_spans(spans.collect()).expect("a legal motion")
}

/// One span of a duration other than 1, so that the clock and the span are not mixed up.
pub(crate) fn steady(generator: Generator) -> Motion {
    chain(&[generator])
}

/// A chain of spans of duration 2, 4, 8, ..
pub(crate) fn chain(generators: &[Generator]) -> Motion {
    let mut duration = 1.0;
    let spans = generators.iter().map(|&generator| {
        duration *= 2.0;
        Span::new(generator, duration).expect("finite")
    });
    Motion::from_spans(spans.collect()).expect("a legal motion")
}

/// Whether every edge is run through equally often in both senses.
pub(crate) fn is_closed((_, triangles): &Shape) -> bool {
    let mut balance: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *balance.entry([from.min(to), from.max(to)]).or_default() +=
                if from < to { 1 } else { -1 };
        }
    }
    balance.values().all(|&sum| sum == 0)
}

/// Smallest distance of the triangles of two surfaces.
pub(crate) fn gap(a: &Shape, b: &Shape) -> f64 {
    let corners = |(positions, triangles): &Shape| -> Vec<distance::Triangle> {
        triangles
            .iter()
            .map(|triangle| triangle.map(|k| positions[k as usize]))
            .collect()
    };
    let (a, b) = (corners(a), corners(b));
    a.iter()
        .flat_map(|x| b.iter().map(|y| distance::distance(x, y)))
        .fold(f64::INFINITY, f64::min)
}

pub(crate) fn moved(shape: Shape, by: DVec3) -> Shape {
    shapes::mapped(shape, |p| p + by)
}

pub(crate) fn tetrahedron() -> Shape {
    let corners = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
        .map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z)) / 3.0_f64.sqrt());
    (
        corners.to_vec(),
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
    )
}

pub(crate) fn octahedron() -> Shape {
    let positions = vec![
        DVec3::X,
        -DVec3::X,
        DVec3::Y,
        -DVec3::Y,
        DVec3::Z,
        -DVec3::Z,
    ];
    let triangles = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    (positions, triangles)
}

/// A box about the origin.
pub(crate) fn brick(size: DVec3) -> Shape {
    shapes::cuboid(-size / 2.0, size / 2.0)
}

/// An open rectangle in the plane z = 0 about the origin: two triangles.
pub(crate) fn sheet(width: f64, depth: f64) -> Shape {
    let (x, y) = (width / 2.0, depth / 2.0);
    let corners = [(-x, -y), (x, -y), (x, y), (-x, y)];
    (
        corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
        vec![[0, 1, 2], [0, 2, 3]],
    )
}

/// A ball of 20 or 80 triangles, with vertices pushed in or out.
pub(crate) fn star(random: &mut Random, subdivisions: u32) -> Shape {
    let (mut positions, triangles) = shapes::icosphere(subdivisions, 1.0, DVec3::ZERO);
    for position in &mut positions {
        *position *= random.between(0.5, 1.1);
    }
    (positions, triangles)
}

/// A bar with teeth towards +z: an extruded comb.
pub(crate) fn comb(teeth: u32) -> Shape {
    let mut outline = vec![glam::DVec2::new(0.0, 0.0)];
    let width = 1.0 / f64::from(2 * teeth - 1);
    outline.push(glam::DVec2::new(1.0, 0.0));
    for k in (0..teeth).rev() {
        let left = 2.0 * f64::from(k) * width;
        outline.extend([
            glam::DVec2::new(left + width, 0.6),
            glam::DVec2::new(left, 0.6),
        ]);
        if k > 0 {
            outline.extend([
                glam::DVec2::new(left, 0.2),
                glam::DVec2::new(left - width, 0.2),
            ]);
        }
    }
    // The last tooth begins at (1, 0.6): the corner (1, 0) stays, (0, 0.6) closes to (0, 0).
    shapes::mapped(shapes::prism(&outline, 0.15), |p| {
        DVec3::new(p.x - 0.5, p.z - 0.075, p.y - 0.3)
    })
}

/// Any small closed body about the origin, of size about 1, turned at random.
pub(crate) fn any_body(random: &mut Random) -> Shape {
    let shape = match random.below(8) {
        0 => tetrahedron(),
        1 => brick(DVec3::new(
            random.between(0.4, 1.4),
            random.between(0.4, 1.4),
            random.between(0.4, 1.4),
        )),
        2 => brick(DVec3::new(1.5, random.between(0.2, 1.0), 0.02)),
        3 => brick(DVec3::new(2.0, 0.1, 0.1)),
        4 => octahedron(),
        5 => shapes::mapped(shapes::l_prism(random.between(0.2, 0.5), 0.4), |p| {
            p - DVec3::new(0.4, 0.4, 0.2)
        }),
        6 => star(random, 0),
        _ => shapes::mapped(shapes::cone(0.5, 1.0, 5), |p| p - DVec3::Z * 0.4),
    };
    turned(random, shape)
}

/// Any body or an open sheet.
pub(crate) fn any_obstacle(random: &mut Random) -> Shape {
    if random.chance(0.25) {
        let sheet = sheet(random.between(0.3, 3.0), random.between(0.3, 3.0));
        turned(random, sheet)
    } else {
        any_body(random)
    }
}

pub(crate) fn turned(random: &mut Random, shape: Shape) -> Shape {
    let rotation = random.rotation();
    shapes::mapped(shape, |p| rotation * p)
}
