//! Aim IK: a bone that points at a target, in closed form.

use glam::{DQuat, Quat, Vec3A};

use super::bone_placement::{BonePlacement, set_rotation};
use super::{Corrected, ShearCorrection};
use crate::animation::blend::{clamp_to_unit, finite_or_0};
use crate::animation::rotation::exponential::rotation_about;
use crate::animation::rotation::slerp;
use crate::animation::{Armature, LayerError, Mirror, Pose, SizeMismatch};
use kinopt_kinematics::scalar::elementary::single;
use kinopt_kinematics::skeleton::BoneId;

/// Angle to the target at which a corrected bone has converged, radians; the limit of single precision.
const ANGLE_TOLERANCE: f64 = 3e-7;

/// Bone with an axis that points at a target: a head that looks, a hand that aims, a foot aligned with the ground
/// normal.
///
/// ```
/// use glam::Vec3A;
/// use kinopt::animation::{Aim, AimGoal, Armature, ArmatureBone, LocalTransform};
///
/// let head = ArmatureBone { name: "head".into(), parent: None, rest: LocalTransform::IDENTITY };
/// let armature = Armature::new(vec![head], Vec::new())?;
/// let looks = Aim::new(&armature, armature.bone("head")?, Vec3A::Z)?.with_up(Vec3A::Y)?;
///
/// let mut pose = armature.rest().clone();
/// let goal = AimGoal { up: Some(Vec3A::Y), ..AimGoal::at(Vec3A::new(3.0, 0.0, 0.0)) };
/// assert!(looks.turn(&armature, &mut pose, &goal)?);
/// assert!((pose.rotations()[0] * Vec3A::Z).abs_diff_eq(Vec3A::X, 1e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    bone: BoneId,
    /// Unit vectors and a point in the bone's coordinates.
    forward: Vec3A,
    up: Option<Vec3A>,
    offset: Vec3A,
}

/// Goal of an aim for one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AimGoal {
    /// Target point, in model coordinates.
    pub target: Vec3A,
    /// Desired direction of the bone's up axis, in model coordinates. With `None`, or without an up axis, the bone
    /// rotates by the shortest arc.
    pub up: Option<Vec3A>,
    /// Additional rotation about the direction to the target, radians, counter-clockwise as seen from the target. A
    /// number that is not finite counts as 0.
    pub twist: f32,
    /// Fraction of the rotation that is applied: 0 leaves the pose, 1 points at the target. Clamped to [0, 1]; NaN
    /// counts as 0.
    pub weight: f32,
}

impl AimGoal {
    /// Goal at a point in model coordinates, with weight 1, by the shortest arc.
    #[must_use]
    pub fn at(target: impl Into<Vec3A>) -> Self {
        let target = target.into();
        Self {
            target,
            up: None,
            twist: 0.0,
            weight: 1.0,
        }
    }
}

impl Aim {
    /// Aim along an axis in the bone's coordinates.
    ///
    /// # Errors
    /// An [`LayerError`].
    pub fn new(
        armature: &Armature,
        bone: BoneId,
        forward: impl Into<Vec3A>,
    ) -> Result<Self, LayerError> {
        let forward = forward.into();
        let (bones, index) = (armature.bones(), bone.index());
        if index >= bones {
            return Err(LayerError::UnknownBone { bone: index, bones });
        }
        Ok(Self {
            bone,
            forward: axis("forward", forward)?,
            up: None,
            offset: Vec3A::ZERO,
        })
    }

    /// Sets the up axis, in the bone's coordinates, that goals can align.
    ///
    /// # Errors
    /// The axis is not finite, zero, or parallel to the forward axis.
    pub fn with_up(mut self, up: impl Into<Vec3A>) -> Result<Self, LayerError> {
        let up = up.into();
        let up = axis("up", up)?;
        if up.cross(self.forward).length_squared() < 1e-6 {
            return Err(LayerError::UpIsForward);
        }
        self.up = Some(up);
        Ok(self)
    }

    /// Sets the origin of the aiming line, in the bone's coordinates; the default is the joint. Examples are an eye in
    /// a head and the muzzle of a gun.
    ///
    /// # Errors
    /// The point is not finite.
    pub fn with_offset(mut self, offset: impl Into<Vec3A>) -> Result<Self, LayerError> {
        let offset = offset.into();
        if !offset.is_finite() {
            return Err(LayerError::BadOffset);
        }
        self.offset = offset;
        Ok(self)
    }

    /// Rotates the bone towards the target by the goal's weight. Returns false, without a change of the pose, if there
    /// is no such rotation. This happens if the target is not finite, coincides with the joint, or is nearer to the
    /// joint than the aiming line.
    ///
    /// Uneven scales of the bone and its ancestors shear its axes. The rotation is then corrected iteratively until the
    /// axis of the posed bone points at the target, as far as this converges.
    ///
    /// # Errors
    /// The pose is of another armature.
    pub fn turn(
        &self,
        armature: &Armature,
        pose: &mut Pose,
        goal: &AimGoal,
    ) -> Result<bool, SizeMismatch> {
        armature.rest().check_same_size(pose)?;
        let parent = BonePlacement::within(armature, pose, armature.parent(self.bone), None);
        let bone = parent * BonePlacement::local(pose, self.bone);
        let Some(mut target_rotation) = self.aim_rotation(&bone, goal) else {
            return Ok(false);
        };
        let weight = clamp_to_unit(goal.weight);
        if weight > 0.0 {
            let set = |pose: &mut Pose, rotation: Quat| {
                let local = parent.rotation.conjugate() * rotation;
                set_rotation(pose, self.bone, parent.mirror.single(local));
            };
            if bone.uneven {
                let placed = |pose: &Pose| parent * BonePlacement::local(pose, self.bone);
                target_rotation = self.corrected(goal, target_rotation, |rotation| {
                    set(pose, rotation);
                    placed(pose)
                });
            }
            set(pose, slerp(bone.rotation, target_rotation, weight));
        }
        Ok(true)
    }

    /// Corrects the rotation of a sheared bone until it points at the target, as far as this converges. `placed` is the
    /// bone in the model with an approximate rotation.
    fn corrected(
        &self,
        goal: &AimGoal,
        mut target_rotation: Quat,
        mut placed: impl FnMut(Quat) -> BonePlacement,
    ) -> Quat {
        let mut bone = placed(target_rotation);
        let to_target = goal.target - bone.affine.translation;
        let aim_direction = |bone: &BonePlacement| {
            let points = AimingLine::new(self, bone).point_at(to_target.length());
            let direction = points.map(|points| bone.rotation * points);
            direction.map(|direction| [direction.as_dvec3()])
        };
        let Some((to, start)) = to_target.try_normalize().zip(aim_direction(&bone)) else {
            return target_rotation;
        };
        let mut correction = ShearCorrection::new(&[to.as_dvec3()], &start);
        while !(correction.off() < ANGLE_TOLERANCE || correction.gives_up()) {
            let commands = correction.commands();
            let command = commands
                .first()
                .map_or(to, |direction| direction.as_vec3a());
            let command = AimGoal {
                target: bone.affine.translation + command.normalize_or(to) * to_target.length(),
                ..*goal
            };
            let Some(rotation) = self.aim_rotation(&bone, &command) else {
                break;
            };
            let rotated = placed(rotation);
            let Some(direction) = aim_direction(&rotated) else {
                break;
            };
            if correction.learn(&direction, true) != Corrected::Undone {
                (target_rotation, bone) = (rotation, rotated);
            }
        }
        target_rotation
    }

    /// Rotation in the model that points the bone at the target, if its scaled axes rotate rigidly from `bone`.
    fn aim_rotation(&self, bone: &BonePlacement, goal: &AimGoal) -> Option<Quat> {
        let to_target = goal.target - bone.affine.translation;
        let line = AimingLine::new(self, bone);
        let to = to_target.try_normalize()?;
        let points = line.point_at(to_target.length())?;
        let swing = arc(bone.rotation * points, to);
        let mut target_rotation = swing * bone.rotation;
        let up_angle = goal.up.zip(line.up).and_then(|(goal_up, up)| {
            let [current_up, goal_up] =
                [target_rotation * up, goal_up].map(|v| v.reject_from_normalized(to));
            let [current_up, goal_up] = [current_up.try_normalize()?, goal_up.try_normalize()?];
            Some(single::atan2(
                to.dot(current_up.cross(goal_up)),
                current_up.dot(goal_up),
            ))
        });
        let angle = up_angle.unwrap_or(0.0) + finite_or_0(goal.twist);
        if angle != 0.0 {
            target_rotation = rotation_about(to.into(), angle) * target_rotation;
        }
        Some(target_rotation)
    }
}

/// Aiming line, in the axes of the bone's rotation in the model.
struct AimingLine {
    /// Unit vectors.
    forward: Vec3A,
    up: Option<Vec3A>,
    offset: Vec3A,
    /// Ratio of lengths in the model to those of `offset`.
    scale: f32,
}

impl AimingLine {
    fn new(aim: &Aim, bone: &BonePlacement) -> Self {
        if bone.uneven || bone.mirror != Mirror::NONE {
            let scaled = |v: Vec3A| bone.rotation.conjugate() * bone.affine.transform_vector3a(v);
            return Self {
                forward: scaled(aim.forward).normalize_or(aim.forward),
                up: aim.up.map(|up| scaled(up).normalize_or(up)),
                offset: scaled(aim.offset),
                scale: 1.0,
            };
        }
        Self {
            forward: aim.forward,
            up: aim.up,
            offset: aim.offset,
            scale: bone.affine.matrix3.x_axis.length(),
        }
    }

    /// Direction from the joint to the point of the line at `distance` from the joint, which is rotated onto the
    /// target. Solves |m + s f| = d for s ≥ 0.
    fn point_at(&self, distance: f32) -> Option<Vec3A> {
        let distance = distance / self.scale;
        let offset_along = self.offset.dot(self.forward);
        let perpendicular = self.offset - self.forward * offset_along;
        let reach = distance * distance - perpendicular.length_squared();
        // A point behind the offset cannot be aimed.
        let along = (reach > 0.0).then(|| reach.sqrt())?;
        if along < offset_along {
            return None;
        }
        (perpendicular + self.forward * along).try_normalize()
    }
}

/// Shortest rotation between two unit vectors. Double precision, because near half a turn the axis results from
/// cancellation.
fn arc(from: Vec3A, to: Vec3A) -> Quat {
    let [from, to] = [from, to].map(|v| v.as_dvec3().normalize());
    DQuat::from_rotation_arc(from, to).as_quat()
}

fn axis(name: &'static str, axis: Vec3A) -> Result<Vec3A, LayerError> {
    axis.try_normalize()
        .ok_or(LayerError::BadAxis { axis: name })
}
