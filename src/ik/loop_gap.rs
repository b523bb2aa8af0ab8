//! How far loops are open, and why they stay so.

use super::OpenLoop;
use crate::model::{Loop, Model, ModelError};
use crate::problem::ProblemError;
use crate::search::SolveError;
use crate::task::Quantity;

/// How far the places of a loop are apart in a configuration.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LoopGap {
    /// The loop.
    pub name: String,
    /// Between the places, in metres (or the model's own unit).
    pub gap: f64,
    /// Between their axes, in radians; 0 where the loop holds origins alone.
    pub angle: f64,
    unit: &'static str,
}

impl LoopGap {
    pub(super) fn of(own: &Loop, model: &Model) -> Self {
        Self {
            name: own.name.clone(),
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

    pub(super) fn take(&mut self, quantity: Quantity, error: f64) {
        match quantity {
            Quantity::Radians => self.angle = error,
            _ => self.gap = error,
        }
    }

    /// Whether it is closed, within [`Loop::TOLERANCE`].
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.gap <= Loop::TOLERANCE && self.angle <= Loop::TOLERANCE
    }
}

impl std::fmt::Display for LoopGap {
    /// As in "loop `pin` is open by 3.000e-3 m".
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

/// Why loops do not close.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoopClosureError {
    /// A configuration of the wrong length, a joint that is held outside its limits, or one that cannot be dependent.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// What a problem on the model is refused for.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A number that is not finite.
    #[error(transparent)]
    Start(#[from] SolveError),
    /// Nobody said which joints close the loops.
    #[error(
        "`{model}` has loops, but no passive joints that close them: name some of {}",
        joints.join(", ")
    )]
    NoPassiveJoints {
        /// The model.
        model: String,
        /// The joints that move the loops.
        joints: Vec<String>,
    },
    /// No values of the dependent joints close a loop.
    #[error("{}: no values of {} that were found close it", listed(open), dependent.join(", "))]
    Open {
        /// The loops that stay open, and by how much.
        open: Vec<LoopGap>,
        /// The joints that were to close them.
        dependent: Vec<String>,
    },
}

fn listed(open: &[LoopGap]) -> String {
    let open: Vec<String> = open.iter().map(LoopGap::to_string).collect();
    open.join(", ")
}
