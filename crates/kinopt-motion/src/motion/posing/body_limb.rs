//! Limbs of a skeleton: three joints, and the end of a foot.

use kinopt_kinematics::skeleton::{BoneId, Skeleton};
use kinopt_kinematics::spatial::Vector3;

use super::limb_chains::chains;
use crate::motion::retarget::{BodyPart, parts_of};

/// Kind of a limb, which determines the direction in which it bends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BodyLimbKind {
    Leg,
    Arm,
    /// A limb of an unknown kind, such as a leg of an animal.
    Other,
}

/// Side of a limb, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LimbSide {
    Left,
    Right,
}

/// A limb with its joints at rest, in model coordinates.
#[derive(Clone, Debug)]
pub(super) struct BodyLimb {
    pub(super) kind: BodyLimbKind,
    pub(super) side: Option<LimbSide>,
    /// Bone at the hip or shoulder.
    pub(super) upper: BoneId,
    /// Bone that rotates about the knee or elbow.
    pub(super) lower: BoneId,
    /// Bone at the ankle or wrist; `None` if the limb ends at the tip of its lower bone.
    pub(super) end: Option<BoneId>,
    /// Bone of the toes.
    pub(super) toe: Option<BoneId>,
    /// Positions of hip, knee and ankle, or of shoulder, elbow and wrist.
    pub(super) joints: [Vector3<f64>; 3],
    /// Position of the toes, if they are known.
    pub(super) toe_position: Option<Vector3<f64>>,
}

impl BodyLimb {
    /// Length along both segments, in the skeleton's unit.
    pub(super) fn length(&self) -> f64 {
        let [upper, middle, end] = self.joints;
        (middle - upper).norm() + (end - middle).norm()
    }
}

/// Parts of a paired limb: hip, knee, ankle and toe, or shoulder, elbow and hand.
type LimbParts = (BodyLimbKind, LimbSide, [BodyPart; 3], Option<BodyPart>);

const LIMBS: [LimbParts; 4] = [
    (
        BodyLimbKind::Leg,
        LimbSide::Left,
        [BodyPart::LeftHip, BodyPart::LeftKnee, BodyPart::LeftAnkle],
        Some(BodyPart::LeftToe),
    ),
    (
        BodyLimbKind::Leg,
        LimbSide::Right,
        [
            BodyPart::RightHip,
            BodyPart::RightKnee,
            BodyPart::RightAnkle,
        ],
        Some(BodyPart::RightToe),
    ),
    (
        BodyLimbKind::Arm,
        LimbSide::Left,
        [
            BodyPart::LeftShoulder,
            BodyPart::LeftElbow,
            BodyPart::LeftHand,
        ],
        None,
    ),
    (
        BodyLimbKind::Arm,
        LimbSide::Right,
        [
            BodyPart::RightShoulder,
            BodyPart::RightElbow,
            BodyPart::RightHand,
        ],
        None,
    ),
];

/// The limbs of a skeleton: by the names of bones. If no leg has a known name, also by lengths and branches.
pub(super) fn limbs(skeleton: &Skeleton) -> Vec<BodyLimb> {
    let mut limbs = named_limbs(skeleton);
    if !limbs.iter().any(|limb| limb.kind == BodyLimbKind::Leg) {
        for chain in chains(skeleton) {
            if limbs
                .iter()
                .all(|limb| limb.lower != chain.lower && limb.upper != chain.lower)
            {
                limbs.push(chain);
            }
        }
    }
    limbs
}

fn named_limbs(skeleton: &Skeleton) -> Vec<BodyLimb> {
    let bones = skeleton.bones();
    let parts = parts_of(bones.iter().map(|bone| bone.name.as_str()));
    let bone_of = |part: BodyPart| parts.get(&part).and_then(|&index| skeleton.bone_at(index));
    let tail = |bone: BoneId| bones[bone.index()].rest_tail();
    let limbs = LIMBS
        .iter()
        .filter_map(|&(kind, side, [upper, lower, end], toe)| {
            let (upper, lower) = (bone_of(upper)?, bone_of(lower)?);
            let end = bone_of(end).filter(|&end| is_below(skeleton, end, lower));
            if !is_below(skeleton, lower, upper) {
                return None;
            }
            let end_position = match end {
                Some(end) => tail(end),
                None => bones[lower.index()].rest_tip(),
            };
            let toe = toe.and_then(bone_of);
            let toe = toe.filter(|&toe| end.is_some_and(|end| is_below(skeleton, toe, end)));
            let foot_tip = end.filter(|end| bones[end.index()].length > 0.0);
            let toe_position = match (toe, foot_tip) {
                (Some(toe), _) => Some(tail(toe)),
                (None, Some(foot)) => Some(bones[foot.index()].rest_tip()),
                (None, None) => end.and_then(|end| first_child_tail(skeleton, end)),
            };
            let limb = BodyLimb {
                kind,
                side: Some(side),
                upper,
                lower,
                end,
                toe,
                joints: [tail(upper), tail(lower), end_position],
                toe_position: toe_position.filter(|_| kind == BodyLimbKind::Leg),
            };
            let [upper, middle, end] = limb.joints;
            let shortest = (middle - upper).norm().min((end - middle).norm());
            (shortest > 1e-6 * skeleton.size()).then_some(limb)
        });
    limbs.collect()
}

/// Reports whether `bone` is a proper descendant of `ancestor`.
fn is_below(skeleton: &Skeleton, bone: BoneId, ancestor: BoneId) -> bool {
    let parent = |bone: &BoneId| skeleton.bones()[bone.index()].parent;
    std::iter::successors(parent(&bone), parent).any(|above| above == ancestor)
}

fn first_child_tail(skeleton: &Skeleton, bone: BoneId) -> Option<Vector3<f64>> {
    let mut children = skeleton
        .bones()
        .iter()
        .filter(|child| child.parent == Some(bone));
    children.next().map(|child| child.rest_tail())
}
