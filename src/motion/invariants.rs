//! What a steady motion of any kind leaves alone: eigenvalues, fixed point, the plane in which it
//! turns, and how volumes change.

use super::Generator;
use super::deflation::{Deflation, largest_entry};
use super::pair::Traceless;
use crate::numeric::difference_of_products;
use crate::numeric::tolerance::{NEGATIVE_PAIR, NEGLIGIBLE_RATE};
use glam::{DMat3, DVec2, DVec3};

/// What a steady motion leaves alone, whatever its kind.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Invariants {
    /// The eigenvalues of M, the linear part of the generator of the whole span, as \[re, im\]: those
    /// of its map are their exponentials. The real one that is split off first; a complex pair
    /// follows with im > 0 first.
    pub eigenvalues: [[f64; 2]; 3],
    /// The point that stays, where there is exactly one.
    pub fixed_point: Option<DVec3>,
    /// Unit normal of the invariant plane in which a complex pair turns; the turn is positive about
    /// it. Where shapes change, the direction along which points of the axis move may lean on that
    /// plane.
    pub plane_normal: Option<DVec3>,
    /// The turn of the complex pair in radians, above 0, of any size.
    pub turn: Option<f64>,
    /// The volume of a body at the end, divided by that at the start.
    pub volume_factor: f64,
}

/// The eigenvalues of a block, and its turn if it turns.
pub(super) struct PairInvariants {
    pub(super) eigenvalues: [[f64; 2]; 2],
    pub(super) turn: Option<f64>,
}

impl PairInvariants {
    /// - `mean`: half the trace of the block, `block` the rest of it; `noise`: bound on the error of
    ///   its discriminant.
    pub(super) fn new(mean: f64, block: &Traceless, noise: f64) -> PairInvariants {
        let disc = block.discriminant();
        let width = disc.abs().sqrt();
        let eigenvalues = if disc >= 0.0 {
            [[mean + width, 0.0], [mean - width, 0.0]]
        } else if -disc > noise && width > NEGLIGIBLE_RATE {
            [[mean, width], [mean, -width]]
        } else {
            // The turn is rounding.
            [[mean, 0.0], [mean, 0.0]]
        };
        let turn = eigenvalues[0][1];
        PairInvariants {
            eigenvalues,
            turn: (turn > 0.0).then_some(turn),
        }
    }
}

/// What exp(tG) leaves alone.
///
/// Rates (turn in radians, logarithms of factors) below `NEGLIGIBLE_RATE` count as 0.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use std::f64::consts::PI;
/// use steadysweep::motion::{Generator, invariants};
///
/// let spiral = Generator::screw(DVec3::Z, DVec3::ONE, PI, 0.0, 0.5);
/// let found = invariants(&spiral);
/// assert!(found.fixed_point.is_some_and(|point| point.distance(DVec3::ONE) < 1e-15));
/// assert_eq!(found.plane_normal, Some(DVec3::Z));
/// assert!((found.volume_factor - 0.125).abs() < 1e-15);
/// ```
pub fn invariants(generator: &Generator) -> Invariants {
    let linear = &generator.linear;
    let form = Deflation::new(linear);
    let block = form.traceless();
    let pair = PairInvariants::new(form.mean(), &block, discriminant_noise(linear, &form));
    let [first, second] = pair.eigenvalues;
    let eigenvalues = [[form.lambda, 0.0], first, second];
    let moves = |[re, im]: &[f64; 2]| re.hypot(*im) > NEGLIGIBLE_RATE;
    Invariants {
        eigenvalues,
        fixed_point: eigenvalues
            .iter()
            .all(moves)
            .then(|| fixed_point(&form, generator.offset))
            .filter(|point| point.is_finite()),
        plane_normal: pair.turn.map(|_| plane_normal(&form, generator)),
        turn: pair.turn,
        volume_factor: generator.volume_rate().exp(),
    }
}

/// Bound on the error of the discriminant of the pair.
///
/// With the eigenvalues minus their mean, x^3 + a x = b, the discriminant of the cubic is -4 a^3 -
/// 27 b^2 = 4 disc (h^2 - disc)^2. An error e of the entries moves a by some e |N| and b by some e
/// |N|^2. So three eigenvalues that meet, as in a shear, do not turn.
fn discriminant_noise(linear: &DMat3, form: &Deflation) -> f64 {
    let mean = (form.lambda + 2.0 * form.mean()) / 3.0;
    let size = largest_entry(&(*linear - DMat3::from_diagonal(DVec3::splat(mean))));
    let (h, disc) = (form.lambda - form.mean(), form.traceless().discriminant());
    let a = -h * h / 3.0 - disc;
    let b = 2.0 * h / 3.0 * (h * h / 9.0 - disc);
    let apart = h.mul_add(h, -disc);
    let of_cubic = 12.0 * a * a + 54.0 * b.abs() * size;
    NEGATIVE_PAIR * largest_entry(linear) * size * of_cubic / (4.0 * apart * apart)
}

/// q with M q = -tau.
fn fixed_point(form: &Deflation, offset: DVec3) -> DVec3 {
    let right = form.basis * -offset;
    let [[a, b], [c, d]] = form.block;
    let determinant = difference_of_products(a, d, b, c);
    let y = difference_of_products(right.y, d, b, right.z) / determinant;
    let z = difference_of_products(a, right.z, right.y, c) / determinant;
    let x = (right.x - form.coupling.dot(DVec2::new(y, z))) / form.lambda;
    form.basis * DVec3::new(x, y, z)
}

/// The left eigenvector of lambda, to which the invariant plane of the pair is perpendicular: (1, y)
/// in the basis, y (lambda I - C) = coupling.
fn plane_normal(form: &Deflation, generator: &Generator) -> DVec3 {
    let rest = form.traceless();
    let h = form.lambda - form.mean();
    // (h I - C0)^-1 = (h I + C0) / (h^2 - disc), and disc < 0.
    let x = form.coupling;
    let y = (x * h + rest.left(x)) / h.mul_add(h, -rest.discriminant());
    let normal = (form.basis * DVec3::new(1.0, y.x, y.y)).normalize();
    let inside = normal.any_orthonormal_vector();
    let turned = inside.cross(generator.linear * inside);
    normal * normal.dot(turned).signum()
}

/// How a chain of motions changes volumes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeChange {
    /// The volume at the end, divided by that at the start.
    pub factor: f64,
    /// Whether it only grows, or only shrinks, or stays.
    pub monotone: bool,
}

/// How a chain changes volumes, in the plane areas.
///
/// - `rates`: the rate of each span, [`Generator::volume_rate`]; below `NEGLIGIBLE_RATE` it counts
///   as 0.
pub fn volume_change(rates: impl IntoIterator<Item = f64>) -> VolumeChange {
    let (mut sum, mut grows, mut shrinks) = (0.0, false, false);
    for rate in rates {
        sum += rate;
        grows |= rate > NEGLIGIBLE_RATE;
        shrinks |= rate < -NEGLIGIBLE_RATE;
    }
    VolumeChange {
        factor: sum.exp(),
        monotone: !(grows && shrinks),
    }
}
