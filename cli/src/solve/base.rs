//! Reference frame of targets.

use kinopt::ik::Drag;
use kinopt::model::FrameId;
use kinopt::problem::{ProblemBuilder, ProblemError, TaskId};
use kinopt::spatial::Placement;
use kinopt::task::{FramePose, Point, PoseBounds, Task};

use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// Reference frame of targets.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Base {
    /// World, or a frame that no free joint moves: world_from_base.
    Still(Placement<f64>),
    /// Frame that free joints move.
    Moving(FrameId),
}

/// Task of a target in a problem, so that its target can change.
#[derive(Clone, Copy, Debug)]
pub(super) enum TargetTask {
    Point(TaskId<Point>),
    Pose(TaskId<FramePose>),
}

impl Base {
    /// Base of a name, or the world without one.
    pub(crate) fn named(loaded: &LoadedModel, name: Option<&str>) -> Outcome<Self> {
        let Some(name) = name else {
            return Ok(Self::Still(Placement::identity()));
        };
        let frame = loaded.frame(name, BareName::Tail)?;
        let map = loaded.parameters();
        let mut carriers = loaded.model.joints_above(frame);
        if carriers.any(|joint| loaded.variable_of(&map, joint).is_some()) {
            return Ok(Self::Moving(frame));
        }
        let placements = loaded.all_frames(&loaded.rest());
        let placed = placements.get(frame.index()).copied();
        Ok(Self::Still(placed.unwrap_or_else(Placement::identity)))
    }

    /// The frame, if free joints move it.
    pub(super) fn moving_frame(&self) -> Option<FrameId> {
        match *self {
            Self::Still(_) => None,
            Self::Moving(frame) => Some(frame),
        }
    }

    /// Adds the task that brings `tip` to a target in this frame, with its name, weight and priority level.
    ///
    /// With goal bounds, only those decide which axes count. Otherwise the orientation counts if `turns` is true.
    pub(super) fn add_target(
        &self,
        builder: &mut ProblemBuilder,
        tip: FrameId,
        base_from_target: Placement<f64>,
        (turns, goal): (bool, Option<PoseBounds>),
        (name, weight, level): (String, f64, usize),
    ) -> TargetTask {
        let target = self.placed(base_from_target);
        let frame = self.moving_frame();
        if turns || goal.is_some() {
            let pose = FramePose::new(tip, target);
            let pose = goal.map_or(pose, |goal| pose.with_goal(goal));
            let pose = frame.map_or(pose, |base| pose.relative_to(base));
            TargetTask::Pose(builder.add(Task::new(pose).named(name).scale(weight).at_level(level)))
        } else {
            let point = Point::new(tip, target.translation);
            let point = frame.map_or(point, |base| point.relative_to(base));
            TargetTask::Point(
                builder.add(Task::new(point).named(name).scale(weight).at_level(level)),
            )
        }
    }

    /// Sets the target of a task, given in this frame.
    pub(super) fn set_target(
        &self,
        drag: &mut Drag,
        task: TargetTask,
        target: Placement<f64>,
    ) -> Result<(), ProblemError> {
        let target_in_task = self.placed(target);
        match task {
            TargetTask::Point(id) => drag.target_mut(id)?.set_target(target_in_task.translation),
            TargetTask::Pose(id) => drag.target_mut(id)?.set_target(target_in_task),
        }
        Ok(())
    }

    /// Target in the coordinates of its task: those of the world, or of a frame that moves.
    fn placed(&self, target: Placement<f64>) -> Placement<f64> {
        match *self {
            Self::Still(world_from_base) => world_from_base * target,
            Self::Moving(_) => target,
        }
    }
}
