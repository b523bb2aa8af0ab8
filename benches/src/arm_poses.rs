//! Arms from URDF as chains of the SIMD solver, and reachable poses.

use kinopt::robot::Robot;
use kinopt::simd_ik::{Chain, ChainJoint, JointKind};
use kinopt::spatial::Placement;

use crate::Sequence;

/// Chain of joints from the link `base` to the link `tip`, with fixed joints merged.
///
/// # Errors
/// Returns an error for an unknown link (with the valid names), a base that is not above the tip, and a chain that the
/// SIMD solver does not support.
pub fn chain(robot: &Robot, base: &str, tip: &str) -> Result<Chain, Box<dyn std::error::Error>> {
    let model = robot.model();
    let base = &model.frames()[model.frame(base)?.index()];
    let tip = &model.frames()[model.frame(tip)?.index()];
    let mut path = Vec::new();
    let mut ancestor = tip.joint;
    while ancestor != base.joint {
        let joint = &model.joints()[ancestor.ok_or("the tip does not hang on the base")?.index()];
        path.push(joint);
        ancestor = joint.parent;
    }
    let mut joints = Vec::new();
    let mut last_from_joint = base.joint_from_frame.inverse();
    for joint in path.into_iter().rev() {
        last_from_joint = last_from_joint * joint.parent_from_joint;
        if joint.kind == JointKind::Fixed {
            continue;
        }
        joints.push(ChainJoint {
            parent_from_joint: std::mem::replace(&mut last_from_joint, Placement::identity()),
            axis: joint.axis,
            kind: joint.kind,
            lower: joint.limits.lower,
            upper: joint.limits.upper,
        });
    }
    Ok(Chain::new(joints, last_from_joint * tip.joint_from_frame)?)
}

/// Reachable queries of a chain.
pub struct ArmPoses {
    /// `base_from_target` of each query.
    pub targets: Vec<Placement<f64>>,
    /// One start configuration for each target, one after another, radians and metres.
    pub starts: Vec<f64>,
}

fn at_configuration(chain: &Chain, q: &[f64]) -> Placement<f64> {
    chain.base_from_tip(q).expect("a configuration of its own")
}

/// Tip poses of random configurations within the full limits (unbounded joints within ±π), with other random
/// configurations as starts.
#[must_use]
pub fn random_poses(chain: &Chain, count: usize, random: &mut Sequence) -> ArmPoses {
    let targets = (0..count)
        .map(|_| at_configuration(chain, &random_configuration(chain, random)))
        .collect();
    let starts = (0..count)
        .flat_map(|_| random_configuration(chain, random))
        .collect();
    ArmPoses { targets, starts }
}

/// A random configuration within the limits; unbounded joints within ±π.
#[must_use]
pub fn random_configuration(chain: &Chain, random: &mut Sequence) -> Vec<f64> {
    let joints = chain.joints().iter();
    joints
        .map(|joint| {
            let (lower, upper) = range(joint);
            lower + random.unit() * (upper - lower)
        })
        .collect()
}

/// Tip poses along a path on which each joint oscillates slowly about the middle of its range. A joint moves by at
/// most 0.005 rad per step. All queries start from the first configuration of the path.
#[must_use]
pub fn smooth_path(chain: &Chain, count: usize) -> ArmPoses {
    let configuration = |step: usize| -> Vec<f64> {
        let joints = chain.joints().iter().enumerate();
        joints
            .map(|(index, joint)| {
                let (lower, upper) = range(joint);
                let phase = 0.001 * step as f64 * (1.0 + 0.3 * index as f64);
                0.5 * (lower + upper) + 0.3 * (upper - lower).min(6.0) * phase.sin()
            })
            .collect()
    };
    ArmPoses {
        targets: (0..count)
            .map(|step| at_configuration(chain, &configuration(step)))
            .collect(),
        starts: configuration(0),
    }
}

fn range(joint: &ChainJoint) -> (f64, f64) {
    if joint.lower.is_finite() && joint.upper.is_finite() {
        (joint.lower, joint.upper)
    } else {
        (
            joint.lower.max(-std::f64::consts::PI),
            joint.upper.min(std::f64::consts::PI),
        )
    }
}
