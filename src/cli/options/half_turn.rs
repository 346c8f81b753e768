//! `--half-turn`: the senses of half turns between keyframes, assigned to the motions.

use super::MOTION;
use crate::motion::{HalfTurns, Sense};
use clap::Args;

/// The value of the option, as written.
#[derive(Debug, Default, Args)]
pub(crate) struct HalfTurnOption {
    /// Sense of the half turns between keyframes, which two poses leave open: + by the right-hand
    /// rule about the axis whose first component that is not zero (above 1e-9) is positive, in the
    /// plane from x towards y; or -. One for all, or one for each half turn in the order of time,
    /// separated by commas (those of --motion, then those of each --against-motion file); default:
    /// a half turn is refused, except by `motion`, which shows +.
    #[arg(long, help_heading = MOTION, value_name = "+|-", allow_hyphen_values = true, value_delimiter = ',',
          value_parser = sense)]
    half_turn: Vec<Sense>,
}

/// Why the senses do not fit the motions.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(crate) enum HalfTurnError {
    #[error(
        "--half-turn: the motion has no half turn between keyframes (`steadysweep motion` lists each span); leave it out"
    )]
    None,
    #[error(
        "--half-turn has {given} senses for {}; give one for each, or one for all",
        half_turns(*.found)
    )]
    Count { given: usize, found: usize },
}

impl HalfTurnOption {
    /// Whether the option was not given.
    pub(crate) fn is_none(&self) -> bool {
        self.half_turn.is_empty()
    }

    /// How to treat half turns while motions are read: [`HalfTurnOption::shared`] decides once all
    /// are.
    pub(crate) fn while_reading(&self) -> HalfTurns {
        if self.is_none() {
            HalfTurns::Refused
        } else {
            HalfTurns::All(Sense::Positive)
        }
    }

    /// The senses for the half turns of a single motion, from their number.
    pub(crate) fn of_one(&self, count: usize) -> Result<HalfTurns, HalfTurnError> {
        self.shared(&[count]).map(|mut each| each.swap_remove(0))
    }

    /// The senses for the half turns of several motions, from their numbers.
    pub(crate) fn shared(&self, counts: &[usize]) -> Result<Vec<HalfTurns>, HalfTurnError> {
        let found: usize = counts.iter().sum();
        match self.half_turn[..] {
            [] => Ok(vec![HalfTurns::Refused; counts.len()]),
            _ if found == 0 => Err(HalfTurnError::None),
            [one] => Ok(vec![HalfTurns::All(one); counts.len()]),
            ref each if each.len() == found => {
                let mut left = each.iter().copied();
                let of = |&count: &usize| HalfTurns::Each(left.by_ref().take(count).collect());
                Ok(counts.iter().map(of).collect())
            }
            ref each => Err(HalfTurnError::Count {
                given: each.len(),
                found,
            }),
        }
    }
}

fn half_turns(count: usize) -> String {
    match count {
        1 => "one half turn".to_owned(),
        _ => format!("{count} half turns"),
    }
}

fn sense(text: &str) -> Result<Sense, String> {
    match text.trim() {
        "+" => Ok(Sense::Positive),
        "-" => Ok(Sense::Negative),
        _ => Err("expected + or -, or a list such as +,-".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Command, Options};
    use super::*;
    use Sense::{Negative, Positive};
    use clap::Parser;

    fn parsed(arguments: &str) -> HalfTurnOption {
        let words = ["steadysweep", "motion", "--motion", "a.json"]
            .into_iter()
            .chain(arguments.split_whitespace());
        match Options::try_parse_from(words)
            .unwrap_or_else(|error| panic!("{arguments}: {error}"))
            .command
        {
            Command::Motion(options) => options.motion.half_turn,
            other => panic!("parsed as {other:?}"),
        }
    }

    #[test]
    fn senses_are_signs_separated_by_commas() {
        let cases: [(&str, &[Sense]); 6] = [
            ("", &[]),
            ("--half-turn +", &[Positive]),
            ("--half-turn -", &[Negative]),
            ("--half-turn=- --json", &[Negative]),
            ("--half-turn -,+", &[Negative, Positive]),
            ("--half-turn +,-,-", &[Positive, Negative, Negative]),
        ];
        for (arguments, expected) in cases {
            assert_eq!(parsed(arguments).half_turn, expected, "{arguments}");
        }
        for bad in ["", "1", "++", "right"] {
            assert!(sense(bad).is_err(), "{bad:?} is no sense");
        }
    }

    #[test]
    fn senses_go_to_the_motions_in_order() {
        let each = |senses: &[Sense]| HalfTurns::Each(senses.to_vec());
        assert_eq!(
            parsed("--half-turn +,-,-").shared(&[1, 0, 2]),
            Ok(vec![
                each(&[Positive]),
                each(&[]),
                each(&[Negative, Negative])
            ])
        );
        assert_eq!(
            parsed("--half-turn -").shared(&[0, 2]),
            Ok(vec![HalfTurns::All(Negative); 2])
        );
        assert_eq!(parsed("").shared(&[0]), Ok(vec![HalfTurns::Refused]));
        let count = |given, found| Err(HalfTurnError::Count { given, found });
        assert_eq!(parsed("--half-turn +,-").shared(&[1]), count(2, 1));
        assert_eq!(parsed("--half-turn +,-").shared(&[2, 1]), count(2, 3));
        assert_eq!(
            parsed("--half-turn +").shared(&[0]),
            Err(HalfTurnError::None)
        );
    }
}
