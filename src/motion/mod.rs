//! Steady affine motions: velocity field, flow, logarithm, chains of spans. Knows no bodies.

mod chain;
mod error;
mod flow;
mod generator;
mod logarithm;
mod trajectory;

pub use chain::{Keyframe, Motion, Span};
pub use error::MotionError;
pub use flow::Flow;
pub use generator::Generator;
pub use logarithm::{Logarithm, logarithm};
pub use trajectory::{path_bounds, stretch};
