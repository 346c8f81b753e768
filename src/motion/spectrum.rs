//! exp and phi1(z) = (e^z - 1)/z of a matrix in the form [lambda x; 0 mean I + C0], C0^2 = disc I.
//!
//! A function f of that matrix needs five numbers: f(lambda); f(C) = even I + odd C0; and the
//! corner x (corner_even I + corner_odd C0), the first divided difference f[lambda, C]. Each is
//! computed by a formula that is accurate to a few units in the last place of its natural size.
//! Where the spectrum is clustered, this is a series of complete symmetric functions (with no
//! branch at confluence, and real for complex pairs), and quotients elsewhere. Derivation:
//! [`super`].

use super::pair::{
    FunctionOnPair, HYPERBOLIC_SERIES, INVERSE_FACTORIAL, Pair, hyperbolic_sine_ratio, phi_one,
    terms_for,
};

/// Eigenvalues lambda and mean +- sqrt(disc).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spectrum {
    pub(super) lambda: f64,
    pub(super) mean: f64,
    /// Negative for a complex pair.
    pub(super) disc: f64,
    /// sqrt|disc|, kept because it is often known better than `disc`.
    pub(super) root: f64,
}

/// f(lambda) and f(C) = even I + odd C0 of a matrix with a [`Spectrum`].
#[derive(Debug, Clone, Copy)]
pub(super) struct FunctionOnSpectrum {
    pub(super) lambda: f64,
    pub(super) even: f64,
    pub(super) odd: f64,
}

/// f[lambda, C] = even I + odd C0, which multiplies the coupling; not needed where there is none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub(super) even: f64,
    pub(super) odd: f64,
}

// Where the formulas change over. Both sides are accurate there: moving a bound by a factor of two
// costs at most a digit or a few terms. So these are not tolerances.

/// Squared radius of the spectrum about its centre below which corners are summed; quotients would
/// lose a factor of 1/0.25 there.
const CLUSTER: f64 = 0.25;
/// With centres farther out than this, the formula divides by lambda instead of summing an
/// alternating series.
const FAR_CENTRE: f64 = 2.0;

impl Spectrum {
    /// The spectrum of the matrix times t.
    pub(super) fn scaled(&self, t: f64) -> Spectrum {
        Spectrum {
            lambda: t * self.lambda,
            mean: t * self.mean,
            disc: t * t * self.disc,
            root: t.abs() * self.root,
        }
    }

    /// Squared radius about the mean of the pair. Relative to their centre, the eigenvalues are
    /// within 4/3 of the radius.
    fn radius_squared(&self) -> f64 {
        let h = self.lambda - self.mean;
        (h * h).max(self.disc.abs())
    }

    /// The eigenvalues of the block.
    fn pair(&self) -> Pair {
        Pair {
            mean: self.mean,
            disc: self.disc,
            root: self.root,
        }
    }

    /// exp.
    pub(super) fn exponential(&self) -> FunctionOnSpectrum {
        let FunctionOnPair { even, odd } = self.pair().exponential();
        FunctionOnSpectrum {
            lambda: self.lambda.exp(),
            even,
            odd,
        }
    }

    /// The corner of exp.
    pub(super) fn exponential_corner(&self, exponential: &FunctionOnSpectrum) -> Corner {
        if self.radius_squared() < CLUSTER {
            let odd = self.clustered_exponential();
            Corner {
                even: exponential.odd + (self.lambda - self.mean) * odd,
                odd,
            }
        } else {
            self.separated_corner(exponential, exponential_difference)
        }
    }

    /// A corner by quotients, where lambda is separated from the pair or the pair is wide.
    fn separated_corner(
        &self,
        f: &FunctionOnSpectrum,
        difference: impl Fn(f64, f64) -> f64,
    ) -> Corner {
        let &Spectrum {
            lambda,
            mean,
            disc,
            root,
        } = self;
        let h = lambda - mean;
        if disc <= 0.0 {
            let separation = h * h - disc;
            let change = f.lambda - f.even;
            Corner {
                even: (change * h - f.odd * disc) / separation,
                odd: (change - f.odd * h) / separation,
            }
        } else {
            let (upper, lower) = (mean + root, mean - root);
            let (first, second) = (difference(lambda, upper), difference(lambda, lower));
            // The second difference is taken over the farthest pair.
            let odd = if h > 0.0 {
                (first - f.odd) / (lambda - lower)
            } else {
                (second - f.odd) / (lambda - upper)
            };
            Corner {
                even: 0.5 * (first + second),
                odd,
            }
        }
    }

    /// exp[lambda, mu1, mu2] as e^centre sum H_k / (k+2)!, H_k the complete symmetric functions of
    /// the centred spectrum.
    fn clustered_exponential(&self) -> f64 {
        let h = self.lambda - self.mean;
        let centre = (self.lambda + 2.0 * self.mean) / 3.0;
        let (e2, e3) = centred_symmetric(h, self.disc);
        // H_0 = 1, H_1 = 0, H_k = -e2 H_{k-2} + e3 H_{k-3}
        let (mut before, mut last, mut current) = (1.0, 0.0, -e2);
        let mut sum = 0.5 - e2 * INVERSE_FACTORIAL[4];
        let terms = 1 + terms_for(16.0 / 9.0 * self.radius_squared());
        for inverse in &INVERSE_FACTORIAL[5..=terms] {
            let next = e3 * before - e2 * last;
            (before, last, current) = (last, current, next);
            sum += inverse * current;
        }
        centre.exp() * sum
    }

    /// phi1, given exp on the same spectrum.
    pub(super) fn phi_one(&self, exponential: &FunctionOnSpectrum) -> FunctionOnSpectrum {
        let &FunctionOnSpectrum { even, odd, .. } = exponential;
        let FunctionOnPair { even, odd } = self.pair().phi_one(&FunctionOnPair { even, odd });
        FunctionOnSpectrum {
            lambda: phi_one(self.lambda),
            even,
            odd,
        }
    }

    /// The corner of phi1, given that of exp.
    pub(super) fn phi_one_corner(
        &self,
        exponential: &Corner,
        phi_one: &FunctionOnSpectrum,
    ) -> Corner {
        if self.radius_squared() < CLUSTER {
            let odd = self.clustered_phi_one(exponential, phi_one.odd);
            Corner {
                even: phi_one.odd + (self.lambda - self.mean) * odd,
                odd,
            }
        } else {
            self.separated_corner(phi_one, phi_one_difference)
        }
    }

    /// phi1[lambda, mu1, mu2] of a cluster.
    fn clustered_phi_one(&self, exponential: &Corner, odd: f64) -> f64 {
        let &Spectrum {
            lambda, mean, disc, ..
        } = self;
        if ((lambda + 2.0 * mean) / 3.0).abs() > FAR_CENTRE {
            // e^z = 1 + z phi1(z) in divided differences: exp[l, m1, m2] = l phi1[l, m1, m2] +
            // phi1[m1, m2]
            return (exponential.odd - odd) / lambda;
        }
        let p1 = lambda + 2.0 * mean;
        let p2 = 2.0 * lambda * mean + mean * mean - disc;
        let p3 = lambda * (mean * mean - disc);
        let (mut before, mut last, mut current) = (0.0, 0.0, 1.0);
        let mut sum = INVERSE_FACTORIAL[3];
        let terms = terms_for(self.pair().modulus_squared().max(lambda * lambda));
        for inverse in &INVERSE_FACTORIAL[4..=terms + 2] {
            let next = p1 * current - p2 * last + p3 * before;
            (before, last, current) = (last, current, next);
            sum += inverse * current;
        }
        sum
    }
}

/// Second and third elementary symmetric functions of {lambda, mu1, mu2} minus their centre, h =
/// lambda - mean.
pub(super) fn centred_symmetric(h: f64, disc: f64) -> (f64, f64) {
    (-h * h / 3.0 - disc, 2.0 * h / 3.0 * (h * h / 9.0 - disc))
}

/// (e^x - e^y)/(x - y).
fn exponential_difference(x: f64, y: f64) -> f64 {
    let half = 0.5 * (x - y);
    let square = half * half;
    if square < HYPERBOLIC_SERIES {
        (0.5 * (x + y)).exp() * hyperbolic_sine_ratio(square)
    } else if square < 1.0 {
        (0.5 * (x + y)).exp() * (half.sinh() / half)
    } else {
        (x.exp() - y.exp()) / (x - y)
    }
}

/// (phi1(x) - phi1(y))/(x - y).
fn phi_one_difference(x: f64, y: f64) -> f64 {
    let far = x.abs().max(y.abs());
    if far < 1.0 {
        let (mut symmetric, mut power, mut sum) = (1.0, 1.0, 0.5);
        for inverse in &INVERSE_FACTORIAL[3..=22] {
            power *= y;
            symmetric = x * symmetric + power;
            sum += inverse * symmetric;
        }
        sum
    } else if (x - y).abs() > 0.5 * far {
        (phi_one(x) - phi_one(y)) / (x - y)
    } else if x.abs() > y.abs() {
        (exponential_difference(x, y) - phi_one(y)) / x
    } else {
        (exponential_difference(x, y) - phi_one(x)) / y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spectrum(lambda: f64, mean: f64, disc: f64) -> Spectrum {
        Spectrum {
            lambda,
            mean,
            disc,
            root: disc.abs().sqrt(),
        }
    }

    /// All ten numbers: exp and phi1 with their corners.
    fn values(s: &Spectrum) -> [f64; 10] {
        let exponential = s.exponential();
        let corner = s.exponential_corner(&exponential);
        let phi = s.phi_one(&exponential);
        let phi_corner = s.phi_one_corner(&corner, &phi);
        [
            exponential.lambda,
            exponential.even,
            exponential.odd,
            corner.even,
            corner.odd,
            phi.lambda,
            phi.even,
            phi.odd,
            phi_corner.even,
            phi_corner.odd,
        ]
    }

    #[test]
    fn a_triple_eigenvalue_gives_the_derivatives() {
        for z in [-30.0_f64, -3.0, -0.7, 1e-9, 0.4, 2.5, 30.0] {
            let e = z.exp();
            let phi = z.exp_m1() / z;
            // phi1' = (e^z - phi1)/z, phi1'' = (e^z - 2 phi1')/z: well-conditioned only away
            // from 0.
            let (first, second) = if z.abs() > 0.3 {
                let first = (e - phi) / z;
                (first, 0.5 * (e - 2.0 * first) / z)
            } else {
                (0.5, 1.0 / 6.0)
            };
            let expected = [e, e, e, e, e / 2.0, phi, phi, first, first, second];
            for (index, (found, expected)) in values(&spectrum(z, z, 0.0))
                .iter()
                .zip(expected)
                .enumerate()
            {
                let error = (found - expected).abs() / expected.abs();
                let bar = if z.abs() > 0.3 || index < 7 {
                    2e-14
                } else {
                    1e-8
                };
                assert!(
                    error < bar,
                    "z = {z}, number {index}: {found:e} instead of {expected:e}"
                );
            }
        }
    }

    #[test]
    fn formulas_agree_where_they_change_over() {
        let step = 1e-13;
        for level in [-6.0, -2.1, -1.9, -0.4, 0.0, 0.3, 1.9, 2.1, 6.0] {
            for radius_squared in [1e-6, 0.01, 0.04, 0.1406, 0.25, 0.5625, 1.0, 2.25, 4.0] {
                let radius = f64::sqrt(radius_squared);
                for (h, disc) in [
                    (radius, 0.0),
                    (radius, 0.3 * radius_squared),
                    (radius, -0.3 * radius_squared),
                    (0.2 * radius, radius_squared),
                    (0.2 * radius, -radius_squared),
                    (-0.9 * radius, radius_squared),
                ] {
                    let [below, above] = [1.0 - step, 1.0 + step].map(|factor| {
                        values(&spectrum(level + factor * h, level, factor * factor * disc))
                    });
                    let natural = (level + 2.0 * radius).max(0.0).exp();
                    for (index, (a, b)) in below.iter().zip(above).enumerate() {
                        let size = a.abs().max(1e-2 * natural);
                        assert!(
                            (a - b).abs() < 2e-12 * size,
                            "level {level}, h {h}, disc {disc}, number {index}: {a:e} and {b:e}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_whole_turn_ends_where_it_began() {
        let turn = 2.0 * std::f64::consts::PI;
        let exponential = spectrum(0.0, 0.0, -turn * turn).exponential();
        assert!(
            (exponential.even - 1.0).abs() < 1e-15,
            "cosine {}",
            exponential.even
        );
        assert!(exponential.odd.abs() < 1e-15, "sine {}", exponential.odd);
        let phi = spectrum(0.0, 0.0, -turn * turn).phi_one(&exponential);
        assert!(
            phi.even.abs() < 1e-15 && phi.odd.abs() < 1e-15,
            "phi1 is singular there: {phi:?}"
        );
    }

    #[test]
    fn far_eigenvalues_do_not_overflow_each_other() {
        for number in values(&spectrum(0.0, -750.0, 750.0 * 750.0)) {
            assert!(
                number.is_finite(),
                "eigenvalues 0, 0 and -1500 have finite functions: {number}"
            );
        }
    }
}
