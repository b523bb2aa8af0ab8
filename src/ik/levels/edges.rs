//! Rows with room, at its edge: held, unless what ranks below them pulls inward.
//!
//! A row of a reached rank that has room costs nothing within it, so that it holds only what pushes it outward: it is
//! the inequality |row| ≤ 0, and belongs to the working set while its multiplier pushes against the edge (Nocedal &
//! Wright 2006, section 16.5). Which rows have room is not declared; a row that vanishes a little way in has.

use std::ops::Range;

use nalgebra::DMatrix;

use super::asked::Asked;
use super::held::{HeldRank, is_of_reached};
use crate::problem::{Question, Share};

/// How far round a corner gradients are taken, as a multiple of how far beyond an edge rows are left.
const ROUND: f64 = 4.0;
/// By how much a block is bent there at least where it has a corner, as a share of what its gradients say.
const BENT: f64 = 1e-5;

/// What is known of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Side {
    #[default]
    Unknown,
    /// It vanishes a little way in.
    One,
    Both,
}

/// The rows of the ranks above one that may have an edge.
#[derive(Clone, Debug, Default)]
pub(super) struct Edges {
    /// By row: how far beyond its edge it is left, so that it is seen there; 0 for a row without.
    slack: Vec<f64>,
    side: Vec<Side>,
    /// The rows of its quantity: at a corner they vanish together.
    block: Vec<Range<usize>>,
    /// Which have gradients of another place round a corner.
    turned: Vec<bool>,
    /// Which rows are let go at the place that is looked at.
    released: Vec<bool>,
    /// Which hold nothing there: those, and those within their room.
    free: Vec<bool>,
    /// The residual where a step begins.
    here: Vec<f64>,
    /// Another place, and the residual there.
    inside: Vec<f64>,
    there: Vec<f64>,
    step: Vec<f64>,
    /// What a block would be there, were it straight, and the gradients round its corner.
    straight: Vec<f64>,
    round: DMatrix<f64>,
}

impl Edges {
    /// Learns of which rows it may be asked: those of reached ranks whose tasks may have edges.
    pub(super) fn take(&mut self, question: Question<'_>, ranks: &[HeldRank], rows: usize) {
        self.slack.clear();
        self.slack.resize(rows, 0.0);
        self.block.clear();
        self.block.resize(rows, 0..0);
        let problem = question.problem;
        for (index, task, own) in problem.tasks_of(Share::above(ranks.len())) {
            let edged = question.residual(index).has_edges();
            let kept = task.blocks().filter(|block| edged && task.keeps(block));
            for block in kept {
                let rows = block.rows_after(task.rows.start, own.start);
                let reached = rows
                    .clone()
                    .filter(|row| is_of_reached(problem, ranks, *row));
                for row in reached {
                    self.slack[row] = 0.5 * block.kept_within();
                    self.block[row] = rows.clone();
                }
            }
        }
        self.side.clear();
        self.side.resize(rows, Side::Unknown);
        for flags in [&mut self.released, &mut self.free, &mut self.turned] {
            flags.clear();
            flags.resize(rows, false);
        }
    }

    /// Whether any row may have an edge.
    pub(super) fn any(&self) -> bool {
        self.slack.iter().any(|slack| *slack > 0.0)
    }

    /// Holds all rows again, at another place.
    pub(super) fn hold_all(&mut self) {
        self.released.fill(false);
        self.turned.fill(false);
        // A corner is one at its place alone.
        for side in self.side.iter_mut().filter(|side| **side == Side::Both) {
            *side = Side::Unknown;
        }
    }

    /// Takes what is let go out of a Jacobian.
    pub(super) fn take_out(&self, jacobian: &mut DMatrix<f64>) {
        let rows = jacobian.nrows().max(1);
        for (row, _) in self.released.iter().enumerate().filter(|(_, out)| **out) {
            let entries = jacobian.as_mut_slice().iter_mut();
            entries
                .skip(row)
                .step_by(rows)
                .for_each(|entry| *entry = 0.0);
        }
    }

    /// By how much rows have changed from what is kept of them: nowhere within their room, nor a little beyond.
    pub(super) fn change(&mut self, now: &mut [f64], kept: &[f64]) {
        // For what they let through, which is asked where there are edges.
        if self.any() {
            self.there.clear();
            self.there.extend_from_slice(now);
        }
        for (row, (now, kept)) in now.iter_mut().zip(kept).enumerate() {
            *now -= match (self.slack[row], self.side[row]) {
                (slack, Side::One | Side::Unknown) if slack > 0.0 => {
                    now.clamp(kept.min(-slack), kept.max(slack))
                }
                _ => *kept,
            };
        }
    }

    /// What of a rank's gain is not its own, but let through by the rows that stand at an edge: λᵀ of their change from
    /// x to where the last change was taken.
    pub(super) fn let_through(&self, multipliers: &[f64]) -> f64 {
        let rows = self.there.iter().zip(&self.here).zip(multipliers);
        let rows = rows.zip(self.slack.iter().zip(&self.free));
        let standing = rows.filter(|(_, (slack, free))| **slack > 0.0 && !**free);
        let through = standing.map(|(((there, here), multiplier), _)| multiplier * (there - here));
        through.sum()
    }

    /// Lets go of the row that what ranks below pulls inward hardest, by the multipliers of the rows at x, or goes round
    /// a corner with those of its block; whether there was one.
    pub(super) fn let_go(
        &mut self,
        asked: &mut Asked<'_, '_>,
        ranks: &[HeldRank],
        x: &[f64],
        (jacobian, residual): (&mut DMatrix<f64>, &[f64]),
        multiplier: impl Fn(usize) -> f64,
    ) -> bool {
        loop {
            let Some(row) = self.hardest(jacobian, residual, &multiplier) else {
                // At a corner signs say little.
                let turned = (0..residual.len()).any(|row| {
                    let here = (&mut *jacobian, residual);
                    let begins = self.block[row].start == row && self.block[row].len() > 1;
                    begins && self.turn(asked, ranks, x, here, (row, &multiplier))
                });
                if turned {
                    return true;
                }
                let idle = |row: usize| jacobian.row(row).iter().all(|entry| *entry == 0.0);
                let rows = 0..residual.len();
                self.here.clear();
                self.here.extend_from_slice(residual);
                self.free.clear();
                self.free
                    .extend(rows.map(|row| self.slack[row] > 0.0 && idle(row)));
                return false;
            };
            if self.side[row] == Side::Unknown || residual[row] == 0.0 {
                let inward = multiplier(row).signum();
                let here = (&*jacobian, residual);
                self.side[row] = self.look(asked, ranks, x, here, (row, inward));
            }
            if self.side[row] == Side::One {
                self.released[row] = true;
                return true;
            }
        }
    }

    /// The row that may vanish and is pulled inward hardest: beyond its edge a row is pushed further out where it and its
    /// multiplier have one sign; on it, its own arithmetic says.
    fn hardest(
        &self,
        jacobian: &DMatrix<f64>,
        residual: &[f64],
        multiplier: impl Fn(usize) -> f64,
    ) -> Option<usize> {
        let rows = (0..residual.len()).filter(|&row| {
            let may_vanish = self.slack[row] > 0.0 && self.side[row] != Side::Both;
            may_vanish && !self.released[row] && multiplier(row) * residual[row] <= 0.0
        });
        let pulls = rows.map(|row| (row, multiplier(row).abs() * jacobian.row(row).norm()));
        let pulled = pulls.filter(|(_, pull)| *pull > 0.0);
        let hardest = pulled.max_by(|a, b| a.1.total_cmp(&b.1));
        hardest.map(|(row, _)| row)
    }

    /// At a corner several rows hold what one of its edges would: where what they are pulled by slides along one, takes
    /// their gradients a little way there. Whether it does.
    fn turn(
        &mut self,
        asked: &mut Asked<'_, '_>,
        ranks: &[HeldRank],
        x: &[f64],
        (jacobian, residual): (&mut DMatrix<f64>, &[f64]),
        (row, multiplier): (usize, impl Fn(usize) -> f64),
    ) -> bool {
        let (block, share) = (self.block[row].clone(), Share::above(ranks.len()));
        if self.turned[row] {
            return false;
        }
        self.step.clear();
        self.step.resize(x.len(), 0.0);
        for row in block.clone() {
            let (gradient, by) = (jacobian.row(row), multiplier(row));
            for (step, entry) in self.step.iter_mut().zip(gradient.iter()) {
                *step += by * entry;
            }
        }
        let effect = |row: usize| -> f64 {
            let gradient = jacobian.row(row);
            let along = gradient.iter().zip(&self.step);
            along.map(|(entry, step)| entry * step).sum()
        };
        let norm = |entry: &dyn Fn(usize) -> f64| {
            let squares = block.clone().map(|row| entry(row) * entry(row));
            squares.sum::<f64>().sqrt()
        };
        let way = ROUND * self.slack[row] / norm(&effect);
        if !way.is_finite() {
            return false;
        }
        let straight = |row: usize| residual[row] + way * effect(row);
        let least = BENT * norm(&straight);
        self.straight.clear();
        self.straight.extend(block.clone().map(straight));
        for step in &mut self.step {
            *step *= way;
        }
        self.go(asked, share, x, residual.len());
        if norm(&|row| self.there[row] - self.straight[row - block.start]) <= least {
            return false;
        }
        let mut round = std::mem::take(&mut self.round);
        round.resize_mut(jacobian.nrows(), jacobian.ncols(), 0.0);
        asked.held_jacobian(share, &self.inside, &mut round);
        for row in block {
            jacobian.set_row(row, &round.row(row));
            self.turned[row] = true;
        }
        self.round = round;
        true
    }

    /// Takes the residual a step from x.
    fn go(&mut self, asked: &mut Asked<'_, '_>, share: Share, x: &[f64], rows: usize) {
        self.inside.clear();
        self.inside.resize(x.len(), 0.0);
        self.there.clear();
        self.there.resize(rows, 0.0);
        let space = asked.question.space();
        space.integrate(x, &self.step, &mut self.inside);
        asked.residual(share, &self.inside, &mut self.there);
    }

    /// Whether a row vanishes a little way in: goes there along its gradient, bounds aside.
    fn look(
        &mut self,
        asked: &mut Asked<'_, '_>,
        ranks: &[HeldRank],
        x: &[f64],
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
        (row, inward): (usize, f64),
    ) -> Side {
        let gradient = jacobian.row(row);
        let way = (inward * self.slack[row] - residual[row]) / gradient.norm_squared();
        if !way.is_finite() {
            return Side::Both;
        }
        self.step.clear();
        self.step.extend(gradient.iter().map(|entry| way * entry));
        self.go(asked, Share::above(ranks.len()), x, residual.len());
        match self.there[row] == 0.0 {
            true => Side::One,
            false => Side::Both,
        }
    }

    /// How far a step has led out of rooms that held nothing where it began, by the residual after it: 0 within all, up
    /// to 1 at the edge of one, more beyond.
    pub(super) fn beyond(&self, residual: &[f64]) -> f64 {
        let rows = residual.iter().zip(&self.slack).zip(&self.free);
        let free = rows.filter(|(_, free)| **free);
        let shares = free.map(|((row, slack), _)| row.abs() / slack);
        shares.fold(0.0, f64::max)
    }
}
