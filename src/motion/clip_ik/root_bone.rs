//! Choice of the root bone.

use crate::animation::Armature;
use crate::skeleton::BoneId;

/// Returns the ancestors of a bone, parent first.
pub(super) fn above(armature: &Armature, bone: BoneId) -> Vec<BoneId> {
    let parent = |bone: &BoneId| armature.parent(*bone);
    std::iter::successors(parent(&bone), parent).collect()
}

/// Returns the topmost common ancestor of the bones that has more than one child.
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
