//! Two-bone IK of a leg, in the plane in which it bends.

use glam::{DQuat, DVec3};

use super::rotation::{arc, from_rotation_vector};
use kinopt_kinematics::scalar::elementary;

/// Distance of the knee from the line of the leg, relative to the leg, below which its direction blends to the rest
/// pose's.
const STRAIGHT: f64 = 0.03;

/// Rotations in the world that bring an ankle to a target: of the thigh and of the shin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LegRotation {
    pub(super) thigh: DQuat,
    pub(super) shin: DQuat,
}

/// Returns the rotations that bring the ankle to `target`, or as near as the lengths allow.
///
/// `joints` are hip, knee and ankle. The knee stays in the plane of the bent leg. `forward` is the direction in which a
/// straight knee bends. If the target is at the ankle, the rotations are the identity.
pub(super) fn leg_rotation(joints: [DVec3; 3], target: DVec3, forward: DVec3) -> LegRotation {
    let [hip, knee, ankle] = joints;
    let (upper, lower) = (hip.distance(knee), knee.distance(ankle));
    let length = upper + lower;
    // The whole leg rotates towards the target, then the knee bends.
    let swing = arc(ankle - hip, target - hip);
    let along = (target - hip).normalize_or(ankle - hip).normalize_or_zero();
    let rotated_knee = swing * (knee - hip);
    let bent = rotated_knee - along * rotated_knee.dot(along);
    let forward = swing * forward;
    let forward = (forward - along * forward.dot(along)).normalize_or_zero();
    let straightness = (1.0 - bent.length() / (STRAIGHT * length)).max(0.0);
    let side = bent + forward * (straightness * STRAIGHT * length);
    let Some(side) = side.try_normalize() else {
        return LegRotation {
            thigh: swing,
            shin: swing,
        };
    };
    let distance = target.distance(hip).max(1e-9 * length);
    // Angles between the line and both bones, before and after.
    let hip_angle = |distance: f64| {
        let cosine =
            (upper * upper + distance * distance - lower * lower) / (2.0 * upper * distance);
        elementary::acos(cosine.clamp(-1.0, 1.0))
    };
    let ankle_angle = |distance: f64| {
        let cosine =
            (lower * lower + distance * distance - upper * upper) / (2.0 * lower * distance);
        elementary::acos(cosine.clamp(-1.0, 1.0))
    };
    let before = ankle.distance(hip).max(1e-9 * length);
    let axis = along.cross(side);
    let thigh_angle = hip_angle(distance) - hip_angle(before);
    let shin_angle = ankle_angle(before) - ankle_angle(distance);
    LegRotation {
        thigh: (from_rotation_vector(axis * thigh_angle) * swing).normalize(),
        shin: (from_rotation_vector(axis * shin_angle) * swing).normalize(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::rotation::rotation_vector;
    use super::leg_rotation;
    use glam::DVec3;

    const FORWARD: DVec3 = DVec3::Y;

    fn reached(joints: [DVec3; 3], target: DVec3) -> DVec3 {
        let [hip, knee, ankle] = joints;
        let rotation = leg_rotation(joints, target, FORWARD);
        hip + rotation.thigh * (knee - hip) + rotation.shin * (ankle - knee)
    }

    #[test]
    fn ankle_reaches_its_target() {
        let bent = [
            DVec3::new(0.1, 0.0, 0.9),
            DVec3::new(0.1, 0.15, 0.5),
            DVec3::new(0.1, 0.0, 0.1),
        ];
        let straight = [
            DVec3::new(0.1, 0.0, 0.9),
            DVec3::new(0.1, 0.0, 0.5),
            DVec3::new(0.1, 0.0, 0.1),
        ];
        for joints in [bent, straight] {
            for target in [[0.1, 0.2, 0.2], [0.3, -0.2, 0.3], [0.0, 0.0, 0.4]] {
                let target = DVec3::from_array(target);
                let distance = reached(joints, target).distance(target);
                assert!(distance < 1e-9, "{joints:?} to {target}: {distance}");
            }
        }
    }

    #[test]
    fn reached_target_changes_nothing() {
        let joints = [
            DVec3::new(0.1, 0.0, 0.9),
            DVec3::new(0.12, 0.15, 0.5),
            DVec3::new(0.1, 0.0, 0.1),
        ];
        let rotation = leg_rotation(joints, joints[2], FORWARD);
        for rotation in [rotation.thigh, rotation.shin] {
            assert!(rotation_vector(rotation).length() < 1e-7, "{rotation}");
        }
    }

    #[test]
    fn straight_knee_bends_forward() {
        let joints = [DVec3::Z, DVec3::Z * 0.5, DVec3::ZERO];
        let rotation = leg_rotation(joints, DVec3::new(0.0, 0.0, 0.2), FORWARD);
        let knee = joints[0] + rotation.thigh * (joints[1] - joints[0]);
        assert!(knee.y > 0.2 && knee.x.abs() < 1e-9, "{knee}");
    }
}
