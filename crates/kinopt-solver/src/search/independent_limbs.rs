//! Independent limbs: limbs without common variables and tasks, solved separately.
//!
//! An attempt that solves one limb and not another is still useful: later attempts start the solved limb at its
//! solution. Each limb then needs a good start at some time, not all of them in one attempt.

use crate::problem::{ProblemInstance, TaskSubset};

/// Limbs of a search, and their solutions so far.
#[derive(Clone, Debug, Default)]
pub(super) struct IndependentLimbs {
    /// Limb of each variable, as the index of the limb's first variable.
    limbs: Vec<usize>,
    /// There are several limbs, and no collision avoidance connects them.
    several: bool,
    /// Solved limbs, by index of the limb.
    solved: Vec<bool>,
    /// Solutions: the variables of solved limbs.
    x: Vec<f64>,
}

impl IndependentLimbs {
    /// Reserves memory for a search over this number of variables.
    pub(super) fn fit(&mut self, variables: usize) {
        self.several = false;
        self.limbs.clear();
        self.limbs.reserve(variables);
        self.x.clear();
        self.x.reserve(variables);
        self.solved.clear();
        self.solved.reserve(variables);
    }

    /// Starts a search.
    pub(super) fn begin(&mut self, instance: ProblemInstance<'_>, subset: TaskSubset) {
        let problem = instance.problem;
        self.several = false;
        // With collision avoidance the solution of one limb may collide with obstacles or other limbs.
        if problem.collision_constraint().is_some() {
            return;
        }
        self.limbs.clear();
        self.limbs.extend(0..instance.variables());
        let limbs = problem.group_by_tasks(subset, &mut self.limbs);
        self.several = limbs > 1;
        if self.several {
            self.x.clear();
            self.x.resize(self.limbs.len(), 0.0);
            self.solved.clear();
            self.solved.resize(self.limbs.len(), false);
        }
    }

    /// Stores the solutions of the limbs that an attempt solved. It ended at `x` with this residual of the task subset.
    pub(super) fn record_solved(
        &mut self,
        instance: ProblemInstance<'_>,
        subset: TaskSubset,
        (x, residual): (&[f64], &[f64]),
    ) {
        if !self.several {
            return;
        }
        for (j, limb) in self.limbs.iter().enumerate() {
            let is_new = *limb == j && !self.solved[j];
            if is_new
                && instance
                    .problem
                    .is_limb_reached(subset, residual, &self.limbs, j)
            {
                self.solved[j] = true;
                for (stored, (value, limb)) in self.x.iter_mut().zip(x.iter().zip(&self.limbs)) {
                    if *limb == j {
                        *stored = *value;
                    }
                }
            }
        }
    }

    /// Writes the solutions of solved limbs into a start.
    pub(super) fn write_solved(&self, x: &mut [f64]) {
        if !self.several {
            return;
        }
        for ((value, stored), limb) in x.iter_mut().zip(&self.x).zip(&self.limbs) {
            if self.solved[*limb] {
                *value = *stored;
            }
        }
    }
}
