//! The bone that carries all that is asked for.

use crate::animation::Armature;
use crate::skeleton::BoneId;

/// What a bone hangs on, from its parent up.
pub(super) fn above(armature: &Armature, bone: BoneId) -> Vec<BoneId> {
    let parent = |bone: &BoneId| armature.parent(*bone);
    std::iter::successors(parent(&bone), parent).collect()
}

/// The topmost bone that carries all of these and at which the armature branches.
pub(super) fn branching_above(armature: &Armature, bones: &[BoneId]) -> Option<BoneId> {
    let carried: Vec<Vec<BoneId>> = bones.iter().map(|&bone| above(armature, bone)).collect();
    let branches = |bone: &BoneId| {
        let children = armature.bone_ids();
        children
            .filter(|child| armature.parent(*child) == Some(*bone))
            .count()
            > 1
    };
    let mut from_top = carried.first()?.iter().rev();
    let found =
        from_top.find(|bone| carried.iter().all(|above| above.contains(bone)) && branches(bone));
    found.copied()
}
