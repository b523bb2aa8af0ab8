//! Frames of a drag whose ways are free.

use std::sync::Arc;

use super::Drag;
use super::drag::near;
use super::keep_clear::ClearRoom;
use super::levels::Extent;
use super::solver::Run;
use super::step_guard::WayGuard;
use crate::problem::Fence;
use crate::search::{Collision, Found};
use crate::solver::Silent;

impl Drag {
    /// Keeps the frame's end where the straight way to it is free. Where it is not, the frame is solved again with the clearance among
    /// its goals, each step no longer than that way is free, so that the body slides along what is in the way; the solution says what
    /// that is, unless its goals are reached all the same. From a place that touches something the next one touches less.
    pub(super) fn keep_way_clear(&mut self) {
        let Some(fence) = self.problem.fence().map(Arc::clone) else {
            return;
        };
        let mut room = self.clear.take().unwrap_or_else(|| ClearRoom::new(&fence));
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

    fn slide(&mut self, fence: &Fence, room: &mut ClearRoom, by: Collision) {
        let free = room.engine.check.is_free(&self.q_before);
        let before = room.engine.least_distance(&self.q_before);
        let mut found = Found::of(&self.workspace.solution);
        let mut end = None;
        // Preferences may lead where the goals alone do not.
        for extent in [Extent::Frame, Extent::Goals] {
            self.solve_fenced(fence, room, extent, free);
            found.add(&room.fenced.solution);
            let q = &room.fenced.solution.q;
            let ends = q.iter().all(|value| value.is_finite());
            let stands = ends
                && match free {
                    true => room.engine.check.blocked(&self.q_before, q).is_none(),
                    false => {
                        let pairs = room.engine.check.collisions(q);
                        pairs.first().is_none_or(|pair| pair.distance > before)
                    }
                };
            if stands {
                end = Some(room.fenced.search.keeper.x.clone());
                break;
            }
        }
        let question = near(&self.problem, &self.targets, &self.moves);
        let x = end.as_ref().unwrap_or(&self.x);
        let workspace = &mut self.workspace;
        self.solver
            .report_at(question, x, found, workspace, &mut Silent);
        let touched = room.engine.check.collisions(&workspace.solution.q);
        self.touches = !touched.is_empty();
        match touched.is_empty() && !workspace.solution.reached {
            true => workspace.solution.set_collisions(vec![by]),
            false => workspace.solution.set_collisions(touched),
        }
    }

    /// Solves a frame with the clearance among its goals, from where the body stood; guarded from where that is free.
    fn solve_fenced(&mut self, fence: &Fence, room: &mut ClearRoom, extent: Extent, guarded: bool) {
        let question = near(&self.problem, &self.targets, &self.moves).fenced(fence.holding());
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
