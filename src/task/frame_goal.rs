//! Exact target of a frame, for geometric solvers.

use std::any::Any;

use super::{Orientation, Point, Pose};
use crate::spatial::{Matrix3, Vector3};

/// The exact target of a frame in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameGoal {
    /// The point of the frame with a target position, in frame coordinates, metres.
    pub(crate) offset: Vector3<f64>,
    pub(crate) place: Option<Vector3<f64>>,
    /// Target orientation of the frame.
    pub(crate) axes: Option<Matrix3<f64>>,
    /// True if the residual has no further rows.
    pub(crate) whole: bool,
}

impl FrameGoal {
    /// The target of a residual; `None` if it is not a position or an orientation in the world.
    pub(crate) fn by(residual: &dyn Any) -> Option<Self> {
        if let Some(point) = residual.downcast_ref::<Point>() {
            return point.base().is_none().then(|| Self {
                offset: point.offset(),
                place: Some(point.target()),
                axes: None,
                whole: true,
            });
        }
        if let Some(orientation) = residual.downcast_ref::<Orientation>() {
            return orientation.base().is_none().then(|| Self {
                offset: Vector3::zero(),
                place: None,
                axes: Some(orientation.target()),
                whole: true,
            });
        }
        let pose = residual.downcast_ref::<Pose>()?;
        let exact = pose.goal().is_none_or(|goal| goal.is_exact_in_position());
        let tool = pose.frame_from_tool();
        (pose.base().is_none() && exact).then(|| Self {
            offset: tool.translation,
            place: Some(pose.target().translation),
            axes: Some(pose.target().rotation * tool.rotation.transpose()),
            whole: pose.goal().is_none_or(|goal| goal.is_full_pose()),
        })
    }
}
