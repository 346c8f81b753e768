//! Swept volumes of bodies that move by steady affine motions, their first contact with others, and
//! the times during which points are inside them.
//!
//! A body, a closed triangle mesh, is carried by a *steady affine motion* p(t) = exp(tG) p, or by a
//! chain of them: a screw, a spiral that scales, a translation, a shear, any affine map with a real
//! logarithm. [`sweep()`] gives the region that it passes through as a closed oriented boundary
//! with a bound on its error; [`collision::check`] proves that it meets no obstacle, or gives the
//! first contact; [`membership::Membership`] gives the time intervals during which a point is
//! inside; [`grazing::of`] gives the points and segments at which the velocity grazes the body, fixed
//! on it, and [`envelope::spatial::envelope`] the untrimmed envelope that they sweep. In the plane,
//! [`planar::sweep`] does the same for outlines with holes, and proves both of its error bounds.
//!
//! ```
//! use glam::DVec3;
//! use steadysweep::body::Mesh;
//! use steadysweep::motion::{Generator, Motion, Span};
//! use steadysweep::{SweepSettings, sweep};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A tetrahedron that turns by 90 degrees about the z axis.
//! let corners = [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]];
//! let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let body = Mesh::new(corners.map(DVec3::from_array).to_vec(), triangles)?;
//! let turn = Generator::screw(DVec3::Z, DVec3::ZERO, std::f64::consts::FRAC_PI_2, 0.0, 1.0);
//! let motion = Motion::from_spans(vec![Span::new(turn, 1.0)?])?;
//!
//! let swept = sweep(&body, &motion, &SweepSettings::default())?;
//! let measures = swept.solid.measures();
//! assert!(measures.watertight && measures.manifold);
//! assert_eq!((measures.components, measures.voids, measures.genus), (1, 0, 0));
//! // The face in the plane y = 0 (area 1/2, centroid 4/3 from the axis) alone sweeps pi/3, by
//! // Pappus.
//! let missing = swept.error_bound.inside.length * measures.area;
//! assert!(measures.volume + missing > std::f64::consts::PI / 3.0);
//! # Ok(())
//! # }
//! ```
//!
//! The example `grazing_points` shows the words of the subject, one after the other: velocity field,
//! grazing points, envelope, swept region and its triangles.
//!
//! # Conventions
//! - Right-handed coordinates, column vectors: p' = G p = M p + tau. Triangles run
//!   counter-clockwise seen from outside.
//! - Any unit of length; results are in the same unit. Angles are radians unless a name ends in
//!   `_deg`.
//! - Times are on the motion's own clock; inside a span, s runs from 0 to 1.
//! - Everything is computed in `f64`. Single precision occurs in the boxes of the broad phase,
//!   which are rounded outward; where the coordinates of a binary STL are rounded, which the error
//!   bound counts; and in readers, writers and pictures.
//! - The same input gives the same bits for any number of threads.
//!
//! # The map
//! Data flows down this list, and a module uses only modules above it:
//!
//! | module | what it holds |
//! |---|---|
//! | `fault`, `watch` | a broken invariant, [`Fault`]; the stages of a run, reported and stopped |
//! | `numeric` | thresholds and their derivation, exact signs, roots |
//! | [`motion`] | velocity field, flow, logarithm, chains; knows no bodies |
//! | `surface` | closed triangle surfaces: half-edges, shells, measures; knows no bodies |
//! | [`body`] | closed oriented meshes, validated once; knows no motion |
//! | [`bounds`] | boxes and trees over a surface at rest |
//! | [`grazing`] | where the velocity grazes the body, fixed on it |
//! | [`envelope`] | grazing sets carried along; the sweep cycle |
//! | [`membership`] | a point against the moving body: time intervals |
//! | [`collision`] | a moving body against surfaces, points, planes: first contact, clearance |
//! | [`solid`] | from the cycle to the boundary of the swept region |
//! | `sweep` | the stages of a sweep and its error bound: [`sweep()`] and [`planar::sweep`] |
//! | [`io`] | files in and out (feature `files`) |
//! | `cli` | the command line tool (feature `cli`) |
//!
//! The guide for users, a page per job, is [`docs`].

mod fault;

mod watch;

mod numeric;

pub mod motion;

mod surface;

pub mod body;

pub mod bounds;

pub mod grazing;

pub mod envelope;

pub mod membership;

pub mod collision;

pub mod solid;

#[cfg(test)]
mod samples;

mod sweep;

#[cfg(feature = "files")]
pub mod io;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;

// Text alone: only the documentation and its tests have it.
#[cfg(any(doc, doctest))]
pub mod docs;

pub use fault::Fault;
pub use solid::spatial::Precision;
pub use sweep::inspection::Inspection;
pub use sweep::sources::TriangleSource;
pub use sweep::spatial::{Simplify, Sweep, SweepError, SweepSettings, sweep};
pub use sweep::surface::{SurfaceSweepError, sweep_surface};
pub use sweep::{Bound, ErrorBound, Stage};
pub use watch::Interrupted;

/// All that is needed in the plane, in one place: bodies, motions, sweeps and membership.
///
/// ```
/// use glam::DVec2;
/// use steadysweep::planar::{FillRule, Generator, Membership, Motion, Polygon, Span};
/// use steadysweep::planar::{SweepSettings, subtract, sweep};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let square = |from: f64, to: f64| {
///     [[from, from], [to, from], [to, to], [from, to]].map(DVec2::from_array).to_vec()
/// };
/// let tool = Polygon::new(vec![square(0.0, 1.0)], FillRule::NonZero)?;
/// let slide = Generator::translation(DVec2::new(2.0, 0.0));
/// let motion = Motion::from_spans(vec![Span::new(slide, 1.0)?])?;
///
/// let swept = sweep(&tool, &motion, &SweepSettings::default())?;
/// assert!((swept.measures.area - 3.0).abs() < 1e-9);
///
/// // A blank of 4 x 4 loses what the tool passes through.
/// let blank = Polygon::new(vec![square(0.0, 4.0)], FillRule::NonZero)?;
/// let left = subtract(&blank, &swept.loops().collect::<Vec<_>>())?;
/// assert!((left.measures(&left.outlines()).area - 13.0).abs() < 1e-9);
///
/// // The point (2, 1/2) is inside from the time at which the right side comes by.
/// let times = Membership::new(&tool, &motion).intervals(DVec2::new(2.0, 0.5));
/// assert_eq!(times, [[0.5, 1.0]]);
/// # Ok(())
/// # }
/// ```
pub mod planar {
    pub use crate::body::{FillRule, Polygon, PolygonError, PolylineError, Polylines};
    pub use crate::membership::planar::Membership;
    pub use crate::motion::planar::{Flow, Generator, Keyframe, Motion, Span, Spiral};
    pub use crate::solid::planar::{
        Arrangement, ArrangementError, Measures, Outlines, RegionTriangles, subtract,
    };
    pub use crate::sweep::planar::{Sweep, SweepError, SweepSettings, sweep, sweep_lines};
}
