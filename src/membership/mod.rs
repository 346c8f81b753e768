//! A point against the moving body: during which times is it inside?

use crate::body::Mesh;
use crate::motion::Motion;
use glam::DVec3;

/// A moving body prepared for many point queries.
#[derive(Debug)]
pub struct Membership {}

impl Membership {
    /// `body` in its own frame, carried by `motion`.
    pub fn new(_body: &Mesh, _motion: &Motion) -> Membership {
        Membership {}
    }
    /// Closed time intervals on the motion's clock during which `point` (world) is in the closed body, merged across joints, ascending.
    pub fn intervals(&self, _point: DVec3) -> Vec<[f64; 2]> {
        todo!()
    }
    /// Whether `point` is ever inside.
    pub fn is_ever_inside(&self, _point: DVec3) -> bool {
        true
    }
}
