//! Solutions of a problem with collision avoidance.

use std::sync::Arc;

use super::collision_free_search::SearchWorkspace;
use super::priority::Extent;
use super::solver::Run;
use super::{Restarts, SolveError, Solver, Workspace};
use crate::problem::{CollisionConstraint, ProblemInstance};
use crate::search::SearchResult;
use crate::solver::Termination;

/// Workspace of collision avoidance.
#[derive(Clone, Debug)]
pub(super) struct CollisionWorkspace {
    owner: Arc<CollisionConstraint>,
    pub(super) engine: SearchWorkspace,
    /// Workspace of a search with collision avoidance among the required tasks.
    pub(super) fenced: Workspace,
}

impl CollisionWorkspace {
    pub(super) fn new(fence: &Arc<CollisionConstraint>) -> Box<Self> {
        Box::new(Self {
            owner: Arc::clone(fence),
            engine: SearchWorkspace::new(fence),
            fenced: Workspace::new(),
        })
    }
}

impl Solver {
    /// Solves a problem instance with collision avoidance.
    ///
    /// Attempts in collision continue until they are collision-free. Soft tasks then act in the null space of required
    /// tasks and collision avoidance. If no attempt is collision-free, the result reaches the required tasks with the
    /// least penetration.
    pub(super) fn run_clear(
        &self,
        fence: &Arc<CollisionConstraint>,
        question: ProblemInstance<'_>,
        start: &[f64],
        workspace: &mut Workspace,
        run: &mut Run<'_>,
    ) -> Result<(), SolveError> {
        let known = workspace.clear.take();
        let known = known.filter(|room| Arc::ptr_eq(&room.owner, fence));
        let mut room = known.unwrap_or_else(|| CollisionWorkspace::new(fence));
        let goals = self.clone().with_refining(Extent::Goals);
        let mut clear = Run {
            deadline: run.deadline,
            observer: &mut *run.observer,
            guard: None,
            clear: Some((fence, &mut room.engine)),
        };
        goals.run(question, start, workspace, &mut clear)?;
        self.touch_less(fence, question, &mut room, workspace, run)?;
        let solution = &workspace.solution;
        let prefers = question.problem.search_share() != crate::problem::TaskSubset::All;
        if prefers && solution.reached && self.refining() != Extent::Goals {
            self.prefer(fence, question, &mut room, workspace, run)?;
        }
        let solution = &mut workspace.solution;
        if solution.q.iter().all(|value| value.is_finite()) {
            solution.set_collisions(room.engine.check.collisions(&solution.q));
        }
        workspace.clear = Some(room);
        Ok(())
    }

    /// Reduces collisions of a solution that reaches the required tasks, in their null space and on the same branch.
    fn touch_less(
        &self,
        fence: &CollisionConstraint,
        question: ProblemInstance<'_>,
        room: &mut CollisionWorkspace,
        workspace: &mut Workspace,
        run: &mut Run<'_>,
    ) -> Result<(), SolveError> {
        let (problem, share) = (question.problem, question.problem.search_share());
        let meets_goals =
            |workspace: &Workspace| problem.is_reached_by(share, &workspace.search.keeper.residual);
        let solution = &workspace.solution;
        if solution.termination != Termination::Stationary || !meets_goals(workspace) {
            return Ok(());
        }
        let (q, x) = (solution.q.clone(), workspace.search.keeper.x.clone());
        let before = room.engine.least_distance(&q);
        if before == f64::INFINITY {
            return Ok(());
        }
        let once = self.clone().with_restarts(Restarts::none());
        once.run(question.fenced(fence.yielding()), &q, &mut room.fenced, run)?;
        let mut found = SearchResult::of(&workspace.solution).refined_by(&room.fenced.solution);
        if found.termination == Termination::Reached {
            // The inner search reached its required tasks, but collision avoidance is not one of them.
            found.termination = Termination::Stationary;
        }
        let end = &room.fenced.search.keeper.x;
        self.report_at(question, end, found, workspace, run.observer);
        let after = room.engine.least_distance(&workspace.solution.q);
        if after <= before || !meets_goals(workspace) {
            self.report_at(question, &x, found, workspace, run.observer);
        } else if after == f64::INFINITY {
            workspace.solution.termination = Termination::Reached;
        }
        Ok(())
    }

    /// Applies the soft tasks to a solution that reaches the required tasks without collision.
    fn prefer(
        &self,
        fence: &CollisionConstraint,
        question: ProblemInstance<'_>,
        room: &mut CollisionWorkspace,
        workspace: &mut Workspace,
        run: &mut Run<'_>,
    ) -> Result<(), SolveError> {
        let found = SearchResult::of(&workspace.solution);
        if !room.engine.check.is_free(&workspace.solution.q) {
            return Ok(());
        }
        let once = self.clone().with_restarts(Restarts::none());
        let q = workspace.solution.q.clone();
        once.run(question.fenced(fence.holding()), &q, &mut room.fenced, run)?;
        let refined = &room.fenced.solution;
        let found = found.refined_by(refined);
        let x = match refined.reached && room.engine.check.is_free(&refined.q) {
            true => room.fenced.search.keeper.x.clone(),
            false => workspace.search.keeper.x.clone(),
        };
        self.report_at(question, &x, found, workspace, run.observer);
        Ok(())
    }
}
