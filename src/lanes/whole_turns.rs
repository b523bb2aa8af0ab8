//! Whole turns: which of the equal values of a wide joint is returned.

use std::f64::consts::TAU;

use super::prepared::Prepared;
use super::trigonometry::MAX_ANGLE;

/// A start that is too large an angle for exact sines, less whole turns: within half a turn of zero.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn reduced(start: f64) -> f64 {
    if start.abs() > MAX_ANGLE - TAU {
        start - TAU * (start / TAU).round()
    } else {
        start
    }
}

/// A value of a joint that turns, by whole turns as near to the start as the bounds allow; as it is where these
/// have no room for one, or do not hold it.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn turned_towards(start: f64, value: f64, (lower, upper): (f64, f64)) -> f64 {
    if upper - lower < TAU {
        return value;
    }
    let lowest = ((lower - value) / TAU).ceil();
    let highest = ((upper - value) / TAU).floor();
    let turns = ((reduced(start) - value) / TAU)
        .round()
        .min(highest)
        .max(lowest);
    let turned = value + turns * TAU;
    match lower <= turned && turned <= upper {
        true => turned,
        false => value,
    }
}

/// Adds whole turns to the joints that can make them, as near to the start as bounds allow.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn unwrap_towards(prepared: &Prepared, start: &[f64], q: &mut [f64]) {
    if !prepared.wide {
        return;
    }
    for ((q, link), start) in q.iter_mut().zip(&prepared.links.links).zip(start) {
        if link.kind.turns() {
            *q = turned_towards(*start, *q, (link.lower, link.upper));
        }
    }
}
