//! Single pairs of features, one of them moving: random ones, most of them nasty, and the answer of
//! the slow method.

use super::super::random::Random;
use super::distance::Triangle;
use super::reference::{DOUBTFUL, Mover, Search, Slow};
use crate::support::membership::exponential;
use crate::support::shapes::Shape;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;
use steadysweep::collision::pair::{PairOutcome, edge_edge, face_vertex, vertex_face};
use steadysweep::motion::{Generator, Motion, Span};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    VertexFace,
    FaceVertex,
    EdgeEdge,
}

/// A moving feature against one at rest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    pub(crate) kind: Kind,
    pub(crate) generator: Generator,
    /// Four points, those of the moving feature first.
    pub(crate) points: [DVec3; 4],
    pub(crate) window: [f64; 2],
}

impl Pair {
    pub(crate) fn outcome(&self) -> PairOutcome {
        let Pair {
            generator, window, ..
        } = self;
        let [a, b, c, d] = self.points;
        match self.kind {
            Kind::VertexFace => vertex_face(generator, a, [b, c, d], *window),
            Kind::FaceVertex => face_vertex(generator, [a, b, c], d, *window),
            Kind::EdgeEdge => edge_edge(generator, [a, b], [c, d], *window),
        }
    }

    /// Number of points of the moving feature.
    fn moving(&self) -> usize {
        match self.kind {
            Kind::VertexFace => 1,
            Kind::FaceVertex => 3,
            Kind::EdgeEdge => 2,
        }
    }

    fn shapes(&self) -> [Shape; 2] {
        let shape = |points: &[DVec3]| {
            let last = points.len() as u32 - 1;
            (points.to_vec(), vec![[0, 1.min(last), last]])
        };
        let (moving, resting) = self.points.split_at(self.moving());
        [shape(moving), shape(resting)]
    }

    /// All four points at a time.
    fn at(&self, time: f64) -> [DVec3; 4] {
        let pose = exponential(&self.generator.linear, self.generator.offset, time);
        let mut points = self.points;
        for point in &mut points[..self.moving()] {
            *point = pose.transform_point3(*point);
        }
        points
    }

    /// Contact is certain where one feature changes the side of the other on which it lies, while
    /// both are well inside each other's range.
    pub(crate) fn slow(&self) -> Slow {
        let [moving, resting] = self.shapes();
        let span = Span::new(self.generator, 1.0).expect("finite");
        let motion = Motion::from_spans(vec![span]).expect("a motion");
        let sides = [(&moving, Some(&motion)), (&resting, None)]
            .map(|(shape, motion)| Mover { shape, motion });
        let mut search = Search::new(sides, self.window, 0.0);
        let unclear = search.first_doubt();
        if search.has_given_up() {
            return Slow::GivenUp;
        }
        let Some(clear_until) = unclear else {
            return Slow::Clear;
        };
        let (mut step, before) = (1e-12, self.height(clear_until));
        while step < 1e-4 && clear_until + step <= self.window[1] {
            let by = clear_until + step;
            let after = self.height(by);
            let certain = |height: f64| height.abs() > 1e-14 * search.largest();
            if before * after < 0.0
                && certain(before)
                && certain(after)
                && [clear_until, by]
                    .iter()
                    .all(|&time| self.depth(time) > 0.1 * step + DOUBTFUL * search.largest())
                && self.height_is_smooth([clear_until, by])
            {
                return Slow::Contact { clear_until, by };
            }
            step *= 1.5;
        }
        Slow::Doubt {
            clear_until,
            until: search.doubt_ends(clear_until),
        }
    }

    /// Whether the direction along which the height is measured is certain and hardly turns: edges
    /// that are nearly parallel flip it, and so do faces almost without area.
    fn height_is_smooth(&self, times: [f64; 2]) -> bool {
        let [from, to] = times.map(|time| {
            let [a, b, c, d] = self.at(time);
            let [p, q] = match self.kind {
                Kind::VertexFace => [c - b, d - b],
                Kind::FaceVertex => [b - a, c - a],
                Kind::EdgeEdge => [b - a, d - c],
            };
            let sine = p.cross(q) / (p.length() * q.length());
            if sine.length() > 1e-3 {
                sine.normalize()
            } else {
                DVec3::ZERO
            }
        });
        from.dot(to) > 0.9
    }

    /// The signed distance of the vertex from the plane, or of the lines of the edges.
    fn height(&self, time: f64) -> f64 {
        let [a, b, c, d] = self.at(time);
        match self.kind {
            Kind::VertexFace => (a - b).dot((c - b).cross(d - b).normalize_or_zero()),
            Kind::FaceVertex => (d - a).dot((b - a).cross(c - a).normalize_or_zero()),
            Kind::EdgeEdge => (c - a).dot((b - a).cross(d - c).normalize_or_zero()),
        }
    }

    /// The smallest of the weights of the points in the place of contact, times the size: its
    /// distance from the boundary of the features, up to a constant.
    fn depth(&self, time: f64) -> f64 {
        let [a, b, c, d] = self.at(time);
        let in_triangle = |[a, b, c]: Triangle, p: DVec3| {
            let normal = (b - a).cross(c - a);
            let share = |q: DVec3, r: DVec3| (r - q).cross(p - q).dot(normal);
            share(a, b).min(share(b, c)).min(share(c, a)) / normal.length_squared()
        };
        match self.kind {
            Kind::VertexFace => in_triangle([b, c, d], a),
            Kind::FaceVertex => in_triangle([a, b, c], d),
            Kind::EdgeEdge => {
                let (p, q, r) = (b - a, d - c, c - a);
                let across = p.cross(q);
                let square = across.length_squared();
                let s = r.cross(q).dot(across) / square;
                let t = r.cross(p).dot(across) / square;
                s.min(1.0 - s).min(t).min(1.0 - t)
            }
        }
    }
}

/// Screws with any turn, spirals, shears, Jordan blocks, scalings, translations, any affine motion,
/// rest.
pub(crate) fn any_generator(random: &mut Random) -> Generator {
    let screw = |random: &mut Random, turn: f64, scale: f64| {
        Generator::screw(
            random.direction(),
            random.point(1.0),
            turn * random.sign(),
            random.between(-1.5, 1.5),
            scale,
        )
    };
    match random.below(10) {
        0..3 => {
            let turn = random.between(10.0, 90.0) * PI / 180.0;
            screw(random, turn, 1.0)
        }
        3..5 => {
            let turn = random.between(180.0, 1080.0) * PI / 180.0;
            screw(random, turn, 1.0)
        }
        5 => {
            let (turn, scale) = (random.between(0.0, 4.0), random.magnitude(1e-3, 4.0));
            screw(random, turn, scale)
        }
        6 => Generator::translation(random.point(2.0)),
        7 => {
            let along = random.direction();
            let across = along.any_orthonormal_vector() * random.between(0.3, 3.0);
            Generator {
                linear: DMat3::from_cols(along * across.x, along * across.y, along * across.z),
                offset: random.point(1.0),
            }
        }
        8 => {
            let rate = random.one_of(&[0.0, 0.0, -0.7, 0.4]);
            let one = random.one_of(&[1.0, 2.0]);
            let form = DMat3::from_cols_array(&[rate, 0.0, 0.0, one, rate, 0.0, 0.0, one, rate]);
            let turn = DMat3::from_quat(random.rotation());
            Generator {
                linear: turn * form * turn.transpose(),
                offset: random.point(1.5),
            }
        }
        _ => Generator {
            linear: random.matrix(1.5),
            offset: random.point(1.5),
        },
    }
}

/// A pair of the kind; about half of them meet.
pub(crate) fn any_pair(random: &mut Random, kind: Kind) -> Pair {
    let generator = if random.chance(0.02) {
        Generator::translation(DVec3::ZERO)
    } else {
        any_generator(random)
    };
    let time = random.between(0.0, 1.0);
    let pose = exponential(&generator.linear, generator.offset, time);
    let size = random.magnitude(0.02, 1.5);
    // At this time the features meet, barely miss, or are anywhere.
    let place = random.point(1.0);
    let velocity = generator.velocity(place).normalize_or(DVec3::X);
    let off = match random.below(10) {
        0..5 => DVec3::ZERO,
        5 => random.direction() * random.magnitude(1e-8, 1e-1),
        _ => random.direction() * random.between(0.0, 1.5),
    };
    let corner = |random: &mut Random, plane: Option<DVec3>| {
        let way = random.direction() * size;
        // In the plane, for double roots and for sliding.
        plane.map_or(way, |normal| way.reject_from_normalized(normal))
    };
    let normal = random.direction();
    let plane = match random.below(8) {
        0 => Some(velocity.cross(normal).normalize_or(DVec3::Z)),
        1 => Some(DVec3::Z),
        _ => None,
    };
    let centred = |random: &mut Random, points: [DVec3; 3]| {
        // A random point of the triangle, in some cases on a side or corner, comes to the place.
        let [mut s, mut t] = [random.unit(), random.unit()];
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        match random.below(12) {
            0 => s = 0.0,
            1 => (s, t) = (0.0, 0.0),
            2 => t = 1e-9,
            _ => {}
        }
        let inner = points[0] + (points[1] - points[0]) * s + (points[2] - points[0]) * t;
        points.map(|point| point - inner)
    };
    let mut points = match kind {
        Kind::VertexFace | Kind::FaceVertex => {
            let first = corner(random, plane);
            let second = corner(random, plane);
            let mut third = corner(random, plane);
            if random.chance(0.02) {
                // Without area.
                third = first + (second - first) * random.one_of(&[0.0, 0.5, 1.0]);
            }
            let [a, b, c] = centred(random, [first, second, third]);
            [DVec3::ZERO, a, b, c]
        }
        Kind::EdgeEdge => {
            let mut ways = [corner(random, plane), corner(random, plane)];
            if random.chance(0.05) {
                // Parallel at that time.
                ways[1] = ways[0] * random.one_of(&[1.0, -0.5, 2.0]);
            }
            let shares = [0, 1].map(|_| match random.below(12) {
                0 => 0.0,
                1 => 1.0,
                _ => random.unit(),
            });
            let [p, q] = ways;
            [
                -p * shares[0],
                p * (1.0 - shares[0]),
                -q * shares[1],
                q * (1.0 - shares[1]),
            ]
        }
    };
    if kind == Kind::FaceVertex {
        points.rotate_left(1);
    }
    let back = pose.inverse();
    let moving = match kind {
        Kind::VertexFace => 1,
        Kind::FaceVertex => 3,
        Kind::EdgeEdge => 2,
    };
    for (index, point) in points.iter_mut().enumerate() {
        *point = if index < moving {
            back.transform_point3(place + *point)
        } else {
            place + off + *point
        };
    }
    let window = match random.below(5) {
        0 => [random.between(0.0, 0.5), random.between(0.5, 1.0)],
        _ => [0.0, 1.0],
    };
    Pair {
        kind,
        generator,
        points,
        window,
    }
}

/// Pairs whose answer is barely decided or depends on symmetry: sliding in a plane, tangency, edges
/// that stay parallel.
pub(crate) fn degenerate_pair(random: &mut Random, kind: Kind) -> Pair {
    let turn = Generator::screw(DVec3::Z, DVec3::ZERO, random.between(0.5, 18.0), 0.0, 1.0);
    let slide = Generator::translation(DVec3::new(random.one_of(&[0.5, 1.0, 2.0]), 0.0, 0.0));
    let generator = if random.chance(0.5) { turn } else { slide };
    let height = random.one_of(&[0.0, 0.0, 1e-9, -1e-6]);
    let flat = |random: &mut Random, z: f64| {
        DVec3::new(
            (random.between(-1.0, 1.0) * 8.0).round() / 8.0,
            (random.between(-1.0, 1.0) * 8.0).round() / 8.0,
            z,
        )
    };
    let points = match kind {
        Kind::VertexFace => [
            flat(random, height),
            flat(random, 0.0),
            flat(random, 0.0),
            flat(random, 0.0),
        ],
        Kind::FaceVertex => [
            flat(random, height),
            flat(random, height),
            flat(random, height),
            flat(random, 0.0),
        ],
        Kind::EdgeEdge => {
            let (a, b) = (flat(random, height), flat(random, 0.0));
            let way = if random.chance(0.5) {
                // Along the axis: always parallel.
                DVec3::Z
            } else {
                DVec3::new(0.5, 0.25, 0.0)
            };
            [a, a + way, b, b + way * random.one_of(&[1.0, 0.5, -1.0])]
        }
    };
    Pair {
        kind,
        generator,
        points,
        window: [0.0, 1.0],
    }
}
