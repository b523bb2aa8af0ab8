//! Interpolation of keyframes at times that need not be evenly spaced.

use super::EulerClip;
use crate::animation::Playback;
use crate::skeleton::ANGLES_PER_BONE;

/// Why a clip cannot be sampled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SampleError {
    /// The time is NaN or infinite.
    #[error("the time {time} is not finite")]
    NonFiniteTime {
        /// In seconds.
        time: f64,
    },
    /// The clip moves a bone that the configuration has no angles for.
    #[error("the clip moves bone {bone}, but there is room for {angles} angles only")]
    TooFewAngles {
        /// The bone's index.
        bone: usize,
        /// How many angles there is room for.
        angles: usize,
    },
}

impl EulerClip {
    /// Writes the angles at `time` (seconds) into the stacked configuration `q` (radians, shape
    /// 3 × bones: θ₁, θ₂, θ₃ of bone 0, of bone 1, …). Bones without keys are at 0.
    ///
    /// Between keys P_i at t_i runs a straight line or a cubic Hermite segment, as each track's
    /// [`EulerInterpolation`](super::EulerInterpolation) says. A Catmull-Rom spline has the tangents
    /// m_i = (P_{i+1} − P_{i−1}) / (t_{i+1} − t_{i−1}), times the segment's own length in time; at a
    /// track's first and last key the tangent is one-sided. At evenly spaced keys this is the
    /// classic one (Catmull & Rom 1974). Kochanek-Bartels tangents are
    /// [`TensionContinuityBias::rates`](crate::animation::curve::TensionContinuityBias::rates). At a key's time the values are the key's, to the bit. A track
    /// shorter than the clip holds its ends. Limits are not looked at, and a cubic may leave the
    /// range of its keys.
    ///
    /// # Errors
    /// A [`SampleError`]: the time is not finite, or `q` is too short for a bone that has keys.
    pub fn sample(&self, time: f64, playback: Playback, q: &mut [f64]) -> Result<(), SampleError> {
        if !time.is_finite() {
            return Err(SampleError::NonFiniteTime { time });
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
            let room = q
                .get_mut(first..first + ANGLES_PER_BONE)
                .ok_or(SampleError::TooFewAngles { bone, angles })?;
            room.copy_from_slice(&curve.at(time).to_array());
        }
        Ok(())
    }
}
