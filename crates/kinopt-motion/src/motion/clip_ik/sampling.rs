//! Sample times of a clip, and the positions of its bones.

use glam::DVec3;

use super::ClipIkError;
use super::posed_bones::PosedBones;
use kinopt_animation::animation::{Armature, Clip, ClipError, Cursor, Playback, Pose};
use kinopt_kinematics::skeleton::BoneId;

/// Number of frames above which a rate is rejected as a mistake.
const MAX_FRAMES: f64 = 4e6;
/// Smallest distance of two sample times, in frames.
const MIN_SAMPLE_DISTANCE: f64 = 0.5;

/// Returns evenly spaced sample times of a clip, and their number per second.
///
/// The rate is at least `rate`. Each time of `extra_times` within the clip replaces its neighbours.
pub(super) fn sample_times(
    clip: &Clip,
    rate: f64,
    extra_times: impl Iterator<Item = f64>,
) -> Result<(Vec<f32>, f64), ClipIkError> {
    let [start, end] = clip.span().map(f64::from);
    let steps = (clip.duration() * rate).ceil();
    if !(rate > 0.0 && steps < MAX_FRAMES) {
        let keys_per_second = rate;
        return Err(ClipError::BadRate { keys_per_second }.into());
    }
    let steps = steps.max(1.0);
    let step = (end - start) / steps;
    let mut times: Vec<f64> = (0..=steps as usize)
        .map(|k| start + k as f64 * step)
        .collect();
    for time in extra_times.filter(|time| *time > start && *time < end) {
        times.retain(|known| {
            let is_end = *known == start || *known == end;
            is_end || (known - time).abs() > MIN_SAMPLE_DISTANCE * step
        });
        times.push(time);
        times.sort_by(f64::total_cmp);
    }
    let mut times: Vec<f32> = times.into_iter().map(|time| time as f32).collect();
    times.dedup();
    let rate = if step > 0.0 { 1.0 / step } else { rate };
    Ok((times, rate))
}

/// Sampler of a clip at increasing times.
#[derive(Debug)]
pub(super) struct Poses<'a> {
    clip: &'a Clip,
    cursor: Cursor,
    pose: Pose,
}

impl<'a> Poses<'a> {
    pub(super) fn new(armature: &Armature, clip: &'a Clip) -> Self {
        let pose = armature.rest().clone();
        let cursor = Cursor::new();
        Self { clip, cursor, pose }
    }

    pub(super) fn at(&mut self, time: f32) -> Result<&mut Pose, ClipIkError> {
        let time = f64::from(time);
        self.clip
            .sample(time, Playback::Hold, &mut self.cursor, &mut self.pose)?;
        Ok(&mut self.pose)
    }
}

/// Positions of a bone and its limb over the frames of a clip.
#[derive(Clone, Debug, Default)]
pub(super) struct LimbMotion {
    /// Position of the bone by frame.
    pub(super) positions: Vec<DVec3>,
    /// Position of the limb's upper end by frame.
    pub(super) upper: Vec<DVec3>,
    pub(super) lengths: Vec<f64>,
}

impl LimbMotion {
    /// Translates the limb in each frame.
    pub(super) fn move_by(&mut self, moved: &[DVec3]) {
        for points in [&mut self.positions, &mut self.upper] {
            for (point, moved) in points.iter_mut().zip(moved) {
                *point += *moved;
            }
        }
    }

    pub(super) fn max_length(&self) -> f64 {
        self.lengths.iter().copied().fold(0.0, f64::max)
    }
}

/// Samples the positions of bones and their limbs over a clip.
pub(super) fn limb_motions(
    armature: &Armature,
    clip: &Clip,
    times: &[f32],
    bones: &[BoneId],
    posed: &mut PosedBones,
) -> Result<Vec<LimbMotion>, ClipIkError> {
    let mut limbs = vec![LimbMotion::default(); bones.len()];
    let mut poses = Poses::new(armature, clip);
    for &time in times {
        posed.store_clip_pose(poses.at(time)?);
        for (limb, &bone) in limbs.iter_mut().zip(bones) {
            let (upper, length) = posed.limb(armature, bone);
            limb.positions.push(posed.effector_position(bone));
            limb.upper.push(upper);
            limb.lengths.push(length);
        }
    }
    Ok(limbs)
}
