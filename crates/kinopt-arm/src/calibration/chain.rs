//! The joints between base and tip, with their placements.

use kinopt_kinematics::model::{FrameRef, JointKind};
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_robot::robot::Robot;

use super::CalibrationError;

/// A moving joint after the fixed placements before it.
#[derive(Clone, Debug)]
pub(super) struct ChainJoint {
    pub(super) name: String,
    /// Placement of the joint frame in the frame moved by the joint before, or in the base.
    pub(super) before_from_joint: Placement<f64>,
    pub(super) kind: JointKind,
    pub(super) axis: Vector3<f64>,
}

/// Moving joints from base to tip.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub(super) joints: Vec<ChainJoint>,
    /// Placement of the tip in the frame moved by the last joint.
    pub(super) last_from_tip: Placement<f64>,
    /// Name of the fixed joint that mounts the tip's link, if there is one: it takes the correction of the tool.
    pub(super) tip_joint: Option<String>,
}

impl Chain {
    pub(super) fn new(
        robot: &Robot,
        base: FrameRef<'_>,
        tip: FrameRef<'_>,
    ) -> Result<Self, CalibrationError> {
        let model = robot.model();
        let (base, tip) = (base.resolve(model)?, tip.resolve(model)?);
        let path = model.path(Some(base), tip);
        let frames = model.frames();
        if !path.up.is_empty() {
            return Err(CalibrationError::NotBelow {
                base: frames[base.index()].name.clone(),
                tip: frames[tip.index()].name.clone(),
            });
        }
        let mut joints = Vec::new();
        let mut placement = frames[base.index()].joint_from_frame.inverse();
        let mut tip_joint = None;
        for id in path.down {
            let joint = &model.joints()[id.index()];
            placement = placement * joint.parent_from_joint;
            if joint.kind.is_ball() {
                let joint = joint.name.clone();
                return Err(CalibrationError::BallJoint { joint });
            }
            if !joint.kind.moves() {
                tip_joint = Some(joint.name.clone());
                continue;
            }
            tip_joint = None;
            joints.push(ChainJoint {
                name: joint.name.clone(),
                before_from_joint: placement,
                kind: joint.kind,
                axis: joint.axis,
            });
            placement = Placement::identity();
        }
        Ok(Self {
            joints,
            last_from_tip: placement * frames[tip.index()].joint_from_frame,
            tip_joint,
        })
    }

    pub(super) fn joints(&self) -> impl ExactSizeIterator<Item = &str> {
        self.joints.iter().map(|joint| joint.name.as_str())
    }
}
