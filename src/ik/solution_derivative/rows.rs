//! Which rows are held at a solution, and which pull.

use std::cmp::Ordering;

use crate::problem::{CompiledTask, Question, Share};

/// What the rows of a problem, as all tasks count them, do at a solution.
#[derive(Clone, Debug, Default)]
pub(super) struct Roles {
    /// Rows that keep their value: goals that are reached.
    pub(super) held: Vec<usize>,
    /// Rows whose half squared sum is as low as it can be.
    pub(super) pulled: Vec<usize>,
}

impl Roles {
    /// For the weighted residual of all tasks.
    pub(super) fn take(&mut self, question: Question<'_>, r: &[f64]) {
        let problem = question.problem();
        let Self { held, pulled } = self;
        held.clear();
        pulled.clear();
        let tasks = problem.compiled_tasks().iter();
        if problem.search_share() == Share::All {
            let hold = problem.is_reached_by(Share::All, r) && !problem.has_preferences();
            for task in tasks {
                match hold {
                    true => held.extend(wanted_rows(task)),
                    false => pulled.extend(task.rows.clone()),
                }
            }
            return;
        }
        // The first rank that is not all reached goals pulls within those above; what ranks below it has only
        // what that leaves free.
        let (ranks, levels) = (problem.ranks().count(), problem.ranks().levels());
        let misses = |rank: usize| {
            let mut errors = problem.errors(Share::All, r);
            errors.any(|block| {
                let task = problem.compiled_tasks().get(block.task);
                task.is_some_and(|task| task.rank == rank) && !block.reached
            })
        };
        let mut pulling = (0..ranks)
            .filter(|&rank| rank >= levels || problem.pulls_in(Share::rank(rank)) || misses(rank));
        let pulls = pulling.next().unwrap_or(ranks);
        for task in tasks {
            match task.rank.cmp(&pulls) {
                Ordering::Less => held.extend(wanted_rows(task)),
                Ordering::Equal => pulled.extend(task.rows.clone()),
                Ordering::Greater => {}
            }
        }
    }
}

/// The rows of a task for which not any error will do.
fn wanted_rows(task: &CompiledTask) -> impl Iterator<Item = usize> {
    let blocks = task.blocks().filter(|block| block.can_miss());
    blocks.flat_map(|block| block.rows.clone())
}
