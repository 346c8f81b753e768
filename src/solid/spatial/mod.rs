//! The swept solid of a triangle mesh.
//!
//! The cycle is arranged (`arrangement`). Cavities that the sampling or the dropped folds made are
//! filled, handles that they made are cut or filled, and loose pieces are dropped (`artefacts`).
//! Vertices that a reader would take for one are joined or separated, and triangles that rounding
//! moved through each other come apart (`storing`). The parts of the cycle that are left outside
//! determine how far the region may fall short (`missed`). Within what the tolerance leaves, edges
//! collapse (`lean`).

mod arrangement;
mod artefacts;
mod lean;
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
use crate::watch::{Interrupted, Stop, Work};
use arrangement::{Cancelled, PositiveRegion, ShowFacets, positive_region};
use artefacts::pockets::{Dropped, Filled};
use artefacts::{handles, islands, pockets};
use glam::DVec3;
use missed::Missed;
use storing::joining::Joined;
use storing::untangling::Loosened;
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

    /// The solid with fewer triangles, and how far each of the two may reach out of the other, at
    /// most `allowed`.
    pub(crate) fn simplified(&self, allowed: f64, work: Work) -> Result<(Solid, f64), Interrupted> {
        let lean = lean::lean(&self.positions, &self.triangles, allowed, work)?;
        let (positions, triangles) = without_unused(&self.positions, &lean.triangles);
        let measures = Measures {
            touching_edges: self.measures.touching_edges,
            ..measure(&positions, &triangles, &Shells::new(&triangles))
        };
        let solid = Solid {
            positions,
            triangles,
            measures,
        };
        Ok((solid, lean.error))
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

/// Most times that a boundary whose triangles cross is arranged again.
const ROUNDS: usize = 4;

/// More pairs than this are left as they are: so many cross where a solid is no thicker than
/// rounding, and arranging it again multiplies them.
const MOST_CROSSINGS: usize = 20_000;

/// What the boundary of a region is made for.
#[derive(Clone, Copy)]
pub(crate) struct Making<'a> {
    pub(crate) errors: &'a CycleErrors,
    pub(crate) membership: &'a Membership,
    pub(crate) precision: Precision,
}

/// A boundary as it is stored, and what was done to it.
#[derive(Debug, Clone, Default)]
struct Stored {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    repairs: Repairs,
    /// Number of pairs of triangles that meet elsewhere than in common corners and edges.
    crossings: usize,
}

/// A record of the repairs of a boundary.
#[derive(Debug, Clone, Default)]
struct Repairs {
    filled: Filled,
    handles: usize,
    /// How far the boundary reaches out of that of the region, at most, by filled holes.
    out: f64,
    /// Parts of the cycle, or of a boundary before, that are left outside.
    lost: Vec<[DVec3; 3]>,
    /// Crumbs and flat pieces.
    crumbs: Dropped,
    /// Bound on the distance by which a point was moved.
    moved: f64,
    /// Number of edges along which the region touches itself, before anything was moved apart.
    touching_edges: Option<usize>,
}

/// The boundary of a region as it is stored: pockets and handles that the sampling or the dropped
/// folds of the cycle made are removed, vertices that readers would take for one are joined or
/// separated, and triangles that rounding moved through each other come apart. Where moves alone do
/// not part them, the boundary is arranged again as it is stored. `anchors`: a point of each shell
/// of the body at the start.
pub(crate) fn finished(
    region: RawBoundary,
    wrong: &[WrongSheet],
    anchors: &[DVec3],
    making: Making,
    work: Work,
) -> Result<SweptSolid, Stop> {
    let [storing, dropping, measuring] = work.parts([17, 1, 2]);
    let mut stored = stored(region, Repairs::default(), making, storing)?;
    let mut last = None;
    for _ in 0..ROUNDS {
        let before = last.as_ref().unwrap_or(&stored);
        if before.crossings == 0 || before.crossings > MOST_CROSSINGS {
            break;
        }
        let work = work.uncounted();
        let (again, moved) = untangling::arranged_again(
            &before.positions,
            &before.triangles,
            making.precision,
            work,
        )?;
        let mut repairs = before.repairs.clone();
        repairs.moved += moved;
        let next = self::stored(again, repairs, making, work)?;
        if next.crossings < stored.crossings {
            stored = next;
            last = None;
        } else {
            last = Some(next);
        }
    }
    let Stored {
        positions,
        mut triangles,
        repairs,
        crossings,
    } = stored;
    let Repairs {
        filled,
        handles: removed_handles,
        mut lost,
        crumbs: mut dropped,
        moved: largest_move,
        touching_edges,
        ..
    } = repairs;
    let errors = making.errors;
    dropped.extend(islands::drop_islands(
        &positions,
        &mut triangles,
        anchors,
        errors.artefact(),
        dropping,
    )?);
    let (positions, triangles) = without_unused(&positions, &triangles);
    lost.extend(dropped.triangles);
    // Some of those that crossed may have been dropped.
    let crossings = match crossings {
        0 => 0,
        _ => untangling::crossings(&positions, &triangles, work.uncounted())?,
    };
    let mut missed = missed::missed(&lost, wrong, errors, &positions, &triangles, measuring)?;
    missed.left += dropped.depth;
    let measures = Measures {
        touching_edges: touching_edges.unwrap_or(0),
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
        removed_handles,
        missed,
        largest_move,
        crossings,
    })
}

/// A boundary as it is stored, after these repairs.
fn stored(
    region: RawBoundary,
    mut repairs: Repairs,
    making: Making,
    work: Work,
) -> Result<Stored, Stop> {
    let [filling, removing, joining, dividing, loosening, cleaning] =
        work.parts([2, 6, 2, 3, 2, 2]);
    let Making {
        errors,
        membership,
        precision,
    } = making;
    let (sampling, artefact) = (errors.sampling, errors.artefact());
    repairs.lost.extend(region.outside);
    let (mut positions, mut triangles) =
        repairs.fill(&region.positions, region.triangles, making, filling)?;
    work.check()?;
    repairs
        .touching_edges
        .get_or_insert_with(|| touching_edges(&positions, &triangles));
    let removed = handles::remove(
        &mut positions,
        &mut triangles,
        sampling,
        artefact,
        membership,
        removing,
    )?;
    closed(&triangles, "surgery opened the boundary")?;
    repairs.handles += removed.handles;
    repairs.out += removed.depth;
    repairs.filled.depth = repairs.filled.depth.max(repairs.out);
    let Joined {
        positions,
        triangles,
        largest_move,
    } = joining::join_near(&positions, &triangles, precision, joining)?;
    closed(&triangles, "joining opened the boundary")?;
    let (mut positions, mut triangles) = without_unused(&positions, &triangles);
    let divided = touching::separate(&mut positions, &mut triangles, precision, dividing)?;
    repairs.lost.extend(divided.films);
    closed(&triangles, "dividing edges opened the boundary")?;
    let Loosened {
        positions,
        triangles,
        largest_move: loosened,
        meetings: crossings,
    } = untangling::loosened(positions, triangles, precision, loosening)?;
    // One after the other.
    repairs.moved += removed.moved + largest_move + divided.largest_move + loosened;
    // Joining and surgery part shells that hung together by edges without width, and turn inside
    // out what is of the size of rounding.
    let (positions, triangles) = repairs.fill(&positions, triangles, making, cleaning)?;
    Ok(Stored {
        positions,
        triangles,
        repairs,
        crossings,
    })
}

impl Repairs {
    /// The boundary without pockets and crumbs.
    fn fill(
        &mut self,
        positions: &[DVec3],
        triangles: Vec<[u32; 3]>,
        making: Making,
        work: Work,
    ) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), Stop> {
        let Making {
            errors, membership, ..
        } = making;
        let (sampling, artefact) = (errors.sampling, errors.artefact());
        let (triangles, filled, crumbs) =
            pockets::fill(positions, triangles, sampling, artefact, membership, work)?;
        self.crumbs.extend(crumbs);
        self.filled.pockets += filled.pockets;
        self.filled.depth = self.filled.depth.max(self.out + filled.depth);
        Ok(without_unused(positions, &triangles))
    }
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
