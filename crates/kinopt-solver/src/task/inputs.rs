//! Inputs of residuals: frames and joints.

use kinopt_kinematics::model::{FrameId, JointId};

/// The frames and joints that a residual reads.
///
/// ```
/// # use kinopt::model::{Limits, Model};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::Inputs;
/// # let mut builder = Model::builder("one link");
/// # let (still, z) = (Placement::identity(), Vector3::UNITS[2]);
/// # let hinge = builder.revolute("hinge", None, still, z, Limits::new(-1.0, 1.0));
/// # let tip = builder.frame("tip", Some(hinge), still);
/// let inputs = Inputs::frames([tip]).with_joints([hinge]);
/// assert_eq!((inputs.frame_ids(), inputs.joint_ids()), (&[tip][..], &[hinge][..]));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    pub(crate) frames: Vec<FrameId>,
    pub(crate) joints: Vec<JointId>,
    pub(crate) joint_values: Option<usize>,
}

impl Inputs {
    /// Frames, in the order of the placements in [`Residual::evaluate`](super::Residual::evaluate).
    #[must_use]
    pub fn frames(frames: impl IntoIterator<Item = FrameId>) -> Self {
        Self {
            frames: frames.into_iter().collect(),
            ..Self::default()
        }
    }

    /// Moving joints, in the order of the values in [`Residual::evaluate`](super::Residual::evaluate).
    #[must_use]
    pub fn joints(joints: impl IntoIterator<Item = JointId>) -> Self {
        Self::default().with_joints(joints)
    }

    /// Sets the moving joints, in the order of the values in [`Residual::evaluate`](super::Residual::evaluate).
    #[must_use]
    pub fn with_joints(mut self, joints: impl IntoIterator<Item = JointId>) -> Self {
        self.joints = joints.into_iter().collect();
        self
    }

    /// Sets the expected number of joint values, which a problem checks: one for each joint, four for a ball joint.
    #[must_use]
    pub fn with_joint_values(mut self, count: usize) -> Self {
        self.joint_values = Some(count);
        self
    }

    /// The frames, in the order of the placements in [`Residual::evaluate`](super::Residual::evaluate).
    #[must_use]
    pub fn frame_ids(&self) -> &[FrameId] {
        &self.frames
    }

    /// The moving joints, in the order of the values in [`Residual::evaluate`](super::Residual::evaluate).
    #[must_use]
    pub fn joint_ids(&self) -> &[JointId] {
        &self.joints
    }
}
