//! When what may stand does, told by where it goes.

use std::ops::Range;

use crate::bad_option::{AT_LEAST_0, BadOption, NOT_NEGATIVE};
use crate::spatial::Vector3;

/// How long the legs are of a body whose feet stand below the default speed, metres.
pub(super) const USUAL_LEG_M: f64 = 0.9;

/// When something that may stand does: by its speed, and how high it is, on a body of the model's size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ContactDetection {
    /// It moves no faster than this, m/s.
    pub speed: f64,
    /// It is no higher over the ground than this, metres; infinity where people climb.
    #[cfg_attr(feature = "serde", serde(with = "crate::search::non_finite"))]
    pub height: f64,
    /// It does so for at least this long, seconds.
    pub shortest_s: f64,
    /// So long before and after, what stands is led to its place and let go, seconds.
    pub lead_s: f64,
}

impl Default for ContactDetection {
    /// 0.25 m/s at any height, for a tenth of a second, led for 0.15 seconds.
    fn default() -> Self {
        Self {
            speed: 0.25,
            height: f64::INFINITY,
            shortest_s: 0.1,
            lead_s: 0.15,
        }
    }
}

impl ContactDetection {
    setters! {
        /// How fast it moves at most, m/s.
        pub fn with_speed(mut self, speed: f64) { self.speed = speed }
        /// How high it is at most, metres.
        pub fn with_height(mut self, height: f64) { self.height = height }
        /// How long it stands at least, seconds.
        pub fn with_shortest(mut self, seconds: f64) { self.shortest_s = seconds }
        /// How long it is led to its place and let go, seconds.
        pub fn with_lead(mut self, seconds: f64) { self.lead_s = seconds }
    }

    /// Whether its numbers are in their ranges.
    pub(super) fn check(&self) -> Result<(), BadOption> {
        BadOption::check("the speed of what stands", self.speed, AT_LEAST_0)?;
        BadOption::check("the height of what stands", self.height, AT_LEAST_0)?;
        BadOption::check("shortest_s", self.shortest_s, NOT_NEGATIVE)?;
        BadOption::check("lead_s", self.lead_s, NOT_NEGATIVE)
    }

    /// The spans of frames over which a point hardly moves and is not high: by where it is in each frame, its height
    /// over the ground there, and how many frames a second there are.
    pub(super) fn spans(
        &self,
        way: &[Vector3<f64>],
        height: impl Fn(usize) -> f64,
        rate: f64,
    ) -> Vec<Range<usize>> {
        let last = way.len().saturating_sub(1);
        // Over five frames, as captures tremble.
        let is_still = |frame: usize| {
            let (from, to) = (frame.saturating_sub(2), (frame + 2).min(last));
            let moved = (way[to] - way[from]).norm() * rate / (to - from).max(1) as f64;
            moved <= self.speed && height(frame) <= self.height
        };
        let shortest = ((self.shortest_s * rate).ceil() as usize).max(2);
        let mut spans: Vec<Range<usize>> = Vec::new();
        for frame in (0..way.len()).filter(|&frame| is_still(frame)) {
            match spans.last_mut() {
                Some(span) if span.end == frame => span.end += 1,
                _ => spans.push(frame..frame + 1),
            }
        }
        spans.retain(|span| span.len() >= shortest);
        spans
    }

    /// Over how many frames what stands is led there, and let go.
    pub(super) fn lead_frames(&self, rate: f64) -> usize {
        (self.lead_s * rate).ceil() as usize
    }
}

/// The middle of where a point is over some frames, at least one.
pub(super) fn mean_place(way: &[Vector3<f64>]) -> Vector3<f64> {
    let sum = way.iter().fold(Vector3::zero(), |sum, at| sum + *at);
    sum * (1.0 / way.len().max(1) as f64)
}

/// From 0 to 1, level at both ends.
pub(super) fn smooth(share: f64) -> f64 {
    share * share * (3.0 - 2.0 * share)
}

#[cfg(test)]
mod tests {
    use super::ContactDetection;
    use crate::spatial::Vector3;

    /// The first and the last frames have fewer beside them, over which less is gone.
    #[test]
    fn what_goes_evenly_stands_nowhere() {
        let detection = ContactDetection {
            shortest_s: 0.0,
            ..ContactDetection::default()
        };
        let rate = 100.0;
        for (times, spans) in [(1.2, 0), (0.8, 1)] {
            let step = times * detection.speed / rate;
            let way: Vec<_> = (0..30)
                .map(|frame| Vector3::new(step * f64::from(frame), 0.0, 0.0))
                .collect();
            let found = detection.spans(&way, |_| 0.0, rate);
            assert_eq!(found.len(), spans, "{found:?}");
        }
    }
}
