//! Cones of hips and ankles: they keep knees above their feet.

use std::f64::consts::PI;

use kinopt_kinematics::model::{BallLimits, Limits};
use kinopt_kinematics::skeleton::{BoneCone, BoneId, Cones, Skeleton};
use kinopt_kinematics::spatial::Vector3;

use super::body_limb::{BodyLimb, BodyLimbKind};

/// Largest swing and twist of a thigh about its own direction, radians.
const HIP: [f64; 2] = [130.0 * PI / 180.0, 40.0 * PI / 180.0];
/// Largest swing and twist of a foot about the direction of the shin, radians.
const ANKLE: [f64; 2] = [60.0 * PI / 180.0, 20.0 * PI / 180.0];

/// Adds cones for the hips and ankles of legs, except for bones that are locked or have a cone or a hinge.
pub(super) fn add_leg_cones(skeleton: &Skeleton, limbs: &[BodyLimb], cones: &mut Cones) {
    let bones = skeleton.bones();
    let mut add = |id: BoneId, along: Vector3<f64>, [swing, twist]: [f64; 2]| {
        let bone = &bones[id.index()];
        let is_locked = bone.limits.iter().all(Limits::is_locked);
        if is_locked || skeleton.hinge(id).is_some() || bone.parent.is_none() {
            return;
        }
        let limits = BallLimits::cone(swing, Limits::new(-twist, twist));
        let axis = bone.model_from_rest.rotation.transpose_mul(along);
        let cone = BoneCone::about(axis, limits);
        cones.entry(bone.name.clone()).or_insert(cone);
    };
    for leg in limbs.iter().filter(|limb| limb.kind == BodyLimbKind::Leg) {
        let [hip, knee, ankle] = leg.joints;
        add(leg.upper, knee - hip, HIP);
        if let Some(foot) = leg.end {
            add(foot, ankle - knee, ANKLE);
        }
    }
}
