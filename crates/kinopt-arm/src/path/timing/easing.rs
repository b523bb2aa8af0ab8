//! Eased curve parameter that starts and ends slowly, for motions with bounded jerk.
//!
//! From rest with bounded jerk, the distance grows with the cube of the time. If the distance is the cube of a
//! parameter σ, the speed of σ at rest is positive, and the motion has no singularity there. The curve's first and
//! second derivatives by σ are 0 at both ends, so velocity and acceleration are 0 too.

use super::cell::CurveState;

/// Curve parameter s over σ. Its derivative s′ rises from 0 to 1 over `ramp` by the smoothstep 3 y² − 2 y³, stays at 1,
/// and falls likewise.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SmoothstepEasing {
    /// First curve parameter.
    start: f64,
    /// Length of the curve.
    length: f64,
    /// Length of each ramp in σ. It covers half that length of the curve.
    ramp: f64,
}

/// Length of a ramp in σ, relative to the curve's length.
const RAMP_RATIO: f64 = 0.5;
/// Maximum number of Newton steps for σ at a curve parameter.
const MAX_STEPS: usize = 64;

impl SmoothstepEasing {
    pub(super) fn new(start: f64, end: f64) -> Self {
        let length = end - start;
        Self {
            start,
            length,
            ramp: RAMP_RATIO * length,
        }
    }

    /// Last value of σ; the first is 0.
    pub(super) fn end(&self) -> f64 {
        self.length + self.ramp
    }

    /// Values of σ at which the first ramp ends and the second begins.
    pub(super) fn ramp_ends(&self) -> [f64; 2] {
        [self.ramp, self.length]
    }

    /// Returns the curve parameter and its first three derivatives by σ.
    pub(super) fn derivatives(&self, parameter: f64) -> [f64; 4] {
        let remaining = self.end() - parameter;
        if parameter < self.ramp {
            let [s, first, second, third] = self.in_ramp(parameter);
            [self.start + s, first, second, third]
        } else if remaining < self.ramp {
            let [s, first, second, third] = self.in_ramp(remaining);
            [self.start + self.length - s, first, -second, third]
        } else {
            [self.start + parameter - 0.5 * self.ramp, 1.0, 0.0, 0.0]
        }
    }

    fn in_ramp(&self, parameter: f64) -> [f64; 4] {
        let y = parameter / self.ramp;
        [
            self.ramp * y * y * y * (1.0 - 0.5 * y),
            y * y * (3.0 - 2.0 * y),
            6.0 * y * (1.0 - y) / self.ramp,
            (6.0 - 12.0 * y) / (self.ramp * self.ramp),
        ]
    }

    /// Converts a state of σ to one of the curve parameter.
    pub(super) fn state(&self, state: CurveState) -> CurveState {
        let [position, first, second, _] = self.derivatives(state.position);
        CurveState {
            position,
            speed: first * state.speed,
            acceleration: second * state.speed * state.speed + first * state.acceleration,
        }
    }

    /// Returns σ at a curve parameter.
    pub(super) fn parameter(&self, s: f64) -> f64 {
        let moved = (s - self.start).clamp(0.0, self.length);
        let end_distance = moved.min(self.length - moved);
        let from_end = if end_distance >= 0.5 * self.ramp {
            end_distance + 0.5 * self.ramp
        } else {
            // Newton's method from the right on a convex function.
            let mut parameter = self.ramp;
            for _ in 0..MAX_STEPS {
                let [value, slope, ..] = self.in_ramp(parameter);
                let correction = (value - end_distance) / slope;
                if !correction.is_finite() || correction <= 1e-16 * self.ramp {
                    break;
                }
                parameter -= correction;
            }
            parameter.max(0.0)
        };
        match moved <= 0.5 * self.length {
            true => from_end,
            false => self.end() - from_end,
        }
    }
}
