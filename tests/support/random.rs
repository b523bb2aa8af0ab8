//! Small seeded generator (Marsaglia's xorshift64*, independent of the library's).

use super::{Rigid, rigid};
use nalgebra as na;

#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        let mut generator = Self(seed.wrapping_mul(0x2545_F491_4F6C_DD1D) ^ 0x1234_5678_9ABC_DEF1);
        for _ in 0..8 {
            generator.bits();
        }
        generator
    }

    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() >> 33) as usize % count
    }

    /// Uniform in the cube of half side `size`.
    pub fn vector(&mut self, size: f64) -> na::Vector3<f64> {
        na::Vector3::from_fn(|_, _| self.within(-size, size))
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> na::Unit<na::Vector3<f64>> {
        loop {
            let v = self.vector(1.0);
            if (0.1..1.0).contains(&v.norm()) {
                return na::Unit::new_normalize(v);
            }
        }
    }

    /// Rotation about a random axis by up to π.
    pub fn rotation(&mut self) -> na::Rotation3<f64> {
        let angle = self.within(-std::f64::consts::PI, std::f64::consts::PI);
        na::Rotation3::from_axis_angle(&self.direction(), angle)
    }

    pub fn rigid(&mut self, size: f64) -> Rigid {
        rigid(self.rotation(), self.vector(size))
    }
}
