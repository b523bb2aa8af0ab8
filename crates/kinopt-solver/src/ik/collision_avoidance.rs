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
pub(super) struct AvoidanceWorkspace {
    constraint: Arc<CollisionConstraint>,
    pub(super) engine: SearchWorkspace,
    /// Workspace of a search with collision avoidance among the required tasks.
    pub(super) constrained: Workspace,
}

impl AvoidanceWorkspace {
    pub(super) fn new(constraint: &Arc<CollisionConstraint>) -> Box<Self> {
        Box::new(Self {
            constraint: Arc::clone(constraint),
            engine: SearchWorkspace::new(constraint),
            constrained: Workspace::new(),
        })
    }
}

impl Solver {
    /// Solves a problem instance with collision avoidance.
    ///
    /// Attempts in collision continue until they are collision-free. Soft tasks then act in the null space of required
    /// tasks and collision avoidance. If no attempt is collision-free, the result reaches the required tasks with the
    /// least penetration.
    pub(super) fn run_collision_free(
        &self,
        constraint: &Arc<CollisionConstraint>,
        instance: ProblemInstance<'_>,
        start: &[f64],
        workspace: &mut Workspace,
        run: &mut Run<'_>,
    ) -> Result<(), SolveError> {
        let known = workspace.collision.take();
        let known = known.filter(|collision| Arc::ptr_eq(&collision.constraint, constraint));
        let mut collision = known.unwrap_or_else(|| AvoidanceWorkspace::new(constraint));
        let goal_solver = self.clone().with_extent(Extent::Goals);
        let mut collision_free_run = Run {
            deadline: run.deadline,
            observer: &mut *run.observer,
            guard: None,
            clear: Some((constraint, &mut collision.engine)),
        };
        goal_solver.run(instance, start, workspace, &mut collision_free_run)?;
        self.reduce_collisions(constraint, instance, &mut collision, workspace, run)?;
        let solution = &workspace.solution;
        let has_soft_tasks = instance.problem.searched_subset() != crate::problem::TaskSubset::All;
        if has_soft_tasks && solution.reached && self.extent() != Extent::Goals {
            self.apply_soft_tasks(constraint, instance, &mut collision, workspace, run)?;
        }
        let solution = &mut workspace.solution;
        if solution.q.iter().all(|value| value.is_finite()) {
            solution.set_collisions(collision.engine.check.collisions(&solution.q));
        }
        workspace.collision = Some(collision);
        Ok(())
    }

    /// Reduces collisions of a solution that reaches the required tasks, in their null space and on the same branch.
    fn reduce_collisions(
        &self,
        constraint: &CollisionConstraint,
        instance: ProblemInstance<'_>,
        collision: &mut AvoidanceWorkspace,
        workspace: &mut Workspace,
        run: &mut Run<'_>,
    ) -> Result<(), SolveError> {
        let (problem, subset) = (instance.problem, instance.problem.searched_subset());
        let meets_goals = |workspace: &Workspace| {
            problem.is_reached_by(subset, &workspace.search.keeper.residual)
        };
        let solution = &workspace.solution;
        if solution.termination != Termination::Stationary || !meets_goals(workspace) {
            return Ok(());
        }
        let (q, x) = (solution.q.clone(), workspace.search.keeper.x.clone());
        let start_distance = collision.engine.min_distance(&q);
        if start_distance == f64::INFINITY {
            return Ok(());
        }
        let single_attempt = self.clone().with_restarts(Restarts::none());
        single_attempt.run(
            instance.with_constraint(constraint.with_soft_clearance()),
            &q,
            &mut collision.constrained,
            run,
        )?;
        let mut result =
            SearchResult::of(&workspace.solution).refined_by(&collision.constrained.solution);
        if result.termination == Termination::Reached {
            // The inner search reached its required tasks, but collision avoidance is not one of them.
            result.termination = Termination::Stationary;
        }
        let end = &collision.constrained.search.keeper.x;
        self.report_at(instance, end, result, workspace, run.observer);
        let end_distance = collision.engine.min_distance(&workspace.solution.q);
        if end_distance <= start_distance || !meets_goals(workspace) {
            self.report_at(instance, &x, result, workspace, run.observer);
        } else if end_distance == f64::INFINITY {
            workspace.solution.termination = Termination::Reached;
        }
        Ok(())
    }

    /// Applies the soft tasks to a solution that reaches the required tasks without collision.
    fn apply_soft_tasks(
        &self,
        constraint: &CollisionConstraint,
        instance: ProblemInstance<'_>,
        collision: &mut AvoidanceWorkspace,
        workspace: &mut Workspace,
        run: &mut Run<'_>,
    ) -> Result<(), SolveError> {
        let result = SearchResult::of(&workspace.solution);
        if !collision.engine.check.is_free(&workspace.solution.q) {
            return Ok(());
        }
        let single_attempt = self.clone().with_restarts(Restarts::none());
        let q = workspace.solution.q.clone();
        single_attempt.run(
            instance.with_constraint(constraint.with_strong_clearance()),
            &q,
            &mut collision.constrained,
            run,
        )?;
        let refined = &collision.constrained.solution;
        let result = result.refined_by(refined);
        let x = match refined.reached && collision.engine.check.is_free(&refined.q) {
            true => collision.constrained.search.keeper.x.clone(),
            false => workspace.search.keeper.x.clone(),
        };
        self.report_at(instance, &x, result, workspace, run.observer);
        Ok(())
    }
}
