//! Problem of all cases of a set.

use kinopt::Problem;
use kinopt::problem::{Derivatives, ProblemError, ProblemInstance, Targets, TaskId};
use kinopt::spatial::Placement;
use kinopt::task::{FramePose, Point, Quantity};

use crate::{Case, HarnessError, ProblemSet};

/// Problem of a set, with targets that change from case to case.
pub(crate) struct SetProblem {
    pub(crate) problem: Problem,
    targets: Targets,
    points: Vec<TaskId<Point>>,
    poses: Vec<TaskId<FramePose>>,
}

impl SetProblem {
    pub(crate) fn new(set: &ProblemSet) -> Result<Self, HarnessError> {
        let mut builder = Problem::builder(set.model());
        builder
            .parameters(set.map().clone())
            .tolerance(Quantity::Metres, set.length_tolerance())
            .tolerance(Quantity::Radians, set.tolerance());
        let (mut points, mut poses) = (Vec::new(), Vec::new());
        for &frame in set.frames() {
            if set.turns() {
                poses.push(builder.add(FramePose::new(frame, Placement::identity())));
            } else {
                points.push(builder.add(Point::new(frame, [0.0; 3])));
            }
        }
        let problem = builder.build()?;
        Ok(Self {
            targets: problem.targets(),
            problem,
            points,
            poses,
        })
    }

    pub(crate) fn aim(&mut self, case: &Case) -> Result<(), ProblemError> {
        for (&id, target) in self.points.iter().zip(&case.targets) {
            self.targets.get_mut(id)?.set_target(target.translation);
        }
        for (&id, &target) in self.poses.iter().zip(&case.targets) {
            self.targets.get_mut(id)?.set_target(target);
        }
        Ok(())
    }
    /// Sets the derivative mode.
    pub(crate) fn derive_by(&mut self, route: Derivatives) {
        self.problem = self.problem.clone().with_derivatives(route);
    }

    /// Problem instance with the targets of the case.
    pub(crate) fn instance(&self) -> Result<ProblemInstance<'_>, ProblemError> {
        self.problem.with_targets(&self.targets)
    }
}
