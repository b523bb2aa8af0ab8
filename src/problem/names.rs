//! The names that reports need, shared with every solution.

use super::frame_reach::Anchor;
use crate::model::LengthUnit;

/// Names of a problem's parts, by index.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ReportNames {
    pub(crate) model: String,
    pub(crate) length_unit: LengthUnit,
    /// The joint that each variable moves directly, or which part of a ball joint.
    pub(crate) variables: Vec<String>,
    /// The joints themselves.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) joints: Vec<String>,
    /// Whether that joint turns, rather than slides.
    pub(crate) variable_is_angle: Vec<bool>,
    pub(crate) tasks: Vec<String>,
    /// The model's loops, which the last tasks close.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) loops: Vec<String>,
    /// The level each task was given.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) task_levels: Vec<usize>,
    /// The first frame each task looks at, if any.
    pub(crate) task_frames: Vec<Option<String>>,
    /// Where the chain of that frame begins, if it is of finite length.
    pub(crate) anchors: Vec<Option<Anchor>>,
}
