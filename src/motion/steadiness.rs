//! How far a motion is from steady, by SAM's average relative acceleration.
//!
//! With the poses A(t) of a body and W = A^-1 A', its velocity field in its own frame, a motion is
//! steady where W' = 0. The average relative acceleration (SAM, section 2.4) is the mean over the
//! body and over time of |W' x|, a length per square of time. SAM gives no formula; this one is 0
//! for steady motions and stays the same in any rigid frame of the world.
//!
//! Where W jumps, at the joints of a chain or at the keyframes of a scheme, the integral of |W' x|
//! over time is the jump |(W+ - W-) x|. A chain that follows a smooth motion by m spans therefore
//! has nearly the same average, and exactly (m - 1) / m of it where even spans follow a uniform turn
//! with a uniform straight path: the start and the end have no jump.
//!
//! # Accuracy
//! Derivatives are exact up to rounding; the integral over time is found to six digits or more
//! where the motion does not come near to flattening the body. The mean over the body is that over
//! the samples.

use super::MotionError;
use super::chain::{Motion, Steady};
use super::scheme::{Course, Rates};
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// Points and weights of Gauss and Legendre on [-1, 1], five points.
const FIVE_POINTS: [[f64; 2]; 5] = [
    [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [0.906_179_845_938_664, 0.236_926_885_056_189_1],
];
/// Error of the integral over a part of a piece, relative to that over the piece so far.
const QUADRATURE: f64 = 1e-8;
/// An integral this small, relative to speed times size, is rounding.
const ROUNDING: f64 = 1e-11;
/// Most halvings of a piece.
const MOST_HALVINGS: u32 = 24;
/// Cells of a box in each direction; each has two Gauss points.
const CELLS: usize = 6;
/// Cells of a rectangle in each direction.
const PLANAR_CELLS: usize = 24;

/// A point of a body in its own frame, and the part of the body for which it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<Point> {
    /// In the frame of the body.
    pub point: Point,
    /// Relative to the sum of the weights, which must be positive.
    pub weight: f64,
}

/// How far a motion is from steady.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Steadiness {
    /// The average relative acceleration, a length per square of time; 0 for a steady motion.
    pub average_relative_acceleration: f64,
    /// The same times the duration, divided by the mean speed: by how much of its own speed the
    /// body is accelerated on the whole. 0 for a body at rest.
    pub relative: f64,
    /// Mean over the body and over time of the speed.
    pub mean_speed: f64,
    /// The jumps of the velocity, in the order of time.
    pub jumps: Vec<Jump>,
}

/// A sudden change of the velocity of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Jump {
    /// On the clock of the motion.
    pub time: f64,
    /// Mean over the body of the change of the velocity relative to the body.
    pub speed: f64,
}

impl Steadiness {
    /// The largest of the jumps; 0 without one.
    pub fn largest_jump(&self) -> f64 {
        let speeds = self.jumps.iter().map(|jump| jump.speed);
        speeds.fold(0.0, f64::max)
    }
}

/// Of a chain of steady spans as it is, not of a motion that it may stand for: the spans are steady,
/// and the velocity jumps at the joints. All joints are listed.
///
/// # Errors
/// [`MotionError::Flattened`] where the poses are singular in f64.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use steadysweep::motion::{Generator, Motion, Span, steadiness};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // Along x, then along y, at the speed 1.
/// let [x, y] = [DVec3::X, DVec3::Y].map(Generator::translation);
/// let motion = Motion::from_spans(vec![Span::new(x, 1.0)?, Span::new(y, 1.0)?])?;
/// let body = steadiness::in_box(DVec3::ZERO, DVec3::ONE);
/// let found = steadiness::of_chain(&motion, &body)?;
/// assert!((found.largest_jump() - 2.0_f64.sqrt()).abs() < 1e-12);
/// assert!((found.average_relative_acceleration - 0.5_f64.sqrt()).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
pub fn of_chain<F: Steady>(
    motion: &Motion<F>,
    body: &[Sample<F::Point>],
) -> Result<Steadiness, MotionError> {
    of_course(&Course::of_chain(motion), body)
}

/// Of a motion by a scheme. All keyframes but the first and the last are listed as jumps.
///
/// # Errors
/// [`MotionError::Flattened`] where the scheme flattens the body or makes a mirror image of it.
pub fn of_course<F: Steady>(
    course: &Course<F>,
    body: &[Sample<F::Point>],
) -> Result<Steadiness, MotionError> {
    let body: Vec<(DVec3, f64)> = body
        .iter()
        .map(|sample| (F::point_in_space(sample.point), sample.weight))
        .collect();
    let pieces = (0..course.pieces.len())
        .into_par_iter()
        .map(|number| of_piece(course, number, &body))
        .collect::<Result<Vec<OfPiece>, MotionError>>()?;
    let jumps: Vec<Jump> = pieces
        .windows(2)
        .zip(&course.keys[1..])
        .map(|(pair, key)| Jump {
            time: key.time,
            speed: mean_length(&pair[1].at_ends[0].minus(&pair[0].at_ends[1]), &body),
        })
        .collect();
    let duration = course.keys[course.keys.len() - 1].time - course.keys[0].time;
    let turned: f64 = jumps.iter().map(|jump| jump.speed).sum();
    let total = |i: usize| pieces.iter().map(|piece| piece.integrals[i]).sum::<f64>();
    let average = (turned + total(0)) / duration;
    let mean_speed = total(1) / duration;
    Ok(Steadiness {
        average_relative_acceleration: average,
        relative: if mean_speed > 0.0 {
            average * duration / mean_speed
        } else {
            0.0
        },
        mean_speed,
        jumps,
    })
}

/// Samples of a box, for a body that fills it: two Gauss points in each direction of 6 x 6 x 6
/// cells.
///
/// - `low`, `high`: corners, in the frame of the body.
pub fn in_box(low: DVec3, high: DVec3) -> Vec<Sample<DVec3>> {
    let at = gauss_points(CELLS);
    let mut samples = Vec::with_capacity(at.len().pow(3));
    for &x in &at {
        for &y in &at {
            samples.extend(at.iter().map(|&z| Sample {
                point: low + (high - low) * DVec3::new(x, y, z),
                weight: 1.0,
            }));
        }
    }
    samples
}

/// Samples of a rectangle, for a body of the plane that fills it: two Gauss points in each
/// direction of 24 x 24 cells.
///
/// - `low`, `high`: corners, in the frame of the body.
pub fn in_rectangle(low: DVec2, high: DVec2) -> Vec<Sample<DVec2>> {
    let at = gauss_points(PLANAR_CELLS);
    let mut samples = Vec::with_capacity(at.len().pow(2));
    for &x in &at {
        samples.extend(at.iter().map(|&y| Sample {
            point: low + (high - low) * DVec2::new(x, y),
            weight: 1.0,
        }));
    }
    samples
}

/// The two Gauss points of each cell of [0, 1].
fn gauss_points(cells: usize) -> Vec<f64> {
    let off = 1.0 / 3.0_f64.sqrt();
    (0..2 * cells)
        .map(|number| {
            let middle = (number / 2) as f64 + 0.5;
            let off = if number % 2 == 0 { -off } else { off };
            (middle + 0.5 * off) / cells as f64
        })
        .collect()
}

/// A velocity field x -> M x + o, or a change of one.
#[derive(Debug, Clone, Copy)]
struct Field {
    linear: DMat3,
    offset: DVec3,
}

impl Field {
    fn minus(&self, other: &Field) -> Field {
        Field {
            linear: self.linear - other.linear,
            offset: self.offset - other.offset,
        }
    }
}

fn mean_length(field: &Field, body: &[(DVec3, f64)]) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for &(point, weight) in body {
        sum += weight * (field.linear * point + field.offset).length();
        weights += weight;
    }
    sum / weights
}

/// What one piece adds.
struct OfPiece {
    /// Integrals over time of the means of |W' x| and |A' x|.
    integrals: [f64; 2],
    /// W at the start and at the end, per unit of time.
    at_ends: [Field; 2],
}

fn of_piece<F: Steady>(
    course: &Course<F>,
    number: usize,
    body: &[(DVec3, f64)],
) -> Result<OfPiece, MotionError> {
    let piece = &course.pieces[number];
    let [start, end] = [number, number + 1].map(|key| course.keys[key].time);
    let duration = end - start;
    let rates = |u: f64| {
        let rates = piece.rates(u);
        if rates.pose.matrix3.determinant() > 0.0 {
            return Ok(rates);
        }
        let time = start + duration * u;
        Err(MotionError::Flattened { time }.between_keyframes(number))
    };
    // Both are integrals over u as they are: of |W'| du, W = dA/du / duration, and of |dA/du| du.
    let means = |u: f64| {
        let rates = rates(u)?;
        let changed = relative_acceleration(&rates);
        let moved = Field {
            linear: rates.first.matrix3,
            offset: rates.first.translation,
        };
        Ok([
            changed.map_or(0.0, |field| mean_length(&field, body) / duration),
            mean_length(&moved, body),
        ])
    };
    let at_end = |u: f64| {
        let Rates { pose, first, .. } = rates(u)?;
        let inverse = pose.matrix3.inverse();
        Ok(Field {
            linear: inverse * first.matrix3 * (1.0 / duration),
            offset: inverse * first.translation / duration,
        })
    };
    Ok(OfPiece {
        integrals: integrals(&means, duration)?,
        at_ends: [at_end(0.0)?, at_end(1.0)?],
    })
}

/// W' = A^-1 (A'' - A' A^-1 A'); `None` where the motion is steady.
fn relative_acceleration(rates: &Rates) -> Option<Field> {
    let second = rates.second?;
    let inverse = rates.pose.matrix3.inverse();
    let first = rates.first;
    let relative = first.matrix3 * inverse;
    Some(Field {
        linear: inverse * (second.matrix3 - relative * first.matrix3),
        offset: inverse * (second.translation - relative * first.translation),
    })
}

/// The integrals over u from 0 to 1, by halving where five points and twice five points differ.
fn integrals(
    means: &dyn Fn(f64) -> Result<[f64; 2], MotionError>,
    duration: f64,
) -> Result<[f64; 2], MotionError> {
    let five = |[from, to]: [f64; 2]| {
        let [middle, half] = [0.5 * (from + to), 0.5 * (to - from)];
        let mut sum = [0.0; 2];
        for [at, weight] in FIVE_POINTS {
            let found = means(middle + half * at)?;
            sum = [0, 1].map(|i| sum[i] + half * weight * found[i]);
        }
        Ok::<[f64; 2], MotionError>(sum)
    };
    let whole = five([0.0, 1.0])?;
    let mut open = vec![([0.0, 1.0], whole, 0)];
    let mut sum = [0.0_f64; 2];
    while let Some(([from, to], once, halvings)) = open.pop() {
        let middle = 0.5 * (from + to);
        let halves = [five([from, middle])?, five([middle, to])?];
        let twice = [0, 1].map(|i| halves[0][i] + halves[1][i]);
        let floor = ROUNDING * whole[1].max(sum[1] + twice[1]);
        let floors = [floor / duration, floor];
        let is_near = [0, 1].into_iter().all(|i| {
            let size = whole[i].max(sum[i] + twice[i]);
            (twice[i] - once[i]).abs() <= (QUADRATURE * size).max(floors[i])
        });
        if is_near || halvings == MOST_HALVINGS {
            sum = [0, 1].map(|i| sum[i] + twice[i]);
        } else {
            open.push(([middle, to], halves[1], halvings + 1));
            open.push(([from, middle], halves[0], halvings + 1));
        }
    }
    Ok(sum)
}
