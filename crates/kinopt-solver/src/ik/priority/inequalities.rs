//! Inequality constraints from the pose bounds of required tasks in higher levels.
//!
//! A reached task within its bounds costs nothing and constrains only steps that would leave them. Each inequality is
//! slack(x) ≥ 0, linearised per step. It acts as an equation while its multiplier has the sign of a pushing constraint
//! (Nocedal & Wright 2006, sections 16.5 and 18.1). An inequality on which an unreached level in between rests is
//! locked as an equation.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::level_constraints::LevelConstraint;
use crate::problem::TaskSubset;
use crate::solver::Inequalities;
use kinopt_kinematics::buffer::refill;

/// Inequality constraint of one bound.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BoundInequality {
    pub(super) rank: usize,
    /// True if its task is reached within the bounds. The rows of the task are equations otherwise.
    pub(super) is_enabled: bool,
    /// Smallest allowed slack: 0, or the negative slack at the start if that is within tolerance.
    pub(super) min_slack: f64,
    /// Slack below which the inequality is active.
    pub(super) active_slack: f64,
    /// True if an unreached level rests on it.
    pub(super) is_locked: bool,
    /// True if it is in the active set.
    pub(super) is_active: bool,
    /// True if the model of the last step ended on it.
    pub(super) ended_step: bool,
    /// True if the trial must end on it.
    pub(super) is_required: bool,
    /// True if the trial has crossed it.
    pub(super) is_crossed: bool,
}

impl BoundInequality {
    /// Returns whether it acts as an equation.
    fn is_equation(&self) -> bool {
        self.is_enabled && (self.is_locked || self.is_active)
    }
}

/// Inequality constraints of the levels above one level.
#[derive(Clone, Debug, Default)]
pub(super) struct LevelInequalities {
    pub(super) edges: Vec<BoundInequality>,
    /// For each residual row, whether inequalities replace it.
    pub(super) replaced_rows: Vec<bool>,
    /// Slacks at the current variables.
    pub(super) slacks: Vec<f64>,
    /// Jacobian of the slacks at the current variables.
    pub(super) jacobian: DMatrix<f64>,
    /// Largest decrease of each slack that a step may make.
    max_decrease: Vec<f64>,
    pub(super) trial_slacks: Vec<f64>,
    pub(super) trial_jacobian: DMatrix<f64>,
}

impl LevelInequalities {
    /// Resizes for a number of inequalities, residual rows and variables.
    pub(super) fn fit(&mut self, edges: usize, rows: usize, variables: usize) {
        refill(&mut self.edges, edges, BoundInequality::default());
        refill(&mut self.replaced_rows, rows, false);
        for slacks in [&mut self.slacks, &mut self.trial_slacks] {
            slacks.resize(edges, 0.0);
        }
        for jacobian in [&mut self.jacobian, &mut self.trial_jacobian] {
            if jacobian.shape() != (edges, variables) {
                *jacobian = DMatrix::zeros(edges, variables);
            }
        }
    }

    /// Number of inequalities.
    pub(super) fn len(&self) -> usize {
        self.edges.len()
    }

    /// Selects the inequalities that apply from `x` on.
    pub(super) fn select(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        ranks: &[LevelConstraint],
        x: &[f64],
    ) {
        self.edges.fill(BoundInequality::default());
        self.replaced_rows.fill(false);
        if self.edges.is_empty() {
            return;
        }
        descent.slacks(TaskSubset::above(ranks.len()), x, &mut self.slacks);
        for bounds in descent.instance.problem.inequalities_above(ranks.len()) {
            let reached = ranks
                .iter()
                .any(|level| level.rank == bounds.rank && level.reached);
            let slacks = &self.slacks[bounds.slacks.clone()];
            let is_enabled =
                reached && slacks.iter().all(|slack| *slack >= -2.0 * bounds.tolerance);
            for (edge, slack) in self.edges[bounds.slacks].iter_mut().zip(slacks) {
                *edge = BoundInequality {
                    rank: bounds.rank,
                    is_enabled,
                    min_slack: slack.min(0.0),
                    active_slack: bounds.max_change,
                    ..BoundInequality::default()
                };
            }
            self.replaced_rows[bounds.rows].fill(is_enabled);
        }
    }

    /// Returns whether any inequality applies.
    pub(super) fn any(&self) -> bool {
        self.edges.iter().any(|edge| edge.is_enabled)
    }

    /// Computes the slacks and their Jacobian at `x`.
    pub(super) fn evaluate(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        rank: usize,
        x: &[f64],
    ) {
        let subset = TaskSubset::above(rank);
        descent.slacks(subset, x, &mut self.slacks);
        descent.slack_jacobian(subset, x, &mut self.jacobian);
    }

    /// Returns the slack above its smallest allowed value.
    fn gap(&self, edge: usize) -> f64 {
        self.slacks[edge] - self.edges[edge].min_slack
    }

    /// Returns whether an inequality is active at the current variables and not locked.
    pub(super) fn is_binding(&self, edge: usize) -> bool {
        let inequality = self.edges[edge];
        inequality.is_enabled && !inequality.is_locked && self.gap(edge) <= inequality.active_slack
    }

    /// Sets the active set: all active inequalities, or after a step those on which its model ended.
    pub(super) fn choose_active_set(&mut self, has_stepped: bool) {
        for edge in 0..self.edges.len() {
            let is_active = self.is_binding(edge) && (!has_stepped || self.edges[edge].ended_step);
            self.edges[edge].is_active = is_active;
        }
    }

    /// Returns whether the active set is not empty.
    pub(super) fn has_active(&self) -> bool {
        self.edges.iter().any(|edge| edge.is_active)
    }

    /// Removes the inequality with the largest inward multiplier from the active set, and returns its index.
    pub(super) fn drop_inward(&mut self, multipliers: &[f64]) -> Option<usize> {
        let active_edges = (0..self.edges.len()).filter(|&edge| self.edges[edge].is_active);
        let weighted =
            active_edges.map(|edge| (edge, multipliers[edge] * self.jacobian.row(edge).norm()));
        let inward = weighted.filter(|(_, pull)| *pull > 0.0);
        let (edge, _) = inward.max_by(|a, b| a.1.total_cmp(&b.1))?;
        self.edges[edge].is_active = false;
        Some(edge)
    }

    /// Returns the locked inequalities of the tasks of one level.
    pub(super) fn locked_of(&self, rank: usize) -> impl Iterator<Item = usize> {
        let edges = self.edges.iter().enumerate();
        let locked = edges.filter(move |(_, edge)| edge.rank == rank && edge.is_locked);
        locked.map(|(edge, _)| edge)
    }

    /// Returns the inequalities of one level that act as equations.
    pub(super) fn equations_of(&self, rank: usize) -> impl Iterator<Item = usize> {
        let edges = self.edges.iter().enumerate();
        let equations = edges.filter(move |(_, edge)| edge.rank == rank && edge.is_equation());
        equations.map(|(edge, _)| edge)
    }

    /// Locks an inequality at its current slack.
    pub(super) fn lock(&mut self, edge: usize) {
        self.edges[edge].is_locked = true;
        self.edges[edge].min_slack = self.slacks[edge];
    }

    /// Returns the active set.
    pub(super) fn active_set(&self) -> impl Iterator<Item = usize> {
        let edges = self.edges.iter().enumerate();
        edges
            .filter(|(_, edge)| edge.is_active)
            .map(|(edge, _)| edge)
    }

    /// Writes the constraint Jacobian: residual rows first, of which some are replaced, then inequality rows.
    pub(super) fn write_constraint_jacobian(
        &self,
        residual: &DMatrix<f64>,
        jacobian: &mut DMatrix<f64>,
    ) {
        self.write(
            residual,
            &self.jacobian,
            BoundInequality::is_equation,
            jacobian,
        );
    }

    pub(super) fn write(
        &self,
        residual: &DMatrix<f64>,
        edges: &DMatrix<f64>,
        is_equation: impl Fn(&BoundInequality) -> bool,
        jacobian: &mut DMatrix<f64>,
    ) {
        let rows = self.replaced_rows.len();
        let from = residual.as_slice().chunks_exact(rows.max(1));
        let slopes = edges.as_slice().chunks_exact(self.edges.len().max(1));
        let to = jacobian
            .as_mut_slice()
            .chunks_exact_mut(rows + self.edges.len());
        for ((to, from), slopes) in to.zip(from).zip(slopes) {
            for ((to, from), replaced) in to.iter_mut().zip(from).zip(&self.replaced_rows) {
                *to = if *replaced { 0.0 } else { *from };
            }
            for ((to, slope), edge) in to[rows..].iter_mut().zip(slopes).zip(&self.edges) {
                *to = if is_equation(edge) { *slope } else { 0.0 };
            }
        }
    }

    /// Returns the inequalities of a step's model, without locked ones and, if `keeps_active_set`, without the active
    /// set.
    pub(super) fn inequalities(&mut self, keeps_active_set: bool) -> Inequalities<'_> {
        let slacks = self.edges.iter().zip(&self.slacks);
        let decreases = slacks.map(|(edge, slack)| {
            let is_kept = edge.is_locked || (keeps_active_set && edge.is_active);
            match edge.is_enabled && !is_kept {
                true => (slack - edge.min_slack).max(0.0),
                false => f64::INFINITY,
            }
        });
        self.max_decrease.clear();
        self.max_decrease.extend(decreases);
        Inequalities {
            rows: &self.jacobian,
            down: &self.max_decrease,
        }
    }

    /// Subtracts the terms of the active set from a gradient, because the step's model treats it as inequalities.
    pub(super) fn subtract_active_terms(&self, multipliers: &[f64], slope: &mut [f64]) {
        for edge in self.active_set() {
            let row = self.jacobian.row(edge);
            for (slope, entry) in slope.iter_mut().zip(row.iter()) {
                *slope -= multipliers[edge] * entry;
            }
        }
    }
}
