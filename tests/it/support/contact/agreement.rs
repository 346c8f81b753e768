//! What an answer must satisfy, given the one of the slow method.

use super::distance::nearest_on_segment;
use super::reference::{DOUBTFUL, Slow};
use super::scene::Scene;
use crate::support::membership;
use crate::support::shapes::Shape;
use glam::DVec3;
use steadysweep::body::{Mesh, Surface};
use steadysweep::collision::{
    Check, CheckSettings, Clearance, Feature, FirstContact, Obstacle, Touch, Verdict, check,
};

/// Widest bracket of a first contact, as a share of the motion's time.
pub(crate) const BRACKET: f64 = 1e-9;
/// Largest distance of a witness from its features, as a share of the largest coordinate: the width
/// of a bracket at a speed of twenty lengths in the whole time.
const WITNESS: f64 = 1e-7;

impl Scene {
    pub(crate) fn mesh(&self) -> Mesh {
        Mesh::new(self.body.0.clone(), self.body.1.clone()).expect("the bodies are closed")
    }

    pub(crate) fn surfaces(&self) -> Vec<Surface> {
        let surface = |shape: &Shape| {
            Surface::new(shape.0.clone(), shape.1.clone()).expect("the obstacles are surfaces")
        };
        self.obstacles
            .iter()
            .map(|obstacle| surface(&obstacle.shape))
            .collect()
    }

    pub(crate) fn check(&self, settings: &CheckSettings) -> Check {
        let surfaces = self.surfaces();
        let obstacles: Vec<Obstacle> = surfaces
            .iter()
            .zip(&self.obstacles)
            .map(|(surface, obstacle)| Obstacle {
                surface,
                motion: obstacle.motion.as_ref(),
            })
            .collect();
        check(&self.mesh(), &self.motion, &obstacles, settings).expect("a legal check")
    }

    /// The defects of the verdict, given the slow answer for each obstacle that counts; empty when
    /// there are none.
    pub(crate) fn verdict_defects(&self, verdict: &Verdict, slow: &[Option<Slow>]) -> String {
        let found = match verdict {
            Verdict::Clear => {
                let missed = slow
                    .iter()
                    .flatten()
                    .find(|slow| matches!(slow, Slow::Contact { .. }));
                return missed.map_or(String::new(), |slow| format!("missed: {slow:?}"));
            }
            Verdict::Contact(found) | Verdict::Closer(found) => found,
            Verdict::Undecided { .. } => return format!("undecided: {verdict:?}, {slow:?}"),
        };
        let slack = BRACKET * self.duration();
        let [from, to] = found.bracket;
        // Where rounding decides for longer than that, the bracket may be as wide as the slow one.
        let (clear_until, by, wide) = match slow[found.obstacle] {
            Some(Slow::Contact { clear_until, by }) => (clear_until, by, by - clear_until),
            Some(Slow::Doubt { clear_until, until }) => (clear_until, until, until - clear_until),
            other => return format!("false contact: {found:?}, {other:?}"),
        };
        let mut defects = String::new();
        let mut claim = |holds: bool, what: &str| {
            if !holds {
                defects += what;
                defects += "; ";
            }
        };
        let wide = wide.max(slack);
        claim(from <= to && to - from <= wide, "wide bracket");
        claim(
            (from..=to).contains(&found.time),
            "time outside the bracket",
        );
        claim(from >= clear_until - slack, "before the proven clear time");
        claim(from <= by, "late");
        let earlier = slow.iter().flatten().any(|slow| match slow {
            Slow::Contact { by, .. } => *by < from,
            _ => false,
        });
        claim(!earlier, "another obstacle is met earlier");
        let times = self.motion.joint_times();
        let in_span = times
            .get(found.span..found.span + 2)
            .is_some_and(|span| span[0] - slack <= found.time && found.time <= span[1] + slack);
        claim(in_span, "another span");
        if defects.is_empty() {
            return defects;
        }
        format!("{defects}{found:?}, slow {clear_until:e} to {by:e}")
    }

    /// The defects of the point, the normal and the features of a contact of surfaces.
    pub(crate) fn witness_defects(&self, found: &FirstContact, offset: f64) -> String {
        let search = self.search(found.obstacle, 0.0);
        let [body, obstacle] = search.shapes_at(found.time);
        let near = WITNESS * search.largest() + 1e-9 * offset;
        let mut defects = String::new();
        let mut claim = |holds: bool, what: String| {
            if !holds {
                defects += &what;
                defects += "; ";
            }
        };
        let normal = found.normal;
        claim(
            (normal.length() - 1.0).abs() < 1e-9,
            format!("normal of length {}", normal.length()),
        );
        let off = distance_to_feature(&obstacle, found.features[1], found.point);
        claim(
            off <= near,
            format!("point {off:e} off the obstacle's feature"),
        );
        let partner = found.point + normal * offset;
        let off = distance_to_feature(&body, found.features[0], partner);
        claim(off <= near, format!("point {off:e} off the body's feature"));
        if defects.is_empty() {
            return defects;
        }
        format!("{defects}{found:?}")
    }

    /// The defects of the bounds on the distance in a scene that is clear.
    pub(crate) fn clearance_defects(&self, clearance: &Clearance, obstacles: &[usize]) -> String {
        let mut defects = String::new();
        let Clearance { lower, upper, .. } = *clearance;
        let mut largest = 0.0_f64;
        for &k in obstacles {
            let search = self.search(k, 0.0);
            largest = largest.max(search.largest());
            for step in 0..=60 {
                let time = self.start() + self.duration() * f64::from(step) / 60.0;
                let (distance, _) = search.closest_at(time);
                if distance < lower - DOUBTFUL * largest {
                    defects += &format!("{distance} at {time} is below the lower bound; ");
                    break;
                }
                if distance < upper * (1.0 - 1e-2) - DOUBTFUL * largest {
                    defects += &format!("{distance} at {time} is far below the least seen; ");
                    break;
                }
            }
        }
        let seen = self
            .search(clearance.obstacle, 0.0)
            .closest_at(clearance.time)
            .0;
        let rounding = 1e-12 * largest;
        if (seen - upper).abs() > rounding + 1e-9 * upper {
            defects += &format!("{seen} at {}, not {upper}; ", clearance.time);
        }
        let apart = clearance.points[0].distance(clearance.points[1]);
        if (apart - upper).abs() > rounding + 1e-9 * upper {
            defects += &format!("points {apart} apart, not {upper}; ");
        }
        if lower < 0.9988 * upper && clearance.limited.is_none() {
            defects += "not sharp, and nothing says why; ";
        }
        if !(0.0 < lower && lower <= upper) {
            defects += "bounds out of order; ";
        }
        if defects.is_empty() {
            return defects;
        }
        format!("{defects}{clearance:?}")
    }
}

/// Distance of a point from a vertex, a segment or a triangle of a surface.
fn distance_to_feature(shape: &Shape, feature: Feature, point: DVec3) -> f64 {
    let at = |vertex: u32| shape.0[vertex as usize];
    match feature {
        Feature::Vertex(vertex) => at(vertex).distance(point),
        Feature::Edge(ends) => nearest_on_segment(ends.map(at), point).distance(point),
        Feature::Face(face) => {
            membership::distance_to_triangle(shape.1[face as usize].map(at), point)
        }
    }
}

impl Scene {
    /// The defects of the first time below a clearance: the distance at that time, and the place.
    pub(crate) fn closer_defects(&self, found: &FirstContact, clearance: f64) -> String {
        let search = self.search(found.obstacle, 0.0);
        let (distance, _) = search.closest_at(found.time);
        let near = WITNESS * search.largest();
        if found.touch == Touch::Inside {
            return String::new();
        }
        if found.time > self.start() && (distance - clearance).abs() > near {
            return format!("{distance} away, not {clearance}: {found:?}");
        }
        self.witness_defects(found, distance)
    }

    /// The defects of the listed times of contact, by samples.
    pub(crate) fn interval_defects(&self, check: &Check) -> String {
        let Some(intervals) = &check.intervals else {
            return "no intervals; ".into();
        };
        let slack = 2.0 * BRACKET * self.duration();
        for (k, _) in self.obstacles.iter().enumerate() {
            let own: Vec<[f64; 2]> = intervals
                .iter()
                .filter(|interval| interval.obstacle == k)
                .map(|interval| interval.times)
                .collect();
            if own.iter().any(|[from, to]| from > to)
                || own.windows(2).any(|pair| pair[0][1] >= pair[1][0])
            {
                return format!("not ascending: {own:?}");
            }
            let mut times: Vec<f64> = (0..=200)
                .map(|step| self.start() + self.duration() * f64::from(step) / 200.0)
                .collect();
            for [from, to] in &own {
                times.extend([from - 1e-6, *from, from.midpoint(*to), *to, to + 1e-6]);
            }
            times.retain(|time| (self.start()..=self.end()).contains(time));
            let search = self.search(k, 0.0);
            for time in times {
                let (distance, crossing) = search.closest_at(time);
                let doubtful = distance <= 10.0 * DOUBTFUL * search.largest();
                let inside = crossing || (!doubtful && search.reaches_inside(time));
                let near_an_end = own.iter().flatten().any(|end| (time - end).abs() <= slack);
                if near_an_end || (doubtful && !inside) {
                    continue;
                }
                let listed = own.iter().any(|[from, to]| (*from..=*to).contains(&time));
                if listed != inside {
                    return format!("at {time} listed {listed}, in contact {inside}: {own:?}");
                }
            }
        }
        let first = intervals.iter().map(|interval| interval.times[0]);
        let first = first.fold(f64::INFINITY, f64::min);
        match &check.verdict {
            Verdict::Contact(found) if (found.time - first).abs() > slack => {
                format!("first interval at {first}, first contact at {}", found.time)
            }
            Verdict::Clear if first.is_finite() => "clear, but intervals".into(),
            _ => String::new(),
        }
    }
}
