//! Joints of a written BVH file. The format has no rest rotations.
//!
//! A bone j with the rest rotation A_j in the model becomes a joint without one. Let the bone have the local
//! rotation R_j and translation t_j in its parent p. The joint's rotation is then A_p R_j A_j⁻¹ and its position A_p t_j.
//! All angles are zero at rest, and joints are always at the positions of the bones.

use glam::{DQuat, DVec3, Quat, Vec3A};

use super::angles::{Axes, ROTATION_TOLERANCE};
use super::hierarchy::end_site_name;
use super::{BvhChannel, BvhFormat, MAX_COORDINATE, channel};
use crate::animation::{Armature, LocalTransform, Pose, SizeMismatch};
use crate::io::FormatError;
use kinopt_kinematics::skeleton::BoneId;

/// Deviation of a scale from one that counts as rounding.
const SCALE_TOLERANCE: f32 = 1e-5;

/// A bone as it is written.
#[derive(Debug)]
pub(super) struct WrittenJoint {
    pub(super) children: Vec<usize>,
    pub(super) is_end_site: bool,
    /// Offset from the parent at rest.
    pub(super) offset: Vec3A,
    /// Channels in file order.
    pub(super) channels: Vec<BvhChannel>,
    /// Axes of the rotation channels.
    pub(super) axes: Axes,
    /// Rest rotation A_p of the parent in the model.
    parent_rest_rotation: DQuat,
    /// Rest rotation A_j in the model.
    rest_rotation: DQuat,
}

impl WrittenJoint {
    /// Position of the joint in its parent.
    pub(super) fn position(&self, local: &LocalTransform) -> Vec3A {
        rotate(self.parent_rest_rotation, local.translation)
    }

    /// Rotation of the joint in its parent.
    pub(super) fn rotation(&self, local: &LocalTransform) -> DQuat {
        let rotation =
            self.parent_rest_rotation * local.rotation.as_dquat() * self.rest_rotation.conjugate();
        rotation.normalize()
    }

    /// Returns true if a position without a channel differs from the offset.
    fn lacks_position(
        &self,
        given_channels: &[BvhChannel],
        axis: usize,
        mut locals: impl Iterator<Item = LocalTransform>,
    ) -> bool {
        let offset = self.offset.as_dvec3();
        let differs = |local: LocalTransform| {
            let position = self.position(&local).as_dvec3();
            (position[axis] - offset[axis]).abs() > ROTATION_TOLERANCE * offset.length()
        };
        !given_channels.contains(&BvhChannel::of_axis(axis, false)) && locals.any(differs)
    }

    /// Sets the channels: missing positions, the given channels, then missing rotations.
    fn set_channels(
        &mut self,
        given_channels: &[BvhChannel],
        positions: Vec<usize>,
        complete: bool,
    ) {
        let rotations = given_channels
            .iter()
            .filter(|channel| channel.is_rotation());
        let given_axes: Vec<usize> = rotations.map(|channel| channel.axis()).collect();
        let axes = Axes::new(&given_axes);
        self.axes = if complete { axes.completed() } else { axes };
        let positions = positions.into_iter();
        let added = self.axes.to_vec().into_iter().skip(given_axes.len());
        self.channels = positions
            .map(|axis| BvhChannel::of_axis(axis, false))
            .chain(given_channels.iter().copied())
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
) -> Result<Vec<WrittenJoint>, FormatError> {
    if armature.bones() == 0 {
        return Err(FormatError::NoBones);
    }
    for pose in poses {
        SizeMismatch::check("bones in a pose", pose.bones(), armature.bones())?;
    }
    if let Some(channels) = format.channels() {
        SizeMismatch::check("lists of channels", channels.len(), armature.bones())?;
    }
    let mut joints: Vec<WrittenJoint> = Vec::with_capacity(armature.bones());
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
        let parent_rest_rotation = match parent.and_then(|parent| joints.get_mut(parent)) {
            Some(parent) => {
                parent.children.push(bone.index());
                parent.rest_rotation
            }
            None => DQuat::IDENTITY,
        };
        let mut joint = WrittenJoint {
            children: Vec::new(),
            is_end_site: false,
            offset: rotate(parent_rest_rotation, rest.translation),
            channels: Vec::new(),
            axes: Axes::new(&[]),
            parent_rest_rotation,
            rest_rotation: (parent_rest_rotation * rest.rotation.as_dquat()).normalize(),
        };
        let locals = poses.iter().map(|pose| pose.local_of(bone));
        match format
            .channels()
            .map(|lists| lists[bone.index()].as_slice())
        {
            None => {
                let is_moving =
                    parent.is_none() || locals.clone().any(|local| is_moved(&rest, &local));
                joint.set_channels(
                    &[],
                    if is_moving { vec![0, 1, 2] } else { Vec::new() },
                    true,
                );
            }
            Some(given_channels) => {
                if let Some(fault) = channel::channel_error(given_channels) {
                    let bone = name.clone();
                    return Err(FormatError::Channels { bone, fault });
                }
                let missing_axes = (0..3)
                    .filter(|axis| joint.lacks_position(given_channels, *axis, locals.clone()));
                let missing_axes: Vec<usize> = missing_axes.collect();
                let axes = given_channels
                    .iter()
                    .filter(|channel| channel.is_rotation());
                joint.axes = Axes::new(&axes.map(|channel| channel.axis()).collect::<Vec<_>>());
                let is_representable =
                    |local: LocalTransform| joint.axes.can_represent(joint.rotation(&local));
                let is_complete = locals.clone().all(is_representable);
                joint.set_channels(given_channels, missing_axes, !is_complete);
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
        let tip_name = end_site_name(&names[parent], end_sites[parent] + 1);
        let rest = armature.rest().local_of(bone);
        let joint = &mut joints[bone.index()];
        let is_still = match format.channels() {
            Some(_) => joint.channels.is_empty(),
            None => poses.iter().all(|pose| {
                let local = pose.local_of(bone);
                !is_moved(&rest, &local) && !is_rotated(rest.rotation, local.rotation)
            }),
        };
        if tip_name == names[bone.index()] && joint.children.is_empty() && is_still {
            joint.is_end_site = true;
            joint.channels.clear();
            end_sites[parent] += 1;
        }
    }
    Ok(joints)
}

fn check_name(name: &str) -> Result<(), FormatError> {
    let words: Vec<&str> = name.split_whitespace().collect();
    if words.is_empty() || words.join(" ") != name || name.contains(['{', '}']) {
        let bone = name.to_owned();
        return Err(FormatError::Name { bone });
    }
    Ok(())
}

fn check_local(
    name: &str,
    local: &LocalTransform,
    frame: Option<usize>,
) -> Result<(), FormatError> {
    let bone = || name.to_owned();
    let longest = f64::from(local.translation.abs().max_element());
    let is_finite = local.translation.is_finite() && local.rotation.is_finite();
    if !is_finite || longest > MAX_COORDINATE {
        let bone = bone();
        return Err(FormatError::OutOfRange { bone, frame });
    }
    if !local.scale.is_finite() || (local.scale - Vec3A::ONE).abs().max_element() > SCALE_TOLERANCE
    {
        let bone = bone();
        return Err(FormatError::Scaled { bone, frame });
    }
    Ok(())
}

fn is_moved(rest: &LocalTransform, local: &LocalTransform) -> bool {
    let [rest, local] = [rest, local].map(|local| local.translation.as_dvec3());
    (local - rest).length() > ROTATION_TOLERANCE * rest.length()
}

fn is_rotated(rest: Quat, rotation: Quat) -> bool {
    let [rest, rotation] = [rest, rotation].map(|rotation| rotation.as_dquat().normalize());
    // Half of the sine of the angle.
    (rest.conjugate() * rotation).xyz().length() > 0.5 * ROTATION_TOLERANCE
}

/// The rotated vector; exactly the vector for the identity.
fn rotate(rotation: DQuat, vector: Vec3A) -> Vec3A {
    let rotated: DVec3 = rotation * vector.as_dvec3();
    rotated.as_vec3a()
}
