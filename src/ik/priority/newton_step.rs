//! Newton step of a level: model, minimiser and trial.

use super::descent::Descent;
use super::descent_problem::DescentProblem;
use super::slope_differences::Weighted;
use crate::problem::TaskSubset;
use crate::solver::{StepBounds, dot};

impl Descent {
    /// Computes ∇²L along the free directions at x.
    pub(super) fn take_hessian(&mut self, descent: &mut DescentProblem<'_, '_>) {
        let newton = &mut self.newton;
        let rows = newton.weights.len();
        let of = Weighted {
            share: TaskSubset::above(self.rank + 1),
            multipliers: &newton.weights,
            edges: &newton.edges,
            own: rows - self.pulls.len()..rows,
        };
        let kept = match newton.weighs_bounds {
            true => &self.fixed,
            false => &newton.pinned,
        };
        (newton.above).complement(kept, &mut newton.model.directions);
        newton.differences.stand(descent, &of, &self.x);
        newton.model.take(self.x.len(), |direction, image| {
            (newton.differences).along(descent, &of, (&self.x, direction), image);
        });
    }

    /// Writes the damped step into `best`, limited to the longest joint step. Returns the predicted decrease if the
    /// model has a minimum.
    pub(super) fn aim_newton(
        &mut self,
        descent: &DescentProblem<'_, '_>,
        damping: f64,
    ) -> Option<f64> {
        let newton = &mut self.newton;
        let (pinned, keeps) = (&newton.pinned, !newton.weighs_bounds);
        let within = StepBounds {
            x: &self.x,
            space: descent.question.space(),
            fixed: if keeps { pinned } else { &self.fixed },
        };
        let (slope, inequalities) = (&newton.slope, self.held.inequalities.inequalities(keeps));
        let whole =
            (newton.model).minimise(damping, slope, &within, inequalities, &mut self.best)?;
        newton.model.write_resting(&mut newton.resting);
        for (resting, pinned) in newton.resting.iter_mut().zip(pinned) {
            *resting |= *pinned && keeps;
        }
        newton.has_stepped = true;
        self.direction.copy_from_slice(&self.best);
        let share = self.longest_share(descent.question).min(1.0);
        for entry in &mut self.best {
            *entry *= share;
        }
        let resting = self.newton.model.resting_on();
        self.held.inequalities.rest(resting, keeps, share == 1.0);
        let linear = -dot(&self.newton.slope, &self.direction);
        let promise = share * (linear - share * (linear - whole));
        (promise > 0.0).then_some(promise)
    }

    /// Returns the level's cost after the step, or infinity if the trial cannot satisfy the constraints.
    pub(super) fn try_step(&mut self, descent: &mut DescentProblem<'_, '_>) -> f64 {
        let space = descent.question.space();
        space.integrate(&self.x, &self.best, &mut self.trial);
        space.project(&mut self.trial);
        // Variables that reached a bound stay there if that is feasible.
        for (j, stopped) in self.newton.stopped.iter_mut().enumerate() {
            *stopped = self.fixed[j] || !space.is_between_bounds(&self.trial, j);
        }
        let stopped = &self.newton.stopped;
        let mut back = (self.held).bring_back(descent, &mut self.trial, &mut self.step, stopped);
        if !back && *stopped != self.fixed {
            space.integrate(&self.x, &self.best, &mut self.trial);
            space.project(&mut self.trial);
            back = self.bring_back(descent);
        }
        if !back {
            return f64::INFINITY;
        }
        descent.counts.residuals += 1;
        let now = self.cost_at_trial(descent);
        if now.is_finite() { now } else { f64::INFINITY }
    }
}
