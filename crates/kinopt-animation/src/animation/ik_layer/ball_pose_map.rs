//! Conversion between local transforms of a pose (single precision) and configurations of ball joints.

use glam::{DAffine3, DQuat, DVec3, Vec3A};

use super::euler_pose_map::{has_bones, hinge_angle};
use crate::animation::{Armature, LayerError, Mirror, Pose};
use kinopt_kinematics::Buffer;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::skeleton::{BallSkeleton, BoneId};

/// Map between configurations of a [`BallSkeleton`] and poses of its armature. Locked bones, scales and all
/// translations except those of a free root do not change.
#[derive(Clone, Debug)]
pub struct BallPoseMap {
    skeleton: BallSkeleton,
    /// Local rotation of each bone at rest.
    rest: Vec<DQuat>,
    /// Mirror of the ancestors of each bone at rest.
    mirrors: Vec<Mirror>,
    /// Roots of a skeleton with a free base.
    roots: Vec<Root>,
}

/// Bone moved by a free root.
#[derive(Clone, Debug)]
struct Root {
    bone: BoneId,
    /// Placement of its parent at rest.
    model_from_parent: DAffine3,
    /// The placement of the parent without scale.
    parent_rotation: DQuat,
    /// Position at rest in the model.
    tail: DVec3,
}

impl BallPoseMap {
    /// Map for poses of `armature`, whose bones are those of `skeleton`. The skeleton was made of [the armature's
    /// skeleton](Armature::skeleton), or the armature is [of the skeleton](Armature::of_skeleton).
    #[must_use]
    pub fn new(armature: &Armature, skeleton: &BallSkeleton) -> Self {
        let rest = armature.rest();
        let local = |bone: BoneId| {
            let local = rest.local_of(bone);
            let rotation = local.rotation.as_dquat().normalize();
            let (scale, translation) = (local.scale.as_dvec3(), local.translation.as_dvec3());
            let affine = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
            (affine, rotation)
        };
        let ids = (0..armature.bones()).map(BoneId::new);
        let mut mirrors: Vec<Mirror> = Vec::with_capacity(armature.bones());
        for bone in ids.clone() {
            let parent = armature.parent(bone);
            let mirror = parent.map_or(Mirror::NONE, |parent| {
                mirrors[parent.index()].below(rest.local_of(parent).scale)
            });
            mirrors.push(mirror);
        }
        let roots = ids
            .clone()
            .filter(|&bone| skeleton.is_free(bone))
            .map(|bone| {
                let mut product = (DAffine3::IDENTITY, DQuat::IDENTITY);
                let parent = |bone: &BoneId| armature.parent(*bone);
                for ancestor in std::iter::successors(parent(&bone), parent) {
                    let (affine, rotation) = local(ancestor);
                    let mirrored = mirrors[ancestor.index()].rotation(rotation);
                    product = (affine * product.0, mirrored * product.1);
                }
                let (model_from_parent, parent_rotation) = product;
                Root {
                    bone,
                    tail: (model_from_parent * local(bone).0).translation,
                    model_from_parent,
                    parent_rotation,
                }
            });
        Self {
            roots: roots.collect(),
            rest: ids.map(|bone| local(bone).1).collect(),
            skeleton: skeleton.clone(),
            mirrors,
        }
    }

    /// Writes the configuration of a pose: the rotation of each bone from rest and the placement of a free root. Cone
    /// limits are not applied. A `Vec` is resized.
    ///
    /// # Errors
    /// The pose has fewer bones, or a slice has another length.
    pub fn configuration_of(
        &self,
        pose: &Pose,
        q: &mut (impl Buffer<f64> + ?Sized),
    ) -> Result<(), SizeMismatch> {
        has_bones(pose, self.rest.len())?;
        let model = self.skeleton.model();
        let q = q.sized(model.configuration_len());
        SizeMismatch::check("numbers", q.len(), model.configuration_len())?;
        let bones = self.rest.iter().zip(&self.mirrors).zip(pose.rotations());
        for (index, ((rest, mirror), rotation)) in bones.enumerate() {
            let bone = BoneId::new(index);
            let joint = self.skeleton.joint(bone);
            let Some(coordinate) = joint.and_then(|joint| model.coordinate(joint)) else {
                continue;
            };
            let rotation = rotation.as_dquat().normalize();
            let joint_rotation = match self.root(bone) {
                Some(root) => {
                    let local = pose.local_of(bone).translation.as_dvec3();
                    let offset = root.model_from_parent.transform_point3(local) - root.tail;
                    let prismatic = coordinate
                        .checked_sub(3)
                        .and_then(|first| q.get_mut(first..coordinate));
                    if let Some(prismatic) = prismatic {
                        prismatic.copy_from_slice(&offset.to_array());
                    }
                    // In the axes of the model: P r = t (P r₀).
                    let parent_rotation = root.parent_rotation;
                    let [rotation, rest_inverse] =
                        [rotation, rest.conjugate()].map(|q| mirror.rotation(q));
                    parent_rotation * rotation * rest_inverse * parent_rotation.conjugate()
                }
                None => mirror.rotation(rest.conjugate() * rotation),
            };
            let joint_rotation = joint_rotation.normalize();
            if let Some(hinge) = self.skeleton.hinge(bone) {
                if let Some(angle) = q.get_mut(coordinate) {
                    *angle = hinge_angle(&hinge, joint_rotation);
                }
                continue;
            }
            // Of the two quaternions of a rotation, the one nearer to rest.
            let [x, y, z, w] = match joint_rotation.w < 0.0 {
                true => -joint_rotation,
                false => joint_rotation,
            }
            .to_array();
            if let Some(quaternion) = q.get_mut(coordinate..coordinate + 4) {
                quaternion.copy_from_slice(&[w, x, y, z]);
            }
        }
        Ok(())
    }

    /// Writes the local rotations of a configuration into a pose, and the placement of a free root. The pose does not
    /// change on an error.
    ///
    /// # Errors
    /// - The pose has fewer bones.
    /// - The configuration has another length, is not finite, or contains a zero quaternion.
    pub fn pose_of(&self, q: &[f64], pose: &mut Pose) -> Result<(), LayerError> {
        has_bones(pose, self.rest.len())?;
        self.skeleton.model().check_configuration(q)?;
        for (index, (rest, mirror)) in self.rest.iter().zip(&self.mirrors).enumerate() {
            let bone = BoneId::new(index);
            let Some((joint_rotation, offset)) = self.skeleton.rotation_and_offset(bone, q) else {
                continue;
            };
            let [x, y, z] = joint_rotation.v.to_array();
            let joint_rotation = DQuat::from_xyzw(x, y, z, joint_rotation.w);
            let rotation = match self.root(bone) {
                Some(root) => {
                    let position = root.tail + DVec3::from(offset.to_array());
                    let local = root.model_from_parent.inverse().transform_point3(position);
                    // With a singular parent transform the root does not change.
                    let local = local.is_finite().then(|| Vec3A::from(local.as_vec3()));
                    if let Some((local, translation)) = local.zip(pose.translations.get_mut(index))
                    {
                        *translation = local;
                    }
                    let parent_rotation = root.parent_rotation;
                    mirror.rotation(parent_rotation.conjugate() * joint_rotation * parent_rotation)
                        * *rest
                }
                None => *rest * mirror.rotation(joint_rotation),
            };
            if let Some(local_rotation) = pose.rotations.get_mut(index) {
                *local_rotation = rotation.normalize().as_quat().normalize();
            }
        }
        Ok(())
    }

    fn root(&self, bone: BoneId) -> Option<&Root> {
        self.roots.iter().find(|root| root.bone == bone)
    }
}
