//! Up, left and forward directions of a body at rest.

use kinopt_kinematics::spatial::Vector3;

use super::body_limb::{BodyLimb, BodyLimbKind, LimbSide};

/// Smallest horizontal length of a foot, relative to its leg, that shows where a body faces.
const MIN_RELATIVE_FOOT: f64 = 0.05;

/// Unit directions of a body at rest, in model coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyAxes {
    pub(super) forward: Vector3<f64>,
    /// `None` if no name states the side of a limb.
    pub(super) left: Option<Vector3<f64>>,
}

impl BodyAxes {
    /// Axes of a body with legs; `None` without legs or without a forward direction.
    ///
    /// Up is from the ankles to the hips. Forward is the mean direction of the feet, or for bodies without toes the
    /// product of left and up.
    pub(super) fn of(limbs: &[BodyLimb]) -> Option<Self> {
        let legs: Vec<&BodyLimb> = limbs
            .iter()
            .filter(|limb| limb.kind == BodyLimbKind::Leg)
            .collect();
        let zero = Vector3::zero();
        let up = legs
            .iter()
            .fold(zero, |sum, leg| sum + leg.joints[0] - leg.joints[2]);
        let up = unit(up)?;
        let horizontal = |v: Vector3<f64>| v - up * v.dot(up);
        let sided = limbs.iter().map(|limb| match limb.side {
            Some(LimbSide::Left) => limb.joints[0],
            Some(LimbSide::Right) => -limb.joints[0],
            None => zero,
        });
        let left = unit(horizontal(sided.fold(zero, |sum, side| sum + side)));
        let feet = legs.iter().filter_map(|leg| {
            let foot = horizontal(leg.toe_position? - leg.joints[2]);
            (foot.norm() > MIN_RELATIVE_FOOT * leg.length()).then_some(foot)
        });
        let forward = unit(feet.fold(zero, |sum, foot| sum + foot));
        let forward = forward.or_else(|| left.map(|left| left.cross(up)))?;
        Some(Self { forward, left })
    }
}

/// The unit vector in a direction; `None` for a vector of length 0.
pub(super) fn unit(v: Vector3<f64>) -> Option<Vector3<f64>> {
    let length = v.norm();
    (length > 0.0 && length.is_finite()).then(|| v * (1.0 / length))
}
