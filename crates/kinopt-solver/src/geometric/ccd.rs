//! Cyclic coordinate descent (CCD).

use super::Geometric;
use super::descent::GeometricDescent;
use super::goal::goals;
use super::sweeps::{self, Limits};
use crate::ik::{Restarts, Solution};
use crate::problem::ProblemInstance;
use crate::search::SolveError;
use crate::solver::{Observer, Stopping};

/// Cyclic coordinate descent (Wang & Chen 1991), from the tips to the root.
///
/// Each joint rotates about its axis by the signed angle that brings the frames it carries closest to their targets.
/// The angle is clamped to the limits before the next joint moves. Prismatic joints translate by the remaining offset
/// along their axis.
///
/// It accepts any number of point, pose and orientation tasks, on revolute, continuous and prismatic joints. Each joint
/// minimises the sum of the tasks' weighted squared errors. For orientations, the chord ½ Σ ‖cᵢ − tᵢ‖² of the three
/// axes replaces the squared angle; both agree for small angles. Locked joints do not move. A variable that moves
/// several joints takes damped Gauss-Newton steps before each sweep.
///
/// Tolerances are those of the optimisers by default. An iteration is a sweep over all joints. An attempt has at most
/// 500, and ends if 60 do not halve the cost. Attempts restart until 2 000 iterations are spent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ccd {
    limits: Limits,
}

impl Ccd {
    /// Sets the limits of each attempt; the time limit applies to all attempts together.
    #[must_use]
    pub fn with_stopping(mut self, stopping: Stopping) -> Self {
        self.limits.stopping = stopping;
        self
    }

    /// Sets the number of further attempts.
    ///
    /// [`Restarts::none`] is the bare method, which does not bend a chain that is straight towards its target.
    #[must_use]
    pub fn with_restarts(mut self, restarts: Restarts) -> Self {
        self.limits.restarts = restarts;
        self
    }
}

impl Geometric for Ccd {
    fn name(&self) -> &'static str {
        "ccd"
    }

    fn solve_question(
        &self,
        instance: ProblemInstance<'_>,
        start: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Solution, SolveError> {
        let mut descent = GeometricDescent::new(instance, goals(instance, "CCD")?);
        sweeps::solve(instance, start, self.limits, &mut descent, observer)
    }
}
