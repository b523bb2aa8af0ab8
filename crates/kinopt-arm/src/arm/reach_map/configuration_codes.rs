//! Configurations as fractions of the joint limits, two bytes a joint.

use std::f64::consts::{PI, TAU};

/// Interval of a joint's codes: its limits, or a revolution for a joint without one of them.
fn coded(lower: f64, upper: f64) -> (f64, f64) {
    match (lower.is_finite(), upper.is_finite()) {
        (true, true) => (lower, upper),
        (true, false) => (lower, lower + TAU),
        (false, true) => (upper - TAU, upper),
        (false, false) => (-PI, PI),
    }
}

/// Code of a joint value within its limits, radians or metres.
pub(super) fn encode(value: f64, lower: f64, upper: f64) -> u16 {
    let is_limited = lower.is_finite() && upper.is_finite();
    let (low, high) = coded(lower, upper);
    let value = match is_limited {
        true => value,
        false => value - TAU * ((value - low) / TAU).floor(),
    };
    let fraction = match high > low {
        true => (value - low) / (high - low),
        false => 0.0,
    };
    // Casts saturate.
    (fraction * f64::from(u16::MAX)).round() as u16
}

/// Joint value of a code, within the limits, radians or metres.
pub(super) fn decode(code: u16, lower: f64, upper: f64) -> f64 {
    let (low, high) = coded(lower, upper);
    let value = low + (high - low) * (f64::from(code) / f64::from(u16::MAX));
    value.clamp(lower, upper)
}
