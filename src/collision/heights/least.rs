//! The least distance of a body from a half-space over its whole motion.

use super::timeline::Timeline;
use crate::collision::scene::Scene;
use crate::collision::{Clearance, Closest};
use crate::numeric::index;
use crate::numeric::tolerance::CLEARANCE_PRECISION;
use crate::watch::Interrupted;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Most boxes and vertices in windows that are examined for one half-space: some seconds of work.
const MOST_LOOKED_AT: usize = 4_000_000;

/// A box in a window, by a lower bound of its heights: the lowest one comes first.
struct Open {
    lower: f64,
    node: u32,
    window: u32,
}

impl PartialEq for Open {
    fn eq(&self, other: &Open) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Open) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Open) -> Ordering {
        let places = (other.window, other.node).cmp(&(self.window, self.node));
        other.lower.total_cmp(&self.lower).then(places)
    }
}

/// What is certain about the distance from a half-space.
pub(in crate::collision) struct LeastDistance {
    /// A lower bound at all times.
    pub(in crate::collision) lower: f64,
    /// Whether the limit on work was reached.
    pub(in crate::collision) is_limited: bool,
}

/// The least distance from a half-space, of which `clearance` sees the place.
///
/// Boxes in windows are opened, the lowest first, until none can be lower by more than the precision
/// asks for than the least height seen.
pub(in crate::collision) fn see_least(
    scene: &Scene,
    obstacle: usize,
    clearance: &mut Clearance,
) -> Result<LeastDistance, Interrupted> {
    let nothing = LeastDistance {
        lower: 0.0,
        is_limited: true,
    };
    let Some(plane) = scene.plane(obstacle) else {
        return Ok(nothing);
    };
    let movers = |stage| scene.movers(obstacle, stage);
    let Some(timeline) = Timeline::new(scene.body, &scene.stages, movers, plane, 0.0) else {
        return Ok(nothing);
    };
    let bottom = |node: u32, window: u32| Open {
        lower: timeline.windows[window as usize]
            .heights(scene.body, &scene.body.nodes[node as usize])[0],
        node,
        window,
    };
    let mut open: BinaryHeap<Open> = (0..index(timeline.windows.len()))
        .map(|window| bottom(0, window))
        .collect();
    let mut least = LeastDistance {
        lower: f64::INFINITY,
        is_limited: false,
    };
    let mut looked_at = 0;
    while let Some(next) = open.pop() {
        scene.work.check()?;
        looked_at += 1;
        let enough = (1.0 - CLEARANCE_PRECISION) * clearance.upper;
        if next.lower >= enough || looked_at > MOST_LOOKED_AT {
            least.lower = least.lower.min(next.lower);
            least.is_limited = next.lower < enough;
            break;
        }
        let node = &scene.body.nodes[next.node as usize];
        if !node.is_leaf() {
            let children = [node.children, node.children + 1];
            open.extend(children.map(|child| bottom(child, next.window)));
            continue;
        }
        let window = &timeline.windows[next.window as usize];
        for (_, position) in timeline.own_corners(node.triangle) {
            let found = window.height(position).least(clearance.upper);
            least.lower = least.lower.min(found.lower);
            if found.seen < clearance.upper {
                let local = window.middle + found.time;
                let movers = scene.movers(obstacle, window.stage);
                let [body, carried] = [0, 1].map(|i: usize| movers[i].pose(local));
                let place = body.transform_point3(position);
                let placed = plane.placed(&carried);
                let distance = placed.height(place).max(0.0);
                let seen = Closest {
                    distance,
                    obstacle,
                    points: [place, place - distance * placed.normal()],
                };
                clearance.see(scene.stages[window.stage].clock(local), &seen);
            }
        }
    }
    least.lower = least.lower.max(0.0);
    Ok(least)
}
