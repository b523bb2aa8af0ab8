//! Whether an answer is one.

use kinopt::lanes::Chain;
use kinopt::spatial::{Placement, rotation_log};

use crate::TOLERANCE;

/// Judges by kinopt's forward kinematics in plain `f64` and by the limits in the file, whatever
/// the solver said of its answer.
pub struct Judge<'a>(pub &'a Chain);

impl Judge<'_> {
    /// Whether `q` is within all limits to the bit and puts the tip within both tolerances of the
    /// target (and a millionth of them more, for the rounding of other orders of operations).
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
