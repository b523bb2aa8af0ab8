//! Choice among values of a revolute joint that differ by whole revolutions.

use std::f64::consts::TAU;

use super::prepared::Prepared;
use super::trigonometry::MAX_ANGLE;

/// Removes whole revolutions from a start that is too large for exact sines, down to within half a revolution of zero.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn reduced_angle(start: f64) -> f64 {
    if start.abs() > MAX_ANGLE - TAU {
        start - TAU * (start / TAU).round()
    } else {
        start
    }
}

/// Adds whole revolutions to a revolute joint's value, to bring it as near to the start as the bounds allow.
///
/// Returns the value unchanged if the bounds span less than a revolution or do not include the result. Radians.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn nearest_revolution(start: f64, value: f64, (lower, upper): (f64, f64)) -> f64 {
    if upper - lower < TAU {
        return value;
    }
    let lowest = ((lower - value) / TAU).ceil();
    let highest = ((upper - value) / TAU).floor();
    let revolutions = ((reduced_angle(start) - value) / TAU)
        .round()
        .min(highest)
        .max(lowest);
    let shifted = value + revolutions * TAU;
    match lower <= shifted && shifted <= upper {
        true => shifted,
        false => value,
    }
}

/// Adds whole revolutions to the joints that can make them, as near to the start as bounds allow.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn unwrap_towards(prepared: &Prepared, start: &[f64], q: &mut [f64]) {
    if !prepared.has_full_revolution {
        return;
    }
    for ((q, link), start) in q.iter_mut().zip(&prepared.links.links).zip(start) {
        if link.kind.turns() {
            *q = nearest_revolution(*start, *q, (link.lower, link.upper));
        }
    }
}
