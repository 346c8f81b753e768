//! Membership in needles, plates and slivers under motions that stretch and squeeze them: every
//! reported interval must be near the body at its start, middle and end, and no visit may be
//! missed.

use crate::support::membership::{Sampled, distance, exponential, winding_number};
use crate::support::random::pseudo_random;
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use steadysweep::body::Mesh;
use steadysweep::membership::Membership;
use steadysweep::motion::{Generator, Motion, Span};

/// Largest distance of a reported time from the body, as a share of its size.
const CLOSE: f64 = 1e-9;

fn membership(shape: &Shape, generator: Generator) -> (Membership, Motion) {
    let mesh = Mesh::new(shape.0.clone(), shape.1.clone()).expect("the shapes are bodies");
    let span = Span::new(generator, 1.0).expect("finite");
    let motion = Motion::from_spans(vec![span]).expect("a legal motion");
    (Membership::new(&mesh, &motion), motion)
}

fn stretching(rates: DVec3, offset: DVec3) -> Generator {
    Generator {
        linear: DMat3::from_diagonal(rates),
        offset,
    }
}

#[test]
fn a_point_that_passes_the_plane_of_a_needle_far_from_it_is_never_inside() {
    let half = DVec3::new(0.5, 4.999_999_873_689_376e-5, 4.999_999_873_689_376e-5);
    let needle = shapes::cuboid(-half, half);
    let generator = stretching(DVec3::new(-8.0, 0.5, 0.0), DVec3::new(0.0, 0.0, 0.2));
    let (membership, _) = membership(&needle, generator);
    // The needle never gets beyond x = 1/2. The point passes the plane of a side at t = 0.036,
    // where the needle ends at x = 0.374.
    let point = DVec3::new(
        0.537_773_763_675_783_8,
        5.091_391_667_487_76e-5,
        0.005_576_812_374_802_66,
    );
    assert_eq!(membership.intervals(point), [[0.0; 2]; 0], "it is 0.16 off");
    assert!(!membership.is_ever_inside(point), "it is 0.16 off");
}

/// A tetrahedron over a needle of a triangle: sharp at both ends.
fn splinter() -> Shape {
    let positions = vec![
        DVec3::ZERO,
        DVec3::X,
        DVec3::new(0.4, 1e-5, 0.0),
        DVec3::new(0.6, 0.0, 1e-5),
    ];
    (positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
}

fn thin_bodies() -> Vec<(&'static str, Shape)> {
    let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 0.7));
    let needle = shapes::cuboid(DVec3::new(-0.5, -5e-5, -5e-5), DVec3::new(0.5, 5e-5, 5e-5));
    let plate = shapes::cuboid(DVec3::new(-0.5, -0.4, -1e-6), DVec3::new(0.5, 0.4, 1e-6));
    let spike = shapes::cone(1e-4, 1.0, 7);
    vec![
        (
            "needle, turned",
            shapes::mapped(needle.clone(), |p| turn * p),
        ),
        ("needle", needle),
        ("plate, turned", shapes::mapped(plate.clone(), |p| turn * p)),
        ("plate", plate),
        ("splinter, turned", shapes::mapped(splinter(), |p| turn * p)),
        ("splinter", splinter()),
        ("spike", spike),
    ]
}

fn violent_motions() -> Vec<(&'static str, Generator)> {
    let turn = DMat3::from_quat(DQuat::from_scaled_axis(DVec3::new(-0.3, 0.8, 0.5)));
    let tilted = |rates: DVec3| Generator {
        linear: turn * DMat3::from_diagonal(rates) * turn.transpose(),
        offset: DVec3::new(0.1, -0.2, 0.3),
    };
    let rates = DVec3::new(-8.0, 0.5, 0.0);
    let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
    let screw = |turns: f64, scale: f64| {
        Generator::screw(
            axis,
            DVec3::new(0.1, 0.0, 0.2),
            turns * std::f64::consts::TAU,
            0.3,
            scale,
        )
    };
    let shear = Generator {
        linear: DMat3::from_cols(
            DVec3::new(0.2, 0.0, 0.1),
            DVec3::new(30.0, -0.3, 0.0),
            DVec3::ZERO,
        ),
        offset: DVec3::new(0.0, 0.3, 0.2),
    };
    vec![
        ("shrinking along x", stretching(rates, DVec3::Z * 0.2)),
        ("growing along x", stretching(-rates, DVec3::Z * 0.2)),
        ("shrinking aslant", tilted(rates)),
        ("growing aslant", tilted(-rates)),
        ("squeezed", tilted(DVec3::new(-4.0, 4.0, 0.1))),
        ("barely moved", stretching(rates * 1e-3, DVec3::Z * 1e-4)),
        ("sheared", shear),
        ("shrinking spiral", screw(1.3, 1e-3)),
        ("growing spiral", screw(0.8, 1e3)),
        ("screw", screw(2.6, 1.0)),
    ]
}

/// A point inside, on or near the surface, or in the plane of a face or on the line of an edge but
/// beyond it.
fn seen(shape: &Shape, numbers: &mut impl Iterator<Item = f64>) -> DVec3 {
    let mut number = || numbers.next().expect("endless");
    let index = (number() * shape.1.len() as f64).floor();
    let corners = shape
        .1
        .iter()
        .zip(0_u32..)
        .find(|(_, k)| f64::from(*k) == index)
        .map(|(triangle, _)| triangle.map(|corner| shape.0[corner as usize]))
        .expect("an index in range");
    let [a, b, c] = corners;
    let kind = (number() * 5.0).floor();
    let reach = 10_f64.powf(-6.0 * number());
    let (u, v) = (number(), number());
    if kind < 1.0 {
        // Any convex combination of corners: inside, because the bodies are convex.
        let far = shape.0.iter().fold(DVec3::ZERO, |sum, p| sum + p) / shape.0.len() as f64;
        a.lerp(b, u).lerp(c, v).lerp(far, number())
    } else if kind < 2.0 {
        a.lerp(b, u).lerp(c, v)
    } else if kind < 3.0 {
        // On the line of an edge, beyond it.
        b + (b - a) * reach
    } else if kind < 4.0 {
        // In the plane, anywhere around.
        a + (b - a) * (3.0 * u - 1.0) + (c - a) * (3.0 * v - 1.0)
    } else {
        let aside = DVec3::new(number(), number(), number()) - DVec3::splat(0.5);
        a.lerp(b, u).lerp(c, v) + aside * reach
    }
}

/// Checks that panic where the intervals of a point disagree with the moving body.
struct Attack<'a> {
    name: String,
    shape: &'a Shape,
    generator: Generator,
    membership: &'a Membership,
    sampled: &'a Sampled<'a>,
}

impl Attack<'_> {
    fn pose(&self, time: f64) -> DAffine3 {
        exponential(&self.generator.linear, self.generator.offset, time)
    }

    /// Upper bound of the distance of the point from the moving body in the world, as a share of
    /// the body's size there or at rest, whichever is larger; 0 inside.
    ///
    /// In the world, a sliver may be too long for a plain cross product: the distance is measured
    /// at rest and transformed.
    fn relative_distance(&self, point: DVec3, time: f64) -> f64 {
        let pose = self.pose(time);
        let seen = pose.inverse().transform_point3(point);
        if winding_number(self.shape, seen) >= 1 {
            return 0.0;
        }
        let columns = pose.matrix3.to_cols_array();
        let stretch = columns.iter().map(|x| x * x).sum::<f64>().sqrt();
        let size = |shape: &Shape| {
            let extents = shape.0.iter().map(|p| p.distance(shape.0[0]));
            extents.fold(0.0, f64::max)
        };
        let moved = shapes::mapped(self.shape.clone(), |p| pose.transform_point3(p));
        distance(self.shape, seen) * stretch / size(&moved).max(size(self.shape))
    }

    /// The number of intervals, and their largest distance from the body.
    fn check(&self, point: DVec3) -> (usize, f64) {
        let intervals = self.membership.intervals(point);
        let mut worst = 0.0_f64;
        for &[start, end] in &intervals {
            for time in [start, start + (end - start) / 2.0, end] {
                let away = self.relative_distance(point, time);
                assert!(
                    away <= CLOSE,
                    "{}: {point:?} is {away:e} sizes off at {time}; {intervals:?}",
                    self.name
                );
                worst = worst.max(away);
            }
        }
        assert_eq!(
            self.membership.is_ever_inside(point),
            !intervals.is_empty(),
            "{}: {point:?}",
            self.name
        );
        // In the frame of the body, at all sampled times.
        self.sampled.check(point, &intervals, CLOSE);
        (intervals.len(), worst)
    }
}

#[test]
fn intervals_of_thin_bodies_under_violent_motions_are_sound_and_complete() {
    let mut numbers = pseudo_random(5);
    for (body_name, shape) in &thin_bodies() {
        for (motion_name, generator) in violent_motions() {
            let (membership, motion) = membership(shape, generator);
            let sampled = Sampled::new(shape, &motion, 100);
            let attack = Attack {
                name: format!("{body_name}, {motion_name}"),
                shape,
                generator,
                membership: &membership,
                sampled: &sampled,
            };
            let (mut visits, mut worst) = (0, 0.0_f64);
            for k in 0..150 {
                let number = numbers.next().expect("endless");
                let time = [0.0, 1.0, number, number][k % 4];
                let point = attack
                    .pose(time)
                    .transform_point3(seen(shape, &mut numbers));
                let (count, away) = attack.check(point);
                visits += count;
                worst = worst.max(away);
            }
            println!("{}: {visits} visits, {worst:e} off at most", attack.name);
            assert!(visits > 30, "{}: too few visits, {visits}", attack.name);
        }
    }
}
