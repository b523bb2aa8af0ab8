//! Playback modes: extrapolation of a clip outside its span.

/// Extrapolation before the first and after the last key.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, Default, serde::Deserialize, serde::Serialize,
)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Playback {
    /// Holds the first pose before the clip and the last pose after it.
    #[default]
    Hold,
    /// Repeats the clip with the period of its span. Both ends of the span are played as they are.
    Loop,
    /// Plays the clip forwards, then backwards, with twice the period of its span.
    PingPong,
}

impl Playback {
    /// Maps a time to the span `[start, end]`, all in seconds. NaN maps to the start, as does an infinite time in a
    /// repeating mode.
    #[must_use]
    pub fn within(self, time: f64, [start, end]: [f64; 2]) -> f64 {
        if (start..=end).contains(&time) || start >= end {
            return time.max(start).min(end);
        }
        if !time.is_finite() && self != Self::Hold {
            return start;
        }
        let length = end - start;
        match self {
            Self::Hold => time.max(start).min(end),
            Self::Loop => start + (time - start).rem_euclid(length),
            Self::PingPong => {
                let phase = (time - start).rem_euclid(2.0 * length);
                start + phase.min(2.0 * length - phase)
            }
        }
    }
}
