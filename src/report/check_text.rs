//! The report of a check for reading.

use super::check::{
    CheckReport, FeatureReport, ObstacleReport, RelativeMotionReport, TouchReport, VerdictReport,
};
use super::text::{Vector, counted};
use crate::numeric::Readable;
use std::fmt;

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.body)?;
        writeln!(f, "motion  {}", counted(self.motion.spans, "steady span"))?;
        for (index, obstacle) in self.obstacles.iter().enumerate() {
            let label = if index == 0 { "against" } else { "" };
            writeln!(f, "{label:<7} {obstacle}")?;
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
        writeln!(
            f,
            "CLEAR   the distance is never below {} (proven)",
            Readable(self.clearance.lower)
        )?;
        self.closest(f)
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
            obstacle.file
        )
    }

    fn met(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let obstacle = self.obstacle_file();
        let time = Time(self.time.unwrap_or(f64::NAN));
        if self.verdict == VerdictReport::Contact {
            writeln!(
                f,
                "CONTACT with {obstacle} at time {time}{}",
                self.in_span()
            )?;
        } else {
            writeln!(
                f,
                "CLOSER  to {obstacle} than the clearance from time {time} on{}",
                self.in_span()
            )?;
        }
        if let Some([start, end]) = self.bracket {
            writeln!(
                f,
                "        certain to within {}: it is after {} and not after {}",
                Readable(end - start),
                start,
                end
            )?;
        }
        if let Some(features) = self.features {
            writeln!(
                f,
                "        {} of the body {} {} of {obstacle} (as the files count, from 0)",
                features.body,
                match self.verdict {
                    VerdictReport::Contact => "meets",
                    _ => "is near",
                },
                features.obstacle,
            )?;
        }
        if let (Some(point), Some(normal)) = (self.point, self.normal) {
            writeln!(
                f,
                "        at {}, normal {} from the obstacle to the body",
                Vector(point),
                Vector(normal)
            )?;
        }
        if let Some(touch) = self.touch {
            writeln!(f, "        {touch}")?;
        }
        Ok(())
    }

    fn undecided(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let obstacle = self.obstacle_file();
        let [start, end] = self.bracket.unwrap_or([f64::NAN; 2]);
        writeln!(
            f,
            "UNDECIDED about {obstacle} between time {start} and {end}{}",
            self.in_span()
        )?;
        writeln!(
            f,
            "        there is no contact before; in this window neither contact nor the distance could be proven"
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
            writeln!(f, "{what}with {}", obstacle.file)?;
        }
        Ok(())
    }

    fn obstacle_file(&self) -> &str {
        self.obstacle.as_ref().map_or("", |name| &name.file)
    }

    /// Where in a chain that is.
    fn in_span(&self) -> String {
        match self.span {
            Some(span) if self.motion.spans > 1 => {
                format!(", in span {} of {}", span + 1, self.motion.spans)
            }
            _ => String::new(),
        }
    }
}

impl fmt::Display for ObstacleReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {}, {}",
            self.file,
            counted(self.triangles, "triangle"),
            if self.closed { "closed" } else { "open" }
        )?;
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
        Ok(())
    }
}

impl fmt::Display for FeatureReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FeatureReport::Vertex(vertex) => write!(f, "vertex {vertex}"),
            FeatureReport::Edge([from, to]) => write!(f, "edge {from}-{to}"),
            FeatureReport::Face(face) => write!(f, "face {face}"),
        }
    }
}

impl fmt::Display for TouchReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            TouchReport::Touch => "they touch, and are not certain to come into each other",
            TouchReport::Slide => "they slide along each other",
            TouchReport::Enter => "one enters the other",
            TouchReport::Inside => "one is inside the other",
        })
    }
}

/// A time for reading: ten significant digits, which is what the bracket of a contact is good for.
struct Time(f64);

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded: f64 = format!("{:.9e}", self.0).parse().unwrap_or(self.0);
        write!(f, "{}", rounded + 0.0)
    }
}
