//! Steps in which a joint goes further than in a step: a branch is left in each to which small parts of the tool's way do not lead.

use super::PathError;
use super::branch_continuation::{MOST_PARTS, SMALLER};
use super::bridge::is_led;
use super::knot_configurations::Way;
use super::knots::NEAR;
use super::layers::Growth;
use super::straight_way::between;
use crate::arm::Ends;

/// Parts of the tool's way in a step at least.
const FEWEST_PARTS: f64 = 100.0;
/// How near they lead, as a share of the longest step.
const AGREES: f64 = 5e-3;

/// What an arm does in small parts with what it has to spare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Spare {
    /// It is left where it is.
    Left,
    /// It goes evenly to where the step ends.
    GoesAlong,
}

/// The steps in which the tool goes far, both of whose ends are reached, and in which a branch is left; rising.
pub(super) fn left(growth: &Growth<'_>, way: &Way) -> Vec<usize> {
    let steps = 1..way.joined.len();
    steps
        .filter(|&knot| !way.joined[knot] && goes_far(growth, knot) && is_led(growth, way, knot))
        .collect()
}

/// Leaves the branch in the long steps that are not led.
pub(super) fn leave_unled(
    growth: &Growth<'_>,
    way: &mut Way,
    spare: Spare,
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

/// Joins the steps in which the tool goes far and a branch was left, but which are led.
pub(super) fn join_led(growth: &Growth<'_>, way: &mut Way) -> Result<(), PathError> {
    let (knots, n) = (growth.knots, growth.width());
    for knot in left(growth, way) {
        if !do_parts_lead(growth, way, knot, Spare::GoesAlong)? {
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

/// Whether a joint goes further than in a step, however much time there is.
fn is_long(growth: &Growth<'_>, way: &Way, knot: usize) -> bool {
    let n = growth.width();
    growth
        .bounds
        .least_excess(way.row(knot - 1, n), way.row(knot, n))
        > 1.0 + 1e-9
}

/// Whether the arm comes from knot to knot, to which the path leads, if it follows the tool's way in small parts, without a long move in any.
fn do_parts_lead(
    growth: &Growth<'_>,
    way: &Way,
    knot: usize,
    spare: Spare,
) -> Result<bool, PathError> {
    let (knots, n) = (growth.knots, growth.width());
    let arm = growth.arms.of(knots.tool(knot));
    let [from, to] = [knot - 1, knot].map(|knot| knots.targets[knot]);
    let parts = (knots.way[knot] - knots.way[knot - 1]) / NEAR;
    let parts = parts.ceil().clamp(FEWEST_PARTS, MOST_PARTS) as usize;
    let count = parts * SMALLER;
    let (mut q, end) = (way.row(knot - 1, n).to_vec(), way.row(knot, n));
    let (mut start, mut ends) = (Vec::with_capacity(n), Ends::default());
    // Where a joint goes too far in a part, it is gone in smaller ones.
    let (mut at, mut stride) = (0, SMALLER);
    while at < count {
        let next = at + stride;
        let along = match spare {
            Spare::Left => 0.0,
            Spare::GoesAlong => stride as f64 / (count - at) as f64,
        };
        start.clear();
        start.extend(q.iter().zip(end).map(|(q, end)| q + along * (end - q)));
        if next == count {
            arm.continue_all(&[to], &start, &mut ends)?;
        } else {
            // Where the arm is stretched out, the straight way may be some micrometres out of reach.
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
