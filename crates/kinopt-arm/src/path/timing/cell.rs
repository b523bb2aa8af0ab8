//! Motion of a curve parameter within one cell of a grid, in closed form.

use kinopt_kinematics::scalar::elementary::{atan2, cosh, ln_1p, sin_cos, sinh};

/// Grid cell in which the acceleration of the parameter is linear over the parameter: σ̈ = acceleration + slope · (σ −
/// start).
///
/// The squared speed is a parabola over σ. With a slope of 0 the acceleration is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct GridCell {
    /// First parameter of the cell.
    pub(super) start: f64,
    /// Length of the cell.
    pub(super) length: f64,
    /// Speed at the start.
    pub(super) speed: f64,
    pub(super) acceleration: f64,
    pub(super) slope: f64,
    /// Time at the start, seconds from the start of the curve.
    pub(super) time: f64,
}

/// Position, speed and acceleration of the curve parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurveState {
    pub(super) position: f64,
    pub(super) speed: f64,
    pub(super) acceleration: f64,
}

/// Maximum number of Newton steps for the time at a parameter.
const MAX_STEPS: usize = 64;
/// Largest |slope · time²| for which a few terms of the power series are exact.
const SMALL_SQUARE: f64 = 0.1;

impl GridCell {
    /// Returns the state after a time in the cell, seconds.
    pub(super) fn at(&self, time: f64) -> CurveState {
        let (sinh, cosh) = self.basis(time);
        let moved = self.speed * sinh + self.acceleration * cosh;
        CurveState {
            position: self.start + moved,
            speed: self.speed * (1.0 + self.slope * cosh) + self.acceleration * sinh,
            acceleration: self.acceleration + self.slope * moved,
        }
    }

    /// Returns the time until the parameter has moved by `distance`, seconds. The speed must be positive in between.
    pub(super) fn time_to(&self, distance: f64) -> f64 {
        if distance <= 0.0 {
            return 0.0;
        }
        let squared =
            |y: f64| self.speed * self.speed + y * (2.0 * self.acceleration + y * self.slope);
        let ends = [squared(0.0), squared(distance).max(0.0)];
        let mut time = 2.0 * distance / (ends[0].sqrt() + ends[1].sqrt());
        if self.slope == 0.0 {
            return time;
        }
        if (self.slope * time * time).abs() > SMALL_SQUARE {
            let closed = self.closed_time(distance, ends[1].sqrt());
            time = if closed.is_finite() { closed } else { time };
        }
        // Newton's method, bracketed by the times at the largest and smallest speed; bisection outside the bracket.
        let extremum = (-self.acceleration / self.slope).clamp(0.0, distance);
        let extremum = squared(extremum);
        let (min_squared, max_squared) = (
            ends[0].min(ends[1]).min(extremum),
            ends[0].max(ends[1]).max(extremum),
        );
        let (mut early, mut late) = (
            distance / max_squared.sqrt(),
            distance / min_squared.max(0.0).sqrt(),
        );
        for _ in 0..MAX_STEPS {
            let state = self.at(time);
            let excess = state.position - self.start - distance;
            match excess > 0.0 {
                true => late = time,
                false => early = time,
            }
            let mut next = time - excess / state.speed;
            let is_between = next >= early && next <= late;
            if !is_between {
                next = 0.5 * (early + late.min(2.0 * time));
            }
            let correction = next - time;
            time = next;
            if correction.abs() <= 1e-15 * time {
                break;
            }
        }
        time
    }

    /// Returns the time to a distance at which the speed is known, from logarithms or angles.
    fn closed_time(&self, distance: f64, speed: f64) -> f64 {
        let rate = self.slope.abs().sqrt();
        let acceleration_change = self.slope * distance;
        if self.slope > 0.0 {
            let start = rate * self.speed + self.acceleration;
            let change = rate * (speed - self.speed) + acceleration_change;
            return ln_1p(change / start) / rate;
        }
        // The speed is a cosine.
        let start = atan2(self.acceleration / rate, self.speed);
        let end = atan2(-(self.acceleration + acceleration_change) / rate, speed);
        (start + end) / rate
    }

    /// Returns sinh(ω t) / ω and (cosh(ω t) − 1) / ω² with ω² = slope.
    fn basis(&self, time: f64) -> (f64, f64) {
        let square = self.slope * time * time;
        if square.abs() < SMALL_SQUARE {
            let (mut sinh, mut cosh) = (1.0, 0.5);
            let (mut odd, mut even) = (1.0, 0.5);
            for k in 1..8_u32 {
                let k = 2.0 * f64::from(k);
                odd *= square / (k * (k + 1.0));
                even *= square / ((k + 1.0) * (k + 2.0));
                sinh += odd;
                cosh += even;
            }
            return (time * sinh, time * time * cosh);
        }
        let rate = self.slope.abs().sqrt();
        let (sin, cos) = match square > 0.0 {
            true => (sinh(rate * time), cosh(rate * time)),
            false => sin_cos(rate * time),
        };
        (sin / rate, (cos - 1.0) / self.slope)
    }
}
