//! Direction of the trunk and the neck.
//!
//! The trunk has the subject's direction from the middle of the hips to the middle of the shoulders, the neck that from
//! there to the head. Joints of pelvis and chest have no common anatomical place, so their directions differ between
//! skeletons by 10 degrees and more.

use glam::{DQuat, DVec3};

use super::super::BodyPart;
use super::correspondence::AxialChain;
use super::pose::BonePose;
use super::rotation::arc;
use super::transfer::{BoneRig, CharacterTransfer, SubjectFrame};

const HIPS: [BodyPart; 2] = [BodyPart::LeftHip, BodyPart::RightHip];
const SHOULDERS: [BodyPart; 2] = [BodyPart::LeftShoulder, BodyPart::RightShoulder];

/// Rotation of a part of the body about a point.
#[derive(Clone, Copy, Debug)]
struct Turn {
    rotation: DQuat,
    origin: DVec3,
}

impl Turn {
    fn moved(turn: Option<Self>, position: DVec3) -> DVec3 {
        turn.map_or(position, |turn| {
            turn.origin + turn.rotation * (position - turn.origin)
        })
    }
}

impl CharacterTransfer {
    /// Rotates the bones of spine and neck so that both have the subject's directions. Returns whether bones changed.
    pub(super) fn correct_trunk(
        &self,
        rig: &BoneRig,
        frame: SubjectFrame<'_>,
        pose: &BonePose,
        corrections: &mut [DQuat],
    ) -> bool {
        // The trunk comes before the neck, which it moves.
        let mut trunk: Option<Turn> = None;
        let mut changed = false;
        for chain in &rig.relation.axial_chains {
            let Some(&first) = chain.bones.first() else {
                continue;
            };
            let anatomical = match (chain.lower, chain.upper) {
                (BodyPart::Pelvis, BodyPart::Chest) => self.ends(frame, pose, HIPS, SHOULDERS),
                (BodyPart::Chest, head) => self.ends(frame, pose, SHOULDERS, [head; 2]),
                _ => None,
            };
            let moves_shoulders = anatomical.is_some() && chain.upper == BodyPart::Chest;
            let ends = anatomical.or_else(|| self.chain_ends(frame, pose, chain));
            let Some((from, to, direction)) = ends else {
                continue;
            };
            let origin = Turn::moved(trunk, pose.positions[first]);
            // The bones of the neck keep their rotations in the world when the trunk rotates.
            let arm = to - pose.positions[first];
            let fixed = origin - Turn::moved(trunk, from);
            let rotation = turn_towards(arm, fixed, direction);
            let girdle = rig.relation.shoulder_girdle.iter();
            let girdle = girdle.filter(|_| moves_shoulders);
            for bone in chain.bones.iter().chain(girdle) {
                corrections[*bone] = rotation;
            }
            if moves_shoulders {
                trunk = Some(Turn { rotation, origin });
            }
            changed = true;
        }
        changed
    }

    /// Middles of two pairs of parts of the character, and the direction between those of the subject.
    fn ends(
        &self,
        frame: SubjectFrame<'_>,
        pose: &BonePose,
        lower: [BodyPart; 2],
        upper: [BodyPart; 2],
    ) -> Option<(DVec3, DVec3, DVec3)> {
        let subject = |[a, b]: [BodyPart; 2]| {
            Some((self.captured(a, frame)? + self.captured(b, frame)?) * 0.5)
        };
        let character = |[a, b]: [BodyPart; 2]| {
            Some((pose.positions[self.bone(a)?] + pose.positions[self.bone(b)?]) * 0.5)
        };
        Some((
            character(lower)?,
            character(upper)?,
            subject(upper)? - subject(lower)?,
        ))
    }

    /// Ends of a chain of the character, and the direction between those of the subject.
    fn chain_ends(
        &self,
        frame: SubjectFrame<'_>,
        pose: &BonePose,
        chain: &AxialChain,
    ) -> Option<(DVec3, DVec3, DVec3)> {
        self.ends(frame, pose, [chain.lower; 2], [chain.upper; 2])
    }
}

/// Returns the rotation of `arm` for which `fixed` + `arm` has a direction, or comes nearest to it.
fn turn_towards(arm: DVec3, fixed: DVec3, direction: DVec3) -> DQuat {
    let Some(direction) = direction.try_normalize() else {
        return DQuat::IDENTITY;
    };
    let along = direction.dot(fixed);
    let squared = along * along - fixed.length_squared() + arm.length_squared();
    let length = along + squared.max(0.0).sqrt();
    arc(arm, direction * length - fixed)
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "tests")]
mod tests {
    use super::turn_towards;
    use glam::DVec3;

    #[test]
    fn rotated_arm_gives_the_direction() {
        let (arm, fixed) = (DVec3::new(0.1, 0.0, 0.4), DVec3::new(0.0, 0.1, 0.1));
        for direction in [DVec3::Z, DVec3::new(0.3, -0.2, 0.9)] {
            let sum = fixed + turn_towards(arm, fixed, direction) * arm;
            assert!(sum.angle_between(direction) < 1e-9, "{sum}");
        }
    }
}
