//! The priority order of tasks, and subsets of a problem's tasks.
//!
//! Tasks of equal rank are weighted against each other; a rank never increases the error of a rank before it. The
//! model's loops come first. Then come the required tasks that can be unreached, level by level. Soft tasks and
//! required tasks with infinite tolerances come last, level by level. If soft tasks are weighted, they join the last
//! level.

use std::ops::Range;

use super::{CompiledTask, Preferences};

/// A subset of a problem's tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TaskSubset {
    /// Every task, in the order of addition.
    All,
    /// The tasks of a range of ranks, rank by rank, and in the order of addition within a rank.
    Ranks {
        /// The first rank.
        from: usize,
        /// One past the last rank.
        to: usize,
    },
}

impl TaskSubset {
    /// The tasks of one rank.
    pub(crate) fn rank(rank: usize) -> Self {
        Self::Ranks {
            from: rank,
            to: rank + 1,
        }
    }

    /// The tasks of all ranks before one.
    pub(crate) fn above(rank: usize) -> Self {
        Self::Ranks { from: 0, to: rank }
    }
}

/// Coarse priority of a task.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
    /// A loop closure.
    Loop,
    /// A required task that can be unreached, or a soft task weighted with it.
    Goal,
    /// A soft task, or a required task with infinite tolerances.
    Soft,
}

/// The ranks of a problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ranks {
    /// End of the rows of each rank, in the priority order.
    ends: Vec<usize>,
    /// Number of leading ranks with required tasks that can be unreached.
    levels: usize,
}

impl Ranks {
    /// Assigns a rank to every task and numbers its rows in the priority order.
    pub(super) fn of(tasks: &mut [CompiledTask], preferences: Preferences) -> Self {
        let last_level = tasks.iter().filter(|task| task.binds && !task.is_loop);
        let last_level = last_level.map(|task| task.level).max();
        let order = |task: &CompiledTask| match (task.binds, preferences, last_level) {
            (true, _, _) if task.is_loop => (Class::Loop, 0),
            (true, _, _) => (Class::Goal, task.level),
            (false, Preferences::Traded, Some(last)) => (Class::Goal, last),
            (false, _, _) => (Class::Soft, task.level),
        };
        let mut ranks: Vec<_> = tasks.iter().map(order).collect();
        ranks.sort_unstable();
        ranks.dedup();
        let (mut ends, mut end) = (Vec::with_capacity(ranks.len()), 0);
        let mut last_edge = 0;
        for (rank, order_of_rank) in ranks.iter().enumerate() {
            for task in tasks
                .iter_mut()
                .filter(|task| order(task) == *order_of_rank)
            {
                task.rank = rank;
                task.rows_by_rank = end..end + task.rows.len();
                end = task.rows_by_rank.end;
                task.slacks_by_rank = last_edge..last_edge + task.slack_weights.len();
                last_edge = task.slacks_by_rank.end;
            }
            ends.push(end);
        }
        let can_be_unreached = tasks.iter().filter(|task| task.binds);
        let levels = can_be_unreached
            .map(|task| task.rank + 1)
            .max()
            .unwrap_or(0);
        Self { ends, levels }
    }

    /// Number of leading ranks with required tasks that can be unreached.
    #[must_use]
    pub(crate) fn levels(&self) -> usize {
        self.levels
    }

    /// Number of ranks.
    #[must_use]
    pub(crate) fn count(&self) -> usize {
        self.ends.len()
    }

    /// Start of the rows of a rank.
    fn start(&self, rank: usize) -> usize {
        rank.checked_sub(1).map_or(0, |last| self.end(last))
    }

    fn end(&self, rank: usize) -> usize {
        self.ends.get(rank).copied().unwrap_or(0)
    }

    /// Number of rows of a range of ranks.
    pub(super) fn rows(&self, from: usize, to: usize) -> usize {
        self.start(to) - self.start(from)
    }

    /// The rows of a rank, among those of all ranks.
    pub(crate) fn rows_of(&self, rank: usize) -> Range<usize> {
        self.start(rank)..self.end(rank)
    }

    /// The rows of a task among those of a subset; `None` if it is not in the subset.
    pub(super) fn rows_in(&self, task: &CompiledTask, subset: TaskSubset) -> Option<Range<usize>> {
        match subset {
            TaskSubset::All => Some(task.rows.clone()),
            TaskSubset::Ranks { from, to } => {
                let first = self.start(from);
                let Range { start, end } = task.rows_by_rank;
                (from..to)
                    .contains(&task.rank)
                    .then(|| start - first..end - first)
            }
        }
    }
}
