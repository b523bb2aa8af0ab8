//! Inequality constraints from the pose bounds of required tasks in higher levels.
//!
//! A reached task within its bounds costs nothing and constrains only steps that would leave them. Each inequality is
//! slack(x) ≥ 0, linearised per step. It acts as an equation while its multiplier has the sign of a pushing constraint
//! (Nocedal & Wright 2006, sections 16.5 and 18.1). An inequality on which an unreached level in between rests is
//! locked as an equation.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::level_constraints::LevelConstraint;
use crate::buffer::refill;
use crate::problem::TaskSubset;
use crate::solver::Inequalities;

/// Inequality constraint of one bound.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Edge {
    pub(super) rank: usize,
    /// True if its task is reached within the bounds. The rows of the task are equations otherwise.
    pub(super) counts: bool,
    /// Smallest allowed slack: 0, or the negative slack at the start if that is within tolerance.
    pub(super) least: f64,
    /// Slack below which the inequality is active.
    pub(super) slack: f64,
    /// True if an unreached level rests on it.
    pub(super) locked: bool,
    /// True if it is in the active set.
    pub(super) works: bool,
    /// True if the model of the last step ended on it.
    pub(super) rests: bool,
    /// True if the trial must end on it.
    pub(super) stands: bool,
    /// True if the trial has crossed it.
    pub(super) joins: bool,
}

impl Edge {
    /// Returns whether it acts as an equation.
    fn holds(&self) -> bool {
        self.counts && (self.locked || self.works)
    }
}

/// Inequality constraints of the levels above one level.
#[derive(Clone, Debug, Default)]
pub(super) struct LevelInequalities {
    pub(super) edges: Vec<Edge>,
    /// For each residual row, whether inequalities replace it.
    pub(super) replaced: Vec<bool>,
    /// Slacks at the current variables.
    pub(super) slacks: Vec<f64>,
    /// Jacobian of the slacks at the current variables.
    pub(super) jacobian: DMatrix<f64>,
    /// Largest decrease of each slack that a step may make.
    down: Vec<f64>,
    pub(super) trial_slacks: Vec<f64>,
    pub(super) jacobian_there: DMatrix<f64>,
}

impl LevelInequalities {
    /// Resizes for a number of inequalities, residual rows and variables.
    pub(super) fn fit(&mut self, edges: usize, rows: usize, variables: usize) {
        refill(&mut self.edges, edges, Edge::default());
        refill(&mut self.replaced, rows, false);
        for slacks in [&mut self.slacks, &mut self.trial_slacks] {
            slacks.resize(edges, 0.0);
        }
        for jacobian in [&mut self.jacobian, &mut self.jacobian_there] {
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
    pub(super) fn take(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        ranks: &[LevelConstraint],
        x: &[f64],
    ) {
        self.edges.fill(Edge::default());
        self.replaced.fill(false);
        if self.edges.is_empty() {
            return;
        }
        descent.slacks(TaskSubset::above(ranks.len()), x, &mut self.slacks);
        for room in descent.question.problem.inequalities_above(ranks.len()) {
            let reached = ranks
                .iter()
                .any(|held| held.rank == room.rank && held.reached);
            let slacks = &self.slacks[room.edges.clone()];
            let counts = reached && slacks.iter().all(|slack| *slack >= -2.0 * room.tolerance);
            for (edge, slack) in self.edges[room.edges].iter_mut().zip(slacks) {
                *edge = Edge {
                    rank: room.rank,
                    counts,
                    least: slack.min(0.0),
                    slack: room.kept_within,
                    ..Edge::default()
                };
            }
            self.replaced[room.rows].fill(counts);
        }
    }

    /// Returns whether any inequality applies.
    pub(super) fn any(&self) -> bool {
        self.edges.iter().any(|edge| edge.counts)
    }

    /// Computes the slacks and their Jacobian at `x`.
    pub(super) fn stand(&mut self, descent: &mut DescentProblem<'_, '_>, rank: usize, x: &[f64]) {
        let share = TaskSubset::above(rank);
        descent.slacks(share, x, &mut self.slacks);
        descent.depth_jacobian(share, x, &mut self.jacobian);
    }

    /// Returns the slack above its smallest allowed value.
    fn gap(&self, edge: usize) -> f64 {
        self.slacks[edge] - self.edges[edge].least
    }

    /// Returns whether an inequality is active at the current variables and not locked.
    pub(super) fn may_work(&self, edge: usize) -> bool {
        let own = self.edges[edge];
        own.counts && !own.locked && self.gap(edge) <= own.slack
    }

    /// Sets the active set: all active inequalities, or after a step those on which its model ended.
    pub(super) fn work(&mut self, has_stepped: bool) {
        for edge in 0..self.edges.len() {
            let works = self.may_work(edge) && (!has_stepped || self.edges[edge].rests);
            self.edges[edge].works = works;
        }
    }

    /// Returns whether the active set is not empty.
    pub(super) fn any_works(&self) -> bool {
        self.edges.iter().any(|edge| edge.works)
    }

    /// Removes the inequality with the largest inward multiplier from the active set, and returns its index.
    pub(super) fn let_go(&mut self, multipliers: &[f64]) -> Option<usize> {
        let working = (0..self.edges.len()).filter(|&edge| self.edges[edge].works);
        let pulls = working.map(|edge| (edge, multipliers[edge] * self.jacobian.row(edge).norm()));
        let inward = pulls.filter(|(_, pull)| *pull > 0.0);
        let (edge, _) = inward.max_by(|a, b| a.1.total_cmp(&b.1))?;
        self.edges[edge].works = false;
        Some(edge)
    }

    /// Returns the locked inequalities of the tasks of one level.
    pub(super) fn locked_of(&self, rank: usize) -> impl Iterator<Item = usize> {
        let edges = self.edges.iter().enumerate();
        let locked = edges.filter(move |(_, edge)| edge.rank == rank && edge.locked);
        locked.map(|(edge, _)| edge)
    }

    /// Returns the inequalities of one level that act as equations.
    pub(super) fn holding_of(&self, rank: usize) -> impl Iterator<Item = usize> {
        let edges = self.edges.iter().enumerate();
        let holding = edges.filter(move |(_, edge)| edge.rank == rank && edge.holds());
        holding.map(|(edge, _)| edge)
    }

    /// Locks an inequality at its current slack.
    pub(super) fn lock(&mut self, edge: usize) {
        self.edges[edge].locked = true;
        self.edges[edge].least = self.slacks[edge];
    }

    /// Returns the active set.
    pub(super) fn working(&self) -> impl Iterator<Item = usize> {
        let edges = self.edges.iter().enumerate();
        edges.filter(|(_, edge)| edge.works).map(|(edge, _)| edge)
    }

    /// Writes the constraint Jacobian: residual rows first, of which some are replaced, then inequality rows.
    pub(super) fn complete(&self, residual: &DMatrix<f64>, whole: &mut DMatrix<f64>) {
        self.write(residual, &self.jacobian, Edge::holds, whole);
    }

    pub(super) fn write(
        &self,
        residual: &DMatrix<f64>,
        edges: &DMatrix<f64>,
        holds: impl Fn(&Edge) -> bool,
        whole: &mut DMatrix<f64>,
    ) {
        let rows = self.replaced.len();
        let from = residual.as_slice().chunks_exact(rows.max(1));
        let slopes = edges.as_slice().chunks_exact(self.edges.len().max(1));
        let to = whole
            .as_mut_slice()
            .chunks_exact_mut(rows + self.edges.len());
        for ((to, from), slopes) in to.zip(from).zip(slopes) {
            for ((to, from), replaced) in to.iter_mut().zip(from).zip(&self.replaced) {
                *to = if *replaced { 0.0 } else { *from };
            }
            for ((to, slope), edge) in to[rows..].iter_mut().zip(slopes).zip(&self.edges) {
                *to = if holds(edge) { *slope } else { 0.0 };
            }
        }
    }

    /// Returns the inequalities of a step's model, without locked ones and, if `keeps_working`, without the active set.
    pub(super) fn inequalities(&mut self, keeps_working: bool) -> Inequalities<'_> {
        let slacks = self.edges.iter().zip(&self.slacks);
        let down = slacks.map(|(edge, slack)| {
            let kept = edge.locked || (keeps_working && edge.works);
            match edge.counts && !kept {
                true => (slack - edge.least).max(0.0),
                false => f64::INFINITY,
            }
        });
        self.down.clear();
        self.down.extend(down);
        Inequalities {
            rows: &self.jacobian,
            down: &self.down,
        }
    }

    /// Subtracts the terms of the active set from a gradient, because the step's model treats it as inequalities.
    pub(super) fn take_out(&self, multipliers: &[f64], slope: &mut [f64]) {
        for edge in self.working() {
            let row = self.jacobian.row(edge);
            for (slope, entry) in slope.iter_mut().zip(row.iter()) {
                *slope -= multipliers[edge] * entry;
            }
        }
    }
}
