//! Conjugate Gauss-Newton steps for soft tasks (Polak & Ribière 1969).
//!
//! Conjugacy compensates for the curvature of the constraints.

use super::descent::{Descended, Descent, multiply};
use super::descent_problem::DescentProblem;
use super::step_limits::Steps;
use crate::problem::{ProblemInstance, TaskSubset};
use crate::solver::{Iteration, Observer, StepBounds, Termination};

/// Smallest slope of a conjugate direction, relative to the steepest; below it the direction is restarted.
const CONJUGATE: f64 = 0.2;
/// Bounds of the ratio of actual to modelled curvature along a direction.
const BENDS: (f64, f64) = (0.1, 20.0);

impl Descent {
    /// Descends until the level has converged.
    pub(super) fn by_conjugate_steps(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        Steps { steps, halvings }: Steps,
        observer: &mut dyn Observer,
    ) -> Descended {
        let question = descent.question;
        let mut cost = self.cost_at_x(descent);
        descent.counts.residuals += 1;
        let worthwhile = self.held.worthwhile();
        let limit = steps.min(descent.stopping.max_iterations());
        let end = |iterations, cut| Descended { iterations, cut };
        self.newton.has_stepped = false;
        let (mut iterations, mut bend, mut moved, mut last_falls) = (0, 1.0, 0.0, None);
        loop {
            if !cost.is_finite() {
                return end(iterations, Some(Termination::NonFinite));
            }
            let seen = observer.observe(&Iteration {
                index: iterations,
                cost,
                projected_gradient: None,
                step: moved,
                control: 0.0,
                x: &self.x,
            });
            if seen.is_break() {
                return end(iterations, Some(Termination::Cancelled));
            }
            if descent.is_late() {
                return end(iterations, Some(Termination::TimeLimit));
            }
            if iterations >= limit {
                return end(iterations, Some(Termination::IterationLimit));
            }
            let Some(falls) = self.aim(descent) else {
                return end(iterations, None);
            };
            // Predicted decrease within the constraints, without rounding errors.
            let promised = falls.min(inner(&self.effects[0], &self.effects[0]));
            if promised <= 2.0 * worthwhile * cost {
                return end(iterations, None);
            }
            iterations += 1;
            let Direction { slope, stiffness } = self.choose(question, falls, last_falls);
            last_falls = Some(falls);
            let longest = self.longest_share(question);
            let mut share = longest.min(slope / (bend * stiffness));
            let mut gained = None;
            for _ in 0..halvings {
                let space = question.space();
                space.integrate_share(&self.x, share, &self.direction, &mut self.trial);
                space.project(&mut self.trial);
                let back = self.bring_back(descent);
                let now = match back {
                    true => self.cost_at_trial(descent),
                    false => f64::INFINITY,
                };
                descent.counts.residuals += usize::from(back);
                if back && now.is_finite() {
                    let bent = 2.0 * (now - cost + share * slope) / (share * share * stiffness);
                    bend = bent.clamp(BENDS.0, BENDS.1);
                }
                if now < cost {
                    gained = Some(now);
                    break;
                }
                share *= 0.5;
                share = share.min(slope / (bend * stiffness));
            }
            let Some(now) = gained else {
                // A restart with the steepest step would exceed the iterations of a frame.
                return end(iterations, None);
            };
            // The swapped-out vectors serve as buffers.
            let way = &mut self.last_best;
            moved = question.space().distance(&self.trial, &self.x, way);
            std::mem::swap(&mut self.x, &mut self.trial);
            std::mem::swap(&mut self.best, &mut self.last_best);
            cost = now;
        }
    }

    /// Writes the Gauss-Newton step into `best`. Returns the slope of the cost along it, if it is finite.
    fn aim(&mut self, descent: &mut DescentProblem<'_, '_>) -> Option<f64> {
        self.cost_at_x(descent);
        descent.jacobian(TaskSubset::rank(self.rank), &self.x, &mut self.jacobian);
        if !self.step.take_pulls(&self.jacobian, &self.pulls) {
            return None;
        }
        if self.held.inequalities.any() {
            let space = descent.question.space();
            let fixed = self.fixed.iter().enumerate();
            let pinned = fixed.map(|(j, fixed)| *fixed || !space.is_between_bounds(&self.x, j));
            self.newton.pinned.clear();
            self.newton.pinned.extend(pinned);
            self.take_lagrangian(descent);
            self.held.inequalities.stand_where_they_work();
        } else {
            self.held.take_rows(descent, &self.x, &self.fixed, false);
        }
        let held = self.held.rows();
        let within = StepBounds {
            x: &self.x,
            space: descent.question.space(),
            fixed: &self.fixed,
        };
        self.step
            .pull(held, &self.jacobian, &self.pulls, &within, &mut self.best);
        let [effect, _] = &mut self.effects;
        multiply(&self.jacobian, &self.best, effect);
        let falls = -inner(effect, &self.pulls);
        falls.is_finite().then_some(falls)
    }

    /// Makes the step conjugate to the last direction, unless that slope is too small.
    fn choose(
        &mut self,
        question: ProblemInstance<'_>,
        falls: f64,
        last_falls: Option<f64>,
    ) -> Direction {
        let [effect, other] = &mut self.effects;
        let straight = Direction {
            slope: falls,
            stiffness: inner(effect, effect),
        };
        if let Some(last_falls) = last_falls {
            multiply(&self.jacobian, &self.last_best, other);
            let kept = ((falls - inner(effect, other)) / last_falls).max(0.0);
            let space = question.space();
            let steps = self.direction.iter_mut().zip(&self.best).zip(&self.fixed);
            for (j, ((direction, best), fixed)) in steps.enumerate() {
                let way = best + kept * *direction;
                let outward = space.holds(&self.x, j, -way, 0.0);
                *direction = if outward || *fixed { 0.0 } else { way };
            }
            multiply(&self.jacobian, &self.direction, effect);
            let slope = -inner(effect, &self.pulls);
            if slope >= CONJUGATE * falls {
                return Direction {
                    slope,
                    stiffness: inner(effect, effect),
                };
            }
        }
        self.direction.copy_from_slice(&self.best);
        straight
    }
}

/// Slope and curvature of the cost along a direction.
struct Direction {
    slope: f64,
    stiffness: f64,
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
