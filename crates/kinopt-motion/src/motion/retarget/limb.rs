//! Limb of a driven frame.

use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::spatial::Vector3;

/// Driven frame, with the limb that ends there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrivenLimb {
    /// Index of the captured joint.
    pub(super) joint: usize,
    pub(super) frame: FrameId,
    pub(super) offset: Vector3<f64>,
    pub(super) weight: f64,
    /// Index of the parent limb, which comes earlier; `None` for the root.
    pub(super) parent: Option<usize>,
    /// Ratio of the model's limb length to the subject's.
    pub(super) scale: f64,
    /// True if the point makes contact.
    pub(super) makes_contact: bool,
    /// True if the point was moved from the mapped frame to the foot's frame.
    pub(super) is_heel: bool,
    /// Position in the model's stance, metres.
    pub(super) stance: Vector3<f64>,
    /// Height above the ground in the model's stance, metres.
    pub(super) clearance: f64,
    /// Height of the subject's joint on the ground, in the capture's unit.
    pub(super) ground: f64,
}
