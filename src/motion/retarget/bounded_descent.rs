//! A few steps of Gauss-Newton within bounds, for a problem that begins near its end.
//!
//! A step is the damped model's own minimum within the bounds, by an active set: what would go beyond a bound stays on it and
//! the rest is solved anew. A step that is only clamped leaves what hangs on a stopped joint elsewhere than it should
//! be, frame after frame.

use nalgebra::DMatrix;

use crate::motion::clip::BlockBanded;
use crate::solver::{InnerProducts, LeastSquares, dot, half_squared};

/// The first damping, as a share of the size of JᵀJ, and how it follows success and failure.
const DAMPING: f64 = 1e-8;
const LEAST_DAMPING: f64 = 1e-10;
const MOST_DAMPING: f64 = 1.0;
/// Damping up to this hardly shortens a step.
const LIGHT_DAMPING: f64 = 1e-7;
const AFTER_SUCCESS: f64 = 0.2;
const AFTER_FAILURE: f64 = 30.0;
/// So often the step is solved anew with other variables on their bounds.
const ROUNDS: usize = 8;
/// So often a step that wins nothing is corrected, before it is damped.
const CORRECTIONS: usize = 2;
/// A step that wins less than this share of the cost is the last, and so is one after which the cost is within this share
/// what the model told: the next one's would win no more than it was off.
const FLAT: f64 = 1e-4;

/// Memory, and the damping that was learnt.
#[derive(Clone, Debug)]
pub(super) struct BoundedDescent {
    residual: Vec<f64>,
    trial_residual: Vec<f64>,
    jacobian: DMatrix<f64>,
    products: InnerProducts,
    all: Vec<usize>,
    gram: Vec<f64>,
    factor: BlockBanded,
    gradient: Vec<f64>,
    step: Vec<f64>,
    right: Vec<f64>,
    held: Vec<bool>,
    trial: Vec<f64>,
    room: Vec<f64>,
    damping: f64,
    /// How large a diagonal entry of JᵀJ is of what is not stiff.
    size: f64,
}

impl BoundedDescent {
    /// For so many rows and variables; `size` is about that of the largest diagonal entry of JᵀJ, without stiff rows.
    pub(super) fn new(rows: usize, variables: usize, size: f64) -> Self {
        let n = variables;
        let mut products = InnerProducts::default();
        products.reserve(n);
        Self {
            residual: vec![0.0; rows],
            trial_residual: vec![0.0; rows],
            jacobian: DMatrix::zeros(rows, n),
            products,
            all: (0..n).collect(),
            gram: vec![0.0; n * n],
            factor: BlockBanded::new(1, n, 0),
            gradient: vec![0.0; n],
            step: vec![0.0; n],
            right: vec![0.0; n],
            held: vec![false; n],
            trial: vec![0.0; n],
            room: Vec::new(),
            damping: DAMPING,
            size,
        }
    }

    /// r where the last descent ended.
    pub(super) fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Goes downhill from x, which is within the bounds, in at most so many steps. Whether all is finite; else x stays.
    pub(super) fn descend(
        &mut self,
        problem: &mut dyn LeastSquares,
        x: &mut [f64],
        steps: usize,
    ) -> bool {
        problem.residual(x, &mut self.residual);
        let mut cost = half_squared(&self.residual);
        for _ in 0..steps {
            if !cost.is_finite() {
                return false;
            }
            problem.jacobian(x, &mut self.jacobian);
            self.products
                .fill(&self.jacobian, &self.all, &mut self.gram);
            for (slope, column) in self.gradient.iter_mut().zip(self.jacobian.column_iter()) {
                *slope = dot(column.as_slice(), &self.residual);
            }
            let Some((lower, told)) = self.try_steps(problem, x, cost) else {
                break;
            };
            x.copy_from_slice(&self.trial);
            self.residual.copy_from_slice(&self.trial_residual);
            let won = cost - lower;
            cost = lower;
            let was_told = self.damping <= LIGHT_DAMPING && (lower - told).abs() < FLAT * cost;
            if won < FLAT * cost || was_told {
                break;
            }
        }
        cost.is_finite()
    }

    /// The cost after a step that wins, damped as much as that takes, and what the model told of it; none where none does.
    fn try_steps(
        &mut self,
        problem: &mut dyn LeastSquares,
        x: &[f64],
        cost: f64,
    ) -> Option<(f64, f64)> {
        loop {
            if self.solve(problem, x) {
                let (lower, upper) = (problem.lower(), problem.upper());
                for (k, trial) in self.trial.iter_mut().enumerate() {
                    *trial = (x[k] + self.step[k]).max(lower[k]).min(upper[k]);
                }
                let told = cost + self.change_by_step();
                for correction in 0..=CORRECTIONS {
                    if correction > 0 {
                        self.correct(problem);
                    }
                    problem.residual(&self.trial, &mut self.trial_residual);
                    let trial_cost = half_squared(&self.trial_residual);
                    if trial_cost < cost {
                        self.damping = (AFTER_SUCCESS * self.damping).max(LEAST_DAMPING);
                        return Some((trial_cost, told));
                    }
                }
            }
            if self.damping >= MOST_DAMPING {
                self.damping = DAMPING;
                return None;
            }
            self.damping = (AFTER_FAILURE * self.damping).min(MOST_DAMPING);
        }
    }

    /// By how much the model's cost changes by the step.
    fn change_by_step(&self) -> f64 {
        let n = self.step.len();
        let rows = self.gram.chunks_exact(n).zip(&self.step).enumerate();
        let curved: f64 = rows
            .map(|(k, (row, by))| by * (dot(&row[..k], &self.step[..k]) + 0.5 * row[k] * by))
            .sum();
        dot(&self.gradient, &self.step) + curved
    }

    /// Moves the trial by what its own residual asks of the same model: a long step along what is held bends off it, and would
    /// be refused for that alone (Maratos 1978; Nocedal & Wright 2006, "Numerical optimization", 18.3).
    fn correct(&mut self, problem: &dyn LeastSquares) {
        let columns = self.jacobian.column_iter().enumerate();
        for (right, (k, column)) in self.right.iter_mut().zip(columns) {
            *right = match self.held[k] {
                true => 0.0,
                false => -dot(column.as_slice(), &self.trial_residual),
            };
        }
        self.factor.solve(&mut self.right, &mut self.room);
        let bounds = problem.lower().iter().zip(problem.upper());
        for ((trial, by), (lower, upper)) in self.trial.iter_mut().zip(&self.right).zip(bounds) {
            *trial = (*trial + by).max(*lower).min(*upper);
        }
    }

    /// Writes the step to the damped model's minimum within the bounds; false where the model has none.
    fn solve(&mut self, problem: &dyn LeastSquares, x: &[f64]) -> bool {
        let n = x.len();
        let (lower, upper) = (problem.lower(), problem.upper());
        self.step.fill(0.0);
        // What stands at a bound and is pushed against it stays there, unless what else moves pulls it off.
        for (k, held) in self.held.iter_mut().enumerate() {
            let slope = self.gradient[k];
            *held = (x[k] <= lower[k] && slope > 0.0) || (x[k] >= upper[k] && slope < 0.0);
        }
        for round in 0..ROUNDS {
            if !self.solve_free() {
                return false;
            }
            let mut beyond = round == 0 && self.let_go(x, lower);
            for k in 0..n {
                let (down, up) = (lower[k] - x[k], upper[k] - x[k]);
                if !self.held[k] && (self.step[k] < down || self.step[k] > up) {
                    self.step[k] = self.step[k].max(down).min(up);
                    (self.held[k], beyond) = (true, true);
                }
            }
            if !beyond {
                break;
            }
        }
        self.step.iter().all(|step| step.is_finite())
    }

    /// Lets go of what is held and would rather move inward; whether anything is.
    fn let_go(&mut self, x: &[f64], lower: &[f64]) -> bool {
        let n = x.len();
        let mut any = false;
        for k in 0..n {
            if !self.held[k] {
                continue;
            }
            let row = dot(&self.gram[k * n..k * n + k], &self.step[..k]);
            let column = (k..n).map(|below| self.gram[below * n + k] * self.step[below]);
            let slope = self.gradient[k] + row + column.sum::<f64>();
            let inward = if x[k] <= lower[k] {
                slope < 0.0
            } else {
                slope > 0.0
            };
            if inward {
                (self.held[k], any) = (false, true);
            }
        }
        any
    }

    /// Writes the step of what is not held; false where the model has none.
    fn solve_free(&mut self) -> bool {
        let n = self.step.len();
        self.factor.clear();
        for row in 0..n {
            let entries = &mut self.factor.row_mut(0, 0, row)[row..];
            for (column, entry) in entries.iter_mut().enumerate() {
                *entry = self.gram[(row + column) * n + row];
            }
            entries[0] += self.damping * self.size;
        }
        for (right, slope) in self.right.iter_mut().zip(&self.gradient) {
            *right = -slope;
        }
        for held in (0..n).filter(|&held| self.held[held]) {
            let by = self.step[held];
            for (k, right) in self.right.iter_mut().enumerate() {
                let (a, b) = (k.max(held), k.min(held));
                *right -= self.gram[a * n + b] * by;
            }
            self.factor.take_out(0, held);
        }
        for (k, right) in self.right.iter_mut().enumerate() {
            if self.held[k] {
                *right = self.step[k];
            }
        }
        if !self.factor.factorise() {
            return false;
        }
        self.factor.solve(&mut self.right, &mut self.room);
        self.step.copy_from_slice(&self.right);
        true
    }
}
