//! Limbs that share no variable and no goal, whose solutions are found independently.
//!
//! An attempt that solves one limb and misses another is not lost: later attempts start the solved limb at its solution, so that each
//! limb needs a good start of its own, and not all of them in the same attempt.

use crate::problem::{Question, Share};

/// The limbs of a search, and their solutions so far.
#[derive(Clone, Debug, Default)]
pub(super) struct IndependentLimbs {
    /// The limb of each variable; a limb is known by one of its variables.
    limbs: Vec<usize>,
    /// Whether there are several, and nothing else connects them.
    several: bool,
    /// Whether each limb is solved, by that variable.
    solved: Vec<bool>,
    /// The variables of solved limbs.
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

    /// Begins a search.
    pub(super) fn begin(&mut self, question: Question<'_>, share: Share) {
        let problem = question.problem;
        self.several = false;
        // Obstacles and other limbs may be in the way of a solution by itself.
        if problem.fence().is_some() {
            return;
        }
        self.limbs.clear();
        self.limbs.extend(0..question.variables());
        let limbs = problem.join_by_tasks(share, &mut self.limbs);
        self.several = limbs > 1;
        if self.several {
            self.x.clear();
            self.x.resize(self.limbs.len(), 0.0);
            self.solved.clear();
            self.solved.resize(self.limbs.len(), false);
        }
    }

    /// Notes the limbs that an attempt solved, which ended at `x` with this residual of the share.
    pub(super) fn take(
        &mut self,
        question: Question<'_>,
        share: Share,
        (x, residual): (&[f64], &[f64]),
    ) {
        if !self.several {
            return;
        }
        for (j, limb) in self.limbs.iter().enumerate() {
            let is_new = *limb == j && !self.solved[j];
            if is_new
                && question
                    .problem
                    .is_limb_reached(share, residual, &self.limbs, j)
            {
                self.solved[j] = true;
                for (own, (value, limb)) in self.x.iter_mut().zip(x.iter().zip(&self.limbs)) {
                    if *limb == j {
                        *own = *value;
                    }
                }
            }
        }
    }

    /// Starts solved limbs at their solutions.
    pub(super) fn keep(&self, x: &mut [f64]) {
        if !self.several {
            return;
        }
        for ((value, own), limb) in x.iter_mut().zip(&self.x).zip(&self.limbs) {
            if self.solved[*limb] {
                *value = *own;
            }
        }
    }
}
