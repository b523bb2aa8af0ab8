//! Which rows are held at a solution, and which pull.

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
        let is_reached = problem.is_reached(r);
        let within_goals = problem.search_share() == Share::Goals;
        let hold = is_reached && (within_goals || !problem.has_preferences());
        let tasks = problem.compiled_tasks().iter();
        for task in tasks {
            match (hold, within_goals) {
                (true, false) => held.extend(asked(task)),
                (true, true) if task.binds => held.extend(asked(task)),
                (false, true) if !task.binds => {}
                _ => pulled.extend(task.rows.clone()),
            }
        }
    }
}

/// The rows of a task for which not any error will do.
fn asked(task: &CompiledTask) -> impl Iterator<Item = usize> {
    let blocks = task.blocks().filter(|block| block.can_miss());
    blocks.flat_map(|block| block.rows.clone())
}
