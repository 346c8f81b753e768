//! The stages of a sweep in space, shown for debugging.

use super::sources::TriangleSource;
use crate::envelope::spatial::{Sheet, SweepCycle};
use crate::solid::spatial::{ArrangedFacet, Solid};
use std::fmt;

/// The result of a stage of a sweep in space; the stages come in this order. A sweep that is
/// repeated with finer sampling is shown from the beginning; one that fails is shown up to the
/// failure.
///
/// A motion of many spans is swept in parts that are united: their cycles come in order, their
/// arrangements in any order; the arrangements of the unions are not shown.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Inspection<'a> {
    /// The grazing segments that will be carried along and sampled, per span: those of the body
    /// without the dropped shallow folds, before long ones are divided and inner ones sunk.
    Grazing {
        /// Spans are numbered as they are swept: those of one motion are merged, and none is longer
        /// than one period.
        sheets: &'a [Sheet],
    },
    /// The sampled closed surface of a part, which crosses itself.
    Cycle {
        /// Number of the part, from 0.
        part: usize,
        /// Not yet checked to be closed.
        cycle: &'a SweepCycle,
    },
    /// The cycle of a part, cut along itself.
    Arrangement {
        /// Number of the part, from 0.
        part: usize,
        /// With the winding numbers on both sides.
        facets: &'a [ArrangedFacet],
    },
    /// The swept region, without the artefacts of the sampling.
    Region {
        /// As the sweep returns it, if no other attempt is better, but with all its triangles.
        solid: &'a Solid,
    },
    /// What swept the result, once at the end. Only where [`SweepSettings::with_sources`] asks for
    /// it.
    ///
    /// [`SweepSettings::with_sources`]: crate::SweepSettings::with_sources
    Sources {
        /// As the sweep returns it.
        solid: &'a Solid,
        /// Per triangle.
        sources: &'a [TriangleSource],
    },
}

/// The function that is shown the stages, if any.
#[derive(Clone, Copy, Default)]
pub(crate) struct Inspector<'a>(Option<&'a (dyn Fn(Inspection) + Sync)>);

impl<'a> Inspector<'a> {
    pub(crate) fn new(inspect: &'a (dyn Fn(Inspection) + Sync)) -> Inspector<'a> {
        Inspector(Some(inspect))
    }

    /// The function itself, for stages that take time to prepare.
    pub(crate) fn get(self) -> Option<&'a (dyn Fn(Inspection) + Sync)> {
        self.0
    }

    pub(crate) fn show(self, stage: Inspection) {
        if let Some(inspect) = self.0 {
            inspect(stage);
        }
    }
}

impl fmt::Debug for Inspector<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Inspector").field(&self.0.is_some()).finish()
    }
}
