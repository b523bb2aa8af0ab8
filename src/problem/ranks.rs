//! The order in which tasks are met, and the shares of a problem that follow from it.
//!
//! Tasks of one rank are weighed against each other; a rank never costs one above it. First come the model's
//! loops, then the goals that can be missed, level by level, then what only pulls: preferences, and goals for which any error will
//! do, level by level too. Where preferences are traded, all that pulls stands with the last level.

use std::ops::Range;

use super::{CompiledTask, Preferences};

/// A part of a problem's tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Share {
    /// Every task, in the order in which they were added.
    All,
    /// The tasks of these ranks, rank by rank, and by the order in which they were added within one.
    Ranks {
        /// The first one.
        from: usize,
        /// The one after the last.
        to: usize,
    },
}

impl Share {
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

/// What comes before what.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
    /// What closes a loop of the model.
    Loop,
    /// A goal that can be missed.
    Goal,
    /// What only pulls.
    Pull,
}

/// The ranks of a problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ranks {
    /// Where the rows of each end, among those of all ranks one after the other.
    ends: Vec<usize>,
    /// How many have goals that can be missed: the first ones.
    levels: usize,
}

impl Ranks {
    /// Gives every task its rank, and its rows their place.
    pub(super) fn of(tasks: &mut [CompiledTask], preferences: Preferences) -> Self {
        let last_level = tasks.iter().filter(|task| task.binds && !task.is_loop);
        let last_level = last_level.map(|task| task.level).max();
        let order = |task: &CompiledTask| match (task.binds, preferences, last_level) {
            (true, _, _) if task.is_loop => (Class::Loop, 0),
            (true, _, _) => (Class::Goal, task.level),
            (false, Preferences::Traded, Some(last)) => (Class::Goal, last),
            (false, _, _) => (Class::Pull, task.level),
        };
        let mut ranks: Vec<_> = tasks.iter().map(order).collect();
        ranks.sort_unstable();
        ranks.dedup();
        let (mut ends, mut end) = (Vec::with_capacity(ranks.len()), 0);
        let mut last_edge = 0;
        for (rank, own) in ranks.iter().enumerate() {
            for task in tasks.iter_mut().filter(|task| order(task) == *own) {
                task.rank = rank;
                task.rows_by_rank = end..end + task.rows.len();
                end = task.rows_by_rank.end;
                task.edges_by_rank = last_edge..last_edge + task.edge_weights.len();
                last_edge = task.edges_by_rank.end;
            }
            ends.push(end);
        }
        let bound = tasks.iter().filter(|task| task.binds);
        let levels = bound.map(|task| task.rank + 1).max().unwrap_or(0);
        Self { ends, levels }
    }

    getters! {
        /// How many have goals that can be missed: the first ones.
        pub(crate) fn levels(&self) -> usize = self.levels;
        /// How many there are.
        pub(crate) fn count(&self) -> usize = self.ends.len();
    }

    /// Where the rows of a rank begin.
    fn start(&self, rank: usize) -> usize {
        rank.checked_sub(1).map_or(0, |last| self.end(last))
    }

    fn end(&self, rank: usize) -> usize {
        self.ends.get(rank).copied().unwrap_or(0)
    }

    /// How many rows some ranks have.
    pub(super) fn rows(&self, from: usize, to: usize) -> usize {
        self.start(to) - self.start(from)
    }

    /// The rows of a rank, among those of all.
    pub(crate) fn rows_of(&self, rank: usize) -> Range<usize> {
        self.start(rank)..self.end(rank)
    }

    /// Where a task's rows stand among those of a share, if it belongs to that.
    pub(super) fn rows_in(&self, task: &CompiledTask, share: Share) -> Option<Range<usize>> {
        match share {
            Share::All => Some(task.rows.clone()),
            Share::Ranks { from, to } => {
                let before = self.start(from);
                let Range { start, end } = task.rows_by_rank;
                (from..to)
                    .contains(&task.rank)
                    .then(|| start - before..end - before)
            }
        }
    }
}
