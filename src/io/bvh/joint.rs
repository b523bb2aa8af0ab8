//! How an armature stands in a BVH file, where no bone is turned at rest.
//!
//! A bone j that is turned by A_j in the model at rest becomes a joint that is not: the joint's
//! turn in its parent is A_p R_j A_j⁻¹ for a bone turned by R_j in its parent p, and its place there
//! A_p t_j. So at rest all angles are zero, and joints are always where the bones are.

use glam::{DQuat, DVec3, Quat, Vec3A};

use super::hierarchy::end_site_name;
use super::{BvhError, LONGEST};
use crate::animation::{Armature, LocalTransform, Pose, SizeMismatch};
use crate::skeleton::BoneId;

/// A bone that is off its rest by less, as a share of its offset or in radians, stays in its place:
/// what blending in single precision makes of a bone that nothing moves.
const STILL: f64 = 1e-6;
/// A scale that is off one by less is rounding.
const UNSCALED: f32 = 1e-5;

/// What a bone is in a file.
#[derive(Debug)]
pub(super) struct Joint {
    pub(super) children: Vec<usize>,
    pub(super) kind: Kind,
    /// From the parent at rest.
    pub(super) offset: Vec3A,
    /// A_p.
    parent_at_rest: DQuat,
    /// A_j.
    at_rest: DQuat,
}

/// What of a joint is in every frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    EndSite,
    Turns,
    TurnsAndMoves,
}

impl Joint {
    /// Where the joint is in its parent.
    pub(super) fn position(&self, local: &LocalTransform) -> Vec3A {
        turned(self.parent_at_rest, local.translation)
    }

    /// How the joint is turned in its parent.
    pub(super) fn rotation(&self, local: &LocalTransform) -> DQuat {
        let turn = self.parent_at_rest * local.rotation.as_dquat() * self.at_rest.conjugate();
        turn.normalize()
    }
}

/// The bones as joints, by index, once it is known that a file can say what they and the poses are.
pub(super) fn joints(armature: &Armature, poses: &[Pose]) -> Result<Vec<Joint>, BvhError> {
    if armature.bones() == 0 {
        return Err(BvhError::NoBones);
    }
    for pose in poses {
        SizeMismatch::check("bones in a pose", pose.bones(), armature.bones())?;
    }
    let mut joints: Vec<Joint> = Vec::with_capacity(armature.bones());
    let bones = (0..armature.bones()).filter_map(|index| armature.bone_at(index));
    for bone in bones.clone() {
        let name = &armature.names()[bone.index()];
        let rest = armature.rest().local_of(bone);
        check_name(name)?;
        check_local(name, &rest, None)?;
        for (frame, pose) in poses.iter().enumerate() {
            check_local(name, &pose.local_of(bone), Some(frame))?;
        }
        let parent = armature.parent(bone).map(BoneId::index);
        let parent_at_rest = match parent.and_then(|parent| joints.get_mut(parent)) {
            Some(parent) => {
                parent.children.push(bone.index());
                parent.at_rest
            }
            None => DQuat::IDENTITY,
        };
        let moves = |pose: &Pose| is_moved(&rest, &pose.local_of(bone));
        joints.push(Joint {
            children: Vec::new(),
            kind: match parent {
                Some(_) if !poses.iter().any(moves) => Kind::Turns,
                _ => Kind::TurnsAndMoves,
            },
            offset: turned(parent_at_rest, rest.translation),
            parent_at_rest,
            at_rest: (parent_at_rest * rest.rotation.as_dquat()).normalize(),
        });
    }
    let mut end_sites = vec![0; joints.len()];
    for bone in bones {
        let Some(parent) = armature.parent(bone).map(BoneId::index) else {
            continue;
        };
        let names = armature.names();
        let own = end_site_name(&names[parent], end_sites[parent] + 1);
        let rest = armature.rest().local_of(bone).rotation;
        let turns = |pose: &Pose| is_turned(rest, pose.local_of(bone).rotation);
        let joint = &mut joints[bone.index()];
        let is_still = joint.kind == Kind::Turns && !poses.iter().any(turns);
        if own == names[bone.index()] && joint.children.is_empty() && is_still {
            joint.kind = Kind::EndSite;
            end_sites[parent] += 1;
        }
    }
    Ok(joints)
}

fn check_name(name: &str) -> Result<(), BvhError> {
    let words: Vec<&str> = name.split_whitespace().collect();
    if words.is_empty() || words.join(" ") != name || name.contains(['{', '}']) {
        let bone = name.to_owned();
        return Err(BvhError::Name { bone });
    }
    Ok(())
}

fn check_local(name: &str, local: &LocalTransform, frame: Option<usize>) -> Result<(), BvhError> {
    let bone = || name.to_owned();
    let longest = f64::from(local.translation.abs().max_element());
    let is_finite = local.translation.is_finite() && local.rotation.is_finite();
    if !is_finite || longest > LONGEST {
        let bone = bone();
        return Err(BvhError::OutOfRange { bone, frame });
    }
    if !local.scale.is_finite() || (local.scale - Vec3A::ONE).abs().max_element() > UNSCALED {
        let bone = bone();
        return Err(BvhError::Scaled { bone, frame });
    }
    Ok(())
}

fn is_moved(rest: &LocalTransform, local: &LocalTransform) -> bool {
    let [rest, local] = [rest, local].map(|local| local.translation.as_dvec3());
    (local - rest).length() > STILL * rest.length()
}

fn is_turned(rest: Quat, rotation: Quat) -> bool {
    let [rest, rotation] = [rest, rotation].map(|rotation| rotation.as_dquat().normalize());
    // Half the angle's sine.
    (rest.conjugate() * rotation).xyz().length() > 0.5 * STILL
}

/// As it is, to the last bit, where nothing turns it.
fn turned(by: DQuat, vector: Vec3A) -> Vec3A {
    let turned: DVec3 = by * vector.as_dvec3();
    turned.as_vec3a()
}
