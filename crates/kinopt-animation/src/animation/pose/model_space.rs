//! Placement of bones in model coordinates.
//!
//! With W_j = W_parent(j) L_j, a given W_j determines the local transform W_parent(j)⁻¹ W_j. Ancestors do not change;
//! descendants move along.

use glam::{Affine3A, Quat, Vec3A};

use super::{Armature, LocalTransform, Mirror, Pose};
use crate::animation::ClipError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::skeleton::BoneId;

/// Ratio of a parent's volume to its longest axis cubed below which its transform counts as singular.
const MIN_VOLUME_RATIO: f32 = 1e-6;

impl Armature {
    /// Model transform of one bone: W_j, the product of the local transforms from the root.
    /// [`local_to_model`](Self::local_to_model) computes all bones.
    ///
    /// # Errors
    /// The pose is of another armature, or the bone does not exist.
    pub fn model_from_bone(&self, pose: &Pose, bone: BoneId) -> Result<Affine3A, ClipError> {
        self.check(pose, bone)?;
        Ok(self.model_transform(pose, Some(bone)))
    }

    /// Rotation of one bone in the model: the product of the rotations from the root, without scales. Below mirrored
    /// bones rotations are in reflected axes.
    ///
    /// # Errors
    /// As [`model_from_bone`](Self::model_from_bone).
    pub fn model_rotation(&self, pose: &Pose, bone: BoneId) -> Result<Quat, ClipError> {
        self.check(pose, bone)?;
        Ok(self.model_rotation_of(pose, Some(bone)))
    }

    /// Sets the model transform of a bone; [`model_from_bone`](Self::model_from_bone) then returns it. Ancestors do not
    /// change; descendants move along. The pose does not change on an error.
    ///
    /// # Errors
    /// - As [`model_from_bone`](Self::model_from_bone).
    /// - A number is not finite.
    /// - The parent's transform is singular.
    /// - The local transform would contain shear ([`ClipError::Sheared`]).
    pub fn set_model_from_bone(
        &self,
        pose: &mut Pose,
        bone: BoneId,
        model_from_bone: Affine3A,
    ) -> Result<(), ClipError> {
        let parent_from_model = self.parent_from_model(pose, bone)?;
        let index = bone.index();
        if !model_from_bone.is_finite() {
            return Err(ClipError::NonFiniteTransform { bone: index });
        }
        let local = LocalTransform::of_affine(&(parent_from_model * model_from_bone));
        let local = local.ok_or(ClipError::Sheared { bone: index })?;
        pose.set_local(bone, local)
    }

    /// Sets the rotation of a bone in the model; [`model_rotation`](Self::model_rotation) then returns it. Its local
    /// translation and scale do not change; descendants move along. The pose does not change on an error.
    ///
    /// # Errors
    /// As [`model_from_bone`](Self::model_from_bone); also a quaternion that is zero or not finite.
    pub fn set_model_rotation(
        &self,
        pose: &mut Pose,
        bone: BoneId,
        model_from_bone: Quat,
    ) -> Result<(), ClipError> {
        self.check(pose, bone)?;
        let parent_bone = self.parent(bone);
        let parent_rotation = self.model_rotation_of(pose, parent_bone);
        let mirror = self.mirror(pose, parent_bone);
        pose.set_rotation(
            bone,
            mirror.single(parent_rotation.conjugate() * model_from_bone),
        )
    }

    /// Sets the position of a bone's origin in the model, in the model's unit. Its rotation and scale do not change;
    /// descendants move along. The pose does not change on an error.
    ///
    /// # Errors
    /// - As [`model_from_bone`](Self::model_from_bone).
    /// - A number is not finite.
    /// - The parent's transform is singular.
    pub fn set_model_translation(
        &self,
        pose: &mut Pose,
        bone: BoneId,
        origin: Vec3A,
    ) -> Result<(), ClipError> {
        let parent_from_model = self.parent_from_model(pose, bone)?;
        pose.set_translation(bone, parent_from_model.transform_point3a(origin))
    }

    fn check(&self, pose: &Pose, bone: BoneId) -> Result<(), ClipError> {
        SizeMismatch::check("bones in the pose", pose.bones(), self.bones())?;
        let (bone, bones) = (bone.index(), self.bones());
        match bone < bones {
            true => Ok(()),
            false => Err(ClipError::UnknownPoseBone { bone, bones }),
        }
    }

    /// A bone and its ancestors, upwards.
    pub(in crate::animation) fn bone_and_ancestors(
        &self,
        bone: Option<BoneId>,
    ) -> impl Iterator<Item = BoneId> + '_ {
        std::iter::successors(bone, |&bone| self.parent(bone))
    }

    fn model_transform(&self, pose: &Pose, bone: Option<BoneId>) -> Affine3A {
        self.bone_and_ancestors(bone)
            .fold(Affine3A::IDENTITY, |product, bone| {
                pose.local_of(bone).to_affine() * product
            })
    }

    fn model_rotation_of(&self, pose: &Pose, bone: Option<BoneId>) -> Quat {
        let bones = self.bone_and_ancestors(bone);
        bones.fold(Quat::IDENTITY, |product, bone| {
            let local = pose.local_of(bone);
            local.rotation * Mirror::NONE.below(local.scale).single(product)
        })
    }

    /// Mirror of a bone's children.
    fn mirror(&self, pose: &Pose, bone: Option<BoneId>) -> Mirror {
        let bones = self.bone_and_ancestors(bone);
        bones.fold(Mirror::NONE, |mirror, bone| {
            mirror.below(pose.local_of(bone).scale)
        })
    }

    /// Inverse of the model transform of a bone's parent.
    fn parent_from_model(&self, pose: &Pose, bone: BoneId) -> Result<Affine3A, ClipError> {
        self.check(pose, bone)?;
        let model_from_parent = self.model_transform(pose, self.parent(bone));
        let matrix = model_from_parent.matrix3;
        let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
        let longest = x.length().max(y.length()).max(z.length());
        let volume = x.cross(y).dot(z).abs();
        let min_volume = MIN_VOLUME_RATIO * longest * longest * longest;
        // `volume <= min_volume` would accept NaN.
        if volume > min_volume {
            Ok(model_from_parent.inverse())
        } else {
            Err(ClipError::Flattened { bone: bone.index() })
        }
    }
}
