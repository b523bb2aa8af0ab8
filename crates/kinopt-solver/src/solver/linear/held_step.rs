//! Least-squares step with equality constraints and bounds.

use nalgebra::DMatrix;

use super::cholesky;
use super::dense::{add_scaled, dot};
use crate::solver::ConfigurationSpace;
use kinopt_kinematics::buffer::{refill, vacate};

/// Smallest stiffness of a variable, relative to the largest, for variables on which almost no row depends.
const MIN_STIFFNESS: f64 = 1e-6;
/// Relative regularisation of Newton's matrix, for dependent constraints.
const REGULARISATION: f64 = 1e-12;
/// Largest number of Newton steps.
const MAX_NEWTON_STEPS: usize = 40;
/// Fraction of the predicted increase that a Newton step must achieve.
const MIN_INCREASE_FRACTION: f64 = 1e-4;
/// Smallest fraction of a Newton step that is tried.
const MIN_STEP_FRACTION: f64 = 1e-15;

/// Bounds of a step's variables.
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct StepBounds<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) space: ConfigurationSpace<'a>,
    /// Flags of the variables that must not move.
    pub(crate) fixed: &'a [bool],
}

/// Minimises ½‖r + JΔ‖² subject to CΔ = −c and the bounds, for the r and J of an objective and the constraints C.
///
/// Rows of J with a single entry (those of a posture) form a diagonal H. The other rows, E, are unknowns together with
/// the multipliers y of C. With M = [C; E] the remaining system has the order of M's rows. Without bounds it is (M
/// H⁻¹Mᵀ + diag(0, 1)) w = (c, r_E) − M H⁻¹g, and Δ = −H⁻¹(g + Mᵀw).
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct HeldStep {
    /// Diagonal of H, by variable.
    stiffness: Vec<f64>,
    /// g: slope of the rows with a single entry, by variable.
    slope: Vec<f64>,
    entries_of_row: Vec<usize>,
    /// Rows of E among the objective's rows.
    dense: Vec<usize>,
    /// M by columns.
    columns: Vec<f64>,
    /// Right side (c, r_E).
    bias: Vec<f64>,
    factor: Vec<f64>,
    pivot_column: Vec<f64>,
    /// Unknowns w.
    unknown: Vec<f64>,
    /// Unknowns w at the start of a Newton step.
    start: Vec<f64>,
    /// Newton step of w.
    newton: Vec<f64>,
    slope_of_dual: Vec<f64>,
    /// Flags of the variables that move freely.
    moving: Vec<bool>,
    /// Flags of the variables that moved freely before the last step of w.
    last_moving: Vec<bool>,
}

impl HeldStep {
    /// Reserves memory for every problem of this shape.
    pub(crate) fn reserve(&mut self, constraints: usize, objective_rows: usize, variables: usize) {
        let order = constraints + objective_rows;
        for (vector, capacity) in [
            (&mut self.stiffness, variables),
            (&mut self.slope, variables),
            (&mut self.columns, variables * order),
            (&mut self.bias, order),
            (&mut self.factor, order * order),
            (&mut self.pivot_column, 2 * order),
            (&mut self.unknown, order),
            (&mut self.start, order),
            (&mut self.newton, order),
            (&mut self.slope_of_dual, order),
        ] {
            vacate(vector, capacity);
        }
        vacate(&mut self.entries_of_row, objective_rows);
        vacate(&mut self.dense, objective_rows);
        for moving in [&mut self.moving, &mut self.last_moving] {
            vacate(moving, variables);
        }
    }

    /// Sets J and r of the objective. Returns false if all columns are zero or not finite.
    pub(crate) fn set_objective(&mut self, jacobian: &DMatrix<f64>, residual: &[f64]) -> bool {
        let (rows, n) = jacobian.shape();
        let entries = jacobian.as_slice();
        let columns = || entries.chunks_exact(rows.max(1));
        refill(&mut self.entries_of_row, rows, 0);
        for column in columns() {
            for (count, &entry) in self.entries_of_row.iter_mut().zip(column) {
                *count += usize::from(entry != 0.0);
            }
        }
        let counts = &self.entries_of_row;
        self.dense.clear();
        self.dense.extend((0..rows).filter(|&row| counts[row] > 1));
        refill(&mut self.stiffness, n, 0.0);
        refill(&mut self.slope, n, 0.0);
        let mut steepest = 0.0_f64;
        for ((column, stiffness), slope) in columns().zip(&mut self.stiffness).zip(&mut self.slope)
        {
            steepest = steepest.max(dot(column, column));
            for ((&entry, &value), &count) in column.iter().zip(residual).zip(counts) {
                if count == 1 {
                    *stiffness += entry * entry;
                    *slope += entry * value;
                }
            }
        }
        for stiffness in &mut self.stiffness {
            *stiffness += MIN_STIFFNESS * steepest;
        }
        steepest > 0.0 && steepest.is_finite()
    }

    /// Writes the best step for the objective, subject to CΔ = 0 for C = `held`.
    ///
    /// `jacobian` and `residual` must be those of [`set_objective`](Self::set_objective).
    pub(crate) fn minimise(
        &mut self,
        held: &DMatrix<f64>,
        jacobian: &DMatrix<f64>,
        residual: &[f64],
        bounds: &StepBounds<'_>,
        step: &mut [f64],
    ) {
        let (constraints, rows) = (held.nrows(), jacobian.nrows());
        self.columns.clear();
        for (j, held) in held.as_slice().chunks_exact(constraints.max(1)).enumerate() {
            self.columns.extend_from_slice(held);
            let column = &jacobian.as_slice()[j * rows..(j + 1) * rows];
            self.columns
                .extend(self.dense.iter().map(|&row| column[row]));
        }
        refill(&mut self.bias, constraints, 0.0);
        self.bias
            .extend(self.dense.iter().map(|&row| residual[row]));
        self.solve(constraints, bounds, step);
    }

    /// Writes the shortest step in the metric H of the objective with CΔ = −c, for C = `held` and c = `violation`.
    pub(crate) fn restore(
        &mut self,
        held: &DMatrix<f64>,
        violation: &[f64],
        bounds: &StepBounds<'_>,
        step: &mut [f64],
    ) {
        held.as_slice().clone_into(&mut self.columns);
        violation.clone_into(&mut self.bias);
        self.slope.fill(0.0);
        self.solve(held.nrows(), bounds, step);
    }

    /// Solves the concave dual D(w) of the step by Newton's method.
    ///
    /// For given w each variable moves independently, by −(g + Mᵀw)/H within its bounds. The slope of D is the
    /// remaining error of the constraints and E. The result is exact once no variable changes its state at a bound (Li
    /// & Li 2011, "Projections onto a box and hyperplanes").
    fn solve(&mut self, constraints: usize, bounds: &StepBounds<'_>, step: &mut [f64]) {
        let order = self.bias.len();
        refill(&mut self.unknown, order, 0.0);
        self.compute_moves(bounds, step);
        let mut dual_value = self.dual_value(constraints, step);
        let strengths = (0..constraints).map(|row| {
            let columns = self.columns.chunks_exact(order.max(1));
            let entries = columns.zip(&self.stiffness);
            entries.map(|(c, h)| c[row] * c[row] / h).sum()
        });
        let regularisation = REGULARISATION * strengths.fold(0.0, f64::max);
        for _ in 0..MAX_NEWTON_STEPS {
            self.compute_newton_step(constraints, regularisation, step);
            let predicted_increase = dot(&self.slope_of_dual, &self.newton);
            if predicted_increase.is_nan() || predicted_increase <= 0.0 {
                return;
            }
            std::mem::swap(&mut self.moving, &mut self.last_moving);
            self.unknown.clone_into(&mut self.start);
            let mut fraction = 1.0;
            let increased = loop {
                self.unknown.copy_from_slice(&self.start);
                add_scaled(&mut self.unknown, fraction, &self.newton);
                self.compute_moves(bounds, step);
                let new_value = self.dual_value(constraints, step);
                if new_value >= dual_value + MIN_INCREASE_FRACTION * fraction * predicted_increase {
                    dual_value = new_value;
                    break true;
                }
                fraction *= 0.5;
                if fraction < MIN_STEP_FRACTION {
                    break false;
                }
            };
            // Without an increase only rounding is left.
            if !increased || (fraction == 1.0 && self.moving == self.last_moving) {
                return;
            }
        }
    }

    /// Writes the best move of every variable for the current multipliers.
    fn compute_moves(&mut self, bounds: &StepBounds<'_>, step: &mut [f64]) {
        let order = self.bias.len();
        self.moving.clear();
        for (j, step) in step.iter_mut().enumerate() {
            let column = &self.columns[j * order..(j + 1) * order];
            let unbounded = -(self.slope[j] + dot(column, &self.unknown)) / self.stiffness[j];
            let (max_decrease, max_increase) = bounds.space.room(bounds.x, j);
            let (lower, upper) = (-max_decrease, max_increase);
            let is_fixed = bounds.fixed[j] || lower >= upper;
            let clamped = unbounded.max(lower).min(upper);
            *step = if is_fixed { 0.0 } else { clamped };
            self.moving.push(!is_fixed && clamped == unbounded);
        }
    }

    /// D(w) for the corresponding moves; stores its slope.
    fn dual_value(&mut self, constraints: usize, step: &[f64]) -> f64 {
        let order = self.bias.len();
        self.bias.clone_into(&mut self.slope_of_dual);
        let mut dual_value = dot(&self.bias, &self.unknown);
        for ((column, &step), (slope, stiffness)) in
            (self.columns.chunks_exact(order.max(1)).zip(step))
                .zip(self.slope.iter().zip(&self.stiffness))
        {
            let gradient = slope + dot(column, &self.unknown);
            dual_value += (0.5 * stiffness * step + gradient) * step;
            add_scaled(&mut self.slope_of_dual, step, column);
        }
        for row in constraints..order {
            dual_value -= 0.5 * self.unknown[row] * self.unknown[row];
            self.slope_of_dual[row] -= self.unknown[row];
        }
        dual_value
    }

    /// Computes Newton's step for the variables that move freely.
    fn compute_newton_step(&mut self, constraints: usize, regularisation: f64, step: &[f64]) {
        let order = self.bias.len();
        refill(&mut self.factor, order * order, 0.0);
        for j in (0..step.len()).filter(|&j| self.moving[j]) {
            let column = &self.columns[j * order..(j + 1) * order];
            let compliance = 1.0 / self.stiffness[j];
            for (row, &entry) in column
                .iter()
                .enumerate()
                .filter(|(_, entry)| **entry != 0.0)
            {
                let gram = &mut self.factor[row * order..=row * order + row];
                add_scaled(gram, compliance * entry, &column[..=row]);
            }
        }
        for row in 0..order {
            self.factor[row * order + row] += if row < constraints {
                regularisation
            } else {
                1.0
            };
        }
        cholesky::factorise(&mut self.factor, order, &mut self.pivot_column);
        self.slope_of_dual.clone_into(&mut self.newton);
        cholesky::substitute(&self.factor, order, &mut self.newton);
    }
}
