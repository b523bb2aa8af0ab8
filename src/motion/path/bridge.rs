//! Removal of reconfigurations by self-motion.
//!
//! For a redundant arm, the branches before and after a reconfiguration are often connected by a self-motion. A bridge
//! distributes that motion over the neighbouring knots.

use std::ops::Range;

use super::PathError;
use super::knot_configurations::KnotPath;
use super::layers::Growth;
use crate::arm::Ends;

/// Maximum number of knots between the reconfiguration and an end of its bridge. The shortest valid bridge is used.
const LONGEST: usize = 128;
/// Knot stride of the first, coarse check of a bridge.
const COARSE: usize = 8;

/// Bridges every reconfiguration that it can. Reached knots and continuous steps are preserved.
pub(super) fn bridge(growth: &Growth<'_>, way: &mut KnotPath) -> Result<(), PathError> {
    let mut ends = Ends::default();
    for knot in 1..way.joined.len() {
        if way.joined[knot] || !is_led(growth, way, knot) {
            continue;
        }
        let (mut half, mut tried) = (1, None);
        while half <= LONGEST && !way.joined[knot] {
            half *= 2;
            let (first, last) = piers(growth, way, knot, half);
            // A longer bridge has the same ends.
            if tried.replace((first, last)) == Some((first, last)) {
                break;
            }
            if let Some(rows) = span(growth, way, (first, last), &mut ends)? {
                let n = growth.width();
                way.q[(first + 1) * n..last * n].copy_from_slice(&rows);
                way.joined[knot] = true;
            }
        }
    }
    Ok(())
}

/// Returns whether the path leads to a knot from the one before, and both are reached.
pub(super) fn is_led(growth: &Growth<'_>, way: &KnotPath, knot: usize) -> bool {
    way.reached[knot - 1] && way.reached[knot] && growth.knots.is_led_to(knot)
}

/// Returns the end knots of a bridge: up to `half` knots away, without other reconfigurations or unreached knots in
/// between.
fn piers(growth: &Growth<'_>, way: &KnotPath, knot: usize, half: usize) -> (usize, usize) {
    let goes_on = |at: &usize| way.joined[*at] && is_led(growth, way, *at);
    let before = (1..knot).rev().take_while(goes_on).take(half - 1).count();
    let after = knot + 1..way.joined.len();
    let after = after.take_while(goes_on).take(half - 1).count();
    (knot - 1 - before, knot + after)
}

/// Returns the configurations between two knots, guided by linear interpolation.
///
/// Returns `None` if a knot is not reached or in collision, or if a joint would have to move too far.
fn span(
    growth: &Growth<'_>,
    way: &KnotPath,
    (first, last): (usize, usize),
    ends: &mut Ends,
) -> Result<Option<Vec<f64>>, PathError> {
    let (knots, n) = (growth.knots, growth.width());
    let (from, to) = (way.row(first, n), way.row(last, n));
    let steps = (last - first) as f64;
    let tool = knots.tool(last);
    let mut rows = Vec::new();
    // Few knots are enough to reject most invalid bridges.
    for stride in [COARSE, 1] {
        let stops = (first + 1..last).filter(|knot| (knot - first).is_multiple_of(stride));
        let stops: Vec<usize> = stops.collect();
        let guesses = stops.iter().flat_map(|knot| {
            let share = (knot - first) as f64 / steps;
            (from.iter().zip(to)).map(move |(a, b)| a + share * (b - a))
        });
        let guesses: Vec<f64> = guesses.collect();
        let targets: Vec<_> = stops.iter().map(|knot| knots.targets[*knot]).collect();
        let arms = growth.arms;
        arms.continue_all(|_| tool, &targets, &guesses, ends)?;
        if ends.outcomes.iter().any(|outcome| !outcome.reached) {
            return Ok(None);
        }
        rows = [from, &ends.q, to].concat();
        let mut before = first;
        for (pair, knot) in rows
            .windows(2 * n)
            .step_by(n)
            .zip(stops.into_iter().chain([last]))
        {
            if !is_short(growth, way, before..knot, pair) {
                return Ok(None);
            }
            before = knot;
        }
    }
    let inner = &rows[n..rows.len() - n];
    let mut free = Vec::new();
    growth.note_free(last, inner, true, &mut free)?;
    Ok(free.iter().all(|free| *free).then(|| inner.to_vec()))
}

/// Returns whether the steps after these knots can lead from one configuration to the other. For one step the check is
/// exact.
fn is_short(growth: &Growth<'_>, way: &KnotPath, knots: Range<usize>, pair: &[f64]) -> bool {
    let (from, to) = pair.split_at(growth.width());
    let in_time = || {
        let allowance = way.allowance[knots.end];
        (growth.bounds).allow_times(allowance, growth.knots, knots.end, from, to)
    };
    let short = growth.bounds.least_excess(from, to) <= knots.len() as f64 + 1e-9;
    short && (knots.len() > 1 || in_time())
}
