//! Collision-free frames of a drag.

use std::sync::Arc;

use super::Drag;
use super::collision_avoidance::CollisionWorkspace;
use super::collision_free_search::distance_of_first;
use super::drag_frame::near;
use super::priority::Extent;
use super::solver::Run;
use super::step_guard::WayGuard;
use crate::problem::{Collision, CollisionConstraint};
use crate::search::SearchResult;
use crate::solver::Silent;

impl Drag {
    /// Checks the linear joint-space motion of the frame, and replaces a blocked end.
    ///
    /// A blocked frame is solved again with collision avoidance among the required tasks. Each step is then limited to
    /// its collision-free part, so that the model slides along obstacles. The solution lists the blocking pairs, unless
    /// its targets are reached nevertheless. If the frame starts in collision, its end has less penetration.
    pub(super) fn keep_way_clear(&mut self) {
        let Some(fence) = self.problem.fence().map(Arc::clone) else {
            return;
        };
        let mut room = self
            .clear
            .take()
            .unwrap_or_else(|| CollisionWorkspace::new(&fence));
        let end = &self.workspace.solution.q;
        if end.iter().all(|value| value.is_finite()) {
            if let Some(by) = room.engine.check.blocked(&self.q_before, end) {
                self.leap = None;
                self.misses = 0;
                self.slide(&fence, &mut room, by);
            } else if self.touches {
                let touching = room.engine.check.collisions(end);
                self.touches = !touching.is_empty();
                self.workspace.solution.set_collisions(touching);
            }
        }
        self.clear = Some(room);
    }

    fn slide(&mut self, fence: &CollisionConstraint, room: &mut CollisionWorkspace, by: Collision) {
        // A mere contact at the start does not block the motion.
        let stays = room.engine.check.blocked(&self.q_before, &self.q_before);
        let free = stays.is_none();
        let before = match free {
            true => f64::INFINITY,
            false => room.engine.least_distance(&self.q_before),
        };
        let mut found = SearchResult::of(&self.workspace.solution);
        let out = self.go_out_of_contact().filter(|_| !free);
        let goes_out = out.is_some();
        let end = out.or_else(|| self.slide_to(fence, room, (free, before), &mut found));
        let question = near(
            &self.problem,
            &self.targets,
            &self.moves,
            &self.moved_joints,
        );
        let x = end.as_ref().unwrap_or(&self.x);
        let workspace = &mut self.workspace;
        self.solver
            .report_at(question, x, found, workspace, &mut Silent);
        let mut pairs = room.engine.check.collisions(&workspace.solution.q);
        self.touches = !pairs.is_empty();
        let after = distance_of_first(&pairs);
        if free && !workspace.solution.reached {
            pairs.push(by);
        }
        workspace.solution.set_collisions(pairs);
        if free || !self.touches {
            self.way_out_of_contact.clear();
        } else if !goes_out {
            let check = &mut *room.engine.check;
            self.seek_way_out_of_contact(fence, check, (before, after));
        }
    }

    /// Returns the end of a frame solved with collision avoidance among the required tasks, by variable. The motion to
    /// it is collision-free, or if the frame starts in collision, it has less penetration.
    fn slide_to(
        &mut self,
        fence: &CollisionConstraint,
        room: &mut CollisionWorkspace,
        (free, before): (bool, f64),
        found: &mut SearchResult,
    ) -> Option<Vec<f64>> {
        // Soft tasks may lead to an unacceptable end although the required tasks alone do not.
        for extent in [Extent::Frame, Extent::Goals] {
            self.solve_fenced(fence, room, extent, free);
            found.add(&room.fenced.solution);
            let q = &room.fenced.solution.q;
            if !q.iter().all(|value| value.is_finite()) {
                continue;
            }
            let stands = match free {
                true => room.engine.check.blocked(&self.q_before, q).is_none(),
                false => room.engine.least_distance(q) > before,
            };
            if stands {
                return Some(room.fenced.search.keeper.x.clone());
            }
        }
        None
    }

    /// Solves a frame from its start with collision avoidance among the required tasks. If `guarded`, every step is
    /// limited to its collision-free part.
    fn solve_fenced(
        &mut self,
        fence: &CollisionConstraint,
        room: &mut CollisionWorkspace,
        extent: Extent,
        guarded: bool,
    ) {
        let question = near(
            &self.problem,
            &self.targets,
            &self.moves,
            &self.moved_joints,
        )
        .fenced(fence.holding());
        let mut q = std::mem::take(&mut self.q);
        let mut guard = WayGuard {
            check: &mut *room.engine.check,
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
        let solver = self.solver.clone().with_refining(extent);
        let solved = solver.run(question, &self.q_before, &mut room.fenced, &mut run);
        debug_assert!(solved.is_ok(), "a start of its own that does not fit");
        self.q = q;
    }
}
