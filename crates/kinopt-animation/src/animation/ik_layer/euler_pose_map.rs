//! Conversion between local rotations of a pose (single precision) and Euler angles of a skeleton.

use glam::{DQuat, Quat};

use crate::animation::rotation::EulerOrder;
use crate::animation::{LayerError, Mirror, Pose};
use kinopt_kinematics::Buffer;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::model::{Limits, ModelError};
use kinopt_kinematics::skeleton::{ANGLES_PER_BONE, BoneId, Hinge, Skeleton};
use kinopt_kinematics::spatial::Quaternion;

/// Rotation of a bone by its angles θ₁, θ₂, θ₃ in radians: R_x(θ₃) R_z(θ₂) R_x(θ₁).
#[doc(hidden)]
pub fn bone_rotation([first, bend, second]: [f64; 3]) -> DQuat {
    EulerOrder::Xzx.to_quaternion([second, bend, first])
}

/// Angles θ₁, θ₂, θ₃ of a rotation, radians. Twist-bend-twist angles come in pairs, (θ₁, θ₂, θ₃) and (θ₁ ± π, −θ₂, θ₃ ±
/// π).
///
/// The pair that violates the limits less is chosen, or else the one with less twist. If the bend is 0, only the sum of
/// the twists is defined; the second twist then takes as much as its limits allow. The angles are not clamped to the
/// limits.
#[doc(hidden)]
pub fn bone_angles(rotation: DQuat, limits: &[Limits; 3]) -> [f64; 3] {
    let euler = EulerOrder::Xzx.from_quaternion(rotation);
    let [second, bend, first] = euler.angles;
    if euler.gimbal_lock && bend < 1.0 {
        let sum = second;
        let second = sum.max(limits[2].lower).min(limits[2].upper);
        return [sum - second, bend, second];
    }
    let flipped = |angle: f64| angle - std::f64::consts::PI.copysign(angle);
    let pair = [
        [first, bend, second],
        [flipped(first), -bend, flipped(second)],
    ];
    let limit_violation = |angles: &[f64; 3]| -> f64 {
        let angles_and_limits = angles.iter().zip(limits);
        angles_and_limits
            .map(|(angle, limits)| (limits.lower - angle).max(angle - limits.upper).max(0.0))
            .sum()
    };
    let twist = |angles: &[f64; 3]| angles[0].abs() + angles[2].abs();
    // Excludes the rounding of single-precision poses from the choice.
    const VIOLATION_TOLERANCE: f64 = 1e-5;
    let [a, b] = pair;
    let difference = limit_violation(&a) - limit_violation(&b);
    let second_is_better = match difference.abs() > VIOLATION_TOLERANCE {
        true => difference > 0.0,
        false => twist(&a) > twist(&b),
    };
    if second_is_better { b } else { a }
}

/// Rotation of a hinge by an angle in radians.
fn hinge_rotation(hinge: &Hinge, angle: f64) -> DQuat {
    let Quaternion { w, v } = hinge.rotation(angle);
    DQuat::from_xyzw(v.x, v.y, v.z, w)
}

/// Angle of a hinge, radians, whose rotation is closest to `rotation`.
pub(super) fn hinge_angle(hinge: &Hinge, rotation: DQuat) -> f64 {
    let [x, y, z, w] = rotation.to_array();
    let v = [x, y, z].into();
    hinge.angle_of(Quaternion { w, v })
}

/// Returns an error if a pose has fewer bones than a skeleton. Additional bones, as in a scene, are allowed.
pub(super) fn has_bones(pose: &Pose, bones: usize) -> Result<(), SizeMismatch> {
    SizeMismatch::check("bones in the pose", pose.bones().min(bones), bones)
}

/// Map between a skeleton's angles and the local rotations of poses, by the skeleton's rest rotations.
///
/// Local rotations below mirrored bones are in reflected axes.
#[derive(Clone, Debug)]
pub struct EulerPoseMap {
    rest: Vec<DQuat>,
    parents: Vec<Option<BoneId>>,
    limits: Vec<[Limits; 3]>,
    hinges: Vec<Option<Hinge>>,
}

impl EulerPoseMap {
    /// Map for poses of the armature [of the skeleton](crate::animation::Armature::of_skeleton).
    #[must_use]
    pub fn new(skeleton: &Skeleton) -> Self {
        let armature = crate::animation::Armature::of_skeleton(skeleton);
        let rest = armature.rest().rotations().iter();
        Self {
            rest: rest.map(|q| q.as_dquat().normalize()).collect(),
            parents: skeleton.bones().iter().map(|bone| bone.parent).collect(),
            limits: skeleton.bones().iter().map(|bone| bone.limits).collect(),
            hinges: skeleton
                .bone_ids()
                .map(|bone| skeleton.hinge(bone))
                .collect(),
        }
    }

    /// Writes the stacked angles (radians, 3 × bones) of a pose's local rotations. A `Vec` is resized to all bones of
    /// the skeleton.
    ///
    /// # Errors
    /// The pose has fewer bones, or a slice has another length.
    pub fn angles_of(
        &self,
        pose: &Pose,
        q: &mut (impl Buffer<f64> + ?Sized),
    ) -> Result<(), SizeMismatch> {
        has_bones(pose, self.rest.len())?;
        let angles = ANGLES_PER_BONE * self.rest.len();
        let q = q.sized(angles);
        SizeMismatch::check("angles", q.len(), angles)?;
        let joints = self.limits.iter().zip(&self.hinges);
        let bones = self.rest.iter().zip(joints).zip(pose.rotations());
        let bones = q.chunks_exact_mut(ANGLES_PER_BONE).zip(bones).enumerate();
        for (index, (angles, ((rest, (limits, hinge)), rotation))) in bones {
            let mirror = self.mirror_above(BoneId::new(index), pose);
            let rotation_from_rest =
                rest.conjugate() * mirror.rotation(rotation.as_dquat().normalize());
            let bone_angles = match hinge {
                Some(hinge) => [0.0, hinge_angle(hinge, rotation_from_rest), 0.0],
                None => bone_angles(rotation_from_rest, limits),
            };
            angles.copy_from_slice(&bone_angles);
        }
        Ok(())
    }

    /// Writes the local rotations of stacked angles (radians, 3 × bones) into a pose. The pose does not change on an
    /// error.
    ///
    /// # Errors
    /// - The pose has fewer bones.
    /// - The number of angles differs, or an angle is not finite.
    pub fn pose_of(&self, q: &[f64], pose: &mut Pose) -> Result<(), LayerError> {
        has_bones(pose, self.rest.len())?;
        let angles = ANGLES_PER_BONE * self.rest.len();
        ModelError::check_numbers("angles of this skeleton", q, angles)?;
        for index in 0..self.rest.len() {
            self.pose_bone(BoneId::new(index), q, pose);
        }
        Ok(())
    }

    /// [`pose_of`](Self::pose_of) for one bone.
    pub(super) fn pose_bone(&self, bone: BoneId, q: &[f64], pose: &mut Pose) {
        let first = ANGLES_PER_BONE * bone.index();
        let angles = q.get(first..first + ANGLES_PER_BONE);
        let angles = angles.and_then(|angles| <[f64; 3]>::try_from(angles).ok());
        let mirror = self.mirror_above(bone, pose);
        let local_rotation = pose.rotations.get_mut(bone.index());
        let rest = self.rest.get(bone.index());
        if let (Some(angles), Some(local_rotation), Some(rest)) = (angles, local_rotation, rest) {
            let from_rest = match self.hinges.get(bone.index()).copied().flatten() {
                Some(hinge) => hinge_rotation(&hinge, angles[1]),
                None => bone_rotation(angles),
            };
            let rotation: Quat = mirror.rotation(*rest * from_rest).as_quat();
            *local_rotation = rotation.normalize();
        }
    }

    /// Mirror of the ancestors of a bone in a pose.
    fn mirror_above(&self, bone: BoneId, pose: &Pose) -> Mirror {
        let parent = |bone: &BoneId| self.parents.get(bone.index()).copied().flatten();
        let ancestors = std::iter::successors(parent(&bone), parent);
        let scales = ancestors.filter_map(|bone| pose.scales().get(bone.index()));
        scales.fold(Mirror::NONE, |mirror, scale| mirror.below(*scale))
    }
}
