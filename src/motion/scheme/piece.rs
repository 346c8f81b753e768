//! A pose for every time between two keyframes, in the one form that all schemes have.
//!
//! > P(u) x = exp(Z(u)) S(u) x + d(u),   u in [0, 1],
//!
//! with Z and d linear in u and S(u) linear in u, or R exp(Y(u)) with a rotation R and Y linear in
//! u. So values, and series with a bound on the rest, are those of exponentials and products.

use crate::motion::series::{Series, Term};
use crate::motion::{Flow, Generator};
use glam::{DAffine3, DMat3, DVec3};

/// The motion between two keyframes; u runs from 0 to 1.
#[derive(Debug, Clone)]
pub(in crate::motion) struct Piece {
    pub(super) turn: Turn,
    pub(super) shape: Shape,
    /// d at the start, and by how much it changes.
    pub(super) line: [DVec3; 2],
}

/// A pose, and how it changes with u.
#[derive(Debug, Clone, Copy)]
pub(in crate::motion) struct Rates {
    pub(in crate::motion) pose: DAffine3,
    /// P'.
    pub(in crate::motion) first: DAffine3,
    /// P''; `None` where the piece is steady.
    pub(in crate::motion) second: Option<DAffine3>,
}

/// exp(Z(u)).
#[derive(Debug, Clone)]
pub(super) enum Turn {
    /// The identity.
    Still,
    /// exp(uG).
    Steady(Box<Flow>),
    /// exp((1 - u) X + u Y).
    Between([Generator; 2]),
}

/// S(u).
#[derive(Debug, Clone)]
pub(super) enum Shape {
    /// (1 - u) A + u B.
    Blend([DAffine3; 2]),
    /// R exp((1 - u) X + u Y).
    Stretch { first: DMat3, ends: [DMat3; 2] },
}

impl Piece {
    /// exp(uG) P.
    pub(in crate::motion) fn steady(flow: Flow, start: DAffine3) -> Piece {
        Piece {
            turn: Turn::Steady(Box::new(flow)),
            shape: Shape::Blend([start, start]),
            line: [DVec3::ZERO; 2],
        }
    }

    /// The flow, where the piece is steady.
    fn as_steady(&self) -> Option<&Flow> {
        match (&self.turn, &self.shape) {
            (Turn::Steady(flow), Shape::Blend([from, to]))
                if from == to && self.line == [DVec3::ZERO; 2] =>
            {
                Some(flow)
            }
            _ => None,
        }
    }

    /// Body to world at u.
    pub(in crate::motion) fn pose_at(&self, u: f64) -> DAffine3 {
        let turn = match &self.turn {
            Turn::Still => DAffine3::IDENTITY,
            Turn::Steady(flow) => flow.pose_at(u),
            Turn::Between(ends) => Flow::new(between(ends, u)).pose_at(1.0),
        };
        let shape = match &self.shape {
            Shape::Blend([from, to]) => blend(from, to, u),
            Shape::Stretch { first, ends } => {
                let stretch = Flow::new(between(&linear(ends), u)).pose_at(1.0);
                DAffine3::from_mat3(*first * stretch.matrix3)
            }
        };
        let mut pose = turn * shape;
        pose.translation += self.line[0] + self.line[1] * u;
        pose
    }

    /// The pose at u with its derivatives by u.
    pub(in crate::motion) fn rates(&self, u: f64) -> Rates {
        if let Some(flow) = self.as_steady() {
            let (pose, generator) = (self.pose_at(u), flow.generator());
            let first = DAffine3 {
                matrix3: generator.linear * pose.matrix3,
                translation: generator.velocity(pose.translation),
            };
            return Rates {
                pose,
                first,
                second: None,
            };
        }
        let [value, first, second, ..] = self.series(u, 1.0).terms;
        let derivative = |term: Term, factor: f64| DAffine3 {
            matrix3: term.linear * factor,
            translation: term.offset * factor,
        };
        Rates {
            pose: derivative(value, 1.0),
            first: derivative(first, 1.0),
            second: Some(derivative(second, 2.0)),
        }
    }

    /// The poses from `middle` - `half` to `middle` + `half`.
    pub(in crate::motion) fn series(&self, middle: f64, half: f64) -> Series {
        let exponential = |ends: &[Generator; 2]| {
            let slope = Generator {
                linear: (ends[1].linear - ends[0].linear) * half,
                offset: (ends[1].offset - ends[0].offset) * half,
            };
            Series::exponential(&between(ends, middle), &slope)
        };
        let shape = match &self.shape {
            Shape::Blend([from, to]) => Series::line(
                Term::of_pose(&blend(from, to, middle)),
                Term {
                    linear: (to.matrix3 - from.matrix3) * half,
                    offset: (to.translation - from.translation) * half,
                },
            ),
            Shape::Stretch { first, ends } => {
                Series::constant(&DAffine3::from_mat3(*first)).after(&exponential(&linear(ends)))
            }
        };
        let turned = match &self.turn {
            Turn::Still => shape,
            Turn::Steady(flow) if self.as_steady().is_some() => {
                Series::steady(flow.generator(), &self.pose_at(middle), half)
            }
            Turn::Steady(flow) => {
                Series::steady(flow.generator(), &flow.pose_at(middle), half).after(&shape)
            }
            Turn::Between(ends) => exponential(ends).after(&shape),
        };
        let line = self.line;
        if line == [DVec3::ZERO; 2] {
            return turned;
        }
        let displacement = |offset| Term {
            linear: DMat3::ZERO,
            offset,
        };
        turned.plus(&Series::line(
            displacement(line[0] + line[1] * middle),
            displacement(line[1] * half),
        ))
    }
}

fn between([from, to]: &[Generator; 2], u: f64) -> Generator {
    Generator {
        linear: from.linear * (1.0 - u) + to.linear * u,
        offset: from.offset * (1.0 - u) + to.offset * u,
    }
}

fn blend(from: &DAffine3, to: &DAffine3, u: f64) -> DAffine3 {
    DAffine3 {
        matrix3: from.matrix3 * (1.0 - u) + to.matrix3 * u,
        translation: from.translation * (1.0 - u) + to.translation * u,
    }
}

fn linear(ends: &[DMat3; 2]) -> [Generator; 2] {
    ends.map(|linear| Generator {
        linear,
        offset: DVec3::ZERO,
    })
}
