//! 2 x 2 matrices C = mean I + C0 with C0^2 = disc I, and functions of them: f(C) = even I + odd
//! C0.
//!
//! These are all that a planar motion needs, and they serve for the 2 x 2 block of a spatial one.
//! For exp this is SAM's (11), e^x (cosh w I + sinh(w)/w C0) with w^2 = disc, without its division
//! by w = 0. phi1 follows from C phi1(C) = e^C - I where that keeps its digits, and elsewhere from
//! Horner's rule in the algebra of I and C0. All values are real for complex pairs, and confluence
//! is no special case.

use crate::numeric::difference_of_products;
use glam::{DMat2, DVec2};

/// B0 = [z upper; lower -z]: a 2 x 2 block without trace, B0^2 = (z^2 + upper lower) I.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Traceless {
    pub(super) z: f64,
    pub(super) upper: f64,
    pub(super) lower: f64,
}

impl Traceless {
    /// A 2 x 2 matrix minus half its trace.
    pub(super) fn of(matrix: &DMat2) -> Traceless {
        let [x, y] = [matrix.x_axis, matrix.y_axis];
        Traceless {
            z: 0.5 * (x.x - y.y),
            upper: y.x,
            lower: x.y,
        }
    }
    /// Whether the matrix has its eigenvalues on its diagonal.
    pub(super) fn is_triangular(&self) -> bool {
        self.upper == 0.0 || self.lower == 0.0
    }
    /// d with B0^2 = d I.
    pub(super) fn discriminant(&self) -> f64 {
        difference_of_products(self.z, self.z, -self.upper, self.lower)
    }
    /// The largest absolute value of an entry.
    pub(super) fn largest(&self) -> f64 {
        self.z.abs().max(self.upper.abs()).max(self.lower.abs())
    }
    /// factor B0.
    pub(super) fn scaled(&self, factor: f64) -> Traceless {
        Traceless {
            z: factor * self.z,
            upper: factor * self.upper,
            lower: factor * self.lower,
        }
    }
    /// row B0.
    pub(super) fn left(&self, row: DVec2) -> DVec2 {
        // In a shear these products cancel: their rounding would come back, multiplied by the
        // block.
        DVec2::new(
            difference_of_products(row.x, self.z, -row.y, self.lower),
            difference_of_products(row.x, self.upper, row.y, self.z),
        )
    }
}

/// Eigenvalues mean +- sqrt(disc).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub(super) mean: f64,
    /// Negative for a complex pair.
    pub(super) disc: f64,
    /// sqrt|disc|, kept because it is often known better than `disc`.
    pub(super) root: f64,
}

/// f(C) = even I + odd C0 of a matrix with a [`Pair`].
#[derive(Debug, Clone, Copy)]
pub(super) struct FunctionOnPair {
    pub(super) even: f64,
    pub(super) odd: f64,
}

// Where the formulas change over. Both sides are accurate there: moving a bound by a factor of two
// costs at most a digit or a few terms. So these are not tolerances.

/// Bound on |w|^2 below which cosh w and sinh w / w are summed: 6 terms leave less than 2^-53.
pub(super) const HYPERBOLIC_SERIES: f64 = 0.04;
/// Squared modulus of the pair below which phi1 is summed; division by C would lose a factor of
/// 1/0.25 there.
const SMALL_PAIR: f64 = 0.25;

/// Number of terms of a series of complete symmetric functions H_k / (k+2)! of three eigenvalues,
/// from a bound on their squared modulus r^2. H_k has (k+2)(k+1)/2 products, so that the first
/// omitted term is at most r^k / (2 k!), below 2^-56 of the first term.
pub(super) fn terms_for(modulus_squared: f64) -> usize {
    match modulus_squared {
        r if r < 1e-6 => 5,
        r if r < 0.01 => 11,
        r if r < 0.25 => 16,
        r if r < 1.0 => 19,
        r if r < 4.0 => 26,
        _ => 34,
    }
}

/// 1/k!, k = 0..39.
pub(super) const INVERSE_FACTORIAL: [f64; 40] = {
    let mut table = [1.0; 40];
    let mut factorial = 1.0;
    let mut k = 1;
    while k < 40 {
        factorial *= k as f64;
        table[k] = 1.0 / factorial;
        k += 1;
    }
    table
};

impl Pair {
    /// The pair of the matrix times t.
    pub(super) fn scaled(&self, t: f64) -> Pair {
        Pair {
            mean: t * self.mean,
            disc: t * t * self.disc,
            root: t.abs() * self.root,
        }
    }

    /// The squared modulus of the larger eigenvalue.
    pub(super) fn modulus_squared(&self) -> f64 {
        if self.disc > 0.0 {
            (self.mean.abs() + self.root).powi(2)
        } else {
            self.mean * self.mean - self.disc
        }
    }

    /// exp: e^mean (cosh w, sinh w / w), w^2 = disc.
    pub(super) fn exponential(&self) -> FunctionOnPair {
        let &Pair {
            mean,
            disc: d,
            root,
        } = self;
        if d.abs() < HYPERBOLIC_SERIES {
            let scale = mean.exp();
            let even = 1.0
                + d / 2.0
                    * (1.0
                        + d / 12.0
                            * (1.0
                                + d / 30.0
                                    * (1.0 + d / 56.0 * (1.0 + d / 90.0 * (1.0 + d / 132.0)))));
            FunctionOnPair {
                even: scale * even,
                odd: scale * hyperbolic_sine_ratio(d),
            }
        } else if d > 0.0 {
            let (upper, lower) = ((mean + root).exp(), (mean - root).exp());
            FunctionOnPair {
                even: 0.5 * (upper + lower),
                odd: 0.5 * (upper - lower) / root,
            }
        } else {
            let scale = mean.exp();
            let (sine, cosine) = root.sin_cos();
            FunctionOnPair {
                even: scale * cosine,
                odd: scale * (sine / root),
            }
        }
    }

    /// phi1(z) = (e^z - 1)/z, given exp on the same pair.
    pub(super) fn phi_one(&self, exponential: &FunctionOnPair) -> FunctionOnPair {
        let &Pair { mean, disc, root } = self;
        let product = mean * mean - disc;
        let (even, odd) = if self.modulus_squared() < SMALL_PAIR {
            self.small_phi_one()
        } else if disc > 0.0 {
            let (upper, lower) = (mean + root, mean - root);
            let (at_upper, at_lower) = (phi_one(upper), phi_one(lower));
            let odd = if root > 0.5 * upper.abs().max(lower.abs()) {
                (at_upper - at_lower) / (2.0 * root)
            } else if upper.abs() > lower.abs() {
                (exponential.odd - at_lower) / upper
            } else {
                (exponential.odd - at_upper) / lower
            };
            (0.5 * (at_upper + at_lower), odd)
        } else {
            // C phi1(C) = e^C - I, divided by C
            let rest = exponential.even - 1.0;
            (
                (mean * rest - disc * exponential.odd) / product,
                (mean * exponential.odd - rest) / product,
            )
        };
        FunctionOnPair { even, odd }
    }

    /// Horner's rule for sum C^k / (k+1)! in the algebra of I and C0.
    fn small_phi_one(&self) -> (f64, f64) {
        let terms = terms_for(self.modulus_squared());
        let (mut even, mut odd) = (INVERSE_FACTORIAL[terms + 1], 0.0);
        for inverse in INVERSE_FACTORIAL[1..=terms].iter().rev() {
            (even, odd) = (
                self.mean * even + self.disc * odd + inverse,
                even + self.mean * odd,
            );
        }
        (even, odd)
    }
}

/// ln B = even I + odd B0.
pub(super) struct PairLogarithm {
    pub(super) even: f64,
    pub(super) odd: f64,
    /// odd sqrt|disc|: half the difference of the logarithms, or the angle.
    pub(super) root: f64,
}

impl PairLogarithm {
    pub(super) fn new(mean: f64, mean_excess: f64, disc: f64, determinant: f64) -> PairLogarithm {
        // Near the identity the determinant minus one is formed without cancellation.
        let near = mean_excess.abs() < 0.3 && disc.abs() < 0.1;
        let even = if near {
            0.5 * (mean_excess.mul_add(mean_excess, 2.0 * mean_excess) - disc).ln_1p()
        } else {
            0.5 * determinant.ln()
        };
        let width = disc.abs().sqrt();
        if disc >= 0.0 {
            let ratio = width / mean;
            let odd = if ratio < 0.4 {
                inverse_tangent_ratio(ratio * ratio) / mean
            } else {
                let upper = mean + width;
                0.5 * (upper * upper / determinant).ln() / width
            };
            PairLogarithm {
                even,
                odd,
                root: odd * width,
            }
        } else if mean > 0.0 && width < 0.1 * mean {
            let odd = inverse_tangent_ratio(disc / (mean * mean)) / mean;
            PairLogarithm {
                even,
                odd,
                root: odd * width,
            }
        } else {
            let angle = width.atan2(mean);
            PairLogarithm {
                even,
                odd: angle / width,
                root: angle,
            }
        }
    }
}

/// sinh(w)/w for small w^2.
pub(super) fn hyperbolic_sine_ratio(square: f64) -> f64 {
    let d = square;
    1.0 + d / 6.0 * (1.0 + d / 20.0 * (1.0 + d / 42.0 * (1.0 + d / 72.0 * (1.0 + d / 110.0))))
}

/// (e^z - 1)/z.
pub(super) fn phi_one(z: f64) -> f64 {
    let series = 1e-5; // the next term, z^3/24, is below 2^-53
    if z.abs() < series {
        1.0 + z / 2.0 + z * z / 6.0
    } else {
        z.exp_m1() / z
    }
}

/// atanh(sqrt q)/sqrt q for q < 1; atan for negative q.
pub(super) fn inverse_tangent_ratio(q: f64) -> f64 {
    if q.abs() < 0.02 {
        let mut sum = 0.0;
        for k in (0..10).rev() {
            sum = sum * q + 1.0 / f64::from(2 * k + 1);
        }
        sum
    } else if q > 0.0 {
        q.sqrt().atanh() / q.sqrt()
    } else {
        (-q).sqrt().atan() / (-q).sqrt()
    }
}
