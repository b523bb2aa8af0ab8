//! Backends that solve queries: a robot's arm or the general solvers.

use std::time::Instant;

use kinopt::solver::{Observer, Silent};
use rayon::prelude::*;

use super::query::{Answer, Path, Query};
use super::task_name::TaskName;
use crate::failure::Outcome;
use crate::joint_columns::JointColumns;

/// Answers one query after another, with memory that each thread has its own of.
pub(super) trait QueryBackend: Sync {
    /// The memory.
    type Workspace: Default;

    /// Answers, and takes the time of that alone.
    fn answer(
        &self,
        workspace: &mut Self::Workspace,
        query: &Query,
        observer: &mut dyn Observer,
    ) -> Outcome<Answer>;

    /// Answers queries each of which starts from the answer to the one before; the start of the
    /// first counts. `answered` is called after every step.
    fn path(&self, queries: &[Query], answered: &dyn Fn()) -> Outcome<Path>;

    /// The tasks behind every query.
    fn tasks(&self) -> &[TaskName];

    /// Coordinates that no task depends on.
    fn idle_coordinates(&self) -> &[usize];

    /// Columns for the free joints from base to tip, where there is one tip.
    fn columns(&self) -> Option<JointColumns>;

    /// Answers all queries by themselves, on the threads of the current pool where `parallel`.
    fn each(
        &self,
        queries: &[Query],
        parallel: bool,
        answered: &(dyn Fn() + Sync),
    ) -> Outcome<Vec<Answer>> {
        let answer = |workspace: &mut Self::Workspace, query: &Query| {
            let answer = self.answer(workspace, query, &mut Silent);
            answered();
            answer
        };
        if parallel {
            let queries = queries.par_iter();
            return queries.map_init(Self::Workspace::default, answer).collect();
        }
        let workspace = &mut Self::Workspace::default();
        queries.iter().map(|q| answer(workspace, q)).collect()
    }

    /// Answers all queries together. Returns the microseconds that took.
    fn batch(&self, queries: &[Query], parallel: bool) -> Outcome<(Vec<Answer>, f64)> {
        let started = Instant::now();
        let mut answers = self.each(queries, parallel, &|| ())?;
        for answer in &mut answers {
            answer.micros = None;
        }
        Ok((answers, microseconds(started)))
    }
}

pub(super) fn microseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e6
}
