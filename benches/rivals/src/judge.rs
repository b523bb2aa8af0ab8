//! Verification of results.

use kinopt::simd_ik::Chain;
use kinopt::spatial::{Placement, rotation_log};

use crate::TOLERANCE;

/// Judges by kinopt's forward kinematics in plain `f64` and by the limits of the file, independent of the solver's
/// report.
pub struct Judge<'a>(pub &'a Chain);

impl Judge<'_> {
    /// True if `q` is exactly within all limits and the tip is within both tolerances of the target (enlarged by a
    /// millionth, for rounding).
    #[must_use]
    pub fn accepts(&self, target: &Placement<f64>, q: &[f64]) -> bool {
        let within = self.0.joints().len() == q.len()
            && (self.0.joints().iter().zip(q)).all(|(j, &q)| j.lower <= q && q <= j.upper);
        let tolerance = TOLERANCE * (1.0 + 1e-6);
        let (position, orientation) = self.errors(target, q);
        within && position <= tolerance && orientation <= tolerance
    }

    /// Distance, metres, and angle, radians, of the tip from the target.
    #[must_use]
    pub fn errors(&self, target: &Placement<f64>, q: &[f64]) -> (f64, f64) {
        let tip = self.0.base_from_tip(q).expect("one number a joint");
        let turned = rotation_log(&(tip.rotation.transpose() * target.rotation));
        ((tip.translation - target.translation).norm(), turned.norm())
    }
}
