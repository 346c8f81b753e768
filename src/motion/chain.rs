//! A chain of steady spans.

use super::{Flow, Generator, MotionError};
use glam::DAffine3;

/// One steady span of a motion: world generator of the whole span and its share of the clock.
#[derive(Debug, Clone)]
pub struct Span {
    flow: Flow,
    duration: f64,
    unique: bool,
}

/// A pose at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keyframe {
    /// On the motion's clock.
    pub time: f64,
    /// Body to world.
    pub pose: DAffine3,
}

impl Span {
    /// A span that acts on world coordinates by exp(sG), s from 0 to 1 over `duration`.
    pub fn new(generator: Generator, duration: f64) -> Result<Span, MotionError> {
        Ok(Span {
            flow: Flow::new(generator),
            duration,
            unique: true,
        })
    }
    /// exp(sG), s in [0, 1] over the span.
    pub fn flow(&self) -> &Flow {
        &self.flow
    }
    /// Length of the span on the motion's clock.
    pub fn duration(&self) -> f64 {
        self.duration
    }
    /// False when another motion of the same kind joins the same poses (half turn).
    pub fn unique(&self) -> bool {
        self.unique
    }
}

/// A motion: start pose (body to world) and a chain of steady spans.
#[derive(Debug, Clone)]
pub struct Motion {
    start_pose: DAffine3,
    start_time: f64,
    spans: Vec<Span>,
    joints: Vec<DAffine3>,
}

impl Motion {
    /// A body given in the world at the start, then `spans` one after the other; the clock starts at 0.
    pub fn from_spans(_spans: Vec<Span>) -> Result<Motion, MotionError> {
        todo!()
    }
    /// The steady motions between consecutive poses.
    pub fn from_keyframes(_keys: &[Keyframe]) -> Result<Motion, MotionError> {
        todo!()
    }
    /// Body to world at the start.
    pub fn start_pose(&self) -> &DAffine3 {
        &self.start_pose
    }
    /// The spans in order.
    pub fn spans(&self) -> &[Span] {
        &self.spans
    }
    /// Poses of the joints relative to the start, P_0 = identity .. P_K: maps the world at the start to the world there.
    pub fn joints(&self) -> &[DAffine3] {
        &self.joints
    }
    /// Clock times of the joints, K + 1 of them.
    pub fn joint_times(&self) -> Vec<f64> {
        let mut t = self.start_time;
        let mut out = vec![t];
        for span in &self.spans {
            t += span.duration;
            out.push(t);
        }
        out
    }
}
