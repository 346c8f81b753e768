//! The orbits of points under a steady rigid motion: every point stays on its line, circle or helix
//! at all times.
//!
//! Key: the profile of a point of a sliding body is its place across the direction of sliding; that
//! of a turning body is (r, z), the distance from the axis and the height along it. Two points are
//! never nearer than their profiles. They come that near when they are side by side. So where a
//! body makes full turns, the least distance of two surfaces *is* that of their profiles, and no
//! search over time is needed.
//!
//! In the half plane of (r, z), a triangle is bounded by its supports. r is a convex function of
//! the place: a r + b z is largest at a corner for a >= 0. For a < 0, the convex function |a| r - b
//! z is least on a side, where it has a closed form, or where the triangle meets the axis: on lines
//! in a plane square to the axis it decreases towards the foot of the axis, and along these feet it
//! is linear up to the axis.
//!
//! A body that advances as it turns passes through a range of heights: its profile is extended
//! along z by the advance.

use super::encounter::Encounter;
use super::nearest::nearest;
use super::profile::{Rectangle, scatter};
use crate::bounds::{Content, SurfaceTree};
use crate::motion::Generator;
use crate::numeric::area::area_vector;
use crate::numeric::index;
use crate::numeric::tolerance::{CONTACT_ROUNDING, UNIT_ROUNDOFF};
use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};
use std::f64::consts::{PI, TAU};

/// Number of roundings of a place relative to the axis, in units of the coordinates from which it
/// is computed.
const PLACE_ROUNDING: f64 = 64.0;

/// The two shapes by the orbits of their points.
pub(super) struct Orbits {
    sides: [OrbitSide; 2],
    /// The number of the shape that moves.
    moving: usize,
    motion: RigidMotion,
    /// Bound on the error of a distance.
    pub(super) slack: f64,
    /// Number of triangles that were visited to bound them.
    pub(super) work: usize,
}

/// How the moving one moves, per unit of local time.
#[derive(Debug, Clone, Copy)]
enum RigidMotion {
    /// It slides by this length along the third coordinate.
    Slide(f64),
    /// It turns by an angle about the third coordinate axis, and advances by a length along it.
    Turn { angle: f64, advance: f64 },
}

/// One of the shapes.
struct OrbitSide {
    /// Corners of the triangles at local time 0; the third coordinate is along the direction of
    /// sliding or the axis.
    triangles: Vec<[DVec3; 3]>,
    /// A tree over the profiles.
    tree: SurfaceTree,
    /// Rectangles around the contents of each node, then around each triangle, computed on demand:
    /// one along its length, and one along its faces.
    rectangles: Vec<Option<[Rectangle; 2]>>,
}

/// Some of the triangles of one side.
type Bundle = u32;

impl Orbits {
    /// The orbits of an encounter; `None` where the motion of one shape relative to the other is
    /// not rigid and steady, within an `allowance` for errors of distances.
    pub(super) fn new(encounter: &Encounter, allowance: f64) -> Option<Orbits> {
        let movers = &encounter.movers;
        let moving = match [movers[0].rests(), movers[1].rests()] {
            [false, true] => 0,
            [true, false] => 1,
            _ => return None,
        };
        let mover = &movers[moving];
        let reach = movers[0].reach().max(movers[1].reach());
        let (frame, origin, motion, error) = rigid_motion(&mover.generator, reach, mover.growth())?;
        let slack = encounter.slack(1.0) + error;
        if slack.is_nan() || slack > allowance {
            return None;
        }
        let back = frame.transpose();
        let advance = |which: usize| match motion {
            RigidMotion::Turn { advance, .. } if which == moving => advance,
            _ => 0.0,
        };
        let side = |which: usize| {
            let shape = encounter.shapes[which];
            let pose = movers[which].pose(0.0);
            let count = index(shape.len());
            let triangles: Vec<[DVec3; 3]> = (0..count)
                .map(|triangle| {
                    let corners = shape.corners(triangle);
                    corners.map(|corner| back * (pose.transform_point3(corner) - origin))
                })
                .collect();
            OrbitSide::new(triangles, &motion, advance(which))
        };
        Some(Orbits {
            sides: [side(0), side(1)],
            moving,
            motion,
            slack,
            work: 0,
        })
    }

    /// All triangles of both.
    pub(super) const WHOLE: [Bundle; 2] = [0, 0];

    /// The two triangles, if there is only one on each side.
    pub(super) fn triangles(&self, bundles: [Bundle; 2]) -> Option<[u32; 2]> {
        let triangle = |which: usize| {
            let nodes = index(self.sides[which].tree.nodes().len());
            bundles[which].checked_sub(nodes)
        };
        Some([triangle(0)?, triangle(1)?])
    }

    /// The parts of the larger bundle, each paired with the other bundle.
    pub(super) fn divide(&mut self, bundles: [Bundle; 2]) -> Vec<[Bundle; 2]> {
        let sizes = [0, 1].map(|which: usize| {
            if self.sides[which].parts(bundles[which]).is_empty() {
                -1.0
            } else {
                self.rectangles(which, bundles[which])[0].size()
            }
        });
        let divided = usize::from(sizes[1] > sizes[0]);
        let parts = self.sides[divided].parts(bundles[divided]);
        let with = |part: Bundle| {
            let mut pair = bundles;
            pair[divided] = part;
            pair
        };
        parts.into_iter().map(with).collect()
    }

    /// A lower bound of the distance at all times.
    pub(super) fn bound(&mut self, bundles: [Bundle; 2], threshold: f64) -> f64 {
        let [a, b] = [0, 1].map(|which: usize| self.rectangles(which, bundles[which]));
        let distances = a.iter().flat_map(|p| b.iter().map(|q| p.distance(q)));
        let apart = distances.fold(0.0, f64::max) - self.slack;
        match self.triangles(bundles) {
            Some(triangles) if apart <= threshold => apart.max(self.gap(triangles) - self.slack),
            _ => apart,
        }
    }

    fn rectangles(&mut self, which: usize, bundle: Bundle) -> [Rectangle; 2] {
        if let Some(known) = self.sides[which].rectangles[bundle as usize] {
            return known;
        }
        let side = &self.sides[which];
        let members = side.members(bundle);
        let corners = members.iter().map(|&t| &side.triangles[t as usize]);
        let length = scatter(
            corners
                .clone()
                .flat_map(|t| t.map(|p| self.motion.profile(p))),
        );
        let faces = self.motion.faces(corners);
        let support = |direction: DVec2| {
            let each = members.iter().map(|&t| self.support(which, t, direction));
            each.fold(f64::NEG_INFINITY, f64::max)
        };
        let rectangles = [length, faces].map(|axis| Rectangle::along(axis, support));
        self.work += members.len();
        self.sides[which].rectangles[bundle as usize] = Some(rectangles);
        rectangles
    }

    /// How far the profile of a triangle, extended by the advance, reaches in a direction.
    fn support(&self, which: usize, triangle: u32, direction: DVec2) -> f64 {
        let corners = &self.sides[which].triangles[triangle as usize];
        let mut far = self.motion.support(corners, direction);
        if which == self.moving
            && let RigidMotion::Turn { advance, .. } = self.motion
        {
            far += (direction.y * advance).max(0.0);
        }
        far
    }

    /// The gap between the profiles of two triangles along the line between their nearest corners
    /// and sides, or square to one of the faces; negative where they overlap.
    fn gap(&self, triangles: [u32; 2]) -> f64 {
        let corners =
            [0, 1].map(|which: usize| &self.sides[which].triangles[triangles[which] as usize]);
        let flat = corners.map(|corners| corners.map(|p| self.motion.profile(p).extend(0.0)));
        let [p, q] = nearest(&flat[0], &flat[1]).points;
        let reach =
            |which: usize, direction: DVec2| self.support(which, triangles[which], direction);
        let directions = [
            (p - q).xy().normalize_or(DVec2::X),
            self.motion.square(corners[0]),
            self.motion.square(corners[1]),
        ];
        directions
            .iter()
            .flat_map(|&direction| [direction, -direction])
            .map(|direction| -reach(0, -direction) - reach(1, direction))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether no two triangles ever come as near as a distance: a proof if so.
    pub(super) fn keep(&mut self, distance: f64) -> bool {
        let distance = distance + CONTACT_ROUNDING * self.slack;
        let mut open = vec![Orbits::WHOLE];
        while let Some(bundles) = open.pop() {
            if self.bound(bundles, distance) > distance {
                continue;
            }
            match self.triangles(bundles) {
                Some(triangles) if self.times(triangles, distance).is_empty() => {}
                Some(_) => return false,
                None => open.extend(self.divide(bundles)),
            }
        }
        true
    }

    /// Stretches of local time in [0, 1] during which two triangles may be nearer than `reach`;
    /// where they repeat exactly, the first full period stands for all.
    pub(super) fn times(&self, triangles: [u32; 2], reach: f64) -> Vec<[f64; 2]> {
        let resting = 1 - self.moving;
        let reach = reach + self.slack;
        let [own, other] = [self.moving, resting]
            .map(|which: usize| &self.sides[which].triangles[triangles[which] as usize]);
        let (rate, own, other, period) = match self.motion {
            RigidMotion::Slide(rate) => {
                let [own, [low, high]] = [own, other].map(|corners| extent(corners, |p| p.z));
                (rate, own, [low - reach, high + reach], None)
            }
            RigidMotion::Turn { angle, .. } => {
                let radii = [own, other].map(|corners| -self.motion.support(corners, -DVec2::X));
                let (Some(own), Some([low, high])) = (angles(own), angles(other)) else {
                    return vec![[0.0, 1.0]];
                };
                // A chord of 2 r sin(w / 2) across the angle w, with r the root of the product of
                // the radii.
                let half = reach / (2.0 * (radii[0].max(0.0) * radii[1].max(0.0)).sqrt());
                if half.is_nan() || half >= 1.0 {
                    return vec![[0.0, 1.0]];
                }
                let beside = 2.0 * half.asin() + ANGLE_ROUNDING * (1.0 + angle);
                (angle, own, [low - beside, high + beside], Some(TAU))
            }
        };
        let first = [(other[0] - own[1]) / rate, (other[1] - own[0]) / rate];
        let [from, to] = [first[0].min(first[1]), first[0].max(first[1])];
        let Some(period) = period.map(|period| period / rate.abs()) else {
            return Vec::from_iter(clamped([from, to]));
        };
        if to - from >= period {
            return vec![[0.0, 1.0]];
        }
        let repeats =
            matches!(self.motion, RigidMotion::Turn { advance, .. } if advance.abs() <= self.slack);
        let mut times = Vec::new();
        let mut turn = (-to / period).ceil();
        while from + turn * period <= 1.0 {
            let stretch = [from + turn * period, to + turn * period];
            times.extend(clamped(stretch));
            if repeats && stretch[0] >= 0.0 && stretch[1] <= 1.0 {
                return vec![stretch];
            }
            turn += 1.0;
        }
        times
    }
}

/// Rounding of an angle between corners of a triangle that does not contain the axis, and of each
/// radian of a turn.
const ANGLE_ROUNDING: f64 = 1e-12;

fn clamped([from, to]: [f64; 2]) -> Option<[f64; 2]> {
    let (from, to) = (from.max(0.0), to.min(1.0));
    (from <= to).then_some([from, to])
}

/// The least and the largest value at the corners.
fn extent(corners: &[DVec3; 3], value: impl Fn(DVec3) -> f64) -> [f64; 2] {
    corners
        .iter()
        .map(|&p| value(p))
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
            [low.min(v), high.max(v)]
        })
}

/// The range of angles about the axis that a triangle covers; `None` where that is about half a
/// turn or more.
fn angles(corners: &[DVec3; 3]) -> Option<[f64; 2]> {
    let [first, ..] = corners.map(DVec3::xy);
    let from = corners.map(|corner| {
        let corner = corner.xy();
        first.perp_dot(corner).atan2(first.dot(corner))
    });
    let [low, high] = [0.0, 0.0_f64];
    let (low, high) = from.iter().fold((low, high), |(low, high), a| {
        (f64::min(low, *a), f64::max(high, *a))
    });
    // For wider ranges, the third side may be on the other side of the axis.
    let narrow = high - low < 0.9 * PI;
    narrow.then(|| {
        let start = first.to_angle();
        [start + low, start + high]
    })
}

impl RigidMotion {
    /// The profile of a point: its place, whatever the time.
    fn profile(&self, place: DVec3) -> DVec2 {
        match self {
            RigidMotion::Slide(_) => place.xy(),
            RigidMotion::Turn { .. } => DVec2::new(place.xy().length(), place.z),
        }
    }

    /// The direction square to a face in the half plane that the face crosses at right angles:
    /// there, its points are nearest to the axis.
    fn square(&self, corners: &[DVec3; 3]) -> DVec2 {
        let normal = area_vector(*corners);
        let across = normal.xy();
        let direction = match self {
            RigidMotion::Slide(_) => across,
            RigidMotion::Turn { .. } => {
                let middle = corners[0] + corners[1] + corners[2];
                let sign = across.dot(middle.xy()).signum();
                DVec2::new(sign * across.length(), normal.z)
            }
        };
        direction.normalize_or(DVec2::X)
    }

    /// The direction along most of the faces in that half plane.
    fn faces<'a>(&self, triangles: impl Iterator<Item = &'a [DVec3; 3]>) -> DVec2 {
        // Directions without a sense are added by doubling their angles.
        let doubled = triangles.map(|corners| {
            let square = self.square(corners);
            DVec2::from_angle(2.0 * square.to_angle()) * area_vector(*corners).length()
        });
        let sum: DVec2 = doubled.sum();
        DVec2::from_angle(0.5 * sum.to_angle()).perp()
    }

    /// How far the profile of a triangle reaches in a direction.
    fn support(&self, corners: &[DVec3; 3], direction: DVec2) -> f64 {
        let farthest = || {
            let heights = corners.map(|p| direction.dot(self.profile(p)));
            heights.into_iter().fold(f64::NEG_INFINITY, f64::max)
        };
        match self {
            RigidMotion::Turn { .. } if direction.x < 0.0 => -least_inward(corners, -direction),
            _ => farthest(),
        }
    }
}

/// The least value of a r + b z on a triangle, for a > 0.
fn least_inward(corners: &[DVec3; 3], weights: DVec2) -> f64 {
    let [p, q, r] = *corners;
    let sides = [[p, q], [q, r], [r, p]].map(|side| least_on_side(side, weights));
    let least = sides.into_iter().fold(f64::INFINITY, f64::min);
    // The place where it meets the axis.
    let turns = [[q, r], [r, p], [p, q]].map(|[from, to]| from.xy().perp_dot(to.xy()));
    let whole: f64 = turns.iter().sum();
    let is_met = turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0);
    if !is_met || whole == 0.0 {
        return least;
    }
    let height = (turns[0] * p.z + turns[1] * q.z + turns[2] * r.z) / whole;
    least.min(weights.y * height)
}

/// The least value of a r + b z on a segment, for a > 0: where a r' = -b z'.
fn least_on_side([from, to]: [DVec3; 2], weights: DVec2) -> f64 {
    let value = |p: DVec3| weights.x * p.xy().length() + weights.y * p.z;
    let ends = value(from).min(value(to));
    let along = to - from;
    let square = along.xy().length_squared();
    let rise = weights.y * along.z;
    // With x measured from the foot of the axis, r^2 = square x^2 + away^2.
    let slope = weights.x * weights.x * square - rise * rise;
    if slope.is_nan() || slope <= 0.0 {
        return ends;
    }
    let away = along.xy().perp_dot(from.xy()).abs() / square.sqrt();
    let foot = -from.xy().dot(along.xy()) / square;
    let share = foot - rise * away / (square * slope).sqrt();
    if (0.0..=1.0).contains(&share) {
        ends.min(value(from + along * share))
    } else {
        ends
    }
}

/// The steady motion of something in its own frame: the frame and origin, the motion relative to
/// them, and a bound on the error of places.
///
/// - `reach`: largest coordinate of it and of what it moves past. `growth`: deviation of the motion
///   from a rigid one; the growth counts as an error.
///
/// `None` at rest.
fn rigid_motion(
    generator: &Generator,
    reach: f64,
    growth: f64,
) -> Option<(DMat3, DVec3, RigidMotion, f64)> {
    let Generator { linear, offset } = *generator;
    let size = generator.size();
    let rounding = PLACE_ROUNDING * UNIT_ROUNDOFF;
    // As a straight path: the error is the bend by the turn.
    let bend = size * size.exp() * (reach + offset.length());
    let skew = (linear - linear.transpose()) * 0.5;
    let turn = DVec3::new(skew.y_axis.z, skew.z_axis.x, skew.x_axis.y);
    let angle = turn.length();
    let origin = turn.cross(offset) / (angle * angle);
    let grown = growth * growth.exp() * (2.0 * reach + offset.length());
    // The axis is at most this far away.
    let round = grown + rounding * (reach + offset.length() / angle);
    let frame = |along: DVec3| {
        let first = along.any_orthonormal_vector();
        DMat3::from_cols(first, along.cross(first), along)
    };
    // A comparison with NaN fails.
    if angle > 0.0 && round < bend {
        let along = turn / angle;
        let advance = along.dot(offset);
        return Some((
            frame(along),
            origin,
            RigidMotion::Turn { angle, advance },
            round,
        ));
    }
    let along = offset.try_normalize()?;
    let motion = RigidMotion::Slide(offset.length());
    Some((frame(along), DVec3::ZERO, motion, bend + rounding * reach))
}

impl OrbitSide {
    /// - `advance`: length by which profiles are extended.
    fn new(triangles: Vec<[DVec3; 3]>, motion: &RigidMotion, advance: f64) -> OrbitSide {
        // The tree holds diagonals of boxes around the profiles.
        let mut ends = Vec::with_capacity(2 * triangles.len());
        for corners in &triangles {
            let profiles = corners.map(|p| motion.profile(p));
            let [p, q, r] = profiles;
            let (low, high) = (p.min(q).min(r), p.max(q).max(r));
            ends.push(low + DVec2::new(0.0, advance.min(0.0)));
            ends.push(high + DVec2::new(0.0, advance.max(0.0)));
        }
        let diagonals: Vec<[u32; 2]> = (0..index(triangles.len()))
            .map(|t| [2 * t, 2 * t + 1])
            .collect();
        let tree = SurfaceTree::of_segments(&ends, &diagonals);
        OrbitSide {
            rectangles: vec![None; tree.nodes().len() + triangles.len()],
            triangles,
            tree,
        }
    }

    /// The parts of a bundle; none if it is a triangle.
    fn parts(&self, bundle: Bundle) -> Vec<Bundle> {
        let nodes = self.tree.nodes();
        match nodes
            .get(bundle as usize)
            .map(|node| self.tree.content(node))
        {
            None => Vec::new(),
            Some(Content::Children(children)) => children.to_vec(),
            Some(Content::Triangles(triangles)) => {
                let count = index(nodes.len());
                triangles.iter().map(|t| count + t).collect()
            }
        }
    }

    /// The triangles of a bundle.
    fn members(&self, bundle: Bundle) -> Vec<u32> {
        let nodes = self.tree.nodes();
        let Some(triangle) = bundle.checked_sub(index(nodes.len())) else {
            let mut members = Vec::new();
            let mut open = vec![bundle];
            while let Some(node) = open.pop() {
                match self.tree.content(&nodes[node as usize]) {
                    Content::Children(children) => open.extend(children),
                    Content::Triangles(triangles) => members.extend_from_slice(triangles),
                }
            }
            return members;
        };
        vec![triangle]
    }
}

#[cfg(test)]
mod tests {
    use super::super::mover::Mover;
    use super::super::shape::Shape;
    use super::*;
    use crate::body::Surface;
    use crate::motion::Flow;
    use crate::samples::random;
    use glam::DAffine3;

    #[test]
    fn no_point_of_a_triangle_is_beyond_its_supports() {
        let mut next = random(21);
        let motion = RigidMotion::Turn {
            angle: 1.0,
            advance: 0.0,
        };
        let mut sharp = 0;
        for case in 0..400 {
            // Every fourth case is about the axis, every eighth in a plane that contains it.
            let away = [0.0, 1.0, 2.0, 0.3][case % 4];
            let corners = [0; 3].map(|_| {
                let flat = case % 8 == 4;
                DVec3::new(next() + away, if flat { 0.0 } else { next() }, next())
            });
            let direction = DVec2::from_angle(6.0 * next());
            let support = motion.support(&corners, direction);
            let mut farthest = f64::NEG_INFINITY;
            const STEPS: u32 = 60;
            for i in 0..=STEPS {
                for j in 0..=STEPS - i {
                    let (s, t) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                    let p =
                        corners[0] + (corners[1] - corners[0]) * s + (corners[2] - corners[0]) * t;
                    farthest = farthest.max(direction.dot(motion.profile(p)));
                }
            }
            assert!(
                farthest <= support + 1e-14,
                "case {case}: {farthest} beyond {support}"
            );
            assert!(
                support <= farthest + 0.1,
                "case {case}: {support} is far from {farthest}"
            );
            sharp += usize::from(support <= farthest + 1e-3);
        }
        assert!(sharp > 300, "as sharp as samples can be: {sharp}");
    }

    /// Some loose triangles around a place.
    fn crumbs(next: &mut impl FnMut() -> f64, place: DVec3) -> Shape {
        let positions: Vec<DVec3> = (0..12)
            .map(|_| place + DVec3::new(next(), next(), next()) * 0.6)
            .collect();
        let triangles = (0..4).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        Shape::new(&Surface::new(positions, triangles).expect("a surface"))
    }

    #[test]
    fn whatever_the_time_nothing_is_nearer_than_its_orbit_nor_near_at_other_times() {
        let mut next = random(22);
        let generators = [
            Generator::screw(DVec3::Z, DVec3::X, 5.0, 0.0, 1.0),
            Generator::screw(DVec3::new(0.6, 0.0, 0.8), DVec3::Y, -9.0, 0.0, 1.0),
            Generator::screw(DVec3::Y, DVec3::ZERO, 2.0, 1.5, 1.0),
            Generator::translation(DVec3::new(2.0, -1.0, 0.5)),
        ];
        let (mut near, mut sharp) = (0, 0);
        for case in 0..48 {
            let flow = Flow::new(generators[case % 4]);
            let shapes =
                [DVec3::ZERO, DVec3::new(1.2, 0.4, 0.0)].map(|place| crumbs(&mut next, place));
            let moving = Mover::moving(&flow, [0.0, 1.0], DAffine3::IDENTITY, shapes[0].bounds());
            let resting = Mover::resting(DAffine3::IDENTITY, shapes[1].bounds());
            let encounter = if case % 8 < 4 {
                Encounter::new([&shapes[0], &shapes[1]], [moving, resting])
            } else {
                Encounter::new([&shapes[1], &shapes[0]], [resting, moving])
            };
            let mut orbits = Orbits::new(&encounter, 1e-9).expect("rigid and steady");
            let bundle = |orbits: &Orbits, which: usize, t: u32| {
                index(orbits.sides[which].tree.nodes().len()) + t
            };
            for i in 0..4 {
                for j in 0..4 {
                    let bundles = [bundle(&orbits, 0, i), bundle(&orbits, 1, j)];
                    assert_eq!(orbits.triangles(bundles), Some([i, j]));
                    let bound = orbits.bound(bundles, f64::INFINITY);
                    let reach = 0.4;
                    let times = orbits.times([i, j], reach);
                    let mut least = f64::INFINITY;
                    const STEPS: u32 = 1000;
                    for k in 0..=STEPS {
                        let time = f64::from(k) / f64::from(STEPS);
                        let still = encounter.still(time);
                        let [a, b] = [0, 1].map(|which: usize| {
                            let corners = encounter.shapes[which].corners([i, j][which]);
                            corners.map(|p| still.poses[which].transform_point3(p))
                        });
                        let apart = nearest(&a, &b).distance();
                        least = least.min(apart);
                        let turn = TAU / 9.0;
                        let is_listed = times.iter().any(|[from, to]| {
                            let again = case % 4 == 1
                                && (0..2).any(|k| {
                                    let time = time + turn * (f64::from(k) - 1.0);
                                    (*from..=*to).contains(&time)
                                        || (*from..=*to).contains(&(time + 2.0 * turn))
                                });
                            again || (*from..=*to).contains(&time)
                        });
                        near += usize::from(apart < reach);
                        assert!(
                            apart >= reach || is_listed,
                            "case {case}: {apart} at {time}, not in {times:?}"
                        );
                    }
                    assert!(bound <= least + 1e-9, "case {case}: {least} below {bound}");
                    sharp += usize::from(case % 4 == 1 && bound > 0.05 && bound > least - 0.01);
                }
            }
        }
        assert!(near > 1000, "some come near: {near}");
        assert!(sharp > 20, "bounds of whole turns are sharp: {sharp}");
    }

    #[test]
    fn what_is_not_rigid_and_steady_has_no_orbits_of_use() {
        let mut next = random(23);
        let shapes = [DVec3::ZERO, DVec3::X].map(|place| crumbs(&mut next, place));
        let mover = |generator: Generator, shape: &Shape| {
            Mover::moving(
                &Flow::new(generator),
                [0.0, 1.0],
                DAffine3::IDENTITY,
                shape.bounds(),
            )
        };
        let growing = Generator::screw(DVec3::Z, DVec3::ZERO, 1.0, 0.0, 1.1);
        let turning = Generator::screw(DVec3::Z, DVec3::ZERO, 1.0, 0.0, 1.0);
        let elsewhere = Generator::screw(DVec3::Z, DVec3::X, 2.0, 0.0, 1.0);
        let resting = Mover::resting(DAffine3::IDENTITY, shapes[1].bounds());
        let encounter = |movers| Encounter::new([&shapes[0], &shapes[1]], movers);
        let growing = encounter([mover(growing, &shapes[0]), resting.clone()]);
        assert!(Orbits::new(&growing, 1e-3).is_none(), "growing");
        let two = encounter([mover(turning, &shapes[0]), mover(elsewhere, &shapes[1])]);
        assert!(Orbits::new(&two, 1e-3).is_none(), "about two axes");
        let one = encounter([
            mover(turning, &shapes[0]),
            mover(turning.scaled(-2.0), &shapes[1]),
        ]);
        assert!(Orbits::new(&one, 1e-3).is_some(), "about one axis");
        let still = encounter([
            Mover::resting(DAffine3::IDENTITY, shapes[0].bounds()),
            resting,
        ]);
        assert!(Orbits::new(&still, 1e-3).is_none(), "both rest");
    }
}
