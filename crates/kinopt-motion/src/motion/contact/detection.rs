//! Contact detection from the speed and height of points.

use std::ops::Range;

use kinopt_kinematics::bad_option::{AT_LEAST_0, BadOption, NOT_NEGATIVE};
use kinopt_kinematics::spatial::Vector3;

/// Leg length for which the default speed limit is meant, metres.
pub(in crate::motion) const NOMINAL_LEG_LENGTH_M: f64 = 0.9;

/// Criteria of contact of a point: speed and height, for a character of the model's size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ContactDetection {
    /// Largest speed in contact, m/s.
    pub speed: f64,
    /// Largest height above the ground in contact, metres; infinity for climbing.
    #[cfg_attr(feature = "serde", serde(with = "kinopt_solver::search::non_finite"))]
    pub height: f64,
    /// Shortest duration of a contact, seconds.
    pub shortest_s: f64,
    /// Duration of the blend to and from a contact position, seconds.
    pub lead_s: f64,
}

impl Default for ContactDetection {
    /// Returns 0.25 m/s at any height, a shortest duration of 0.1 s and a blend of 0.15 s.
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
    /// Sets the largest speed in contact, m/s.
    #[must_use]
    pub fn with_speed(mut self, speed: f64) -> Self {
        self.speed = speed;
        self
    }

    /// Sets the largest height in contact, metres.
    #[must_use]
    pub fn with_height(mut self, height: f64) -> Self {
        self.height = height;
        self
    }

    /// Sets the shortest duration of a contact, seconds.
    #[must_use]
    pub fn with_shortest(mut self, seconds: f64) -> Self {
        self.shortest_s = seconds;
        self
    }

    /// Sets the duration of the blend to and from a contact position, seconds.
    #[must_use]
    pub fn with_lead(mut self, seconds: f64) -> Self {
        self.lead_s = seconds;
        self
    }

    /// Checks the ranges of all options.
    pub(in crate::motion) fn check(&self) -> Result<(), BadOption> {
        BadOption::check("contact speed", self.speed, AT_LEAST_0)?;
        BadOption::check("contact height", self.height, AT_LEAST_0)?;
        BadOption::check("shortest_s", self.shortest_s, NOT_NEGATIVE)?;
        BadOption::check("lead_s", self.lead_s, NOT_NEGATIVE)
    }

    /// Returns the capture frames in which a point is in contact, as ranges.
    ///
    /// `positions` has the position of the point in each capture frame, metres. `height` returns its height above the
    /// ground, metres. `rate` is in capture frames per second.
    pub(in crate::motion) fn spans(
        &self,
        positions: &[Vector3<f64>],
        height: impl Fn(usize) -> f64,
        rate: f64,
    ) -> Vec<Range<usize>> {
        let last = positions.len().saturating_sub(1);
        // A window of five capture frames, because captures are noisy.
        let is_still = |frame: usize| {
            let (from, to) = (frame.saturating_sub(2), (frame + 2).min(last));
            let moved = (positions[to] - positions[from]).norm() * rate / (to - from).max(1) as f64;
            moved <= self.speed && height(frame) <= self.height
        };
        let shortest = ((self.shortest_s * rate).ceil() as usize).max(2);
        let mut spans: Vec<Range<usize>> = Vec::new();
        for frame in (0..positions.len()).filter(|&frame| is_still(frame)) {
            match spans.last_mut() {
                Some(span) if span.end == frame => span.end += 1,
                _ => spans.push(frame..frame + 1),
            }
        }
        spans.retain(|span| span.len() >= shortest);
        spans
    }

    /// Returns the duration of the blend in capture frames.
    pub(in crate::motion) fn lead_frames(&self, rate: f64) -> usize {
        (self.lead_s * rate).ceil() as usize
    }
}

/// Smoothstep from 0 to 1, with zero slope at both ends.
pub(in crate::motion) fn smooth(fraction: f64) -> f64 {
    fraction * fraction * (3.0 - 2.0 * fraction)
}

#[cfg(test)]
mod tests {
    use super::ContactDetection;
    use kinopt_kinematics::spatial::Vector3;

    /// The window is shorter at the first and last capture frames.
    #[test]
    fn uniform_motion_has_no_contact() {
        let detection = ContactDetection {
            shortest_s: 0.0,
            ..ContactDetection::default()
        };
        let rate = 100.0;
        for (factor, spans) in [(1.2, 0), (0.8, 1)] {
            let step = factor * detection.speed / rate;
            let positions: Vec<_> = (0..30)
                .map(|frame| Vector3::new(step * f64::from(frame), 0.0, 0.0))
                .collect();
            let contacts = detection.spans(&positions, |_| 0.0, rate);
            assert_eq!(contacts.len(), spans, "{contacts:?}");
        }
    }
}
