//! Backends that solve queries: a robot's arm or the general solvers.

use std::time::Instant;

use kinopt::solver::{Observer, Silent};
use rayon::prelude::*;

use super::query::{Answer, Path, Query};
use super::self_motion::SelfMotionCurve;
use super::task_name::TaskName;
use crate::failure::Outcome;
use crate::joint_columns::JointColumns;

/// Solver of queries, with a workspace for each thread.
pub(super) trait QueryBackend: Sync {
    /// Workspace of one thread.
    type Workspace: Default;

    /// Solves a query, and measures the time of the solve alone.
    fn answer(
        &self,
        workspace: &mut Self::Workspace,
        query: &Query,
        observer: &mut dyn Observer,
    ) -> Outcome<Answer>;

    /// Self-motions of a query, if all solutions are wanted and the backend is an arm of seven revolute joints.
    fn self_motions(&self, _query: &Query) -> Outcome<Option<Vec<SelfMotionCurve>>> {
        Ok(None)
    }

    /// Solves queries as a path, each from the solution of the one before. Only the start of the first query counts.
    /// Calls `answered` after every step.
    fn path(&self, queries: &[Query], answered: &dyn Fn()) -> Outcome<Path>;

    /// Tasks of every query.
    fn tasks(&self) -> &[TaskName];

    /// Coordinates that no task depends on.
    fn idle_coordinates(&self) -> &[usize];

    /// Columns of the free joints from base to tip, if there is one tip.
    fn columns(&self) -> Option<JointColumns>;

    /// Start configuration without --start.
    fn default_start(&self) -> Outcome<Vec<f64>>;

    /// Solves all queries independently, on the threads of the current pool if `parallel`.
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

    /// Solves all queries together. Returns the solutions and the time, in microseconds.
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
