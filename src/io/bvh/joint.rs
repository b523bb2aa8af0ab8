//! Joints of a written BVH file. The format has no rest rotations.
//!
//! A bone j with the rest rotation A_j in the model becomes a joint without one. Let the bone have the local
//! rotation R_j and translation t_j in its parent p. The joint's rotation is then A_p R_j A_j⁻¹ and its position A_p t_j.
//! All angles are zero at rest, and joints are always at the positions of the bones.

use glam::{DQuat, DVec3, Quat, Vec3A};

use super::angles::{Axes, STILL};
use super::hierarchy::end_site_name;
use super::{BvhChannel, BvhError, BvhFormat, LONGEST, channel};
use crate::animation::{Armature, LocalTransform, Pose, SizeMismatch};
use crate::skeleton::BoneId;

/// Deviation of a scale from one that counts as rounding.
const UNSCALED: f32 = 1e-5;

/// A bone as it is written.
#[derive(Debug)]
pub(super) struct Joint {
    pub(super) children: Vec<usize>,
    pub(super) is_end_site: bool,
    /// Offset from the parent at rest.
    pub(super) offset: Vec3A,
    /// Channels in file order.
    pub(super) channels: Vec<BvhChannel>,
    /// Axes of the rotation channels.
    pub(super) axes: Axes,
    /// Rest rotation A_p of the parent in the model.
    parent_at_rest: DQuat,
    /// Rest rotation A_j in the model.
    at_rest: DQuat,
}

impl Joint {
    /// Position of the joint in its parent.
    pub(super) fn position(&self, local: &LocalTransform) -> Vec3A {
        turned(self.parent_at_rest, local.translation)
    }

    /// Rotation of the joint in its parent.
    pub(super) fn rotation(&self, local: &LocalTransform) -> DQuat {
        let turn = self.parent_at_rest * local.rotation.as_dquat() * self.at_rest.conjugate();
        turn.normalize()
    }

    /// Returns true if a position without a channel differs from the offset.
    fn lacks_position(
        &self,
        own: &[BvhChannel],
        axis: usize,
        mut locals: impl Iterator<Item = LocalTransform>,
    ) -> bool {
        let offset = self.offset.as_dvec3();
        let leaves = |local: LocalTransform| {
            let position = self.position(&local).as_dvec3();
            (position[axis] - offset[axis]).abs() > STILL * offset.length()
        };
        !own.contains(&BvhChannel::of_axis(axis, false)) && locals.any(leaves)
    }

    /// Sets the channels: missing positions, the given channels, then missing rotations.
    fn set_channels(&mut self, own: &[BvhChannel], positions: Vec<usize>, complete: bool) {
        let turns = own.iter().filter(|channel| channel.is_rotation());
        let given: Vec<usize> = turns.map(|channel| channel.axis()).collect();
        let axes = Axes::new(&given);
        self.axes = if complete { axes.completed() } else { axes };
        let positions = positions.into_iter();
        let added = self.axes.to_vec().into_iter().skip(given.len());
        self.channels = positions
            .map(|axis| BvhChannel::of_axis(axis, false))
            .chain(own.iter().copied())
            .chain(added.map(|axis| BvhChannel::of_axis(axis, true)))
            .collect();
    }
}

/// Joints of the bones, by index. Returns an error if the format cannot represent the armature, the poses or the
/// channels.
pub(super) fn joints(
    armature: &Armature,
    poses: &[Pose],
    format: &BvhFormat,
) -> Result<Vec<Joint>, BvhError> {
    if armature.bones() == 0 {
        return Err(BvhError::NoBones);
    }
    for pose in poses {
        SizeMismatch::check("bones in a pose", pose.bones(), armature.bones())?;
    }
    if let Some(channels) = format.channels() {
        SizeMismatch::check("lists of channels", channels.len(), armature.bones())?;
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
        let mut joint = Joint {
            children: Vec::new(),
            is_end_site: false,
            offset: turned(parent_at_rest, rest.translation),
            channels: Vec::new(),
            axes: Axes::new(&[]),
            parent_at_rest,
            at_rest: (parent_at_rest * rest.rotation.as_dquat()).normalize(),
        };
        let locals = poses.iter().map(|pose| pose.local_of(bone));
        match format.channels().map(|all| all[bone.index()].as_slice()) {
            None => {
                let moves = parent.is_none() || locals.clone().any(|own| is_moved(&rest, &own));
                joint.set_channels(&[], if moves { vec![0, 1, 2] } else { Vec::new() }, true);
            }
            Some(own) => {
                if let Some(fault) = channel::fault(own) {
                    let bone = name.clone();
                    return Err(BvhError::Channels { bone, fault });
                }
                let missing =
                    (0..3).filter(|axis| joint.lacks_position(own, *axis, locals.clone()));
                let missing: Vec<usize> = missing.collect();
                let axes = own.iter().filter(|channel| channel.is_rotation());
                joint.axes = Axes::new(&axes.map(|channel| channel.axis()).collect::<Vec<_>>());
                let reproduces =
                    |local: LocalTransform| joint.axes.reproduce(joint.rotation(&local));
                let is_complete = locals.clone().all(reproduces);
                joint.set_channels(own, missing, !is_complete);
            }
        }
        joints.push(joint);
    }
    let mut end_sites = vec![0; joints.len()];
    for bone in bones {
        let Some(parent) = armature.parent(bone).map(BoneId::index) else {
            continue;
        };
        let names = armature.names();
        let own = end_site_name(&names[parent], end_sites[parent] + 1);
        let rest = armature.rest().local_of(bone);
        let joint = &mut joints[bone.index()];
        let is_still = match format.channels() {
            Some(_) => joint.channels.is_empty(),
            None => poses.iter().all(|pose| {
                let local = pose.local_of(bone);
                !is_moved(&rest, &local) && !is_turned(rest.rotation, local.rotation)
            }),
        };
        if own == names[bone.index()] && joint.children.is_empty() && is_still {
            joint.is_end_site = true;
            joint.channels.clear();
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
    // Half of the sine of the angle.
    (rest.conjugate() * rotation).xyz().length() > 0.5 * STILL
}

/// The rotated vector; exactly the vector for the identity.
fn turned(by: DQuat, vector: Vec3A) -> Vec3A {
    let turned: DVec3 = by * vector.as_dvec3();
    turned.as_vec3a()
}
