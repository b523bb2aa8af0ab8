//! Cyclic coordinate descent: every joint in turn does the best it can.

use super::descent::Descent;
use super::goal::goals;
use super::sweeps::{self, Limits};
use super::{Geometric, GeometricError};
use crate::ik::{Restarts, Solution};
use crate::problem::Question;
use crate::solver::{Observer, Stopping};

/// Cyclic coordinate descent (Wang & Chen 1991): from the tips to the root each joint turns about
/// its own axis, by the signed angle that brings what it carries nearest to its goals, clamped into
/// its limits before the next joint moves. Sliding joints slide by what is left along their axis.
///
/// Any number of point, pose and orientation tasks, on revolute, continuous and prismatic joints.
/// What each joint lowers is the sum of the tasks' weighted squared errors, with the chord
/// ½ Σ ‖cᵢ − tᵢ‖² of the three axes in place of an orientation's squared angle (the same where the
/// angle is small). Locked joints do not move; a variable that moves several joints takes damped
/// Gauss-Newton steps of its own before each sweep.
///
/// By default it has the optimisers' tolerances; an iteration is a sweep over all joints. Up to 500 of
/// them an attempt, which ends when 60 do not halve the cost, and restarts until 2 000 are spent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ccd {
    limits: Limits,
}

impl Ccd {
    setters! {
        /// Sets the limits of each attempt; the time limit is for all of them together.
        pub fn with_stopping(mut self, stopping: Stopping) { self.limits.stopping = stopping }
        /// Sets how often to try again. A chain that is stretched towards its target does not start to
        /// bend by itself: [`Restarts::none`] is the bare method.
        pub fn with_restarts(mut self, restarts: Restarts) { self.limits.restarts = restarts }
    }
}

impl Geometric for Ccd {
    fn name(&self) -> &'static str {
        "ccd"
    }

    fn solve_question(
        &self,
        question: Question<'_>,
        start: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Solution, GeometricError> {
        let mut descent = Descent::new(question, goals(question, "CCD")?);
        sweeps::solve(question, start, self.limits, &mut descent, observer)
    }
}
