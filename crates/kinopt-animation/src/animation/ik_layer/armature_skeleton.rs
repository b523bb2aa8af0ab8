//! Conversion of armatures to skeletons for the solver.

use std::collections::BTreeSet;

use glam::{DAffine3, DMat3, DQuat};

use super::euler_pose_map::has_bones;
use super::posed_skeleton::PosedSkeleton;
use crate::animation::{Armature, Mirror, Pose};
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::model::Limits;
use kinopt_kinematics::model::ModelError;
use kinopt_kinematics::skeleton::{ANGLES_PER_BONE, Bone, BoneId, Skeleton};
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

impl Pose {
    /// `skeleton` with its joints and tips at their positions in this pose of its armature, with the pose's
    /// translations and scales. The meaning of the angles and the rest placements do not change.
    ///
    /// # Errors
    /// The pose has fewer bones.
    pub fn posed_skeleton(&self, skeleton: &Skeleton) -> Result<Skeleton, SizeMismatch> {
        has_bones(self, skeleton.bones().len())?;
        let bones: Vec<BoneId> = skeleton.bone_ids().collect();
        let mut posed = PosedSkeleton::new(skeleton, &bones);
        Ok(posed.update(self, &bones).clone())
    }
}

impl Armature {
    /// The skeleton with the same bones and ids, in the armature's rest pose. [`ReachLayer`](super::ReachLayer) and
    /// problems are defined on it. [`EulerPoseMap`](super::EulerPoseMap) converts its angles to poses of this armature.
    ///
    /// An armature does not define where bones end, so the tip of each bone is at its origin: the tip of a hand is the
    /// wrist. `limits` gives the ranges in radians of a bone's first twist, bend and second twist about its own x, z
    /// and x.
    ///
    /// Scales of the rest pose are part of the bone lengths: every joint is at its rest position in the model. The axes
    /// of a bone are the product of the rotations from the root. Below a mirrored bone they are reflected, so the
    /// skeleton rotates like the mirrored armature.
    ///
    /// Below an [unevenly scaled](Self::scale_notes) bone the armature shears and the skeleton does not, so their
    /// joints separate as bones rotate. [`ReachLayer`](super::ReachLayer) and
    /// `ClipIk` solve for the joints of the armature. A [`Drag`](kinopt_solver::ik::Drag)
    /// does so if [`move_joints`](kinopt_solver::ik::Drag::move_joints) is called after each frame.
    ///
    /// # Errors
    /// A [`ModelError`] with the bone whose limits are not an interval.
    pub fn skeleton(
        &self,
        name: impl Into<String>,
        limits: impl Fn(BoneId) -> [Limits; ANGLES_PER_BONE],
    ) -> Result<Skeleton, ModelError> {
        let mut placed: Vec<(DAffine3, DQuat, Mirror)> = Vec::with_capacity(self.bones());
        let mut bones = Vec::with_capacity(self.bones());
        for (index, name) in self.names().iter().enumerate() {
            let bone = BoneId::new(index);
            let local = self.rest().local_of(bone);
            let parent = self.parent(bone);
            let (model_from_parent, parent_rotation, mirror) = parent
                .and_then(|parent| placed.get(parent.index()).copied())
                .unwrap_or((DAffine3::IDENTITY, DQuat::IDENTITY, Mirror::NONE));
            let local_rotation = local.rotation.as_dquat().normalize();
            let model_from_bone = model_from_parent
                * DAffine3::from_scale_rotation_translation(
                    local.scale.as_dvec3(),
                    local_rotation,
                    local.translation.as_dvec3(),
                );
            let rotation = (parent_rotation * mirror.rotation(local_rotation)).normalize();
            placed.push((model_from_bone, rotation, mirror.below(local.scale)));
            let columns = DMat3::from_quat(rotation)
                .to_cols_array_2d()
                .map(Vector3::from);
            let origin = model_from_bone.translation.to_array();
            bones.push(Bone {
                name: name.clone(),
                parent,
                length: 0.0,
                model_from_rest: Placement::new(
                    Matrix3::from_columns(columns[0], columns[1], columns[2]),
                    Vector3::from(origin),
                ),
                limits: limits(bone),
            });
        }
        Skeleton::new(name, bones)
    }

    /// [`skeleton`](Self::skeleton) with unlimited rotation of the bones in `turning` and all other bones locked. Use
    /// [the skinned bones](crate::io::gltf::Scene::turning_bones) of a scene, or [the bones with
    /// channels](crate::io::bvh::MotionCapture::turning_bones) of a capture.
    ///
    /// # Errors
    /// As [`skeleton`](Self::skeleton).
    pub fn turning_skeleton(
        &self,
        name: impl Into<String>,
        turning: &BTreeSet<BoneId>,
    ) -> Result<Skeleton, ModelError> {
        self.skeleton(name, |bone| match turning.contains(&bone) {
            true => [Limits::UNBOUNDED; ANGLES_PER_BONE],
            false => [Limits::new(0.0, 0.0); ANGLES_PER_BONE],
        })
    }
}
