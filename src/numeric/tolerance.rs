//! The kernel's thresholds of rounding and resolution, and its limits: meaning, unit, derivation
//! and user of each. A constant of a single algorithm may stand beside it instead.
//!
//! Two kinds are kept apart. **Rounding** follows from the data as k u L, with L the largest
//! coordinate reached and u [`UNIT_ROUNDOFF`]. **Resolution** is what the user asked for
//! (`--tolerance`), shared out by [`Budget`], or what files and people distinguish. A tolerance
//! below rounding is refused, naming the smallest usable value.

/// Unit roundoff of `f64`, 2^-53.
pub(crate) const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Flux below this share of the largest speed on the body is zero (dimensionless).
///
/// A flux n . v is computed from a unit normal that carries some 10 u and a velocity with some
/// 10 u: 1e-12 is 400 times that. Without it, rounding cuts faces of zero flux at random.
pub(crate) const ZERO_FLUX: f64 = 1e-12;

/// Distance within which vertices of a body coincide when seen along a translation, and within
/// which they lie on one line, in units of u times the largest coordinate.
///
/// Rounding: the coordinates of a computed body are off by a few u, and the projection along the
/// translation adds a few more (24, see [`PROJECTION_ROUNDING`]). User:
/// `grazing::spatial::projection`.
pub(crate) const PROJECTION: f64 = 128.0;

/// Rounding of a flux n . v, in units of u times the largest speed on the body: some 10 u each of
/// the unit normal and of the velocity, 3 u of the product, and as much again where it is
/// interpolated.
///
/// User: `grazing::spatial::wrong`.
pub(crate) const FLUX_ROUNDING: f64 = 32.0;

/// Rounding of a point that is projected along a direction, in units of u times the largest
/// coordinate: for each of two coordinates three products and two sums, and four u in the
/// directions, times sqrt(3) for the length of the point and sqrt(2) for the two coordinates.
///
/// User: `grazing::spatial::projection`.
pub(crate) const PROJECTION_ROUNDING: f64 = 24.0;

/// A point slower than this share of the largest speed rests (dimensionless); its path is given one
/// position.
///
/// Same derivation as [`ZERO_FLUX`]; the path that is neglected is shorter than this share of the
/// longest one.
pub(crate) const REST: f64 = 1e-12;

/// Two poses are the same if no point of the body differs by more than this share of its largest
/// coordinate; the same holds for two points of the sampled surface (dimensionless).
///
/// A full turn comes back within some 10 u of the largest coordinate; this is 1000 times that.
pub(crate) const SAME_POSE: f64 = 1e-12;

/// A piece of the result that contains no larger ball than this share of the largest coordinate is
/// a crumb: it lies between sheets that differ only by rounding (dimensionless). Four times
/// [`SAME_POSE`], the distance within which sheets are made the same; a body that is not flat
/// contains a ball of 5e-10 of its own size.
pub(crate) const CRUMB: f64 = 4.0 * SAME_POSE;

/// Tolerance of a sweep unless the user gives one, as a share of the diagonal of the body's
/// bounding box.
pub(crate) const DEFAULT_TOLERANCE: f64 = 1e-3;

/// Rounding of a point that is carried to a pose and written to a file, in units of u times the
/// largest coordinate: nine products and sums for the pose's matrix on top of some 10 u in its
/// entries, times sqrt(3) for three coordinates.
pub(crate) const POSE_ROUNDING: f64 = 32.0;

/// Rounding of a point by the arrangement of a swept surface, in units of u times the largest
/// coordinate.
///
/// A unit of the grid is at most 2^-51 of the largest coordinate, 4 u. A point is moved to the
/// grid, joins others within 8 units in each of three coordinates
/// (`solid::spatial::arrangement::heal`), and a crossing is rounded by less than 2 units: 8
/// sqrt(3) + 2 units, 64 u.
pub(crate) const ARRANGEMENT_ROUNDING: f64 = 64.0;

/// Largest number of triangles of a sweep cycle: each takes about 100 bytes before the arrangement,
/// and 1 kB in it.
pub(crate) const MOST_TRIANGLES: usize = 20_000_000;

/// Most turns of one span. The path of a point through more would be cut into more than a million
/// pieces (`membership::path`), or be expanded too far in each for its times to be certain.
pub(crate) const MOST_TURNS: f64 = 25_000.0;

/// How the tolerance of a sweep, a length, is shared out among the sources of error.
///
/// The parts that can make the result too small, all but the last, add up to the tolerance. Those
/// that can make it too large, the sampling and the last, stay below it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Error of the chords of the paths over one time step.
    pub chord: f64,
    /// Error by the twist of the strips that straight pieces sweep over one time step.
    pub twist: f64,
    /// Depth of folds of the exact grazing set that are dropped: faces of mixed flux sign that take
    /// one sign.
    pub fold: f64,
    /// Distance below which two break points on an edge are one, and a break point is the corner
    /// next to it.
    pub merge: f64,
    /// Depth of dents of the boundary of the egress region that are filled; only they and the
    /// sampling can make the result too large.
    pub dent: f64,
}

impl Budget {
    /// The shares of the whole `tolerance`: chord 0.3, twist 0.2, fold 0.49, merge 0.01, dent 0.49.
    ///
    /// The number of time steps grows as 1/sqrt(chord), that of the pieces of long edges as
    /// 1/twist.
    pub fn of(tolerance: f64) -> Budget {
        Budget {
            chord: 0.3 * tolerance,
            twist: 0.2 * tolerance,
            fold: 0.49 * tolerance,
            merge: 0.01 * tolerance,
            dent: 0.49 * tolerance,
        }
    }
}

/// Share of the tolerance of a sweep by which spans of a smooth path may differ to be merged into
/// one steady motion. [`Budget`] divides the rest.
///
/// A larger share gives fewer spans, by its square root, and more time steps in each. Measured on
/// smooth paths of 200 and 1,000 keyframes: at 0.1 they take 9.7 and 4.3 s, at 0.3 7.9 and 3.3 s, at
/// 0.5 6.9 and 3.7 s.
pub(crate) const PATH_SHARE: f64 = 0.3;

/// Depth to which inner sheets are sunk, in units of the sampling error.
///
/// Two sheets that are each off by one sampling error can cross while they are closer than two;
/// four leave room for the twist of neighbours.
pub(crate) const SINK_DEPTH: f64 = 4.0;

/// Largest turn or growth of one time step, as the norm of M times the step (radians, or logarithm
/// of a factor).
///
/// Keeps the third-order terms of a step below a tenth of the second-order terms on which the
/// bounds are built.
pub(crate) const STEP_LIMIT: f64 = 0.3;

/// Distance within which vertices of a file are one point, as a fraction of the bounding-box
/// diagonal.
///
/// Resolution. Exporters that compute a shared corner once per triangle miss it by a few roundings,
/// 1e-12 to 1e-10 of the size; features of a part are far larger. User: `surface::weld`.
pub(crate) const WELD_DISTANCE: f64 = 1e-9;

/// Mean thickness 2 V / A below which a shell counts as flat, as a fraction of the diagonal of the
/// shell.
///
/// Resolution. The same length as [`WELD_DISTANCE`]: the two sides of such a sheet count as one
/// point of the file. User: `body::shell`.
pub(crate) const FLAT_THICKNESS: f64 = WELD_DISTANCE;

/// Thickness below which a shell cannot be told from a flat one because its coordinates are
/// rounded, as a factor of the largest coordinate of the shell.
///
/// Rounding, k u L with k = 4: each of the two sides is off by at most u L in each of its three
/// coordinates, 2 sqrt(3) u L together. User: `body::shell`.
pub(crate) const FLAT_ROUNDING: f64 = 4.0 * UNIT_ROUNDOFF;

/// Largest magnitude of a coordinate of a body, in its own unit.
///
/// Limit of the `f32` boxes of the broad phase: the surface area of a box of twice this size,
/// 2.4e37, still fits. Users: all that accept bodies.
pub(crate) const LARGEST_COORDINATE: f64 = 1e18;

/// Largest allowed ||exp(log A) - A|| / ||A||, for the linear part and for the translation. No
/// unit. The usual value is 1e-15; above this limit the logarithm exists, but `f64` cannot
/// represent the motion. Used by `motion::logarithm` and `motion::chain`.
pub(crate) const LOGARITHM_RESIDUAL: f64 = 1e-10;

/// Relative size below which the deviation of a plane block from a turn with a uniform scale counts
/// as rounding, where the turn is a half turn. No unit. A rotation by pi that is a product computed
/// in `f64` is off by some 1e-16 to 1e-14; reading it as exact moves the end pose by as much. Used
/// by `motion::half_turn`.
pub(crate) const HALF_TURN: f64 = 1e-13;

/// Tangent of the angle to a half turn below which a linear part that is nearly a rotation is taken
/// for one (dimensionless).
///
/// The logarithm magnifies roundings by pi over this angle: to at most some 1e-14 for other
/// rotations. Used by `motion::half_turn`.
pub(crate) const NEAR_HALF_TURN: f64 = 0.05;

/// Angle by which two poses may miss a half turn and still leave the sense open (radians).
///
/// Resolution. Poses in files have ten digits or more, or were computed with a few thousand
/// roundings: both miss by less. A point moves by this share of its distance from the axis. Used by
/// `motion::half_turn`.
pub(crate) const HALF_TURN_ANGLE: f64 = 1e-9;

/// Components of the unit axis of a half turn below this count as zero when its sense is given a
/// sign (dimensionless).
///
/// Resolution, the same as [`HALF_TURN_ANGLE`]: poses of that precision determine the axis only to
/// it. Used by `motion::half_turn`.
pub(crate) const HALF_TURN_AXIS: f64 = HALF_TURN_ANGLE;

/// Largest deviation of a run of equal velocity, in units of u (1 + |M|) times the largest
/// coordinate.
///
/// Rounding, k u L with k = 64: computed poses have some 4 u in each entry, the motion between two
/// of them three times that, its velocity at a corner sqrt(3) times that again, and both ends of a
/// span count. It is added to the rounding of positions, [`PATH_ROUNDING`]. Used by
/// `motion::merging`.
pub(crate) const MERGED_ROUNDING: f64 = 64.0;

/// Largest sum of |M| over the spans of a run whose positions stay near their rounding (radians,
/// times sqrt 2).
///
/// Rounding grows with |M|: eightfold for a little more than a full turn. Runs of twice the length
/// have half the joints. Used by `motion::merging`.
pub(crate) const MERGED_TURN: f64 = 10.0;

/// Rounding of the linear part C B^-1 between two poses, in units of u times |C| |B^-1| |B| |B^-1|,
/// entry by entry.
///
/// Rounding. An inverse from cofactors is off by some 10 u |B^-1| |B| |B^-1|, the product by 3 u
/// |C| |B^-1|; together at most 16. Used by `motion::chain`.
pub(crate) const RELATIVE_POSE: f64 = 16.0;

/// A negative double eigenvalue is a Jordan block when its discriminant is below this times |L|
/// |B0|. No unit. The deflation has a backward error of some 10 units in the last place of |L|,
/// each moves the discriminant by up to 4 |B0| u |L|; below their sum its sign is noise. Used by
/// `motion::logarithm`.
pub(crate) const NEGATIVE_PAIR: f64 = 64.0 * f64::EPSILON;

/// Rates of a motion (radians, logarithm of the scale) and relative advances that count as zero
/// when the motion is given a name. No unit. The logarithm of a rigid motion has a scale of some
/// 1e-16; the generator itself is not touched. Used by `motion::describe`.
pub(crate) const NEGLIGIBLE_RATE: f64 = 1e-12;

/// Relative deviation from a similarity up to which a motion is called one. No unit. The rounding
/// of a rotation by pi - e appears in its logarithm divided by e: 1e-9 allows e down to 1e-6. Used
/// by `motion::describe`.
pub(crate) const SIMILARITY: f64 = 1e-9;

/// Thickness of a set of points below which they count as flat, in units of their length.
///
/// Resolution. Points of files have ten digits or more: below this, an affine map through them is
/// that of their rounding. User: `motion::affinity`.
pub(crate) const FLAT_POINTS: f64 = 1e-9;

/// Thickness of a set of points below which it cannot be told from a flat one because the
/// coordinates are rounded, as a factor of the largest one and of the root of their number.
///
/// Rounding, k u L with k = 4: each point and the centre are off by at most u L in each coordinate.
/// User: `motion::affinity`.
pub(crate) const FLAT_POINTS_ROUNDING: f64 = 4.0 * UNIT_ROUNDOFF;

/// Part of the least change that leaves two poses without a steady motion up to which it is found.
/// No unit.
///
/// Resolution: it is read by people. User: `motion::existence`.
pub(crate) const LEAST_CHANGE: f64 = 0.01;

/// How far the length of a quaternion in a motion file may be from 1.
///
/// Resolution: six decimals, as programs print them; more is a mistake in the file. User:
/// `io::motion`.
#[cfg(feature = "files")]
pub(crate) const UNIT_QUATERNION: f64 = 1e-6;

/// Width of time below which roots are not refined and windows are not cut, as a fraction of a
/// span.
///
/// Rounding, 8 u = 2^-50: a few units in the last place of a time near 1. Users: `numeric::roots`,
/// `membership`, `collision`.
pub(crate) const ROOT_RESOLUTION: f64 = 8.0 * UNIT_ROUNDOFF;

/// Error of the position of a point relative to the moving body, in unit roundoffs of the largest
/// number in its computation.
///
/// Rounding, k u L with k = 16: two products of affinities of 3 + 1 terms (8), the exponential
/// (about 4; growing with the size of the generator, which is a factor of its own), the subtraction
/// of a vertex and a dot product (4). Users: `membership`, `collision`.
pub(crate) const PATH_ROUNDING: f64 = 16.0;

/// Longest absence around a joint between two spans that is ignored, as a fraction of each of the
/// two spans.
///
/// Resolution. This is the accuracy of the times of membership. The pose at the end of a span and
/// that at the start of the next agree only to [`LOGARITHM_RESIDUAL`], so a point that stays inside
/// may seem to leave between them. Users: `membership`, `collision`.
pub(crate) const JOINT_GAP: f64 = 1e-9;

/// Distance up to which two features count as in contact, in units of the error bound of a
/// position.
///
/// Rounding. A distance is certified above one such bound; the search for the time at which it
/// falls to that bound ends within two more. User: `collision`.
pub(crate) const CONTACT_ROUNDING: f64 = 3.0;

/// Distance up to which features count as in contact when the allowed steps did not show them to be
/// apart, in units of the error bound of a position. Beyond it they are undecided.
///
/// Rounding. A dozen roundings of the direction between points that are so near, on top of those of
/// the positions. User: `collision`.
pub(crate) const DOUBTFUL_CONTACT: f64 = 64.0;

/// Relative precision to which a least distance is determined, where work and rounding allow
/// (dimensionless).
///
/// Resolution. The search skips whatever cannot be nearer by more than this. User: `collision`.
pub(crate) const CLEARANCE_PRECISION: f64 = 1e-3;

/// Least depth at which a body can be said to enter an obstacle, in units of the error bound of a
/// position. It is also the default depth.
///
/// Rounding. A body that only touches is shown to be no deeper by moving it out by this much. In a
/// corner whose faces make the angle a with the direction of that move, sin a of it is left as a
/// gap, which must exceed [`CONTACT_ROUNDING`]. 64 suffice for grooves of 6 degrees. User:
/// `collision`.
pub(crate) const LEAST_DEPTH: f64 = 64.0;

/// Excess over the allowed depth that still counts as not deeper where the depth stays there, in
/// units of the error bound of a position.
///
/// Rounding. A depth is certified not to exceed another from [`CONTACT_ROUNDING`] below it, and to
/// exceed it from two above; a few more are for faces that are not square to the direction in which
/// the body is moved out. User: `collision`.
pub(crate) const DEPTH_ROOM: f64 = 16.0;

/// Distance within which ends of the curves of a drawing are joined, as a fraction of the diagonal
/// of the drawing.
///
/// Resolution. Files hold coordinates with three or four decimals, and in relative ones the
/// rounding adds up: published drawings have gaps of 1e-7 to 3e-6 of their size, and no features as
/// small. User: `io::drawing`.
#[cfg(feature = "files")]
pub(crate) const JOIN_DISTANCE: f64 = 1e-5;

/// Distance allowed between the curves of a drawing and the edges that replace them, as a fraction
/// of the diagonal of the drawing, when the user gives none.
///
/// Resolution. A tenth of the usual tolerance of a sweep, [`DEFAULT_TOLERANCE`]. User:
/// `io::drawing`.
#[cfg(feature = "files")]
pub(crate) const FLATTENING: f64 = 0.1 * DEFAULT_TOLERANCE;

/// Largest number of segments of a planar sweep cycle: each takes about 50 bytes before the
/// arrangement, and 500 in it.
pub(crate) const MOST_SEGMENTS: usize = 20_000_000;

/// How the tolerance of a planar sweep, a length, is shared out. Both parts can make the result too
/// small, the first also too large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarBudget {
    /// Error of the chords of the paths over one time step.
    pub chord: f64,
    /// Depth of folds of the exact grazing set that are neglected.
    pub fold: f64,
}

impl PlanarBudget {
    /// The shares of the whole `tolerance`: chord 0.45, fold 0.54, and 0.01 for the rounding to the
    /// grid of the arrangement.
    ///
    /// Sheets of one fold that are farther apart than their sampling error do not cross: so the
    /// fold gets the larger part.
    pub fn of(tolerance: f64) -> PlanarBudget {
        PlanarBudget {
            chord: 0.45 * tolerance,
            fold: 0.54 * tolerance,
        }
    }
}

/// Largest |M| times the length of an edge that may take the sign opposite to its flux, as a share
/// of the least speed on it: within it, the field does not turn round (dimensionless).
///
/// The edges of a regular polygon with nine edges or more that turns about its centre stay below.
/// User: `grazing::planar::heights`.
pub(crate) const FOLD_TURN: f64 = 1.0;

/// Largest |M| times the depth of a fold that is dropped, as a share of the least speed
/// (dimensionless).
///
/// The paths bend, and diverge, over the length |v| / |M|. Within an eighth of it, the curve square
/// to the paths is longer than its chord by less than 1/64, and Newton's method for the foot on a
/// path converges. User: `grazing::planar::heights`.
pub(crate) const FOLD_CURVATURE: f64 = 0.125;

/// Bits of a coordinate on the grid on which plane curves are arranged, not counting the sign.
///
/// Rounding. With 40 of them, twice a product of three differences of coordinates, the largest
/// number in the exact rounding of a crossing, stays below 2^126. User: `solid::planar`.
pub(crate) const GRID_BITS: f64 = 40.0;

/// Most bits of the largest coordinate that the grid of an arrangement resolves: its points must be
/// exact in `f64`.
///
/// Rounding. User: `solid::planar`.
pub(crate) const GRID_LEAST_BITS: f64 = 52.0;

/// Smallest tolerance of a planar sweep, as a share of the largest coordinate during the motion
/// (dimensionless).
///
/// Rounding. The grid of the arrangement has cells of at most 2^-39 of it and moves points by up to
/// two: twice that is 7e-12. User: `sweep::planar`.
pub(crate) const PLANAR_RESOLUTION: f64 = 1e-11;

/// Smallest deviation within which a motion is followed, relative to the largest distance of the
/// body from the origin: a few hundred roundings, some of which are those of the poses. Below it,
/// steady motions are not told from others. Used by `motion::following`.
pub(crate) const FOLLOWED_ROUNDING: f64 = 2048.0 * UNIT_ROUNDOFF;
