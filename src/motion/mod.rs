//! Steady affine motions: velocity field, flow, logarithm, chains of spans. Knows no bodies.

mod chain;
mod deflation;
mod describe;
mod enclosure;
mod error;
mod flow;
mod generator;
mod logarithm;
mod spectrum;
mod trajectory;

pub use chain::{Keyframe, Motion, Span};
pub use describe::{Description, MotionKind, describe};
pub use error::MotionError;
pub use flow::Flow;
pub use generator::{Generator, Screw};
pub use logarithm::{Logarithm, logarithm};
pub use trajectory::{acceleration_bound, box_path_bounds, path_bounds, stretch};
