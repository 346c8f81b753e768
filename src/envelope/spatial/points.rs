//! Points fixed on the body: its vertices, break points, pieces of long edges, crossings, sunk
//! copies.

use crate::numeric::index;
use glam::DVec3;
use std::collections::HashMap;

/// Positions in the frame of the body at the start of the motion. Equal positions have equal
/// indices.
#[derive(Debug, Default)]
pub(crate) struct BodyPoints {
    positions: Vec<DVec3>,
    by_position: HashMap<[u64; 3], u32>,
}

impl BodyPoints {
    /// The index of the point at `position`.
    pub(crate) fn intern(&mut self, position: DVec3) -> u32 {
        // Adding zero makes -0 and 0 the same point.
        let key = (position + DVec3::ZERO).to_array().map(f64::to_bits);
        *self.by_position.entry(key).or_insert_with(|| {
            self.positions.push(position);
            index(self.positions.len() - 1)
        })
    }

    /// The position of a point.
    pub(crate) fn at(&self, point: u32) -> DVec3 {
        self.positions[point as usize]
    }
}
