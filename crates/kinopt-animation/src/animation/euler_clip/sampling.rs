//! Sampling of Euler clips.

use super::EulerClip;
use crate::animation::{ClipError, Playback};
use kinopt_kinematics::skeleton::ANGLES_PER_BONE;

impl EulerClip {
    /// Writes the angles at `time` (seconds) into the stacked configuration `q` (radians, 3 × bones: θ₁, θ₂, θ₃ of bone
    /// 0, of bone 1, …). Bones without keys are at 0.
    ///
    /// [`EulerInterpolation`](super::EulerInterpolation) selects linear or cubic Hermite segments between keys P_i at
    /// t_i. A Catmull-Rom spline has the tangents m_i = (P_{i+1} − P_{i−1}) / (t_{i+1} − t_{i−1}), times the segment's
    /// duration. They are one-sided at the first and last key. At evenly spaced keys this is the classic form (Catmull
    /// & Rom 1974). Kochanek-Bartels tangents are
    /// [`TensionContinuityBias::rates`](kinopt_kinematics::curve::TensionContinuityBias::rates).
    ///
    /// Values at key times are exactly those of the key. A track shorter than the clip holds its end values. Limits are
    /// not applied, and a cubic may exceed the range of its keys.
    ///
    /// # Errors
    /// A [`ClipError`]: the time is not finite, or `q` is too short for a bone that has keys.
    pub fn sample(&self, time: f64, playback: Playback, q: &mut [f64]) -> Result<(), ClipError> {
        if !time.is_finite() {
            return Err(ClipError::NonFiniteSampleTime { time });
        }
        let time = match self.time_span() {
            Some(span) => playback.within(time, span),
            None => time,
        };
        q.fill(0.0);
        let angles = q.len();
        for (track, curve) in self.tracks.iter().zip(&self.curves) {
            let bone = track.bone.index();
            let first = ANGLES_PER_BONE * bone;
            let bone_angles = q
                .get_mut(first..first + ANGLES_PER_BONE)
                .ok_or(ClipError::TooFewAngles { bone, angles })?;
            bone_angles.copy_from_slice(&curve.at(time).to_array());
        }
        Ok(())
    }
}
