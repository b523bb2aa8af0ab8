//! Closure errors of loops.

use crate::task::Quantity;
use kinopt_kinematics::model::{Loop, Model};

/// Closure error of a loop at a configuration.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LoopGap {
    /// Name of the loop.
    pub name: String,
    /// Distance between the two anchor points, in metres (or the model's length unit).
    pub gap: f64,
    /// Angle between the two anchors, radians; 0 if the loop constrains positions only.
    pub angle: f64,
    unit: &'static str,
}

impl LoopGap {
    pub(crate) fn of(model_loop: &Loop, model: &Model) -> Self {
        Self {
            name: model_loop.name.clone(),
            gap: 0.0,
            angle: 0.0,
            unit: model.length_unit().symbol(),
        }
    }

    /// Closure error of the loop `name`: a distance in the model's length unit, and an angle in radians.
    pub(crate) fn new(name: &str, (gap, angle): (f64, f64), model: &Model) -> Self {
        Self {
            name: name.to_owned(),
            gap,
            angle,
            unit: model.length_unit().symbol(),
        }
    }

    pub(crate) fn set_error(&mut self, quantity: Quantity, error: f64) {
        match quantity {
            Quantity::Radians => self.angle = error,
            _ => self.gap = error,
        }
    }

    /// Returns whether both errors are within [`Loop::TOLERANCE`].
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.gap <= Loop::TOLERANCE && self.angle <= Loop::TOLERANCE
    }
}

impl std::fmt::Display for LoopGap {
    /// Formats the error, as in "loop `pin` is open by 3.000e-3 m".
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            name, gap, unit, ..
        } = self;
        write!(f, "loop `{name}` is open by {gap:.3e} {unit}")?;
        match self.angle > 0.0 {
            true => write!(f, " and {:.3e} rad", self.angle),
            false => Ok(()),
        }
    }
}
