//! Names in reports, shared with every solution.

use super::frame_reach::Anchor;
use kinopt_kinematics::model::LengthUnit;

/// Names of a problem's parts, by index.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(hidden)]
pub struct ReportNames {
    #[doc(hidden)]
    pub model: String,
    #[doc(hidden)]
    pub length_unit: LengthUnit,
    /// For each variable, the joint that it moves directly, or the part of a ball joint.
    #[doc(hidden)]
    pub variables: Vec<String>,
    /// For each variable, the joint that it moves directly.
    #[cfg_attr(feature = "serde", serde(default))]
    #[doc(hidden)]
    pub joints: Vec<String>,
    /// For each variable, true if that joint rotates, false if it translates.
    #[doc(hidden)]
    pub variable_is_angle: Vec<bool>,
    #[doc(hidden)]
    pub tasks: Vec<String>,
    /// The model's loops; the last tasks close them.
    #[cfg_attr(feature = "serde", serde(default))]
    #[doc(hidden)]
    pub loops: Vec<String>,
    /// The priority level of each task.
    #[cfg_attr(feature = "serde", serde(default))]
    #[doc(hidden)]
    pub task_levels: Vec<usize>,
    /// The first frame of each task, if any.
    #[doc(hidden)]
    pub task_frames: Vec<Option<String>>,
    /// The reach of that frame, if it is finite.
    #[doc(hidden)]
    pub anchors: Vec<Option<Anchor>>,
}
