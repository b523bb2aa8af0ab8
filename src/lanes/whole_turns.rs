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

/// Adds whole turns to the joints that can make them, as near to the start as bounds allow.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn unwrap_towards(prepared: &Prepared, start: &[f64], q: &mut [f64]) {
    if !prepared.wide {
        return;
    }
    for ((q, link), start) in q.iter_mut().zip(&prepared.links.links).zip(start) {
        if link.kind.turns() && link.upper - link.lower >= TAU {
            let lowest = ((link.lower - *q) / TAU).ceil();
            let highest = ((link.upper - *q) / TAU).floor();
            let turns = ((reduced(*start) - *q) / TAU)
                .round()
                .min(highest)
                .max(lowest);
            let turned = *q + turns * TAU;
            if link.lower <= turned && turned <= link.upper {
                *q = turned;
            }
        }
    }
}
