//! Collision avoidance of retargeting, with type erasure.

use std::fmt;
use std::sync::Arc;

use super::switchable_residual::Switchable;
use crate::motion::trajectory::MotionProblemBuilder;
use kinopt_solver::problem::{AnyClearanceCheck, CollisionAvoidance, ProblemBuilder};
use kinopt_solver::task::Task;

/// Weight of collision avoidance relative to a point, in a whole trajectory.
const AVOIDANCE_WEIGHT: f64 = 100.0;

type AddFrameTasks = dyn Fn(&mut ProblemBuilder<'_>) + Send + Sync;
type AddMotionTasks = dyn Fn(&mut MotionProblemBuilder<'_>, Arc<[bool]>) + Send + Sync;

/// Type-erased collision checker.
#[derive(Clone)]
pub(super) struct Obstacles {
    add_frame_tasks: Arc<AddFrameTasks>,
    add_motion_tasks: Arc<AddMotionTasks>,
    check: Box<dyn AnyClearanceCheck>,
}

impl fmt::Debug for Obstacles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Obstacles")
            .field("check", &self.check)
            .finish_non_exhaustive()
    }
}

impl Obstacles {
    pub(super) fn of<C: CollisionAvoidance + Clone + Send + Sync + 'static>(checker: &C) -> Self {
        let [frame_checker, motion_checker] = [checker.clone(), checker.clone()];
        Self {
            add_frame_tasks: Arc::new(move |tasks| {
                tasks.keep_clear(&frame_checker);
            }),
            add_motion_tasks: Arc::new(move |motion, enabled| {
                let clearance = Switchable::new(motion_checker.clearance().residual);
                let task = motion.add(Task::new(clearance).scale(AVOIDANCE_WEIGHT));
                motion.follow(task, move |frame, residual| residual.set(enabled[frame]));
            }),
            check: Box::new(checker.check()),
        }
    }

    /// Returns a check with its own memory.
    pub(super) fn check(&self) -> Box<dyn AnyClearanceCheck> {
        self.check.clone()
    }

    /// Adds collision avoidance to the tasks of a sample.
    pub(super) fn add_to(&self, tasks: &mut ProblemBuilder<'_>) {
        (self.add_frame_tasks)(tasks);
    }

    /// Adds collision avoidance to a trajectory, at the samples marked in `enabled`.
    pub(super) fn add_to_motion(
        &self,
        motion: &mut MotionProblemBuilder<'_>,
        enabled: Arc<[bool]>,
    ) {
        (self.add_motion_tasks)(motion, enabled);
    }
}
