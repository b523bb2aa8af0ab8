//! Chain through the kinematic tree from a base frame up and down to a tip frame.

use kinopt_kinematics::model::{FrameId, JointId, Model};
use kinopt_kinematics::spatial::Placement;

/// One factor of the chain; `base_from_tip` is the product of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    /// A constant placement.
    Fixed(Placement<f64>),
    /// Motion of a joint, or its inverse if the chain goes up.
    ///
    /// The inverse of a motion by q is exactly the motion by q about (along) the opposite axis.
    Joint { id: JointId, reversed: bool },
}

impl Part {
    /// Returns true for the motion of this joint.
    pub(super) fn is_joint(&self, joint: JointId) -> bool {
        matches!(self, Self::Joint { id, .. } if *id == joint)
    }
}

/// Factors from the base (`None` for the world) to the tip.
pub(super) fn parts(model: &Model, base: Option<FrameId>, tip: FrameId) -> Vec<Part> {
    let path = model.path(base, tip);
    let placement = |id: JointId| model.joints()[id.index()].parent_from_joint;
    let on_joint = |frame: FrameId| model.frames()[frame.index()].joint_from_frame;

    let mut parts: Vec<Part> = base
        .map(|base| Part::Fixed(on_joint(base).inverse()))
        .into_iter()
        .collect();
    for id in path.up {
        let reversed = true;
        parts.push(Part::Joint { id, reversed });
        parts.push(Part::Fixed(placement(id).inverse()));
    }
    for id in path.down {
        let reversed = false;
        parts.push(Part::Fixed(placement(id)));
        parts.push(Part::Joint { id, reversed });
    }
    parts.push(Part::Fixed(on_joint(tip)));
    parts
}
