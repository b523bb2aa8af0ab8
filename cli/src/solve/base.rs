//! Reference frame of targets.

use kinopt::ik::Drag;
use kinopt::model::FrameId;
use kinopt::problem::{ProblemBuilder, ProblemError, TaskId};
use kinopt::spatial::Placement;
use kinopt::task::{Point, Pose, PoseBounds, Task};

use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// Where targets are measured from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Base {
    /// A frame that nothing moves (the world's own is the identity): world_from_base.
    Still(Placement<f64>),
    /// A frame that free joints move.
    Moving(FrameId),
}

/// A target's task in a problem, so that it can be aimed anew.
#[derive(Clone, Copy, Debug)]
pub(super) enum TargetTask {
    Point(TaskId<Point>),
    Pose(TaskId<Pose>),
}

impl Base {
    /// The frame of that name; without one the world.
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

    /// The frame, where free joints move it.
    pub(super) fn moving_frame(&self) -> Option<FrameId> {
        match *self {
            Self::Still(_) => None,
            Self::Moving(frame) => Some(frame),
        }
    }

    /// Adds the task that brings `tip` to a target in this frame, by its name, its weight beside
    /// others and its level; of a target with room only what its goal says counts, else without `turns` its orientation
    /// does not matter.
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
            let pose = Pose::new(tip, target);
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

    /// Moves a task's target, which is given in this frame.
    pub(super) fn aim(
        &self,
        body: &mut Drag,
        task: TargetTask,
        target: Placement<f64>,
    ) -> Result<(), ProblemError> {
        let placed = self.placed(target);
        match task {
            TargetTask::Point(id) => body.target_mut(id)?.set_target(placed.translation),
            TargetTask::Pose(id) => body.target_mut(id)?.set_target(placed),
        }
        Ok(())
    }

    /// A target in this frame as its task takes it: in the world, or in a frame that moves.
    fn placed(&self, target: Placement<f64>) -> Placement<f64> {
        match *self {
            Self::Still(world_from_base) => world_from_base * target,
            Self::Moving(_) => target,
        }
    }
}
