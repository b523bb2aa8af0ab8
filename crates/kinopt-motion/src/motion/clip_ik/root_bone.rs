//! Choice of the root bone.

use kinopt_animation::animation::Armature;
use kinopt_kinematics::skeleton::BoneId;

/// Returns the ancestors of a bone, parent first.
pub(super) fn ancestors(armature: &Armature, bone: BoneId) -> Vec<BoneId> {
    let parent = |bone: &BoneId| armature.parent(*bone);
    std::iter::successors(parent(&bone), parent).collect()
}

/// Returns the topmost common ancestor of the bones from which the armature branches.
///
/// A child without children is often a mesh node, a camera or a light. It is a branch only if `is_bone` is true for it.
/// If the armature branches nowhere, children of any kind are branches.
pub(super) fn branching_above(
    armature: &Armature,
    bones: &[BoneId],
    is_bone: impl Fn(BoneId) -> bool,
) -> Option<BoneId> {
    let ancestor_lists: Vec<Vec<BoneId>> = bones
        .iter()
        .map(|&bone| ancestors(armature, bone))
        .collect();
    let [mut children, mut branches] = [0; 2].map(|count| vec![count; armature.bones()]);
    // Children come after their parents, so their own children are counted before them.
    for bone in armature.bone_ids().collect::<Vec<_>>().into_iter().rev() {
        let Some(parent) = armature.parent(bone) else {
            continue;
        };
        children[parent.index()] += 1;
        if children[bone.index()] > 0 || is_bone(bone) {
            branches[parent.index()] += 1;
        }
    }
    let topmost = |counts: &[usize]| {
        let mut from_top = ancestor_lists.first()?.iter().rev();
        let carries_all = |bone: &BoneId| ancestor_lists.iter().all(|list| list.contains(bone));
        let branching = from_top.find(|bone| counts[bone.index()] > 1 && carries_all(bone));
        branching.copied()
    };
    topmost(&branches).or_else(|| topmost(&children))
}
