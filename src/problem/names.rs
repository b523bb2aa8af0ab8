//! Names in reports, shared with every solution.

use super::frame_reach::Anchor;
use crate::model::LengthUnit;

/// Names of a problem's parts, by index.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ReportNames {
    pub(crate) model: String,
    pub(crate) length_unit: LengthUnit,
    /// For each variable, the joint that it moves directly, or the part of a ball joint.
    pub(crate) variables: Vec<String>,
    /// For each variable, the joint that it moves directly.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) joints: Vec<String>,
    /// For each variable, true if that joint rotates, false if it translates.
    pub(crate) variable_is_angle: Vec<bool>,
    pub(crate) tasks: Vec<String>,
    /// The model's loops; the last tasks close them.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) loops: Vec<String>,
    /// The priority level of each task.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) task_levels: Vec<usize>,
    /// The first frame of each task, if any.
    pub(crate) task_frames: Vec<Option<String>>,
    /// The reach of that frame, if it is finite.
    pub(crate) anchors: Vec<Option<Anchor>>,
}
