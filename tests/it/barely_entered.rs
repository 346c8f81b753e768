//! All times at which something is barely deeper than allowed: pegs in fitting holes, and a convex
//! body whose greatest depth is almost the allowed one.

use crate::support::contact::scene::Scene;
use crate::support::shapes::{self, Shape};
use glam::{DMat4, DQuat, DVec2, DVec3, DVec4};
use std::f64::consts::{PI, TAU};
use steadysweep::collision::{Check, CheckSettings, ContactRule};
use steadysweep::motion::{Generator, Motion, Span};

fn deeper_than(depth: f64) -> CheckSettings<'static> {
    CheckSettings::default()
        .with_rules(vec![ContactRule::Enter { depth: Some(depth) }])
        .with_all_intervals()
}

fn times(check: &Check) -> Vec<[f64; 2]> {
    let intervals = check.intervals.iter().flatten();
    intervals.map(|interval| interval.times).collect()
}

fn polygon(corners: u32, radius: f64) -> Vec<DVec2> {
    let angle = |k| TAU * f64::from(k) / f64::from(corners);
    (0..corners)
        .map(|k| radius * DVec2::from_angle(angle(k)))
        .collect()
}

/// A prism with a hole along its axis, both with the same number of sides.
fn bush(sides: u32, [hole, outside]: [f64; 2], [low, high]: [f64; 2]) -> Shape {
    let mut positions = Vec::new();
    for (radius, z) in [(hole, low), (hole, high), (outside, high), (outside, low)] {
        positions.extend(polygon(sides, radius).into_iter().map(|p| p.extend(z)));
    }
    let mut triangles = Vec::new();
    for ring in 0..4 {
        for k in 0..sides {
            let next = (k + 1) % sides;
            let [a, b] = [k, next].map(|k| ring * sides + k);
            let [c, d] = [next, k].map(|k| (ring + 1) % 4 * sides + k);
            triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    (positions, triangles)
}

#[test]
fn a_peg_that_turns_in_a_fitting_hole_is_as_deep_before_the_half_as_after() {
    // Down into the hole, side on side; then on by one side. A corner is at first on an edge, then
    // beyond a side by as much as the cosine says, and at the end on the next edge.
    let radius = 2.0;
    for sides in [6, 24] {
        let peg = shapes::prism(&polygon(sides, radius), 4.0);
        let hole = bush(sides, [radius, 4.0], [-5.0, 0.0]);
        let side = TAU / f64::from(sides);
        let generators = [
            Generator::translation(DVec3::NEG_Z * 4.0),
            Generator::screw(DVec3::Z, DVec3::ZERO, side, 0.0, 1.0),
        ];
        let spans = generators.map(|way| Span::new(way, 1.0).expect("finite"));
        let motion = Motion::from_spans(spans.to_vec()).expect("a motion");
        let scene = Scene::new(peg, motion, hole);
        let apothem = (PI / f64::from(sides)).cos();
        let greatest = radius * (1.0 - apothem);
        for depth in [0.005, 0.5 * greatest, 0.999 * greatest] {
            let turned = 0.5 * side - (apothem + depth / radius).acos();
            let start = 1.0 + turned / side;
            let check = scene.check(&deeper_than(depth));
            let found = times(&check);
            let [[from, to]] = found[..] else {
                panic!("{sides}, {depth}: {found:?} for [{start}, {}]", 3.0 - start);
            };
            // Near the greatest depth, the depth changes slowly: rounding of positions decides for
            // longer.
            let within = if depth > 0.9 * greatest { 1e-7 } else { 1e-9 };
            assert!(
                (from - start).abs() < within,
                "{sides}, {depth}: {from} for {start}"
            );
            assert!(
                (from + to - 3.0).abs() < within,
                "{sides}, {depth}: [{from}, {to}]"
            );
            assert!(check.doubts.is_empty(), "{:?}", check.doubts);
        }
    }
}

/// The convex hull of points in general position, by trying all triangles.
fn hull(points: &[DVec3]) -> Shape {
    let mut triangles = Vec::new();
    let count = points.len();
    for (i, j, k) in (0..count)
        .flat_map(|i| (i + 1..count).flat_map(move |j| (j + 1..count).map(move |k| (i, j, k))))
    {
        let normal = (points[j] - points[i]).cross(points[k] - points[i]);
        let mut heights = (0..count)
            .filter(|&other| ![i, j, k].contains(&other))
            .map(|other| normal.dot(points[other] - points[i]));
        let [i, j, k] = [i, j, k].map(|corner| u32::try_from(corner).expect("few"));
        if heights.clone().all(|height| height < 0.0) {
            triangles.push([i, j, k]);
        } else if heights.all(|height| height > 0.0) {
            triangles.push([i, k, j]);
        }
    }
    // Drops the points that are inside.
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let number =
        |corner: u32| u32::try_from(used.binary_search(&corner).expect("it is used")).expect("few");
    let corners = used.iter().map(|&corner| points[corner as usize]).collect();
    let triangles = triangles.iter().map(|t| t.map(number)).collect();
    (corners, triangles)
}

/// A convex body that moves along a screw in a time of 1, and a convex obstacle at rest.
struct Convex {
    body: Shape,
    obstacle: Shape,
    axis: DVec3,
    through: DVec3,
    angle: f64,
    advance: f64,
}

impl Convex {
    fn check(&self, depth: f64) -> Check {
        let screw = Generator::screw(self.axis, self.through, self.angle, self.advance, 1.0);
        let span = Span::new(screw, 1.0).expect("finite");
        let motion = Motion::from_spans(vec![span]).expect("a motion");
        Scene::new(self.body.clone(), motion, self.obstacle.clone()).check(&deeper_than(depth))
    }

    /// The greatest depth at a time; when negative, a measure of how far the two are apart.
    ///
    /// It is the greatest s for which some x is below all planes of the body and, by s, below all
    /// of the obstacle: a linear program. The solution is a point where four of the planes meet and
    /// which is below all others. All such points are tried.
    fn depth(&self, time: f64) -> f64 {
        let turn = DQuat::from_axis_angle(self.axis, self.angle * time);
        let place =
            |p: DVec3| self.through + turn * (p - self.through) + self.axis * (self.advance * time);
        let body = shapes::mapped(self.body.clone(), place);
        let mut planes = sides(&body, 0.0);
        planes.extend(sides(&self.obstacle, 1.0));
        let count = planes.len();
        let mut greatest = f64::NEG_INFINITY;
        for i in 0..count {
            for j in i + 1..count {
                for k in j + 1..count {
                    for l in k + 1..count {
                        let four = [i, j, k, l].map(|number| planes[number]);
                        let rows = four.map(|(normal, _)| normal);
                        let matrix = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]);
                        if matrix.determinant().abs() < 1e-9 {
                            continue;
                        }
                        let heights = DVec4::from_array(four.map(|(_, height)| height));
                        let place = matrix.transpose().inverse() * heights;
                        let is_under =
                            |&(normal, height): &(DVec4, f64)| normal.dot(place) <= height + 1e-10;
                        if place.w > greatest && planes.iter().all(is_under) {
                            greatest = place.w;
                        }
                    }
                }
            }
        }
        greatest
    }

    /// The time of the greatest depth, and that depth, as far as samples show.
    fn deepest(&self) -> (f64, f64) {
        let at = |time: f64| (time, self.depth(time));
        let best = |times: Vec<f64>| {
            let all = times.into_iter().map(at);
            all.max_by(|a, b| a.1.total_cmp(&b.1)).expect("some")
        };
        let mut found = best(
            (0..=SAMPLES)
                .map(|k| f64::from(k) / f64::from(SAMPLES))
                .collect(),
        );
        let mut step = 1.0 / f64::from(SAMPLES);
        while step > 1e-9 {
            let around = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|by| found.0 + by * step);
            found = best(around.map(|time| time.clamp(0.0, 1.0)).to_vec());
            step *= 0.5;
        }
        found
    }

    /// The defects of the times that are found; empty when there are none.
    fn defects(&self, depth: f64, deepest: f64) -> String {
        let check = self.check(depth);
        let found = times(&check);
        let doubts: Vec<[f64; 2]> = check.doubts.iter().map(|doubt| doubt.times).collect();
        let is_in = |all: &[[f64; 2]], time: f64, by: f64| {
            let mut all = all.iter();
            all.any(|&[from, to]| from - by <= time && time <= to + by)
        };
        let mut defects = Vec::new();
        let around = (-10..=10).map(|k| deepest + 0.2 / f64::from(SAMPLES) * f64::from(k));
        let samples = (0..=SAMPLES).map(|k| f64::from(k) / f64::from(SAMPLES));
        for time in samples.chain(around.filter(|time| (0.0..=1.0).contains(time))) {
            let excess = self.depth(time) - depth;
            if excess > FINE && !is_in(&found, time, 1e-9) {
                defects.push(format!("not listed: {time}, {excess:e} too deep"));
            }
            if excess < -FINE && is_in(&found, time, -1e-9) && !is_in(&doubts, time, 1e-9) {
                defects.push(format!("listed: {time}, {excess:e} too deep"));
            }
        }
        for &end in found.iter().flatten() {
            let excess = self.depth(end) - depth;
            let is_inner = end > 0.0 && end < 1.0 && !is_in(&doubts, end, 1e-9);
            if is_inner && excess.abs() > FINE {
                defects.push(format!("ends: {end}, {excess:e} too deep"));
            }
        }
        let in_doubt: f64 = doubts.iter().map(|[from, to]| to - from).sum();
        if in_doubt > MOST_DOUBT {
            defects.push(format!("in doubt: {doubts:?}"));
        }
        if defects.is_empty() {
            return String::new();
        }
        format!("{} ({found:?}, {doubts:?})", defects.join(", "))
    }
}

/// Number of times at which the slow method examines the whole motion.
const SAMPLES: u32 = 40;

/// Largest error of depths.
const FINE: f64 = 1e-8;

/// Part of the motion that may be in doubt.
const MOST_DOUBT: f64 = 1e-2;

/// Planes of the sides of a convex body: a normal, with a weight as its last coordinate, and a
/// height.
fn sides((positions, triangles): &Shape, weight: f64) -> Vec<(DVec4, f64)> {
    let side = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|corner| positions[corner as usize]);
        let normal = (b - a).cross(c - a).normalize();
        (normal.extend(weight), normal.dot(a))
    };
    triangles.iter().map(side).collect()
}

#[test]
fn after_a_short_stay_barely_too_deep_the_rest_is_not_listed() {
    let scene = Convex {
        body: hull(&[
            DVec3::new(0.6938730454976959, 0.20695408273018123, 0.35316900034005194),
            DVec3::new(
                0.6732921334825949,
                -2.7868179267691082,
                0.007879857181475554,
            ),
            DVec3::new(1.4867069486127051, 0.8113924504433434, -0.42724909033441894),
            DVec3::new(2.4996712245679253, -2.172084791814556, -1.2180473414896227),
            DVec3::new(
                0.12824722877387928,
                -2.6613931994691735,
                -0.9567614288033387,
            ),
            DVec3::new(2.2817641547856793, 1.0246025752589516, 0.14035965495565297),
            DVec3::new(2.754394145887271, 0.02256372995256295, -0.45481076438680584),
        ]),
        obstacle: hull(&[
            DVec3::new(-2.089925266184662, 2.1180279376158313, 1.9313751134309647),
            DVec3::new(0.7610683936750431, 2.9048722010214494, 2.2744129966170425),
            DVec3::new(-0.2834014826659231, -0.8825411257382648, 0.5504475246755715),
            DVec3::new(0.1700504519601994, 2.933132875558882, -1.8042619141427805),
            DVec3::new(0.2398113822088337, -0.13616178910068583, 2.2874165999149705),
            DVec3::new(0.4123776704998958, 0.18050053257158113, 0.1330106870001122),
            DVec3::new(-2.3053502553820255, -2.131919595786474, 2.818993663708646),
        ]),
        axis: DVec3::new(0.307170604966274, -0.1743462034332683, 0.9355477651050527).normalize(),
        through: DVec3::new(
            -1.5030506397534005,
            0.9994149433312292,
            -0.45952673118851967,
        ),
        angle: 77.05155770466473_f64.to_radians(),
        advance: -3.0820804036927716,
    };
    let depth = 0.22900955455619482;
    let (time, greatest) = scene.deepest();
    assert!(greatest > depth && greatest < 1.02 * depth, "{greatest}");
    assert_eq!(scene.defects(depth, time), "");
    let found = times(&scene.check(depth));
    assert!(
        matches!(found[..], [[from, to]] if from > 0.64 && to < 0.67),
        "{found:?}"
    );
}
