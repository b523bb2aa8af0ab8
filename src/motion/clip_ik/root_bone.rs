//! Choice of the root bone.

use crate::animation::Armature;
use crate::skeleton::BoneId;

/// Returns the ancestors of a bone, parent first.
pub(super) fn ancestors(armature: &Armature, bone: BoneId) -> Vec<BoneId> {
    let parent = |bone: &BoneId| armature.parent(*bone);
    std::iter::successors(parent(&bone), parent).collect()
}

/// Returns the topmost common ancestor of the bones that has more than one child.
pub(super) fn branching_above(armature: &Armature, bones: &[BoneId]) -> Option<BoneId> {
    let ancestor_lists: Vec<Vec<BoneId>> = bones
        .iter()
        .map(|&bone| ancestors(armature, bone))
        .collect();
    let has_several_children = |bone: &BoneId| {
        let children = armature.bone_ids();
        children
            .filter(|child| armature.parent(*child) == Some(*bone))
            .count()
            > 1
    };
    let mut from_top = ancestor_lists.first()?.iter().rev();
    let branching = from_top.find(|bone| {
        ancestor_lists.iter().all(|chain| chain.contains(bone)) && has_several_children(bone)
    });
    branching.copied()
}
