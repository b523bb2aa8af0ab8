//! Exact target of a frame, for geometric solvers.

use std::any::Any;

use super::{FramePose, Orientation, Point};
use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// The exact target of a frame in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameGoal {
    /// The point of the frame with a target position, in frame coordinates, metres.
    pub(crate) offset: Vector3<f64>,
    pub(crate) position: Option<Vector3<f64>>,
    /// Target orientation of the frame.
    pub(crate) orientation: Option<Matrix3<f64>>,
    /// True if the residual has no further rows.
    pub(crate) is_complete: bool,
}

impl FrameGoal {
    /// The target of a residual; `None` if it is not a position or an orientation in the world.
    pub(crate) fn of_residual(residual: &dyn Any) -> Option<Self> {
        if let Some(point) = residual.downcast_ref::<Point>() {
            return point.base().is_none().then(|| Self {
                offset: point.offset(),
                position: Some(point.target()),
                orientation: None,
                is_complete: true,
            });
        }
        if let Some(orientation) = residual.downcast_ref::<Orientation>() {
            return orientation.base().is_none().then(|| Self {
                offset: Vector3::zero(),
                position: None,
                orientation: Some(orientation.target()),
                is_complete: true,
            });
        }
        let pose = residual.downcast_ref::<FramePose>()?;
        let exact = pose.goal().is_none_or(|goal| goal.is_exact_in_position());
        let tool = pose.frame_from_tool();
        (pose.base().is_none() && exact).then(|| Self {
            offset: tool.translation,
            position: Some(pose.target().translation),
            orientation: Some(pose.target().rotation * tool.rotation.transpose()),
            is_complete: pose.goal().is_none_or(|goal| goal.is_full_pose()),
        })
    }
}
