//! Random numbers that are the same in every run.

use glam::{DMat2, DMat3, DQuat, DVec2, DVec3};

pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Random {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d);
        for _ in 0..4 {
            random.unit();
        }
        random
    }
    /// For tests whose seeds are states of the generator.
    pub(crate) fn from_state(state: u64) -> Random {
        Random(state)
    }
    /// A number in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    /// A number in [-1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        self.between(-1.0, 1.0)
    }
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
    /// A number between two positive ones, with equal chances for every order of magnitude.
    pub(crate) fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }
    pub(crate) fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }
    pub(crate) fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }
    pub(crate) fn sign(&mut self) -> f64 {
        self.one_of(&[-1.0, 1.0])
    }
    /// A point in a cube of half width `size`.
    pub(crate) fn point(&mut self, size: f64) -> DVec3 {
        DVec3::new(
            self.between(-size, size),
            self.between(-size, size),
            self.between(-size, size),
        )
    }
    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.point(1.0);
            if (0.1..1.0).contains(&point.length()) {
                return point.normalize();
            }
        }
    }
    pub(crate) fn rotation(&mut self) -> DQuat {
        DQuat::from_axis_angle(self.direction(), self.between(0.0, std::f64::consts::TAU))
    }
    /// A matrix with entries in [-size, size].
    pub(crate) fn matrix(&mut self, size: f64) -> DMat3 {
        DMat3::from_cols(self.point(size), self.point(size), self.point(size))
    }
    /// A point in the square of half width 1.
    pub(crate) fn planar_point(&mut self) -> DVec2 {
        DVec2::new(self.signed(), self.signed())
    }
    /// A matrix with entries in [-1, 1).
    pub(crate) fn planar_matrix(&mut self) -> DMat2 {
        DMat2::from_cols(self.planar_point(), self.planar_point())
    }
}

/// Random numbers in [0, 1), the same in every run.
pub(crate) fn pseudo_random(seed: u64) -> impl Iterator<Item = f64> {
    let mut random = Random::from_state(seed);
    std::iter::repeat_with(move || random.unit())
}
