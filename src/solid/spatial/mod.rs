//! The swept solid of a triangle mesh.
//!
//! The cycle is arranged (`arrangement`). Cavities that the sampling or the dropped folds made are
//! filled, handles that they made are cut or filled, and loose pieces are dropped (`artefacts`).
//! Vertices that a reader would take for one are joined or separated, and triangles that rounding
//! moved through each other come apart (`storing`). The parts of the cycle that are left outside
//! determine how far the region may fall short (`missed`).

mod arrangement;
mod artefacts;
mod missed;
mod storing;

pub use crate::surface::Measures;
pub use arrangement::ArrangedFacet;
pub(crate) use artefacts::islands::anchors;
pub use storing::joining::Precision;

use crate::Fault;
use crate::envelope::spatial::{CycleErrors, SweepCycle, WrongSheet};
use crate::membership::Membership;
use crate::numeric::index;
use crate::surface::{Shells, is_closed, measure, touching_edges};
use crate::watch::{Stop, Work};
use arrangement::{Cancelled, PositiveRegion, ShowFacets, positive_region};
use artefacts::pockets::Filled;
use artefacts::{handles, islands, pockets};
use glam::DVec3;
use missed::Missed;
use storing::joining::Joined;
use storing::untangling::Untangled;
use storing::{joining, touching, untangling};

/// A closed oriented boundary in the world, outward, with its measures.
#[derive(Debug, Clone)]
pub struct Solid {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    measures: Measures,
}

impl Solid {
    /// #V positions, all distinct.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// #F index triples, counter-clockwise from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Volume, area, topology.
    pub fn measures(&self) -> &Measures {
        &self.measures
    }
}

/// The swept solid, with a record of the repairs.
pub(crate) struct SweptSolid {
    pub(crate) solid: Solid,
    /// The filled cavities that the sampling made, and how far they and filled holes reach from the
    /// boundary.
    pub(crate) filled: Filled,
    /// Number of handles that the sampling made and that were removed.
    pub(crate) removed_handles: usize,
    /// What is left outside, the dropped pieces among it, and what wrong signs cut out.
    pub(crate) missed: Missed,
    /// Largest distance by which a vertex was moved.
    pub(crate) largest_move: f64,
    /// Number of pairs of triangles that rounding moved through each other and that still meet.
    pub(crate) crossings: usize,
}

/// A closed boundary before its pockets are examined.
pub(crate) struct RawBoundary {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Pieces of the cycle that are outside.
    outside: Vec<[DVec3; 3]>,
}

/// The function that is shown the arrangement and the number of each cycle, if any; called from any
/// thread.
pub(crate) type ShowArrangements<'a> = Option<&'a (dyn Fn(usize, &[ArrangedFacet]) + Sync)>;

/// What some of the cycles wind round at least once, at least one: the boundary of the union of
/// their regions, joined two by two. `show` is shown the arrangements of the cycles.
pub(crate) fn region(
    cycles: &[SweepCycle],
    show: ShowArrangements,
    work: Work,
) -> Result<RawBoundary, Stop> {
    // Those of the cycles, and one less of pairs.
    let part = work.part(1, (2 * cycles.len() as u64).saturating_sub(1));
    region_from(0, cycles, show, part)
}

/// The region of the cycles from number `first` on. `part` is the work of one arrangement.
fn region_from(
    first: usize,
    cycles: &[SweepCycle],
    show: ShowArrangements,
    part: Work,
) -> Result<RawBoundary, Stop> {
    match cycles {
        [] => Err(Fault::new("a motion has no cycle").into()),
        [cycle] => match show {
            Some(show) => region_of(cycle, Some(&|facets| show(first, facets)), part),
            None => region_of(cycle, None, part),
        },
        _ => {
            let (before, after) = cycles.split_at(cycles.len() / 2);
            let middle = first + before.len();
            let (before, after) = rayon::join(
                || region_from(first, before, show, part),
                || region_from(middle, after, show, part),
            );
            union(before?, after?, part)
        }
    }
}

/// The boundary of {w >= 1} of one cycle.
fn region_of(cycle: &SweepCycle, show: ShowFacets, work: Work) -> Result<RawBoundary, Stop> {
    // Where cancelling parts are outside, the region may fall short.
    arranged(
        &cycle.positions,
        &cycle.triangles,
        Cancelled::Kept,
        show,
        work,
    )
}

/// The boundary of what is in either region.
///
/// Where rounding turned a sliver of one inside out, it cancels the other there: a cavity or a
/// crumb of the size of rounding, which is found with those of the sampling.
fn union(mut first: RawBoundary, second: RawBoundary, work: Work) -> Result<RawBoundary, Stop> {
    let shift = index(first.positions.len());
    first.positions.extend(second.positions);
    let moved = second.triangles.iter().map(|t| t.map(|v| v + shift));
    first.triangles.extend(moved);
    let mut union = arranged(
        &first.positions,
        &first.triangles,
        Cancelled::Dropped,
        None,
        work,
    )?;
    union.outside.extend(first.outside);
    union.outside.extend(second.outside);
    Ok(union)
}

fn arranged(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    cancelled: Cancelled,
    show: ShowFacets,
    work: Work,
) -> Result<RawBoundary, Stop> {
    let PositiveRegion {
        boundary: (positions, triangles),
        outside,
    } = positive_region(positions, triangles, cancelled, show, work)?;
    closed(&triangles, "the boundary of the region is not closed")?;
    Ok(RawBoundary {
        positions,
        triangles,
        outside,
    })
}

/// The boundary of a region as it is stored: pockets that the sampling or the dropped folds of the
/// cycle made are filled, and vertices that readers would take for one are joined or separated.
/// `anchors`: a point of each shell of the body at the start.
pub(crate) fn finished(
    region: RawBoundary,
    errors: &CycleErrors,
    wrong: &[WrongSheet],
    membership: &Membership,
    anchors: &[DVec3],
    precision: Precision,
    work: Work,
) -> Result<SweptSolid, Stop> {
    let parts = work.parts([2, 6, 2, 3, 2, 2, 1, 2]);
    let [
        filling,
        removing,
        joining,
        dividing,
        untangling,
        cleaning,
        dropping,
        measuring,
    ] = parts;
    let (sampling, artefact) = (errors.sampling, errors.artefact());
    let clean = |positions: &[DVec3], triangles: Vec<[u32; 3]>, work: Work| {
        let (triangles, filled, crumbs) =
            pockets::fill(positions, triangles, sampling, artefact, membership, work)?;
        let (positions, triangles) = without_unused(positions, &triangles);
        Ok::<_, Stop>((positions, triangles, filled, crumbs))
    };
    let (mut positions, mut triangles, mut filled, mut lost) =
        clean(&region.positions, region.triangles, filling)?;
    lost.extend(region.outside);
    work.check()?;
    let touching_edges = touching_edges(&positions, &triangles);
    let removed = handles::remove(
        &mut positions,
        &mut triangles,
        sampling,
        artefact,
        membership,
        removing,
    )?;
    closed(&triangles, "surgery opened the boundary")?;
    let Joined {
        positions,
        triangles,
        largest_move,
    } = joining::join_near(&positions, &triangles, precision, joining)?;
    closed(&triangles, "joining opened the boundary")?;
    let (mut positions, mut triangles) = without_unused(&positions, &triangles);
    let divided = touching::separate(&mut positions, &mut triangles, precision, dividing)?;
    lost.extend(divided.films);
    closed(&triangles, "dividing edges opened the boundary")?;
    let Untangled {
        positions,
        triangles,
        largest_move: untangled,
        meetings: crossings,
        lost: outside,
    } = untangling::untangle(positions, triangles, precision, untangling)?;
    lost.extend(outside);
    // Joining and surgery part shells that hung together by edges without width, and turn inside
    // out what is of the size of rounding.
    let (positions, mut triangles, more, crumbs) = clean(&positions, triangles, cleaning)?;
    lost.extend(crumbs);
    filled.pockets += more.pockets;
    filled.depth = filled.depth.max(removed.depth + more.depth);
    let islands = islands::drop_islands(&positions, &mut triangles, anchors, artefact, dropping)?;
    let (positions, triangles) = without_unused(&positions, &triangles);
    lost.extend(islands.triangles);
    let mut missed = missed::missed(&lost, wrong, errors, &positions, &triangles, measuring)?;
    missed.left += islands.depth;
    let measures = Measures {
        touching_edges,
        ..measure(&positions, &triangles, &Shells::new(&triangles))
    };
    if !measures.watertight {
        return Err(Fault::new("the boundary of the result is not closed").into());
    }
    Ok(SweptSolid {
        solid: Solid {
            positions,
            triangles,
            measures,
        },
        filled,
        removed_handles: removed.handles,
        missed,
        largest_move: largest_move.max(divided.largest_move) + untangled + removed.moved,
        crossings,
    })
}

fn closed(triangles: &[[u32; 3]], broken: &'static str) -> Result<(), Fault> {
    if is_closed(triangles) {
        Ok(())
    } else {
        Err(Fault::new(broken))
    }
}

fn without_unused(positions: &[DVec3], triangles: &[[u32; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut new_index = vec![None; positions.len()];
    let mut kept = Vec::new();
    let triangles = triangles
        .iter()
        .map(|t| {
            t.map(|v| {
                *new_index[v as usize].get_or_insert_with(|| {
                    kept.push(positions[v as usize]);
                    index(kept.len() - 1)
                })
            })
        })
        .collect();
    (kept, triangles)
}
