//! Verification of steps with a long joint displacement: small parts of the tool's segment must connect both ends.

use super::PathError;
use super::branch_continuation::{MOST_PARTS, SMALLER};
use super::bridge::is_led;
use super::knot_configurations::KnotPath;
use super::knots::NEAR;
use super::layers::Growth;
use super::linear_segment::between;
use crate::arm::Ends;

/// Minimum number of parts of a step.
const FEWEST_PARTS: f64 = 100.0;
/// Largest distance between the result of the parts and the end of the step, relative to the step bound.
const AGREES: f64 = 5e-3;

/// Null-space motion while a step is followed in parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Redundancy {
    /// Stays at its start.
    Left,
    /// Moves linearly to the end of the step.
    GoesAlong,
}

/// Returns the reconfigurations with a long tool segment and two reached ends, ascending.
pub(super) fn left(growth: &Growth<'_>, way: &KnotPath) -> Vec<usize> {
    let steps = 1..way.joined.len();
    steps
        .filter(|&knot| !way.joined[knot] && goes_far(growth, knot) && is_led(growth, way, knot))
        .collect()
}

/// Marks long steps that cannot be followed in parts as reconfigurations.
pub(super) fn split_untraceable(
    growth: &Growth<'_>,
    way: &mut KnotPath,
    spare: Redundancy,
) -> Result<(), PathError> {
    for knot in 1..way.joined.len() {
        let has_to_be_led = way.joined[knot] && is_long(growth, way, knot);
        if has_to_be_led {
            way.joined[knot] =
                is_led(growth, way, knot) && do_parts_lead(growth, way, knot, spare)?;
        }
    }
    Ok(())
}

/// Joins reconfigurations with a long tool segment that can be followed in parts.
pub(super) fn join_led(growth: &Growth<'_>, way: &mut KnotPath) -> Result<(), PathError> {
    let (knots, n) = (growth.knots, growth.width());
    for knot in left(growth, way) {
        if !do_parts_lead(growth, way, knot, Redundancy::GoesAlong)? {
            continue;
        }
        let (from, to) = (way.row(knot - 1, n), way.row(knot, n));
        let allowance = growth.bounds.allowance(from, to);
        if growth.bounds.allow_times(allowance, knots, knot, from, to) {
            way.joined[knot] = true;
            way.allowance[knot] = allowance;
        }
    }
    Ok(())
}

fn goes_far(growth: &Growth<'_>, knot: usize) -> bool {
    growth.knots.way[knot] - growth.knots.way[knot - 1] > NEAR
}

/// Returns whether a joint moves further than the step bound, independent of times.
fn is_long(growth: &Growth<'_>, way: &KnotPath, knot: usize) -> bool {
    let n = growth.width();
    growth
        .bounds
        .least_excess(way.row(knot - 1, n), way.row(knot, n))
        > 1.0 + 1e-9
}

/// Returns whether the arm gets from knot to knot by following the tool's segment in small parts without a long joint
/// move.
fn do_parts_lead(
    growth: &Growth<'_>,
    way: &KnotPath,
    knot: usize,
    spare: Redundancy,
) -> Result<bool, PathError> {
    let (knots, n) = (growth.knots, growth.width());
    let arm = growth.arms.of(knots.tool(knot));
    let [from, to] = [knot - 1, knot].map(|knot| knots.targets[knot]);
    let parts = (knots.way[knot] - knots.way[knot - 1]) / NEAR;
    let parts = parts.ceil().clamp(FEWEST_PARTS, MOST_PARTS) as usize;
    let count = parts * SMALLER;
    let (mut q, end) = (way.row(knot - 1, n).to_vec(), way.row(knot, n));
    let (mut start, mut ends) = (Vec::with_capacity(n), Ends::default());
    // Parts with a too long joint move are subdivided.
    let (mut at, mut stride) = (0, SMALLER);
    while at < count {
        let next = at + stride;
        let along = match spare {
            Redundancy::Left => 0.0,
            Redundancy::GoesAlong => stride as f64 / (count - at) as f64,
        };
        start.clear();
        start.extend(q.iter().zip(end).map(|(q, end)| q + along * (end - q)));
        if next == count {
            arm.continue_all(&[to], &start, &mut ends)?;
        } else {
            // At full extension the straight segment may be some micrometres out of reach.
            let target = between(&from, &to, next as f64 / count as f64);
            arm.carry_all(&target, &start, &mut ends)?;
        }
        if !ends.outcomes.first().is_some_and(|outcome| outcome.reached) {
            return Ok(false);
        }
        if growth.bounds.allow_part(q.iter().zip(&ends.q)) {
            q.copy_from_slice(&ends.q);
            at = next;
            if at.is_multiple_of(SMALLER) {
                stride = SMALLER;
            }
        } else if stride == SMALLER {
            stride = 1;
        } else {
            return Ok(false);
        }
    }
    Ok(growth.bounds.least_excess(&q, end) <= AGREES)
}
