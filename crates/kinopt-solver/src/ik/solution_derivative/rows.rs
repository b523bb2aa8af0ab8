//! Constrained and minimised rows at a solution.

use std::cmp::Ordering;

use crate::problem::{CompiledTask, ProblemInstance, TaskSubset};

/// Roles of the residual rows of all tasks at a solution.
#[derive(Clone, Debug, Default)]
pub(super) struct Roles {
    /// Constrained rows: reached required tasks.
    pub(super) constrained: Vec<usize>,
    /// Minimised rows: half their squared sum is minimal.
    pub(super) minimised: Vec<usize>,
}

impl Roles {
    /// Determines the roles from the weighted residual of all tasks.
    pub(super) fn assign(&mut self, instance: ProblemInstance<'_>, r: &[f64]) {
        let problem = instance.problem();
        let Self {
            constrained,
            minimised,
        } = self;
        constrained.clear();
        minimised.clear();
        let tasks = problem.compiled_tasks().iter();
        if problem.searched_subset() == TaskSubset::All {
            let is_constrained =
                problem.is_reached_by(TaskSubset::All, r) && !problem.has_preferences();
            for task in tasks {
                match is_constrained {
                    true => constrained.extend(limited_rows(task)),
                    false => minimised.extend(task.rows.clone()),
                }
            }
            return;
        }
        // The first level that is not all reached goals is minimised subject to those above it. Lower levels have no
        // role.
        let (ranks, levels) = (problem.ranks().count(), problem.ranks().levels());
        let is_unreached = |rank: usize| {
            let mut errors = problem.errors(TaskSubset::All, r);
            errors.any(|block| {
                let task = problem.compiled_tasks().get(block.task);
                task.is_some_and(|task| task.rank == rank) && !block.reached
            })
        };
        let mut minimised_ranks = (0..ranks).filter(|&rank| {
            rank >= levels || problem.has_soft_tasks(TaskSubset::rank(rank)) || is_unreached(rank)
        });
        let minimised_rank = minimised_ranks.next().unwrap_or(ranks);
        for task in tasks {
            match task.rank.cmp(&minimised_rank) {
                Ordering::Less => constrained.extend(limited_rows(task)),
                Ordering::Equal => minimised.extend(task.rows.clone()),
                Ordering::Greater => {}
            }
        }
    }
}

/// Returns the rows of a task whose tolerance is finite.
fn limited_rows(task: &CompiledTask) -> impl Iterator<Item = usize> {
    let blocks = task.blocks().filter(|block| block.can_be_unreached());
    blocks.flat_map(|block| block.rows.clone())
}
