//! Masses of a human body by segments.
//!
//! Source: de Leva 1996, "Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters", means of both sexes.

use kinopt_kinematics::model::PointMass;
use kinopt_kinematics::skeleton::{BallSkeleton, BoneId};
use kinopt_kinematics::spatial::Vector3;

use super::body_limb::{BodyLimb, BodyLimbKind};

/// Shares of the whole mass: trunk with head, and the segments of one limb.
const TRUNK: f64 = 0.500;
const THIGH: f64 = 0.145;
const SHANK_AND_FOOT: f64 = 0.059;
const UPPER_ARM: f64 = 0.026;
const FOREARM_AND_HAND: f64 = 0.020;

/// Point masses of a body with `limbs`, total about 1, each at the middle of its segment. The trunk is between hips and
/// shoulders and moves with `trunk`.
pub(super) fn segment_masses(
    skeleton: &BallSkeleton,
    limbs: &[BodyLimb],
    trunk: BoneId,
) -> Vec<PointMass> {
    let bones = skeleton.skeleton().bones();
    let on = |bone: BoneId, position: Vector3<f64>, mass: f64| PointMass {
        frame: skeleton.tail(bone),
        at: bones[bone.index()]
            .model_from_rest
            .inverse()
            .apply(position),
        mass,
    };
    let middle = |a: Vector3<f64>, b: Vector3<f64>| (a + b) * 0.5;
    let mut masses = Vec::new();
    let mut roots = Vector3::zero();
    for limb in limbs {
        let [upper, lower, end] = limb.joints;
        roots += upper;
        let [near, far] = match limb.kind {
            BodyLimbKind::Arm => [UPPER_ARM, FOREARM_AND_HAND],
            BodyLimbKind::Leg | BodyLimbKind::Other => [THIGH, SHANK_AND_FOOT],
        };
        masses.push(on(limb.upper, middle(upper, lower), near));
        masses.push(on(limb.lower, middle(lower, end), far));
    }
    if !limbs.is_empty() {
        masses.push(on(trunk, roots * (1.0 / limbs.len() as f64), TRUNK));
    }
    masses
}
