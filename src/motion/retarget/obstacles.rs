//! Collision avoidance of retargeting, with type erasure.

use std::fmt;
use std::sync::Arc;

use super::switchable_residual::Switchable;
use crate::motion::trajectory::MotionProblemBuilder;
use crate::problem::{AnyClearanceCheck, CollisionAvoidance, ProblemBuilder};
use crate::task::Task;

/// Weight of collision avoidance relative to a point, in a whole trajectory.
const HOLDING: f64 = 100.0;

type OfFrame = dyn Fn(&mut ProblemBuilder<'_>) + Send + Sync;
type OfMotion = dyn Fn(&mut MotionProblemBuilder<'_>, Arc<[bool]>) + Send + Sync;

/// Type-erased collision checker.
#[derive(Clone)]
pub(super) struct Obstacles {
    of_frame: Arc<OfFrame>,
    of_motion: Arc<OfMotion>,
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
        let [of_frame, of_motion] = [checker.clone(), checker.clone()];
        Self {
            of_frame: Arc::new(move |tasks| {
                tasks.keep_clear(&of_frame);
            }),
            of_motion: Arc::new(move |motion, near| {
                let clearance = Switchable::new(of_motion.clearance().residual);
                let task = motion.add(Task::new(clearance).scale(HOLDING));
                motion.follow(task, move |frame, own| own.set(near[frame]));
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
        (self.of_frame)(tasks);
    }

    /// Adds collision avoidance to a trajectory, at the samples marked in `near`.
    pub(super) fn add_to_motion(&self, motion: &mut MotionProblemBuilder<'_>, near: Arc<[bool]>) {
        (self.of_motion)(motion, near);
    }
}
