//! Root motion: horizontal path and heading of a bone, separated from its clip.

use glam::{Affine3A, Quat, Vec3, Vec3A};

use crate::animation::rotation::exponential::rotation_about;
use crate::animation::{Armature, Clip, ClipError, Playback, Pose};
use kinopt_kinematics::curve::KeyedCurve;
use kinopt_kinematics::scalar::elementary::single::atan2;
use kinopt_kinematics::skeleton::BoneId;

/// Horizontal displacement of a character since the clip's start, and its rotation about the up axis. Both are zero at
/// the start.
#[derive(Clone, Debug, PartialEq)]
pub struct RootMotion {
    up: Vec3,
    span: [f32; 2],
    /// Displacement perpendicular to the up axis.
    displacement: KeyedCurve<Vec3A>,
    /// Rotation about the up axis, radians, continuous beyond full turns.
    heading: KeyedCurve<f32>,
}

impl Clip {
    /// Samples the clip and extracts the root motion of a bone. Returns the clip in place and the root motion.
    ///
    /// In the returned clip the bone keeps its initial horizontal position and heading. Height, tilt and sway remain in
    /// the clip. Descendants of the bone move with it.
    ///
    /// # Errors
    /// - The up axis is not finite or zero.
    /// - The rate is invalid, as for [`baked`](Self::baked).
    /// - The armature is not of the clip's size, or the bone is of another armature.
    pub fn without_root_motion(
        &self,
        armature: &Armature,
        bone: BoneId,
        up: Vec3,
        keys_per_second: f64,
    ) -> Result<(Self, RootMotion), ClipError> {
        let up = up
            .try_normalize()
            .ok_or(ClipError::BadUp { up: up.to_array() })?;
        self.resampled(armature, keys_per_second, |times, poses| {
            let motion = RootMotion::from_poses(armature, bone, up, (times, poses))?;
            for (time, pose) in times.iter().zip(poses) {
                move_bone(armature, bone, motion.at(*time).inverse(), pose)?;
            }
            Ok(motion)
        })
    }

    /// Samples the clip and adds root motion to a bone: the reverse of
    /// [`without_root_motion`](Self::without_root_motion).
    ///
    /// # Errors
    /// As [`without_root_motion`](Self::without_root_motion).
    pub fn with_root_motion(
        &self,
        armature: &Armature,
        bone: BoneId,
        motion: &RootMotion,
        keys_per_second: f64,
    ) -> Result<Self, ClipError> {
        let moved = self.resampled(armature, keys_per_second, |times, poses| {
            let mut samples = times.iter().zip(poses);
            samples.try_for_each(|(time, pose)| move_bone(armature, bone, motion.at(*time), pose))
        });
        moved.map(|(moved, ())| moved)
    }
}

impl RootMotion {
    /// Root motion of a bone over poses.
    fn from_poses(
        armature: &Armature,
        bone: BoneId,
        up: Vec3,
        (times, poses): (&[f32], &[Pose]),
    ) -> Result<Self, ClipError> {
        let unknown = ClipError::UnknownBone {
            bone: bone.index(),
            bones: armature.bones(),
        };
        let mut placements = Vec::new();
        let mut start_pose: Option<(Quat, Vec3A)> = None;
        let (mut displacements, mut heading) = (
            Vec::with_capacity(times.len()),
            Vec::with_capacity(times.len()),
        );
        let mut angle = 0.0;
        for pose in poses {
            armature.local_to_model(pose, &mut placements)?;
            let Some(placement) = placements.get(bone.index()) else {
                return Err(unknown);
            };
            let (_, rotation, position) = placement.to_scale_rotation_translation();
            let (first, start) = *start_pose.get_or_insert((rotation, position.into()));
            angle = nearest_angle(twist(rotation * first.inverse(), up), angle);
            let displacement = Vec3A::from(position) - rotation_about(up, angle) * start;
            displacements.push(displacement - Vec3A::from(up) * displacement.dot(up.into()));
            heading.push(angle);
        }
        let [first, .., last] = times else {
            let time = times.first().copied().unwrap_or(0.0);
            return Ok(Self {
                up,
                span: [time; 2],
                displacement: KeyedCurve::linear(vec![time], vec![Vec3A::ZERO])?,
                heading: KeyedCurve::linear(vec![time], vec![0.0])?,
            });
        };
        Ok(Self {
            up,
            span: [*first, *last],
            displacement: KeyedCurve::linear(times.to_vec(), displacements)?,
            heading: KeyedCurve::linear(times.to_vec(), heading)?,
        })
    }

    /// Horizontal displacement in the armature's unit, by clip time in seconds.
    #[must_use]
    pub fn way(&self) -> &KeyedCurve<Vec3A> {
        &self.displacement
    }

    /// Rotation about the up axis in radians by clip time in seconds, continuous beyond full turns.
    #[must_use]
    pub fn heading(&self) -> &KeyedCurve<f32> {
        &self.heading
    }

    /// Transform from the start to the character's placement at a clip time in seconds.
    #[must_use]
    pub fn at(&self, time: f32) -> Affine3A {
        let rotation = rotation_about(self.up, self.heading.at(time));
        Affine3A::from_rotation_translation(rotation, self.displacement.at(time).into())
    }

    /// Transform of the character after `elapsed` seconds of playback. In loop mode the motion accumulates over the
    /// cycles. Other modes hold or reverse as the clip does.
    #[must_use]
    pub fn after(&self, elapsed: f64, playback: Playback) -> Affine3A {
        let [start, end] = self.span.map(f64::from);
        let loops = (elapsed / (end - start)).floor();
        if playback != Playback::Loop || !loops.is_finite() {
            return self.at(playback.within(start + elapsed, [start, end]) as f32);
        }
        // The end of a loop is the start of the next.
        let current = self.at((start + elapsed.rem_euclid(end - start)) as f32);
        let cycle = self.at(self.span[1]);
        let step = if loops < 0.0 { cycle.inverse() } else { cycle };
        power(step, loops.abs().min(f64::from(u32::MAX)) as u32) * current
    }
}

/// Integer power of a transform, by repeated squaring.
fn power(step: Affine3A, mut times: u32) -> Affine3A {
    let (mut result, mut square) = (Affine3A::IDENTITY, step);
    while times > 0 {
        if times % 2 == 1 {
            result = square * result;
        }
        square = square * square;
        times /= 2;
    }
    result
}

/// Rotation angle about a unit axis, radians.
fn twist(q: Quat, axis: Vec3) -> f32 {
    2.0 * atan2(q.xyz().dot(axis), q.w)
}

/// The angle plus full turns that is nearest to `to`, radians.
fn nearest_angle(angle: f32, to: f32) -> f32 {
    let full_turn = std::f32::consts::TAU;
    angle + ((to - angle) / full_turn).round() * full_turn
}

/// Moves a bone in model coordinates, with its descendants.
fn move_bone(
    armature: &Armature,
    bone: BoneId,
    motion: Affine3A,
    pose: &mut Pose,
) -> Result<(), ClipError> {
    let mut placements = Vec::new();
    armature.local_to_model(pose, &mut placements)?;
    let model_from_parent = armature
        .parent(bone)
        .and_then(|parent| placements.get(parent.index()));
    let model_from_parent = model_from_parent.copied().unwrap_or(Affine3A::IDENTITY);
    let mut local = pose.local_of(bone);
    let (_, parent_rotation, _) = model_from_parent.to_scale_rotation_translation();
    let (_, rotation, _) = motion.to_scale_rotation_translation();
    // The rotation in the coordinates of the bone's parent.
    local.rotation =
        (parent_rotation.inverse() * rotation * parent_rotation * local.rotation).normalize();
    let position = motion.transform_point3a(model_from_parent.transform_point3a(local.translation));
    local.translation = model_from_parent.inverse().transform_point3a(position);
    // Fails if the parent has zero scale; the bone then does not change.
    let _ = pose.set_local(bone, local);
    Ok(())
}
