//! Bounded Gauss-Newton method for problems with a good start.
//!
//! A step minimises the damped model within the bounds by an active set. Variables that would leave their bounds are
//! fixed there, and the rest is solved again. Clamped steps would leave the end effectors of clamped joints off their
//! targets at every sample.

use nalgebra::DMatrix;

use kinopt_solver::problem::{Evaluation, NormalEquations, Problem};
use kinopt_solver::solver::{BranchedMatrix, LeastSquares, dot, half_squared};

/// Initial damping, relative to the scale of JᵀJ, its bounds, and its factors after success and failure.
const DAMPING: f64 = 1e-8;
const MIN_DAMPING: f64 = 1e-10;
const MAX_DAMPING: f64 = 1.0;
/// Damping up to which a step is almost as long as without damping.
const LIGHT_DAMPING: f64 = 1e-7;
const DAMPING_DECREASE: f64 = 0.2;
const DAMPING_INCREASE: f64 = 30.0;
/// Maximum number of active set changes per step.
const MAX_ACTIVE_SET_CHANGES: usize = 8;
/// Maximum number of second-order corrections of a step before damping increases.
const MAX_CORRECTIONS: usize = 2;
/// Relative decrease of the cost below which the descent ends. It also ends if the model predicted the cost this
/// accurately, because the next step would gain no more than the prediction error.
const MIN_RELATIVE_DECREASE: f64 = 1e-4;

/// Scratch memory, and the current damping.
#[derive(Clone, Debug)]
pub(super) struct BoundedDescent {
    residual: Vec<f64>,
    trial_residual: Vec<f64>,
    equations: NormalEquations,
    /// Normal equations at the end of a rejected step.
    trial_equations: NormalEquations,
    factor: BranchedMatrix,
    /// Product of JᵀJ and the step.
    hessian_step: Vec<f64>,
    step: Vec<f64>,
    rhs: Vec<f64>,
    fixed: Vec<bool>,
    trial: Vec<f64>,
    damping: f64,
    /// Scale of the diagonal of JᵀJ, without stiff rows.
    size: f64,
}

impl BoundedDescent {
    /// Creates the memory for a problem. `size` is about the largest diagonal entry of JᵀJ without stiff rows.
    pub(super) fn new(problem: &Problem, size: f64) -> Self {
        let (rows, n) = (problem.rows(), problem.variables());
        let equations = NormalEquations::new(problem);
        Self {
            residual: vec![0.0; rows],
            trial_residual: vec![0.0; rows],
            factor: equations.matrix().clone(),
            trial_equations: equations.clone(),
            equations,
            hessian_step: vec![0.0; n],
            step: vec![0.0; n],
            rhs: vec![0.0; n],
            fixed: vec![false; n],
            trial: vec![0.0; n],
            damping: DAMPING,
            size,
        }
    }

    /// Residual r at the end of the last descent.
    pub(super) fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Descends from x, which must be within the bounds, in at most `steps` steps. Returns false and keeps x if a cost
    /// is not finite.
    pub(super) fn descend(
        &mut self,
        problem: &mut Evaluation<'_>,
        x: &mut [f64],
        steps: usize,
    ) -> bool {
        problem.residual(x, &mut self.residual);
        let mut cost = half_squared(&self.residual);
        for _ in 0..steps {
            if !cost.is_finite() {
                return false;
            }
            problem.normal_equations(x, &self.residual, &mut self.equations);
            let Some((lower, predicted)) = self.try_steps(problem, x, cost) else {
                break;
            };
            x.copy_from_slice(&self.trial);
            self.residual.copy_from_slice(&self.trial_residual);
            let decrease = cost - lower;
            cost = lower;
            let is_predicted = predicted
                .is_some_and(|predicted| (lower - predicted).abs() < MIN_RELATIVE_DECREASE * cost);
            if decrease < MIN_RELATIVE_DECREASE * cost
                || (is_predicted && self.damping <= LIGHT_DAMPING)
            {
                break;
            }
        }
        cost.is_finite()
    }

    /// Returns the cost after an accepted step and the cost that the model predicted, if it did. Returns `None` if no
    /// step decreases the cost.
    fn try_steps(
        &mut self,
        problem: &mut Evaluation<'_>,
        x: &[f64],
        cost: f64,
    ) -> Option<(f64, Option<f64>)> {
        let mut is_first = true;
        loop {
            let is_last = self.damping >= MAX_DAMPING;
            if self.solve(problem, x) {
                self.trial.copy_from_slice(x);
                self.apply_step(problem);
                let predicted = cost + self.model_change();
                for correction in 0..=MAX_CORRECTIONS {
                    if correction > 0 {
                        self.correct(problem, x);
                    }
                    problem.residual(&self.trial, &mut self.trial_residual);
                    let trial_cost = half_squared(&self.trial_residual);
                    if trial_cost < cost {
                        self.damping = (DAMPING_DECREASE * self.damping).max(MIN_DAMPING);
                        return Some((trial_cost, Some(predicted)));
                    }
                }
                if is_first || is_last {
                    if let Some(lower) = self.try_second_step(problem, x, cost) {
                        return Some((lower, None));
                    }
                }
            }
            is_first = false;
            if is_last {
                self.damping = DAMPING;
                return None;
            }
            self.damping = (DAMPING_INCREASE * self.damping).min(MAX_DAMPING);
        }
    }

    /// Moves the trial by the step, within the bounds.
    fn apply_step(&mut self, problem: &Evaluation<'_>) {
        let bounds = problem.lower().iter().zip(problem.upper());
        for ((trial, step), (lower, upper)) in self.trial.iter_mut().zip(&self.step).zip(bounds) {
            *trial = (*trial + step).max(*lower).min(*upper);
        }
    }

    /// Returns the cost after a second step from the end of the rejected one, if it is lower than at x. This is a
    /// watchdog (Chamberlain, Powell, Lemarechal & Pedersen 1982).
    ///
    /// The second step uses the model at its start. The model at x lacks residuals that act only there, such as the
    /// ground under a foot at its edge. It would repeat the rejected step.
    fn try_second_step(
        &mut self,
        problem: &mut Evaluation<'_>,
        x: &[f64],
        cost: f64,
    ) -> Option<f64> {
        self.trial.copy_from_slice(x);
        self.apply_step(problem);
        problem.residual(&self.trial, &mut self.trial_residual);
        let trial_equations = &mut self.trial_equations;
        problem.normal_equations(&self.trial, &self.trial_residual, trial_equations);
        let trial = std::mem::take(&mut self.trial);
        std::mem::swap(&mut self.equations, &mut self.trial_equations);
        let is_solved = self.solve(problem, &trial);
        std::mem::swap(&mut self.equations, &mut self.trial_equations);
        self.trial = trial;
        self.apply_step(problem);
        problem.residual(&self.trial, &mut self.trial_residual);
        let lower = half_squared(&self.trial_residual);
        (is_solved && lower < cost).then_some(lower)
    }

    /// Returns the change of the model's cost by the step.
    fn model_change(&mut self) -> f64 {
        self.equations
            .matrix()
            .multiply(&self.step, &mut self.hessian_step);
        dot(self.equations.gradient(), &self.step) + 0.5 * dot(&self.hessian_step, &self.step)
    }

    /// Corrects the trial with its own residual and the same model (second-order correction).
    ///
    /// Otherwise long steps along stiff rows would be rejected because of curvature (Maratos 1978; Nocedal & Wright
    /// 2006, "Numerical optimization", 18.3).
    fn correct(&mut self, problem: &mut Evaluation<'_>, x: &[f64]) {
        let mut empty_matrix = DMatrix::zeros(0, 0);
        problem.gradient(x, &self.trial_residual, &mut self.rhs, &mut empty_matrix);
        for (rhs, fixed) in self.rhs.iter_mut().zip(&self.fixed) {
            *rhs = if *fixed { 0.0 } else { -*rhs };
        }
        self.factor.solve(&mut self.rhs);
        let bounds = problem.lower().iter().zip(problem.upper());
        for ((trial, correction), (lower, upper)) in
            self.trial.iter_mut().zip(&self.rhs).zip(bounds)
        {
            *trial = (*trial + correction).max(*lower).min(*upper);
        }
    }

    /// Writes the step to the minimum of the damped model within the bounds. Returns false if the model has no minimum.
    fn solve(&mut self, problem: &Evaluation<'_>, x: &[f64]) -> bool {
        let n = x.len();
        let (lower, upper) = (problem.lower(), problem.upper());
        self.step.fill(0.0);
        // Variables at a bound stay there if the gradient pushes outward, until the step of the free variables pulls
        // them inward.
        for (k, fixed) in self.fixed.iter_mut().enumerate() {
            let slope = self.equations.gradient()[k];
            *fixed = (x[k] <= lower[k] && slope > 0.0) || (x[k] >= upper[k] && slope < 0.0);
        }
        for round in 0..MAX_ACTIVE_SET_CHANGES {
            if !self.solve_free() {
                return false;
            }
            let mut changed = round == 0 && self.release_inward(x, lower);
            for k in 0..n {
                let (down, up) = (lower[k] - x[k], upper[k] - x[k]);
                if !self.fixed[k] && (self.step[k] < down || self.step[k] > up) {
                    self.step[k] = self.step[k].max(down).min(up);
                    (self.fixed[k], changed) = (true, true);
                }
            }
            if !changed {
                break;
            }
        }
        self.step.iter().all(|step| step.is_finite())
    }

    /// Releases fixed variables that are pulled inward. Returns whether there were any.
    fn release_inward(&mut self, x: &[f64], lower: &[f64]) -> bool {
        if !self.fixed.contains(&true) {
            return false;
        }
        self.equations
            .matrix()
            .multiply(&self.step, &mut self.hessian_step);
        let mut any = false;
        for (k, fixed) in self.fixed.iter_mut().enumerate().filter(|entry| *entry.1) {
            let slope = self.equations.gradient()[k] + self.hessian_step[k];
            let inward = if x[k] <= lower[k] {
                slope < 0.0
            } else {
                slope > 0.0
            };
            if inward {
                (*fixed, any) = (false, true);
            }
        }
        any
    }

    /// Writes the step of the variables that are not fixed. Returns false if the model has no minimum.
    fn solve_free(&mut self) -> bool {
        for (rhs, slope) in self.rhs.iter_mut().zip(self.equations.gradient()) {
            *rhs = -slope;
        }
        let damping = self.damping * self.size;
        let fixed = (self.fixed.as_slice(), self.step.as_slice());
        let matrix = self.equations.matrix();
        self.factor.copy_free(matrix, damping, fixed, &mut self.rhs);
        if !self.factor.factorise() {
            return false;
        }
        self.factor.solve(&mut self.rhs);
        self.step.copy_from_slice(&self.rhs);
        true
    }
}
