//! Conversion between local transforms of a pose (single precision) and configurations of ball joints.

use glam::{DAffine3, DQuat, DVec3, Vec3A};

use super::ReachError;
use super::pose_angles::has_bones;
use crate::animation::{Armature, Mirror, Pose};
use crate::skeleton::{BallSkeleton, BoneId};
use crate::{Buffer, SizeMismatch};

/// Map between configurations of a [`BallSkeleton`] and poses of its armature. Locked bones, scales and all
/// translations except those of a free root do not change.
#[derive(Clone, Debug)]
pub struct BallPoseMap {
    figure: BallSkeleton,
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
    parent_turned: DQuat,
    /// Position at rest in the model.
    tail: DVec3,
}

impl BallPoseMap {
    /// Map for poses of `armature`, whose bones are those of `figure`. The figure was made of [the armature's
    /// skeleton](Armature::skeleton), or the armature is [of the skeleton](Armature::of_skeleton).
    #[must_use]
    pub fn new(armature: &Armature, figure: &BallSkeleton) -> Self {
        let rest = armature.rest();
        let local = |bone: BoneId| {
            let local = rest.local_of(bone);
            let rotation = local.rotation.as_dquat().normalize();
            let (scale, at) = (local.scale.as_dvec3(), local.translation.as_dvec3());
            let affine = DAffine3::from_scale_rotation_translation(scale, rotation, at);
            (affine, rotation)
        };
        let ids = (0..armature.bones()).map(BoneId::new);
        let mut mirrors: Vec<Mirror> = Vec::with_capacity(armature.bones());
        for bone in ids.clone() {
            let above = armature.parent(bone);
            let mirror = above.map_or(Mirror::NONE, |above| {
                mirrors[above.index()].below(rest.local_of(above).scale)
            });
            mirrors.push(mirror);
        }
        let roots = ids
            .clone()
            .filter(|&bone| figure.is_free(bone))
            .map(|bone| {
                let mut above = (DAffine3::IDENTITY, DQuat::IDENTITY);
                let parent = |bone: &BoneId| armature.parent(*bone);
                for carrier in std::iter::successors(parent(&bone), parent) {
                    let (affine, rotation) = local(carrier);
                    let turned = mirrors[carrier.index()].rotation(rotation);
                    above = (affine * above.0, turned * above.1);
                }
                let (model_from_parent, parent_turned) = above;
                Root {
                    bone,
                    tail: (model_from_parent * local(bone).0).translation,
                    model_from_parent,
                    parent_turned,
                }
            });
        Self {
            roots: roots.collect(),
            rest: ids.map(|bone| local(bone).1).collect(),
            figure: figure.clone(),
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
        let model = self.figure.model();
        let q = q.sized(model.configuration_len());
        SizeMismatch::check("numbers", q.len(), model.configuration_len())?;
        let bones = self.rest.iter().zip(&self.mirrors).zip(pose.rotations());
        for (index, ((rest, mirror), rotation)) in bones.enumerate() {
            let bone = BoneId::new(index);
            let joint = self.figure.joint(bone);
            let Some(at) = joint.and_then(|joint| model.coordinate(joint)) else {
                continue;
            };
            let rotation = rotation.as_dquat().normalize();
            let turned = match self.root(bone) {
                Some(root) => {
                    let own = pose.local_of(bone).translation.as_dvec3();
                    let went = root.model_from_parent.transform_point3(own) - root.tail;
                    let slides = at.checked_sub(3).and_then(|first| q.get_mut(first..at));
                    if let Some(slides) = slides {
                        slides.copy_from_slice(&went.to_array());
                    }
                    // In the axes of the model: P r = t (P r₀).
                    let carried = root.parent_turned;
                    let [rotation, back] = [rotation, rest.conjugate()].map(|q| mirror.rotation(q));
                    carried * rotation * back * carried.conjugate()
                }
                None => mirror.rotation(rest.conjugate() * rotation),
            };
            let turned = turned.normalize();
            // Of the two quaternions of a rotation, the one nearer to rest.
            let [x, y, z, w] = match turned.w < 0.0 {
                true => -turned,
                false => turned,
            }
            .to_array();
            if let Some(own) = q.get_mut(at..at + 4) {
                own.copy_from_slice(&[w, x, y, z]);
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
    pub fn pose_of(&self, q: &[f64], pose: &mut Pose) -> Result<(), ReachError> {
        has_bones(pose, self.rest.len())?;
        self.figure.model().check_configuration(q)?;
        for (index, (rest, mirror)) in self.rest.iter().zip(&self.mirrors).enumerate() {
            let bone = BoneId::new(index);
            let Some((turned, went)) = self.figure.turned(bone, q) else {
                continue;
            };
            let [x, y, z] = turned.v.to_array();
            let turned = DQuat::from_xyzw(x, y, z, turned.w);
            let rotation = match self.root(bone) {
                Some(root) => {
                    let place = root.tail + DVec3::from(went.to_array());
                    let own = root.model_from_parent.inverse().transform_point3(place);
                    // With a singular parent transform the root does not change.
                    let own = own.is_finite().then(|| Vec3A::from(own.as_vec3()));
                    if let Some((own, translation)) = own.zip(pose.translations.get_mut(index)) {
                        *translation = own;
                    }
                    let carried = root.parent_turned;
                    mirror.rotation(carried.conjugate() * turned * carried) * *rest
                }
                None => *rest * mirror.rotation(turned),
            };
            if let Some(own) = pose.rotations.get_mut(index) {
                *own = rotation.normalize().as_quat().normalize();
            }
        }
        Ok(())
    }

    fn root(&self, bone: BoneId) -> Option<&Root> {
        self.roots.iter().find(|root| root.bone == bone)
    }
}
