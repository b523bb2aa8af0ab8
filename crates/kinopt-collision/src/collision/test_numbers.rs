//! Deterministic pseudo-random numbers for tests.

use kinopt_kinematics::spatial::Vector3;

/// A linear congruential generator (Press et al. 1992, "Numerical Recipes", ch. 7.1); the field is its state.
pub(super) struct Numbers(pub(super) u32);

impl Numbers {
    /// The next number, in [-1, 1).
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.0 >> 8) / f64::from(1 << 23) - 1.0
    }

    /// A point with each coordinate in [-`size`, `size`).
    pub(super) fn point(&mut self, size: f64) -> Vector3<f64> {
        Vector3::new(self.next(), self.next(), self.next()) * size
    }
}
