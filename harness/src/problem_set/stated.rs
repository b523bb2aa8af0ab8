//! The problem that all cases are stated as.

use kinopt::Problem;
use kinopt::problem::TaskId;
use kinopt::spatial::Placement;
use kinopt::task::{Point, Pose, Quantity};

use crate::{Case, HarnessError, ProblemSet};

/// The problem of a set, whose targets move from case to case.
pub(crate) struct Stated {
    pub(crate) problem: Problem,
    points: Vec<TaskId<Point>>,
    poses: Vec<TaskId<Pose>>,
}

impl Stated {
    pub(crate) fn new(set: &ProblemSet) -> Result<Self, HarnessError> {
        let mut builder = Problem::builder(set.model());
        builder
            .parameters(set.map().clone())
            .tolerance(Quantity::Metres, set.length_tolerance())
            .tolerance(Quantity::Radians, set.tolerance());
        let (mut points, mut poses) = (Vec::new(), Vec::new());
        for &frame in set.frames() {
            if set.turns() {
                poses.push(builder.add(Pose::new(frame, Placement::identity())));
            } else {
                points.push(builder.add(Point::new(frame, [0.0; 3])));
            }
        }
        let problem = builder.build()?;
        Ok(Self {
            problem,
            points,
            poses,
        })
    }

    pub(crate) fn aim(&mut self, case: &Case) {
        for (&id, target) in self.points.iter().zip(&case.targets) {
            if let Some(point) = self.problem.residual_mut(id) {
                point.set_target(target.translation);
            }
        }
        for (&id, &target) in self.poses.iter().zip(&case.targets) {
            if let Some(pose) = self.problem.residual_mut(id) {
                pose.set_target(target);
            }
        }
    }
}
