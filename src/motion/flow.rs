//! exp(tG): the pose at time t.

use super::Generator;
use glam::DAffine3;

/// exp(tG), prepared for many t.
#[derive(Debug, Clone)]
pub struct Flow {
    generator: Generator,
}

impl Flow {
    /// Prepares exp(tG).
    pub fn new(generator: Generator) -> Flow {
        Flow { generator }
    }
    /// G.
    pub fn generator(&self) -> &Generator {
        &self.generator
    }
    /// exp(tG).
    pub fn pose_at(&self, _t: f64) -> DAffine3 {
        todo!()
    }
}
