//! Collision-free frames of a drag.

use std::sync::Arc;

use super::Drag;
use super::collision_avoidance::AvoidanceWorkspace;
use super::collision_free_search::distance_of_first;
use super::drag_frame::frame_instance;
use super::priority::Extent;
use super::solver::Run;
use super::step_guard::MotionGuard;
use crate::problem::{Collision, CollisionConstraint};
use crate::search::SearchResult;
use crate::solver::Silent;

impl Drag {
    /// Checks the linear joint-space motion of the frame, and replaces a blocked end.
    ///
    /// A blocked frame is solved again with collision avoidance among the required tasks. Each step is then limited to
    /// its collision-free part, so that the model slides along obstacles. The solution lists the blocking pairs, unless
    /// its targets are reached nevertheless. If the frame starts in collision, its end has less penetration.
    pub(super) fn keep_motion_collision_free(&mut self) {
        let Some(constraint) = self.problem.collision_constraint().map(Arc::clone) else {
            return;
        };
        let mut workspace = self
            .collision_workspace
            .take()
            .unwrap_or_else(|| AvoidanceWorkspace::new(&constraint));
        let end = &self.workspace.solution.q;
        if end.iter().all(|value| value.is_finite()) {
            if let Some(blocking_pair) = workspace.engine.check.blocked(&self.q_before, end) {
                self.last_jump = None;
                self.unreached_frames = 0;
                self.replace_blocked_end(&constraint, &mut workspace, blocking_pair);
            } else if self.may_collide {
                let pairs = workspace.engine.check.collisions(end);
                self.may_collide = !pairs.is_empty();
                self.workspace.solution.set_collisions(pairs);
            }
        }
        self.collision_workspace = Some(workspace);
    }

    fn replace_blocked_end(
        &mut self,
        constraint: &CollisionConstraint,
        collision_workspace: &mut AvoidanceWorkspace,
        blocking_pair: Collision,
    ) {
        // A mere contact at the start does not block the motion.
        let contact_at_start = collision_workspace
            .engine
            .check
            .blocked(&self.q_before, &self.q_before);
        let is_start_free = contact_at_start.is_none();
        let start_distance = match is_start_free {
            true => f64::INFINITY,
            false => collision_workspace.engine.min_distance(&self.q_before),
        };
        let mut result = SearchResult::of(&self.workspace.solution);
        let depenetration_end = self.depenetration_step().filter(|_| !is_start_free);
        let is_depenetration = depenetration_end.is_some();
        let end = depenetration_end.or_else(|| {
            self.solve_collision_free(
                constraint,
                collision_workspace,
                (is_start_free, start_distance),
                &mut result,
            )
        });
        let instance = frame_instance(
            &self.problem,
            &self.targets,
            &self.move_limits,
            &self.moved_joints,
        );
        let x = end.as_ref().unwrap_or(&self.x);
        let workspace = &mut self.workspace;
        self.solver
            .report_at(instance, x, result, workspace, &mut Silent);
        let mut pairs = collision_workspace
            .engine
            .check
            .collisions(&workspace.solution.q);
        self.may_collide = !pairs.is_empty();
        let end_distance = distance_of_first(&pairs);
        if is_start_free && !workspace.solution.reached {
            pairs.push(blocking_pair);
        }
        workspace.solution.set_collisions(pairs);
        if is_start_free || !self.may_collide {
            self.depenetration.clear();
        } else if !is_depenetration {
            let check = &mut *collision_workspace.engine.check;
            self.attempt_depenetration(constraint, check, (start_distance, end_distance));
        }
    }

    /// Returns the end of a frame solved with collision avoidance among the required tasks, by variable. The motion to
    /// it is collision-free, or if the frame starts in collision, it has less penetration.
    fn solve_collision_free(
        &mut self,
        constraint: &CollisionConstraint,
        workspace: &mut AvoidanceWorkspace,
        (is_start_free, start_distance): (bool, f64),
        result: &mut SearchResult,
    ) -> Option<Vec<f64>> {
        // Soft tasks may lead to an unacceptable end although the required tasks alone do not.
        for extent in [Extent::Frame, Extent::Goals] {
            self.solve_constrained(constraint, workspace, extent, is_start_free);
            result.add(&workspace.constrained.solution);
            let q = &workspace.constrained.solution.q;
            if !q.iter().all(|value| value.is_finite()) {
                continue;
            }
            let is_acceptable = match is_start_free {
                true => workspace.engine.check.blocked(&self.q_before, q).is_none(),
                false => workspace.engine.min_distance(q) > start_distance,
            };
            if is_acceptable {
                return Some(workspace.constrained.search.keeper.x.clone());
            }
        }
        None
    }

    /// Solves a frame from its start with collision avoidance among the required tasks. If `guarded`, every step is
    /// limited to its collision-free part.
    fn solve_constrained(
        &mut self,
        constraint: &CollisionConstraint,
        workspace: &mut AvoidanceWorkspace,
        extent: Extent,
        guarded: bool,
    ) {
        let instance = frame_instance(
            &self.problem,
            &self.targets,
            &self.move_limits,
            &self.moved_joints,
        )
        .with_constraint(constraint.with_strong_clearance());
        let mut q = std::mem::take(&mut self.q);
        let mut guard = MotionGuard {
            check: &mut *workspace.engine.check,
            map: self.problem.parameters(),
            from: (&self.q_before, &self.x),
            q: &mut q,
        };
        let mut run = Run {
            deadline: self.solver.stopping().deadline(),
            observer: &mut Silent,
            guard: None,
            clear: None,
        };
        if guarded {
            run.guard = Some(&mut guard);
        }
        let solver = self.solver.clone().with_extent(extent);
        let solved = solver.run(
            instance,
            &self.q_before,
            &mut workspace.constrained,
            &mut run,
        );
        debug_assert!(solved.is_ok(), "a start of its own that does not fit");
        self.q = q;
    }
}
