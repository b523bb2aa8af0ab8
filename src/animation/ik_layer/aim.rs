//! A bone that points at something, in closed form.

use glam::{DQuat, Quat, Vec3A};

use super::bone_placement::{Placed, set_rotation};
use super::{Corrected, ShearCorrection};
use crate::animation::blend::{finite_or_0, within};
use crate::animation::rotation::exponential::turn_about;
use crate::animation::rotation::slerp;
use crate::animation::{Armature, Mirror, Pose, SizeMismatch};
use crate::scalar::elementary::single;
use crate::skeleton::BoneId;

/// Angle from the target of a corrected bone that has converged, radians: what single precision holds.
const CONVERGED: f64 = 3e-7;

/// A bone that turns so that an axis of it points at a target: a head that looks, a hand that aims, a
/// foot that is laid on the ground by its normal.
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

/// What cannot aim.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AimError {
    /// A bone of another armature.
    #[error("bone {bone} does not exist; the armature has {bones}")]
    UnknownBone {
        /// The bone's index.
        bone: usize,
        /// How many bones there are.
        bones: usize,
    },
    /// A direction that is none.
    #[error("the {axis} axis is not finite or has no length")]
    BadAxis {
        /// "forward" or "up".
        axis: &'static str,
    },
    /// Forward and up are on one line.
    #[error("the up axis is on the line of the forward axis")]
    UpIsForward,
    /// An offset that is not finite.
    #[error("the offset is not finite")]
    BadMuzzle,
}

/// What a bone should point at this frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AimGoal {
    /// The point to point at, in model coordinates.
    pub target: Vec3A,
    /// The direction, in model coordinates, to which the bone's up axis goes as far as it can; with
    /// `None`, or for a bone without one, the bone turns by the shortest arc.
    pub up: Option<Vec3A>,
    /// How far the bone turns about the way to the target besides, in radians, counter-clockwise as
    /// seen from the target. A number that is not finite counts as 0.
    pub twist: f32,
    /// From 0, the pose as it is, to 1, pointing at the target: the bone turns this share of the
    /// angle. Taken into [0, 1]; NaN counts as 0.
    pub weight: f32,
}

impl AimGoal {
    /// At a point in model coordinates, with weight 1, by the shortest arc.
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
    /// A bone that points along an axis in its own coordinates.
    ///
    /// # Errors
    /// An [`AimError`].
    pub fn new(
        armature: &Armature,
        bone: BoneId,
        forward: impl Into<Vec3A>,
    ) -> Result<Self, AimError> {
        let forward = forward.into();
        let (bones, index) = (armature.bones(), bone.index());
        if index >= bones {
            return Err(AimError::UnknownBone { bone: index, bones });
        }
        Ok(Self {
            bone,
            forward: axis("forward", forward)?,
            up: None,
            offset: Vec3A::ZERO,
        })
    }

    /// The axis, in the bone's coordinates, that goals may hold upright.
    ///
    /// # Errors
    /// An axis that is not finite, has no length, or is on the line of the one that points.
    pub fn with_up(mut self, up: impl Into<Vec3A>) -> Result<Self, AimError> {
        let up = up.into();
        let up = axis("up", up)?;
        if up.cross(self.forward).length_squared() < 1e-6 {
            return Err(AimError::UpIsForward);
        }
        self.up = Some(up);
        Ok(self)
    }

    /// A point, in the bone's coordinates, from which it points instead of from its joint: an eye in a
    /// head, the muzzle of a gun.
    ///
    /// # Errors
    /// A point that is not finite.
    pub fn with_offset(mut self, offset: impl Into<Vec3A>) -> Result<Self, AimError> {
        let offset = offset.into();
        if !offset.is_finite() {
            return Err(AimError::BadMuzzle);
        }
        self.offset = offset;
        Ok(self)
    }

    /// Turns the bone by its weight's share of the rotation that points it at the target. Says
    /// whether there is one: there is none for a target that is not finite, that is the joint itself, or
    /// that is nearer to the joint than the line through the offset; then the pose stays as it is.
    ///
    /// Uneven scales of the bone and of those above it shear its axes. The bone is then turned again until the axis as the
    /// pose shows it points at the target, as near as that converges.
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
        let above = Placed::within(armature, pose, armature.parent(self.bone), None);
        let own = above * Placed::local(pose, self.bone);
        let Some(mut wanted) = self.aimed(&own, goal) else {
            return Ok(false);
        };
        let weight = within(goal.weight);
        if weight > 0.0 {
            let set = |pose: &mut Pose, rotation: Quat| {
                let local = above.rotation.conjugate() * rotation;
                set_rotation(pose, self.bone, above.mirror.single(local));
            };
            if own.uneven {
                let placed = |pose: &Pose| above * Placed::local(pose, self.bone);
                wanted = self.corrected(goal, wanted, |rotation| {
                    set(pose, rotation);
                    placed(pose)
                });
            }
            set(pose, slerp(own.rotation, wanted, weight));
        }
        Ok(true)
    }

    /// The rotation with which a sheared bone points at the target, as near as that converges, from one with which it nearly
    /// does. `placed` is the bone in the model with a rotation.
    fn corrected(
        &self,
        goal: &AimGoal,
        mut wanted: Quat,
        mut placed: impl FnMut(Quat) -> Placed,
    ) -> Quat {
        let mut own = placed(wanted);
        let way = goal.target - own.affine.translation;
        let shown = |own: &Placed| {
            let points = Line::of(self, own).point_at(way.length());
            let direction = points.map(|points| own.rotation * points);
            direction.map(|direction| [direction.as_dvec3()])
        };
        let Some((to, start)) = way.try_normalize().zip(shown(&own)) else {
            return wanted;
        };
        let mut correction = ShearCorrection::new(&[to.as_dvec3()], &start);
        while !(correction.off() < CONVERGED || correction.gives_up()) {
            let commands = correction.commands();
            let command = commands.first().map_or(to, |at| at.as_vec3a());
            let command = AimGoal {
                target: own.affine.translation + command.normalize_or(to) * way.length(),
                ..*goal
            };
            let Some(rotation) = self.aimed(&own, &command) else {
                break;
            };
            let turned = placed(rotation);
            let Some(direction) = shown(&turned) else {
                break;
            };
            if correction.learn(&direction, true) != Corrected::Undone {
                (wanted, own) = (rotation, turned);
            }
        }
        wanted
    }

    /// The rotation in the model with which the bone points at the target, if its scaled axes turn rigidly from how it is
    /// placed.
    fn aimed(&self, own: &Placed, goal: &AimGoal) -> Option<Quat> {
        let way = goal.target - own.affine.translation;
        let line = Line::of(self, own);
        let to = way.try_normalize()?;
        let points = line.point_at(way.length())?;
        let turned = arc(own.rotation * points, to);
        let mut wanted = turned * own.rotation;
        let upright = goal.up.zip(line.up).and_then(|(asked, up)| {
            let [is, asked] = [wanted * up, asked].map(|v| v.reject_from_normalized(to));
            let [is, asked] = [is.try_normalize()?, asked.try_normalize()?];
            Some(single::atan2(to.dot(is.cross(asked)), is.dot(asked)))
        });
        let about = upright.unwrap_or(0.0) + finite_or_0(goal.twist);
        if about != 0.0 {
            wanted = turn_about(to.into(), about) * wanted;
        }
        Some(wanted)
    }
}

/// The line that points, in the axes of the bone's rotation in the model.
struct Line {
    /// Unit vectors.
    forward: Vec3A,
    up: Option<Vec3A>,
    offset: Vec3A,
    /// Of lengths in the model to those of `offset`.
    scale: f32,
}

impl Line {
    fn of(aim: &Aim, own: &Placed) -> Self {
        if own.uneven || own.mirror != Mirror::NONE {
            let scaled = |v: Vec3A| own.rotation.conjugate() * own.affine.transform_vector3a(v);
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
            scale: own.affine.matrix3.x_axis.length(),
        }
    }

    /// The direction of the point of the line through the offset that is at a distance from the joint, which is to be turned
    /// onto the target: |m + s f| = d for s ≥ 0.
    fn point_at(&self, distance: f32) -> Option<Vec3A> {
        let distance = distance / self.scale;
        let ahead = self.offset.dot(self.forward);
        let beside = self.offset - self.forward * ahead;
        let reach = distance * distance - beside.length_squared();
        // Behind the offset point is no way to point.
        let along = (reach > 0.0).then(|| reach.sqrt())?;
        if along < ahead {
            return None;
        }
        (beside + self.forward * along).try_normalize()
    }
}

/// The shortest turn from a unit vector to another one; in double precision, because near half a turn
/// its axis is what rounding leaves.
fn arc(from: Vec3A, to: Vec3A) -> Quat {
    let [from, to] = [from, to].map(|v| v.as_dvec3().normalize());
    DQuat::from_rotation_arc(from, to).as_quat()
}

fn axis(name: &'static str, axis: Vec3A) -> Result<Vec3A, AimError> {
    axis.try_normalize().ok_or(AimError::BadAxis { axis: name })
}
