//! Holes that only the sampling made.

use crate::Fault;
use crate::body::Polygon;
use crate::membership::planar::Membership;
use crate::motion::planar::Motion;
use crate::solid::planar::Arrangement;

/// Pockets that were filled.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Filled {
    pub(super) pockets: usize,
    /// Bound on the distance of their points from the region without them.
    pub(super) depth: f64,
}

/// Largest share of the tolerance by which a pocket may be deep to be filled: with the sampling,
/// the region reaches out by less than the tolerance.
const POCKET_SHARE: f64 = 0.5;

/// Fills the holes that only the sampling and the folds that were given up have made: shallow ones
/// of which the body covers, at one time or another, all places that are looked at.
///
/// Holes that are deeper than the error of the curves are real, and so are those of which any of
/// these places is never covered.
pub(super) fn fill(
    arrangement: &mut Arrangement,
    body: &Polygon,
    motion: &Motion,
    tolerance: f64,
) -> Result<Filled, Fault> {
    let deepest = POCKET_SHARE * tolerance;
    let mut pockets = arrangement.pockets()?;
    pockets.retain(|pocket| pocket.reach <= deepest);
    if pockets.is_empty() {
        return Ok(Filled::default());
    }
    let membership = Membership::new(body, motion);
    pockets.retain(|pocket| {
        let mut witnesses = pocket.witnesses.iter();
        witnesses.all(|&place| membership.is_ever_inside(place))
    });
    arrangement.fill(&pockets);
    Ok(Filled {
        pockets: pockets.len(),
        depth: pockets
            .iter()
            .map(|pocket| pocket.reach)
            .fold(0.0, f64::max),
    })
}
