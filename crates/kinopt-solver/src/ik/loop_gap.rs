//! Closure errors of loops, and errors of [`LoopClosure`](super::LoopClosure).

use super::OpenLoop;
use crate::problem::ProblemError;
use crate::search::SolveError;
use crate::task::Quantity;
use kinopt_kinematics::model::{Loop, Model, ModelError};

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
    pub(super) fn of(model_loop: &Loop, model: &Model) -> Self {
        Self {
            name: model_loop.name.clone(),
            gap: 0.0,
            angle: 0.0,
            unit: model.length_unit().symbol(),
        }
    }

    pub(super) fn open(open: &OpenLoop<'_>, model: &Model) -> Self {
        Self {
            name: open.name.to_owned(),
            gap: open.gap,
            angle: open.angle,
            unit: model.length_unit().symbol(),
        }
    }

    pub(super) fn set_error(&mut self, quantity: Quantity, error: f64) {
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

/// Reason why loops do not close.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoopClosureError {
    /// The configuration has the wrong length, a locked joint is outside its limits, or a joint cannot be dependent.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The problem of the loops cannot be built.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The configuration has a number that is not finite.
    #[error(transparent)]
    Start(#[from] SolveError),
    /// No joint is given that closes the loops.
    #[error(
        "model `{model}` has loops but no passive joints that close them: name some of {}",
        joints.join(", ")
    )]
    NoPassiveJoints {
        /// Name of the model.
        model: String,
        /// Names of the joints that move the loops.
        joints: Vec<String>,
    },
    /// The search found no values of the dependent joints that close a loop.
    #[error("{}: no values of {} were found that close it", listed(open), dependent.join(", "))]
    Open {
        /// Open loops with their closure errors.
        open: Vec<LoopGap>,
        /// Names of the dependent joints.
        dependent: Vec<String>,
    },
}

fn listed(open: &[LoopGap]) -> String {
    let open: Vec<String> = open.iter().map(LoopGap::to_string).collect();
    open.join(", ")
}
