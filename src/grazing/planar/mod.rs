//! Grazing sets of polygons.

mod exact;
mod flattening;
mod heights;

pub(crate) use super::flux::EdgeFlux;

pub use exact::{GrazingPoint, Source, SpanGrazing, of, on_line};

use super::flux::snap;
use crate::body::Polygon;
use crate::motion::planar::Generator;
use crate::numeric::tolerance::ZERO_FLUX;
use flattening::{Flattened, flattened};
use glam::DVec2;

/// The grazing set of a polygon for one steady span.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GrazingSet {
    /// The sign of the flux per edge; edge i begins at corner i.
    pub edges: Vec<EdgeFlux>,
    /// Depth of the deepest dropped fold, at the start of the span; 0 when there is none. Proven,
    /// see [`crate::grazing`].
    pub dropped_fold: f64,
}

/// A place on a polygon at which the flux changes sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Change {
    /// The edge that begins at or contains the place.
    pub edge: u32,
    /// Position on that edge: 0 for its first corner, otherwise that of its grazing point.
    pub at: f64,
    /// Whether the loop is egress after the place, and so ingress before it.
    pub to_egress: bool,
}

impl GrazingSet {
    /// The grazing set of a polygon whose corners are at `positions` (#V, world at the start of the
    /// span).
    ///
    /// - `generator`: acts in the same frame as `positions`.
    /// - `fold`: folds up to this depth, a length, may be dropped; 0 keeps all.
    ///
    /// O(n log n).
    pub(crate) fn new(
        polygon: &Polygon,
        positions: &[DVec2],
        generator: &Generator,
        fold: f64,
    ) -> GrazingSet {
        let velocities: Vec<DVec2> = positions.iter().map(|&p| generator.velocity(p)).collect();
        let top_speed = velocities.iter().map(|v| v.length()).fold(0.0, f64::max);
        let zero = ZERO_FLUX * top_speed;
        let edges: Vec<EdgeFlux> = polygon
            .edges()
            .map(|ends| {
                let [p, q] = ends.map(|i| positions[i as usize]);
                let outward = -(q - p).perp().normalize_or_zero();
                edge_flux(ends.map(|i| snap(outward.dot(velocities[i as usize]), zero)))
            })
            .collect();
        let mut set = GrazingSet {
            edges,
            dropped_fold: 0.0,
        };
        if fold > 0.0 && !generator.moves_straight() {
            set.flatten(polygon, positions, generator, fold);
        }
        set
    }

    fn flatten(
        &mut self,
        polygon: &Polygon,
        positions: &[DVec2],
        generator: &Generator,
        fold: f64,
    ) {
        for outline in polygon.loops() {
            let corners: Vec<DVec2> = outline.iter().map(|&i| positions[i as usize]).collect();
            let fluxes: Vec<EdgeFlux> = outline.iter().map(|&i| self.edges[i as usize]).collect();
            let Flattened { edges, depth } = flattened(&corners, &fluxes, generator, fold);
            for (&i, flux) in outline.iter().zip(edges) {
                self.edges[i as usize] = flux;
            }
            self.dropped_fold = self.dropped_fold.max(depth);
        }
    }

    /// All changes of sign, in the order of the edges.
    pub(crate) fn changes(&self, polygon: &Polygon) -> Vec<Change> {
        let mut changes = Vec::new();
        for outline in polygon.loops() {
            let mut before = *outline.last().expect("a loop has corners");
            for &edge in outline {
                let [first, _] = self.edges[edge as usize].is_egress_at_ends();
                let [_, last] = self.edges[before as usize].is_egress_at_ends();
                if first != last {
                    changes.push(Change {
                        edge,
                        at: 0.0,
                        to_egress: first,
                    });
                }
                if let EdgeFlux::Cut { at, egress_first } = self.edges[edge as usize] {
                    changes.push(Change {
                        edge,
                        at,
                        to_egress: !egress_first,
                    });
                }
                before = edge;
            }
        }
        changes
    }
}

/// The sign rule, see [`crate::grazing`].
fn edge_flux([first, second]: [f64; 2]) -> EdgeFlux {
    if first >= 0.0 && second >= 0.0 {
        return EdgeFlux::Egress;
    }
    if first <= 0.0 && second <= 0.0 {
        return EdgeFlux::Ingress;
    }
    // SAM (8) with its sign corrected: the root of the linear interpolation.
    let at = first / (first - second);
    let egress_first = first > 0.0;
    if at > 0.0 && at < 1.0 {
        EdgeFlux::Cut { at, egress_first }
    } else if (at > 0.0) == egress_first {
        EdgeFlux::Egress
    } else {
        EdgeFlux::Ingress
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::FillRule;

    fn square() -> Polygon {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let outline = corners.map(DVec2::from_array).to_vec();
        Polygon::new(vec![outline], FillRule::EvenOdd).expect("a square")
    }

    fn exact(generator: &Generator) -> GrazingSet {
        let square = square();
        GrazingSet::new(&square, square.positions(), generator, 0.0)
    }

    #[test]
    fn an_edge_grazes_at_the_foot_of_the_centre_of_rotation() {
        // SAM (8): on the edge q + s t, the flux of a turn about c vanishes where the direction
        // from c is square to the edge.
        let set = exact(&Generator::spiral(DVec2::new(0.5, 0.0), 1.0, 1.0));
        let EdgeFlux::Cut { at, egress_first } = set.edges[0] else {
            panic!("{:?}", set.edges[0]);
        };
        assert!((at - 0.75).abs() < 1e-15, "below the centre: {at}");
        // Turning counter-clockwise, the lower edge moves down on the left of the centre.
        assert!(egress_first, "from -1 to 0.5 it leaves");
        assert_eq!(
            set.changes(&square()).len(),
            8,
            "all four edges and corners"
        );
    }

    #[test]
    fn an_edge_that_moves_along_itself_is_not_cut_by_rounding() {
        let tilt = DVec2::from_angle(0.3);
        let square = square().transformed(&glam::DAffine2::from_angle(0.3));
        let along = Generator::translation(tilt * 3.0);
        let set = GrazingSet::new(&square, square.positions(), &along, 0.0);
        let cut = set
            .edges
            .iter()
            .any(|edge| matches!(edge, EdgeFlux::Cut { .. }));
        assert!(!cut, "{:?}", set.edges);
        assert_eq!(set.changes(&square).len(), 2, "{:?}", set.edges);
    }
}
