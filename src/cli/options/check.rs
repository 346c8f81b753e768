//! The options of `check`: the obstacles, and how they pair up with motions.

use std::fmt;
use std::path::PathBuf;

use clap::{ArgMatches, Args, Command, FromArgMatches};
use glam::DVec3;

use crate::collision::{ContactRule, Plane};

use super::{MotionOptions, finite, numbers};

/// Heading of the options that give the obstacles.
const OBSTACLES: &str = "Obstacles";

#[derive(Debug, Args)]
pub(crate) struct CheckOptions {
    /// The body: a closed triangle mesh, .stl, .obj or .ply.
    #[arg(value_name = "BODY")]
    pub(crate) body: PathBuf,

    #[command(flatten)]
    pub(crate) motion: MotionOptions,

    #[command(flatten)]
    pub(crate) obstacles: ObstacleOptions,

    /// Obstacle that may touch the body and is left out of the check: the name of its file without
    /// folder and extension, or plane0; may be given several times.
    #[arg(long, value_name = "NAME", help_heading = OBSTACLES)]
    pub(crate) allow: Vec<String>,

    /// Obstacle that the body may touch but not enter deeper than --depth: the name of its file
    /// without folder and extension, or plane0; may be given several times.
    #[arg(long, value_name = "NAME", help_heading = OBSTACLES)]
    pub(crate) touching: Vec<String>,

    /// What counts as contact: `touch`, or `enter`, which is --touching for every obstacle;
    /// default: touch.
    #[arg(
        long,
        value_name = "KIND",
        value_enum,
        default_value_t,
        hide_default_value = true,
        hide_possible_values = true
    )]
    pub(crate) contact: ContactKind,

    /// How deep the body may enter an obstacle that it may touch, in the body's units: the distance
    /// of a point of the body inside the obstacle from the obstacle's surface, or, for an open
    /// obstacle, of a point of it inside the body from the body's surface; default: the least depth
    /// that rounding can tell from touching.
    #[arg(long, value_name = "LEN", allow_hyphen_values = true, value_parser = depth_value)]
    pub(crate) depth: Option<f64>,

    /// Distance to keep, in the body's units: the verdict is `closer` where the distance falls
    /// below; default: 0, contact only.
    #[arg(long, value_name = "LEN", allow_hyphen_values = true, value_parser = not_negative)]
    pub(crate) clearance: Option<f64>,

    /// List all the times of contact (closer than --clearance, if given), not only the first;
    /// default: the first.
    #[arg(long)]
    pub(crate) intervals: bool,

    /// File for the distance to the obstacles over time (never a depth), .csv, replaced when it
    /// exists; default: none.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,

    /// Print the report as one JSON object; default: as text.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What counts as contact by `--contact`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub(crate) enum ContactKind {
    #[default]
    Touch,
    Enter,
}

/// `--against`, `--plane` and `--against-motion`, in the order in which they were written.
#[derive(Debug)]
pub(crate) struct ObstacleOptions {
    words: Vec<Word>,
}

/// A value of one of these options.
#[derive(Debug, Clone, PartialEq)]
enum Word {
    Obstacle(ObstacleSource),
    Motion(PathBuf),
}

/// What an obstacle is given by.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ObstacleSource {
    /// The file of a mesh.
    File(PathBuf),
    /// A plane, with its number among the planes.
    Plane(usize, Plane),
}

impl fmt::Display for ObstacleSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ObstacleSource::File(path) => write!(f, "{}", path.display()),
            ObstacleSource::Plane(number, _) => write!(f, "plane{number}"),
        }
    }
}

impl ObstacleSource {
    /// The name by which options call it: that of the file without folder and extension.
    fn name(&self) -> String {
        match self {
            ObstacleSource::File(path) => path
                .file_stem()
                .map(|stem| stem.to_string_lossy().into_owned())
                .unwrap_or_default(),
            ObstacleSource::Plane(..) => self.to_string(),
        }
    }
}

/// An obstacle of the command line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GivenObstacle {
    pub(crate) source: ObstacleSource,
    /// `None` when it rests.
    pub(crate) motion: Option<PathBuf>,
}

/// Why the options of `check` do not describe one check.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(crate) enum ObstacleOptionsError {
    #[error(
        "{motions} of --against-motion follow {obstacles} of --against and --plane: give one for all the obstacles that are named before \
         it, or one for each; obstacles that are named after it rest"
    )]
    Unpaired { obstacles: usize, motions: usize },
    #[error(
        "{option} {name}: there is no such obstacle; known {} {}",
        if known.len() == 1 { "is" } else { "are" },
        known.join(", ")
    )]
    UnknownName {
        option: &'static str,
        name: String,
        known: Vec<String>,
    },
    #[error(
        "{option} {name} fits two obstacles, {} and {}: rename or copy one of the files, the name is that without folder \
         and extension", .sources[0], .sources[1]
    )]
    AmbiguousName {
        option: &'static str,
        name: String,
        sources: [String; 2],
    },
    #[error(
        "every obstacle is allowed to touch, so nothing is left to check: leave out one of the --allow"
    )]
    AllAllowed,
    #[error(
        "{name} is left out by --allow but checked by --touching: --touching alone finds where it is entered"
    )]
    AllowedAndTouching { name: String },
    #[error(
        "--depth limits how deep the body may enter obstacles that it may touch, and there are none: name one by --touching, or all of them \
         by --contact enter"
    )]
    DepthOfNothing,
    #[error(
        "--clearance is a distance to keep from obstacles that must not be touched, and none is left: leave out one of the two, or name \
         those that may be touched by --touching"
    )]
    ClearanceFromNothing,
}

/// These options as clap reads them.
#[derive(Debug, Args)]
struct Words {
    /// Obstacles: triangle meshes, .stl, .obj or .ply, in the same coordinates as the body, or
    /// points, .csv with lines x,y,z or .ply without faces. Meshes may be open surfaces; inside a
    /// closed one counts as contact, and so does a point inside the body.
    #[arg(long, value_name = "FILE", required_unless_present = "plane", num_args = 1.., help_heading = OBSTACLES)]
    against: Vec<PathBuf>,

    /// Half-space as an obstacle, by a point of its plane and a normal of any length: what is
    /// behind the plane is solid, the normal points out of it; may be given several times, also
    /// without --against. The first one is called plane0.
    #[arg(long, value_name = "X,Y,Z,NX,NY,NZ", allow_hyphen_values = true, value_parser = plane, help_heading = OBSTACLES)]
    plane: Vec<Plane>,

    /// Motion file of the obstacles that are named before it: one for all of them as one assembly,
    /// or one for each in order. Obstacles that are named after it rest; but before all obstacles
    /// it is the motion of those after it. Default: all rest. It shares the clock of the body's
    /// motion.
    #[arg(long, value_name = "FILE.json", num_args = 1.., help_heading = OBSTACLES)]
    against_motion: Vec<PathBuf>,
}

impl Args for ObstacleOptions {
    fn augment_args(command: Command) -> Command {
        Words::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Words::augment_args_for_update(command)
    }
}

impl FromArgMatches for ObstacleOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<ObstacleOptions, clap::Error> {
        let Words {
            against,
            plane,
            against_motion,
        } = Words::from_arg_matches(matches)?;
        let places = |name: &str| matches.indices_of(name).into_iter().flatten();
        let files = against.into_iter().map(ObstacleSource::File);
        let planes = (0..).zip(plane);
        let planes = planes.map(|(number, plane)| ObstacleSource::Plane(number, plane));
        let mut words: Vec<(usize, Word)> = places("against")
            .zip(files.map(Word::Obstacle))
            .chain(places("plane").zip(planes.map(Word::Obstacle)))
            .chain(places("against_motion").zip(against_motion.into_iter().map(Word::Motion)))
            .collect();
        words.sort_by_key(|(place, _)| *place);
        Ok(ObstacleOptions {
            words: words.into_iter().map(|(_, word)| word).collect(),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = ObstacleOptions::from_arg_matches(matches)?;
        Ok(())
    }
}

impl ObstacleOptions {
    /// The obstacles in the order of the command line, each with its motion.
    ///
    /// A run of motions belongs to the run of obstacles before it, one for all or one for each.
    /// When the motions come first, they belong to the obstacles after them; further motions are
    /// then refused.
    pub(crate) fn given(&self) -> Result<Vec<GivenObstacle>, ObstacleOptionsError> {
        let mut words = self.words.clone();
        let leading = words
            .iter()
            .take_while(|word| matches!(word, Word::Motion(_)))
            .count();
        if words[leading..]
            .iter()
            .all(|word| matches!(word, Word::Obstacle(_)))
        {
            words.rotate_left(leading);
        }
        let mut given = Vec::new();
        for run in
            words.chunk_by(|a, b| !(matches!(a, Word::Motion(_)) && matches!(b, Word::Obstacle(_))))
        {
            let mut obstacles = Vec::new();
            let mut motions = Vec::new();
            for word in run {
                match word {
                    Word::Obstacle(source) => obstacles.push(source.clone()),
                    Word::Motion(motion) => motions.push(motion.clone()),
                }
            }
            if motions.len() > 1 && motions.len() != obstacles.len() || obstacles.is_empty() {
                return Err(ObstacleOptionsError::Unpaired {
                    obstacles: obstacles.len(),
                    motions: motions.len(),
                });
            }
            given.extend(
                obstacles
                    .into_iter()
                    .enumerate()
                    .map(|(index, source)| GivenObstacle {
                        source,
                        motion: motions.get(index).or(motions.last()).cloned(),
                    }),
            );
        }
        Ok(given)
    }
}

impl CheckOptions {
    /// What counts as contact, per obstacle.
    pub(crate) fn rules(
        &self,
        given: &[GivenObstacle],
    ) -> Result<Vec<ContactRule>, ObstacleOptionsError> {
        let enter = ContactRule::Enter { depth: self.depth };
        let usual = match self.contact {
            ContactKind::Touch => ContactRule::Touch,
            ContactKind::Enter => enter,
        };
        let mut rules = vec![usual; given.len()];
        for name in &self.touching {
            rules[number("--touching", name, given)?] = enter;
        }
        for name in &self.allow {
            if self.touching.contains(name) {
                let name = name.clone();
                return Err(ObstacleOptionsError::AllowedAndTouching { name });
            }
            rules[number("--allow", name, given)?] = ContactRule::Allowed;
        }
        if rules.iter().all(|&rule| rule == ContactRule::Allowed) {
            return Err(ObstacleOptionsError::AllAllowed);
        }
        if self.depth.is_some() && !rules.contains(&enter) {
            return Err(ObstacleOptionsError::DepthOfNothing);
        }
        if self.clearance.is_some_and(|clearance| clearance > 0.0)
            && !rules.contains(&ContactRule::Touch)
        {
            return Err(ObstacleOptionsError::ClearanceFromNothing);
        }
        Ok(rules)
    }
}

/// The number of the one obstacle that an option names.
fn number(
    option: &'static str,
    name: &str,
    given: &[GivenObstacle],
) -> Result<usize, ObstacleOptionsError> {
    let mut fitting = (0..given.len()).filter(|&i| given[i].source.name() == name);
    let Some(index) = fitting.next() else {
        let mut known: Vec<String> = Vec::new();
        for name in given.iter().map(|obstacle| obstacle.source.name()) {
            if !known.contains(&name) {
                known.push(name);
            }
        }
        return Err(ObstacleOptionsError::UnknownName {
            option,
            name: name.to_owned(),
            known,
        });
    };
    match fitting.next() {
        Some(other) => Err(ObstacleOptionsError::AmbiguousName {
            option,
            name: name.to_owned(),
            sources: [index, other].map(|i| given[i].source.to_string()),
        }),
        None => Ok(index),
    }
}

fn plane(text: &str) -> Result<Plane, String> {
    let expected = "six numbers X,Y,Z,NX,NY,NZ without spaces, a point and a normal";
    match numbers(text, expected)?[..] {
        [x, y, z, across, along, up] => {
            let normal = DVec3::new(across, along, up);
            Plane::new(DVec3::new(x, y, z), normal).map_err(|error| error.to_string())
        }
        ref other => Err(format!("expected {expected}, found {}", other.len())),
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    match finite(text)? {
        value if value >= 0.0 => Ok(value),
        _ => Err(
            "must not be below 0; leave it out, or give 0, to check for contact only".to_owned(),
        ),
    }
}

fn depth_value(text: &str) -> Result<f64, String> {
    match finite(text)? {
        value if value > 0.0 => Ok(value),
        _ => Err(
            "must be above 0; leave it out for the least depth that rounding can tell from touching"
                .to_owned(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Command, Options};
    use super::*;
    use clap::Parser;

    fn options(arguments: &str) -> CheckOptions {
        let words = ["steadysweep", "check", "body.stl", "--translate", "1,0,0"]
            .into_iter()
            .chain(arguments.split_whitespace());
        match Options::try_parse_from(words)
            .expect("the words must parse")
            .command
        {
            Command::Check(options) => options,
            other => panic!("parsed as {other:?}"),
        }
    }

    /// Obstacles and their motions as `a+m b`.
    fn paired(arguments: &str) -> Result<String, ObstacleOptionsError> {
        let given = options(arguments).obstacles.given()?;
        let words: Vec<String> = given
            .iter()
            .map(|given| match &given.motion {
                Some(motion) => format!("{}+{}", given.source, motion.display()),
                None => given.source.to_string(),
            })
            .collect();
        Ok(words.join(" "))
    }

    #[test]
    fn motions_belong_to_the_obstacles_before_them() {
        let cases = [
            ("--against a b --against c", "a b c"),
            ("--against a --against-motion m", "a+m"),
            ("--against-motion m --against a b", "a+m b+m"),
            ("--against a b --against-motion m", "a+m b+m"),
            ("--against a --against b --against-motion m", "a+m b+m"),
            ("--against a --against-motion m --against b", "a+m b"),
            ("--against a b --against-motion m n", "a+m b+n"),
            (
                "--against a --against b --against-motion m --against-motion n",
                "a+m b+n",
            ),
            (
                "--against a --against-motion m --against b c --against-motion n --against d",
                "a+m b+n c+n d",
            ),
            (
                "--against a --clearance 1 --against b --json --against-motion m",
                "a+m b+m",
            ),
            ("--plane 0,0,0,0,0,1", "plane0"),
            (
                "--plane 0,0,0,0,0,1 --against a --against-motion m n --plane -1,-2,-3,1,0,0",
                "plane0+m a+n plane1",
            ),
        ];
        for (arguments, expected) in cases {
            assert_eq!(paired(arguments), Ok(expected.to_owned()), "{arguments}");
        }
    }

    #[test]
    fn motions_that_do_not_pair_up_are_refused() {
        for (arguments, obstacles, motions) in [
            ("--against a --against-motion m n", 1, 2),
            ("--against a b c --against-motion m n", 3, 2),
            ("--against-motion m --against a --against-motion n", 0, 1),
        ] {
            assert_eq!(
                paired(arguments),
                Err(ObstacleOptionsError::Unpaired { obstacles, motions }),
                "{arguments}"
            );
        }
    }

    fn rules(arguments: &str) -> Result<Vec<ContactRule>, ObstacleOptionsError> {
        let options = options(arguments);
        options.rules(&options.obstacles.given()?)
    }

    fn message(arguments: &str) -> String {
        rules(arguments).expect_err("must be refused").to_string()
    }

    #[test]
    fn obstacles_that_may_be_touched_are_named_or_all_of_them() {
        let enter = |depth: Option<f64>| ContactRule::Enter { depth };
        for (arguments, expected) in [
            (
                "--against a.stl b.stl --touching b",
                [ContactRule::Touch, enter(None)],
            ),
            (
                "--against a.stl b.stl --touching b --depth 0.5 --clearance 1",
                [ContactRule::Touch, enter(Some(0.5))],
            ),
            (
                "--against a.stl b.stl --contact enter --allow a",
                [ContactRule::Allowed, enter(None)],
            ),
            (
                "--against a.stl b.stl --contact touch",
                [ContactRule::Touch; 2],
            ),
        ] {
            assert_eq!(rules(arguments), Ok(expected.to_vec()), "{arguments}");
        }
        for (arguments, expected) in [
            (
                "--against a.stl --touching b",
                "--touching b: there is no such obstacle; known is a",
            ),
            (
                "--against x/a.stl y/a.stl --touching a",
                "--touching a fits two",
            ),
            ("--against a.stl --depth 1", "name one by --touching"),
            (
                "--against a.stl b.stl --touching a --allow a",
                "--touching alone finds",
            ),
            (
                "--against a.stl --contact enter --clearance 1",
                "must not be touched, and none is left",
            ),
        ] {
            let message = message(arguments);
            assert!(message.contains(expected), "{arguments}: {message}");
        }
        for depth in ["0", "-1", "nan"] {
            assert!(depth_value(depth).is_err(), "{depth}");
        }
    }

    #[test]
    fn obstacles_are_allowed_by_the_stem_of_their_file() {
        assert_eq!(
            rules("--against d/stand.v2.stl table.obj --allow stand.v2"),
            Ok(vec![ContactRule::Allowed, ContactRule::Touch])
        );
        assert_eq!(
            rules("--against a.stl b.stl c.stl --allow c --allow a"),
            Ok(vec![
                ContactRule::Allowed,
                ContactRule::Touch,
                ContactRule::Allowed
            ])
        );
        assert_eq!(
            message("--against stand.stl x/table.obj y/table.obj --allow stnd"),
            "--allow stnd: there is no such obstacle; known are stand, table"
        );
        assert!(
            message("--against x/table.obj y/table.stl --allow table")
                .contains("fits two obstacles, x/table.obj and y/table.stl"),
            "ambiguous"
        );
        assert!(
            message("--against a.stl --allow a").contains("nothing is left"),
            "a check of nothing is no check"
        );
    }

    #[test]
    fn planes_are_six_numbers_with_a_normal_that_has_a_direction() {
        for (text, expected) in [
            ("0,0,0,0,0,1", None),
            (
                "1,2",
                Some("six numbers X,Y,Z,NX,NY,NZ without spaces, a point and a normal, found 2"),
            ),
            ("0,0,0,0,0,x", Some("expected a number")),
            (
                "0,0,0,0,0,0",
                Some("the normal [0, 0, 0] of a plane has no direction"),
            ),
            ("1e30,0,0,0,0,1", Some("use a nearer point of it")),
        ] {
            match (plane(text), expected) {
                (Ok(_), None) => {}
                (Err(found), Some(expected)) => assert!(found.contains(expected), "{found}"),
                (found, _) => panic!("{text}: {found:?}"),
            }
        }
        assert_eq!(
            rules("--against a.stl --plane 0,0,0,0,0,1 --touching plane0"),
            Ok(vec![ContactRule::Touch, ContactRule::Enter { depth: None }])
        );
    }

    #[test]
    fn a_clearance_below_zero_is_refused() {
        for (text, is_legal) in [("0", true), ("1e-3", true), ("-0.1", false), ("NaN", false)] {
            assert_eq!(not_negative(text).is_ok(), is_legal, "{text}");
        }
    }
}
