//! What a clip does outside its own span of time.

/// What happens before the first and after the last key.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, Default, serde::Deserialize, serde::Serialize,
)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Playback {
    /// The first pose before the clip, the last one after it.
    #[default]
    Hold,
    /// The clip again, with the period of its span. Within the span, both ends included, it plays
    /// as it is.
    Loop,
    /// The clip forwards, then backwards, with twice the period of its span.
    PingPong,
}

impl Playback {
    /// The time within the span `[start, end]` that looks as `time` does; all in seconds. NaN, and
    /// an infinite time of motion that repeats, counts as the start.
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
                let there_and_back = (time - start).rem_euclid(2.0 * length);
                start + there_and_back.min(2.0 * length - there_and_back)
            }
        }
    }
}
