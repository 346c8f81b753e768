//! exp(tG): the pose at time t.

use super::Generator;
use super::deflation::Deflation;
use super::pair::Traceless;
use super::spectrum::{Corner, FunctionOnSpectrum, Spectrum};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::f64::consts::TAU;

/// exp(tG), prepared for many t.
///
/// # Example
/// ```
/// use glam::{DAffine3, DVec3};
/// use std::f64::consts::TAU;
/// use steadysweep::motion::{Flow, Generator};
///
/// // Five turns with growth to twice the size.
/// let flow = Flow::new(Generator::screw(DVec3::Z, DVec3::ZERO, 5.0 * TAU, 0.0, 2.0));
/// assert_eq!(flow.pose_at(0.0), DAffine3::IDENTITY);
/// let end = flow.pose_at(1.0).transform_point3(DVec3::X);
/// assert!(end.distance(2.0 * DVec3::X) < 1e-13);
/// ```
#[derive(Debug, Clone)]
pub struct Flow {
    generator: Generator,
    form: DeflatedGenerator,
}

/// A generator in the form M = Q [lambda x; 0 mean I + C0] Q, tau = Q offset.
#[derive(Debug, Clone, Copy)]
pub(super) struct DeflatedGenerator {
    /// Q; equal to its own inverse.
    pub(super) basis: DMat3,
    pub(super) spectrum: Spectrum,
    pub(super) block: Traceless,
    pub(super) coupling: DVec2,
    /// x C0, kept because it cancels in shears.
    pub(super) coupling_of_block: DVec2,
    pub(super) offset: DVec3,
}

impl Flow {
    /// Prepares exp(tG) for any finite generator, whatever the angle of turn or the confluence of
    /// eigenvalues.
    pub fn new(generator: Generator) -> Flow {
        let split = Deflation::new(&generator.linear);
        let block = split.traceless();
        let disc = block.discriminant();
        // A pure quarter-turn block has the root in its entries, free of the rounding of a square.
        let quarter_turn = block.z == 0.0 && block.upper == -block.lower;
        let root = if quarter_turn {
            block.lower.abs()
        } else {
            disc.abs().sqrt()
        };
        let spectrum = Spectrum {
            lambda: split.lambda,
            mean: split.mean(),
            disc,
            root,
        };
        let form = DeflatedGenerator {
            basis: split.basis,
            spectrum,
            block,
            coupling: split.coupling,
            coupling_of_block: block.left(split.coupling),
            offset: split.basis * generator.offset,
        };
        Flow { generator, form }
    }

    /// A flow whose form is known more accurately than the matrix of its generator.
    pub(super) fn from_form(form: DeflatedGenerator) -> Flow {
        Flow {
            generator: form.generator(),
            form,
        }
    }

    /// Number of turns in a time of 1; 0 where nothing turns.
    pub(crate) fn turns(&self) -> f64 {
        let spectrum = &self.form.spectrum;
        if spectrum.disc < 0.0 {
            spectrum.root / TAU
        } else {
            0.0
        }
    }

    /// G.
    pub fn generator(&self) -> &Generator {
        &self.generator
    }

    /// exp(tG).
    ///
    /// The identity, exactly, at t = 0; a translation by t tau, exactly, where M = 0. Otherwise the
    /// error is a few units in the last place of the largest entry, times t |M|, for all but
    /// extremely sheared motions.
    ///
    /// # Cost
    /// Constant, about 0.15 us; no iteration, no allocation.
    pub fn pose_at(&self, t: f64) -> DAffine3 {
        if t == 0.0 {
            return DAffine3::IDENTITY;
        }
        self.form.exponential(t)
    }
}

impl DeflatedGenerator {
    fn exponential(&self, t: f64) -> DAffine3 {
        let [linear, integral] = self.exponential_and_integral(t);
        DAffine3 {
            matrix3: self.basis * linear * self.basis,
            translation: self.basis * (integral * self.offset * t),
        }
    }

    /// exp(tM) and phi1(tM) in the basis Q.
    pub(super) fn exponential_and_integral(&self, t: f64) -> [DMat3; 2] {
        let spectrum = self.spectrum.scaled(t);
        let exponential = spectrum.exponential();
        let phi_one = spectrum.phi_one(&exponential);
        let block = self.block.scaled(t);
        let mut linear = apply(&exponential, &block);
        let mut integral = apply(&phi_one, &block);
        if self.coupling != DVec2::ZERO {
            let coupling = [self.coupling * t, self.coupling_of_block * (t * t)];
            let corner = spectrum.exponential_corner(&exponential);
            set_corner(&mut linear, &corner, coupling);
            set_corner(
                &mut integral,
                &spectrum.phi_one_corner(&corner, &phi_one),
                coupling,
            );
        }
        [linear, integral]
    }

    /// The generator as a matrix.
    fn generator(&self) -> Generator {
        let Spectrum { lambda, mean, .. } = self.spectrum;
        let form = DMat3::from_cols(
            DVec3::new(lambda, 0.0, 0.0),
            DVec3::new(self.coupling.x, mean + self.block.z, self.block.lower),
            DVec3::new(self.coupling.y, self.block.upper, mean - self.block.z),
        );
        Generator {
            linear: self.basis * form * self.basis,
            offset: self.basis * self.offset,
        }
    }
}

/// f of [lambda 0; 0 mean I + C0].
fn apply(f: &FunctionOnSpectrum, block: &Traceless) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(f.lambda, 0.0, 0.0),
        DVec3::new(0.0, f.even + f.odd * block.z, f.odd * block.lower),
        DVec3::new(0.0, f.odd * block.upper, f.even - f.odd * block.z),
    )
}

/// Sets the entries that the coupling contributes, x f\[lambda, C\], from x and x C0.
fn set_corner(matrix: &mut DMat3, f: &Corner, coupling: [DVec2; 2]) {
    let corner = coupling[0] * f.even + coupling[1] * f.odd;
    matrix.y_axis.x = corner.x;
    matrix.z_axis.x = corner.y;
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_form_gives_back_its_generator() {
        let rows = [
            [0.1, -2.0, 0.3, 1.0],
            [0.7, 0.4, -0.5, 2.0],
            [-0.2, 0.9, 0.6, 3.0],
        ];
        let generator = Generator::from_rows(rows).expect("finite");
        let again = Flow::from_form(Flow::new(generator).form);
        for (found, expected) in again
            .generator()
            .rows()
            .iter()
            .flatten()
            .zip(rows.iter().flatten())
        {
            assert!(
                (found - expected).abs() < 4e-15,
                "{found} instead of {expected}"
            );
        }
    }

    #[test]
    fn a_rotation_stays_rigid_for_a_thousand_turns() {
        let generator =
            Generator::screw(DVec3::new(0.36, 0.48, 0.8), DVec3::X, 2000.0 * PI, 0.0, 1.0);
        let flow = Flow::new(generator);
        for step in 0..1000 {
            let pose = flow.pose_at(f64::from(step) / 999.0).matrix3;
            let skewed = (pose.transpose() * pose - DMat3::IDENTITY).to_cols_array();
            let worst = skewed.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(worst < 5e-15, "step {step}: {worst:e}");
        }
    }

    #[test]
    fn a_turn_about_a_coordinate_axis_leaves_it_alone() {
        let flow = Flow::new(Generator::screw(DVec3::Z, DVec3::ZERO, 5.0, 2.0, 1.0));
        let end = flow
            .pose_at(0.75)
            .transform_point3(DVec3::new(0.0, 0.0, 7.0));
        assert_eq!(end, DVec3::new(0.0, 0.0, 8.5), "exactly along the axis");
    }
}
