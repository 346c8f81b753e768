//! The report of a check as text.

use super::check::{
    CheckReport, FeatureReport, LimitedReport, ObstacleName, ObstacleReport, RelativeMotionReport,
    TouchReport, VerdictReport,
};
use super::half_turn::write_details;
use super::place::{Matrix, PoseRows, ProgressReport};
use super::quantities::{Vector, counted};
use crate::numeric::Readable;
use std::fmt;
use std::path::Path;

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.body)?;
        let [start, end] = self.motion.times;
        writeln!(
            f,
            "motion  {}, from time {} to {}",
            counted(self.motion.spans, "steady span"),
            Time(start),
            Time(end)
        )?;
        write_details(f, self.motion.deviation.as_ref(), &self.motion.half_turns)?;
        for (index, obstacle) in self.obstacles.iter().enumerate() {
            let label = if index == 0 { "against" } else { "" };
            writeln!(f, "{label:<7} {obstacle}")?;
            write_details(f, obstacle.deviation.as_ref(), &obstacle.half_turns)?;
        }
        match self.verdict {
            VerdictReport::Clear => self.clear(f)?,
            VerdictReport::Contact | VerdictReport::Closer => self.met(f)?,
            VerdictReport::Undecided => self.undecided(f)?,
        }
        self.listed_intervals(f)?;
        write!(f, "{}", self.seconds)
    }
}

impl CheckReport {
    fn clear(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut label = "CLEAR";
        if self.clearance.lower.is_finite() {
            self.never_below(f, label)?;
            self.closest(f)?;
            label = "";
        }
        for obstacle in &self.obstacles {
            let Some(depth) = obstacle.depth else {
                continue;
            };
            writeln!(
                f,
                "{label:<7} {} is never entered deeper than {} (proven)",
                obstacle.name(),
                Readable(depth)
            )?;
            label = "";
        }
        Ok(())
    }

    /// What is proven about the distance over the whole motion.
    fn never_below(&self, f: &mut fmt::Formatter<'_>, label: &str) -> fmt::Result {
        let lower = Readable(self.clearance.lower);
        writeln!(f, "{label:<7} the distance is never below {lower} (proven)")
    }

    fn closest(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let closest = &self.clearance;
        let (Some(distance), Some(time), Some([on_body, on_obstacle]), Some(obstacle)) = (
            closest.upper,
            closest.time,
            closest.points,
            &closest.obstacle,
        ) else {
            return Ok(());
        };
        writeln!(
            f,
            "        closest seen: {} at time {}, from {} on the body to {} on {}",
            Readable(distance),
            Time(time),
            Vector(on_body),
            Vector(on_obstacle),
            obstacle.name()
        )?;
        if let Some(limited) = closest.limited {
            writeln!(
                f,
                "        proven only to {}: {limited}",
                Readable(closest.lower)
            )?;
        }
        self.place(f, closest.pose, closest.progress, closest.obstacle_pose)
    }

    /// Where the body is at the time named in the line before, and the obstacle, if it moves.
    fn place(
        &self,
        f: &mut fmt::Formatter<'_>,
        pose: Option<PoseRows>,
        progress: Option<ProgressReport>,
        obstacle_pose: Option<PoseRows>,
    ) -> fmt::Result {
        if let (Some(pose), Some(progress)) = (pose, progress) {
            let in_span = self.in_span(progress.span);
            writeln!(f, "        {progress}{in_span}")?;
            writeln!(f, "        pose {}", Matrix(pose))?;
        }
        match obstacle_pose {
            Some(pose) => writeln!(f, "        pose of the obstacle {}", Matrix(pose)),
            None => Ok(()),
        }
    }

    fn met(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let obstacle = self.obstacle_name();
        let time = Time(self.time.unwrap_or(f64::NAN));
        if let Some(depth) = self.depth {
            writeln!(
                f,
                "CONTACT with {obstacle}, entered deeper than {} at time {time}{}",
                Readable(depth),
                self.in_its_span()
            )?;
        } else if self.verdict == VerdictReport::Contact {
            writeln!(
                f,
                "CONTACT with {obstacle} at time {time}{}",
                self.in_its_span()
            )?;
        } else {
            writeln!(
                f,
                "CLOSER  than {} to {obstacle} from time {time} on{}",
                Readable(self.clearance.required),
                self.in_its_span()
            )?;
        }
        self.place(f, self.pose, self.progress, self.obstacle_pose)?;
        if let Some([start, end]) = self.bracket.filter(|_| !self.is_at_start()) {
            let before = match self.verdict {
                VerdictReport::Contact if self.depth.is_some() => "not as deep",
                VerdictReport::Contact => "apart",
                _ => "farther",
            };
            writeln!(
                f,
                "        bracket [{start:?}, {end:?}]: {before} before it, for certain"
            )?;
        }
        if let Some(features) = self.features {
            let meets = match self.verdict {
                VerdictReport::Contact => "meets",
                _ => "is near",
            };
            write!(f, "        {} of the body {meets} ", features.body)?;
            match features.obstacle {
                FeatureReport::Plane(_) => write!(f, "{obstacle} (as the file counts, from 0)")?,
                feature => write!(f, "{feature} of {obstacle} (as the files count, from 0)")?,
            }
            writeln!(f)?;
        }
        if let (Some(point), Some(normal)) = (self.point, self.normal) {
            writeln!(
                f,
                "        at {}, normal {} from the obstacle to the body",
                Vector(point),
                Vector(normal)
            )?;
        }
        match self.touch {
            Some(touch) if self.verdict == VerdictReport::Contact => {
                writeln!(f, "        {touch}")?;
            }
            _ => {
                self.never_below(f, "")?;
                self.closest(f)?;
            }
        }
        self.advice_at_start(f)
    }

    /// Whether there is contact before the body moves.
    fn is_at_start(&self) -> bool {
        self.time == Some(self.motion.times[0])
    }

    /// Advice for a body that is in contact before it moves, as one that stands on something is.
    fn advice_at_start(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_at_start() {
            return Ok(());
        }
        if self.depth.is_some() {
            return writeln!(
                f,
                "        that is the start: --depth allows for more, --intervals tells when it ends"
            );
        }
        let name = self.obstacle_name();
        let stem = Path::new(&name)
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy();
        writeln!(
            f,
            "        that is the start: --intervals tells when it ends; where it is meant to be so,"
        )?;
        write!(f, "        --touching {stem} asks for what enters it")?;
        let left = self.obstacles.iter().filter(|obstacle| !obstacle.allowed);
        if left.count() > 1 {
            write!(f, ", and --allow {stem} leaves it out")?;
        }
        writeln!(f)
    }

    fn undecided(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let obstacle = self.obstacle_name();
        let [start, end] = self.bracket.unwrap_or([f64::NAN; 2]);
        writeln!(
            f,
            "UNDECIDED about {obstacle} between time {start:?} and {end:?}{}",
            self.in_its_span()
        )?;
        if self.undecided == Some(LimitedReport::Rounding) {
            writeln!(
                f,
                "        up to then it is clear, proven; in this window the depth is the allowed one but for rounding. What helps:"
            )?;
            writeln!(f, "        another --depth")?;
            return self.closest(f);
        }
        if self.undecided == Some(LimitedReport::Deviation) {
            writeln!(
                f,
                "        up to then it is clear, proven; from then on the deviation of the motion decides. What helps: a smaller"
            )?;
            writeln!(f, "        \"deviation\" in the motion file")?;
            return self.closest(f);
        }
        writeln!(
            f,
            "        up to then it is clear, proven; in this window the work for a proof came to its limit. What helps: a motion"
        )?;
        let may_touch = self.obstacle.as_ref().is_some_and(|name| {
            let found = self.obstacles.get(name.index);
            found.is_some_and(|obstacle| obstacle.depth.is_some())
        });
        let option = if may_touch { "--depth" } else { "--clearance" };
        writeln!(
            f,
            "        of this window only, a coarser mesh where it comes close, another {option}"
        )?;
        self.closest(f)
    }

    fn listed_intervals(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for obstacle in &self.obstacles {
            let Some(intervals) = &obstacle.intervals else {
                continue;
            };
            write!(f, "during  ")?;
            for [start, end] in intervals {
                write!(f, "[{}, {}] ", Time(*start), Time(*end))?;
            }
            let what = if intervals.is_empty() { "no time " } else { "" };
            match obstacle.depth {
                None => writeln!(f, "{what}with {}", obstacle.name())?,
                Some(depth) => {
                    let depth = Readable(depth);
                    writeln!(f, "{what}deeper than {depth} in {}", obstacle.name())?;
                }
            }
            for doubt in obstacle.doubts.iter().flatten() {
                let [start, end] = doubt.times;
                let why = match doubt.limited {
                    LimitedReport::Work => "the work for a proof came to its limit",
                    LimitedReport::Rounding => "the depth is that but for rounding",
                    LimitedReport::Deviation => "the deviation of the motion decides",
                };
                writeln!(f, "        not decided during [{start:?}, {end:?}]: {why}")?;
            }
            for end in obstacle.interval_ends.iter().flatten().flatten() {
                let (time, in_span) = (Time(end.time), self.in_span(end.progress.span));
                let (progress, pose) = (end.progress, Matrix(end.pose));
                writeln!(f, "        {time}: {progress}{in_span}; pose {pose}")?;
            }
        }
        Ok(())
    }

    fn obstacle_name(&self) -> String {
        self.obstacle
            .as_ref()
            .map_or_else(String::new, ObstacleName::name)
    }

    /// The span of a chain in which the verdict falls.
    fn in_its_span(&self) -> String {
        self.span.map_or(String::new(), |span| self.in_span(span))
    }

    /// The span in words; nothing when the chain has only one span.
    fn in_span(&self, span: usize) -> String {
        match self.motion.spans {
            1 => String::new(),
            spans => format!(", in span {} of {spans}", span + 1),
        }
    }
}

impl ObstacleName {
    /// The name for reading: the file, or the plane as options call it.
    fn name(&self) -> String {
        named(self.file.as_deref(), self.plane)
    }
}

impl ObstacleReport {
    fn name(&self) -> String {
        let number = self.plane.map(|plane| plane.number);
        named(self.file.as_deref(), number)
    }
}

fn named(file: Option<&str>, plane: Option<usize>) -> String {
    match (file, plane) {
        (Some(file), _) => file.to_owned(),
        (None, Some(number)) => format!("plane{number}"),
        (None, None) => String::new(),
    }
}

impl fmt::Display for ObstacleReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.name())?;
        if let Some(plane) = self.plane {
            let (point, normal) = (Vector(plane.point), Vector(plane.normal));
            write!(f, "through {point}, normal {normal}, solid behind it")?;
        } else if let Some(points) = self.points {
            write!(f, "{}", counted(points, "point"))?;
        } else {
            let kind = if self.closed { "closed" } else { "open" };
            write!(f, "{}, {kind}", counted(self.triangles, "triangle"))?;
        }
        if let Some(motion) = &self.motion {
            write!(f, ", moves by {motion}")?;
            match self.relative_motion {
                RelativeMotionReport::AtRest => {}
                RelativeMotionReport::Steady => write!(f, " (steadily, seen from the body)")?,
                RelativeMotionReport::Bounded => {
                    write!(f, " (not steadily, seen from the body: by bounds)")?;
                }
            }
        }
        if self.allowed {
            write!(f, ", allowed to touch: left out")?;
        }
        if let Some(depth) = self.depth {
            write!(
                f,
                ", may be touched: entered deeper than {}?",
                Readable(depth)
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for FeatureReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FeatureReport::Vertex(vertex) => write!(f, "vertex {vertex}"),
            FeatureReport::Edge([from, to]) => write!(f, "edge {from}-{to}"),
            FeatureReport::Face(face) => write!(f, "face {face}"),
            FeatureReport::Plane(number) => write!(f, "plane{number}"),
        }
    }
}

impl fmt::Display for LimitedReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            LimitedReport::Work => {
                "too many parts are equally near to look at all within the limit on work"
            }
            LimitedReport::Rounding => "the distance is near the rounding of positions",
            LimitedReport::Deviation => {
                "the spans that follow the motion may be off by its deviation, either way"
            }
        })
    }
}

impl fmt::Display for TouchReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            TouchReport::Touch => "they touch",
            TouchReport::Slide => "they slide along each other",
            TouchReport::Enter => "one enters the other",
            TouchReport::Inside => "they overlap, or one is inside the other",
        })
    }
}

/// A time for reading: ten significant digits, as many as the bracket of a contact warrants.
struct Time(f64);

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded: f64 = format!("{:.9e}", self.0).parse().unwrap_or(self.0);
        match rounded {
            0.0 => write!(f, "0"),
            _ if (1e-4..1e9).contains(&rounded.abs()) => write!(f, "{rounded}"),
            _ => write!(f, "{rounded:e}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::{CheckedMotionReport, ClearanceReport, ContactReport, DoubtReport};
    use super::super::place::PlaceReport;
    use super::super::{BodyReport, Seconds};
    use super::*;
    use crate::motion::{Generator, Motion, Span};
    use glam::DVec3;

    /// A place in the second of two spans, a translation by 8.
    fn place() -> PlaceReport {
        let slide = |way: DVec3| Span::new(Generator::translation(way), 1.25).expect("legal");
        let spans = vec![slide(DVec3::X), slide(-8.0 * DVec3::Z)];
        PlaceReport::at_time(&Motion::from_spans(spans).expect("legal"), 1.875)
    }

    /// The check of a chain of two spans about which nothing is known from time 2.5 on.
    fn undecided() -> CheckReport {
        let place = place();
        let name = ObstacleName {
            file: Some("d/wall.stl".to_owned()),
            plane: None,
            index: 0,
        };
        CheckReport {
            verdict: VerdictReport::Undecided,
            time: None,
            bracket: Some([2.5, 2.75]),
            span: Some(1),
            obstacle: Some(name.clone()),
            undecided: Some(LimitedReport::Work),
            features: None,
            touch: None,
            depth: None,
            point: None,
            normal: None,
            pose: None,
            progress: None,
            obstacle_pose: None,
            intervals: None,
            interval_ends: None,
            clearance: ClearanceReport {
                lower: 0.0,
                upper: Some(0.25),
                time: Some(2.625),
                obstacle: Some(name),
                points: Some([[0.0; 3], [0.0, 0.25, 0.0]]),
                pose: Some(place.pose),
                progress: Some(place.progress),
                obstacle_pose: Some([
                    [1.0, 0.0, 0.0, 7.0],
                    [0.0, 1.0, 0.0, 0.0],
                    [0.0, 0.0, 1.0, 0.0],
                ]),
                required: 0.0,
                limited: None,
            },
            body: BodyReport {
                triangles: 12,
                volume: 1.0,
                watertight: true,
                welded: 0,
                largest_move: 0.0,
                collapsed: 0,
                turned: false,
            },
            motion: CheckedMotionReport {
                spans: 2,
                deviation: None,
                half_turns: Vec::new(),
                times: [2.0, 4.0],
            },
            obstacles: vec![ObstacleReport {
                file: Some("d/wall.stl".to_owned()),
                plane: None,
                points: None,
                triangles: 2,
                closed: false,
                welded: 0,
                motion: Some("wall.json".to_owned()),
                deviation: None,
                half_turns: Vec::new(),
                relative_motion: RelativeMotionReport::Bounded,
                allowed: false,
                contact: Some(ContactReport::Touch),
                depth: None,
                intervals: None,
                interval_ends: None,
                doubts: None,
            }],
            seconds: Seconds::default(),
        }
    }

    #[test]
    fn what_is_undecided_says_so_and_what_helps() {
        let text = undecided().to_string();
        for part in [
            "motion  2 steady spans, from time 2 to 4\n",
            "against d/wall.stl: 2 triangles, open, moves by wall.json (not steadily",
            "UNDECIDED about d/wall.stl between time 2.5 and 2.75, in span 2 of 2\n",
            "up to then it is clear, proven; in this window the work for a proof came to its limit.",
            "What helps: a motion\n        of this window only,",
            "closest seen: 0.25 at time 2.625, from (0, 0, 0) on the body to (0, 0.25, 0) on d/wall.stl\n        advanced 4 of 8, in span 2 of 2\n        pose [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, -4]]\n        \
             pose of the obstacle [[1, 0, 0, 7], [0, 1, 0, 0], [0, 0, 1, 0]]\n",
        ] {
            assert!(text.contains(part), "{part:?} is missing: {text}");
        }
    }

    #[test]
    fn what_rounding_leaves_undecided_names_the_depth_and_no_work() {
        let mut report = undecided();
        report.undecided = Some(LimitedReport::Rounding);
        report.obstacles[0].contact = Some(ContactReport::Enter);
        report.obstacles[0].depth = Some(0.5);
        let expected = "in this window the depth is the allowed one but for rounding. What helps:\n        another --depth\n";
        let text = report.to_string();
        assert!(text.contains(expected), "{text}");
        assert!(!text.contains("the work for a proof"), "{text}");
    }

    #[test]
    fn the_place_at_both_ends_of_an_interval_is_listed() {
        let mut report = undecided();
        report.obstacles[0].intervals = Some(vec![[1.875, 2.0]]);
        report.obstacles[0].interval_ends = Some(vec![[place(); 2]]);
        let line = "        1.875: advanced 4 of 8, in span 2 of 2; pose [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, -4]]\n";
        let expected = format!("during  [1.875, 2] with d/wall.stl\n{line}{line}");
        let text = report.to_string();
        assert!(text.contains(&expected), "{text}");
    }

    #[test]
    fn what_of_an_interval_is_in_doubt_is_told() {
        let mut report = undecided();
        report.obstacles[0].depth = Some(0.5);
        report.obstacles[0].intervals = Some(vec![[2.25, 3.0]]);
        report.obstacles[0].doubts = Some(vec![DoubtReport {
            times: [2.5, 2.625],
            limited: LimitedReport::Work,
        }]);
        let expected = "during  [2.25, 3] deeper than 0.5 in d/wall.stl\n        not decided during [2.5, 2.625]: the work for a proof came to its limit\n";
        let text = report.to_string();
        assert!(text.contains(expected), "{text}");
        let json = serde_json::to_value(report).expect("a report is always writable");
        let told = &json["obstacles"][0]["doubts"];
        let expected = serde_json::json!([{"times": [2.5, 2.625], "limited": "work"}]);
        assert_eq!(told, &expected);
    }

    #[test]
    fn what_is_undecided_is_one_object_with_nulls() {
        let json = serde_json::to_value(undecided()).expect("a report is always writable");
        assert_eq!(json["verdict"], "undecided");
        for key in [
            "time",
            "features",
            "touch",
            "point",
            "normal",
            "pose",
            "progress",
            "obstacle_pose",
            "intervals",
            "interval_ends",
        ] {
            assert!(json[key].is_null(), "{key}: {json}");
        }
        assert_eq!(json["bracket"], serde_json::json!([2.5, 2.75]));
        assert_eq!(json["obstacles"][0]["relative_motion"], "bounded");
    }

    #[test]
    fn contact_at_the_start_says_how_to_go_on() {
        let mut report = CheckReport {
            verdict: VerdictReport::Contact,
            time: Some(2.0),
            ..undecided()
        };
        let text = report.to_string();
        assert!(text.contains("--intervals tells"), "the only one: {text}");
        assert!(text.contains("--touching wall asks"), "{text}");
        assert!(!text.contains("--allow"), "the only one: {text}");
        report.obstacles.push(report.obstacles[0].clone());
        let text = report.to_string();
        assert!(text.contains("--allow wall leaves it out\n"), "{text}");
        report.time = Some(2.5);
        assert!(!report.to_string().contains("--allow"), "on the way");
    }

    #[test]
    fn times_have_ten_digits() {
        for (time, expected) in [
            (2.0 / 3.0, "0.6666666667"),
            (-0.0, "0"),
            (123.0, "123"),
            (1.0 / 3e11, "3.333333333e-12"),
        ] {
            assert_eq!(Time(time).to_string(), expected);
        }
    }
}
