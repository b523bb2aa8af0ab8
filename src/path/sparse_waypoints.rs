//! Verification of steps with a long joint displacement: small parts of the tool's segment must connect both ends.

use super::PathError;
use super::branch_continuation::{MAX_PARTS, PART_SUBDIVISIONS};
use super::bridge::is_on_path;
use super::knot_configurations::KnotPath;
use super::knots::STATION_SPACING;
use super::layers::LayerGenerator;
use super::linear_segment::interpolate;
use crate::arm::Ends;

/// Minimum number of parts of a step.
const MIN_PARTS: f64 = 100.0;
/// Largest distance between the result of the parts and the end of the step, relative to the step bound.
const MAX_END_DIFFERENCE: f64 = 5e-3;

/// Null-space motion while a step is followed in parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Redundancy {
    /// Stays at its start.
    Fixed,
    /// Moves linearly to the end of the step.
    Interpolated,
}

/// Returns the reconfigurations with a long tool segment and two reached ends, ascending.
pub(super) fn long_reconfigurations(
    generator: &LayerGenerator<'_>,
    joint_path: &KnotPath,
) -> Vec<usize> {
    let steps = 1..joint_path.joined.len();
    steps
        .filter(|&knot| {
            !joint_path.joined[knot]
                && has_long_segment(generator, knot)
                && is_on_path(generator, joint_path, knot)
        })
        .collect()
}

/// Marks long steps that cannot be followed in parts as reconfigurations.
pub(super) fn split_untraceable(
    generator: &LayerGenerator<'_>,
    joint_path: &mut KnotPath,
    redundancy: Redundancy,
) -> Result<(), PathError> {
    for knot in 1..joint_path.joined.len() {
        let needs_tracing =
            joint_path.joined[knot] && exceeds_step_bound(generator, joint_path, knot);
        if needs_tracing {
            joint_path.joined[knot] = is_on_path(generator, joint_path, knot)
                && is_traceable(generator, joint_path, knot, redundancy)?;
        }
    }
    Ok(())
}

/// Joins reconfigurations with a long tool segment that can be followed in parts.
pub(super) fn join_traceable(
    generator: &LayerGenerator<'_>,
    joint_path: &mut KnotPath,
) -> Result<(), PathError> {
    let (knots, n) = (generator.knots, generator.width());
    for knot in long_reconfigurations(generator, joint_path) {
        if !is_traceable(generator, joint_path, knot, Redundancy::Interpolated)? {
            continue;
        }
        let (from, to) = (joint_path.row(knot - 1, n), joint_path.row(knot, n));
        let allowance = generator.bounds.allowance(from, to);
        if generator
            .bounds
            .allows_scaled(allowance, knots, knot, from, to)
        {
            joint_path.joined[knot] = true;
            joint_path.allowance[knot] = allowance;
        }
    }
    Ok(())
}

fn has_long_segment(generator: &LayerGenerator<'_>, knot: usize) -> bool {
    generator.knots.arc_lengths[knot] - generator.knots.arc_lengths[knot - 1] > STATION_SPACING
}

/// Returns whether a joint moves further than the step bound, independent of times.
fn exceeds_step_bound(generator: &LayerGenerator<'_>, joint_path: &KnotPath, knot: usize) -> bool {
    let n = generator.width();
    generator
        .bounds
        .max_relative_step(joint_path.row(knot - 1, n), joint_path.row(knot, n))
        > 1.0 + 1e-9
}

/// Returns whether the arm gets from knot to knot by following the tool's segment in small parts without a long joint
/// move.
fn is_traceable(
    generator: &LayerGenerator<'_>,
    joint_path: &KnotPath,
    knot: usize,
    redundancy: Redundancy,
) -> Result<bool, PathError> {
    let (knots, n) = (generator.knots, generator.width());
    let arm = generator.arms.arm(knots.tool(knot));
    let [from, to] = [knot - 1, knot].map(|knot| knots.targets[knot]);
    let parts = (knots.arc_lengths[knot] - knots.arc_lengths[knot - 1]) / STATION_SPACING;
    let parts = parts.ceil().clamp(MIN_PARTS, MAX_PARTS) as usize;
    let count = parts * PART_SUBDIVISIONS;
    let (mut q, end) = (
        joint_path.row(knot - 1, n).to_vec(),
        joint_path.row(knot, n),
    );
    let (mut start, mut ends) = (Vec::with_capacity(n), Ends::default());
    // Parts with a too long joint move are subdivided.
    let (mut step, mut stride) = (0, PART_SUBDIVISIONS);
    while step < count {
        let next = step + stride;
        let fraction = match redundancy {
            Redundancy::Fixed => 0.0,
            Redundancy::Interpolated => stride as f64 / (count - step) as f64,
        };
        start.clear();
        start.extend(q.iter().zip(end).map(|(q, end)| q + fraction * (end - q)));
        if next == count {
            arm.continue_all(&[to], &start, &mut ends)?;
        } else {
            // At full extension the straight segment may be some micrometres out of reach.
            let target = interpolate(&from, &to, next as f64 / count as f64);
            arm.carry_all(&target, &start, &mut ends)?;
        }
        if !ends.outcomes.first().is_some_and(|outcome| outcome.reached) {
            return Ok(false);
        }
        if generator.bounds.allows_part(q.iter().zip(&ends.q)) {
            q.copy_from_slice(&ends.q);
            step = next;
            if step.is_multiple_of(PART_SUBDIVISIONS) {
                stride = PART_SUBDIVISIONS;
            }
        } else if stride == PART_SUBDIVISIONS {
            stride = 1;
        } else {
            return Ok(false);
        }
    }
    Ok(generator.bounds.max_relative_step(&q, end) <= MAX_END_DIFFERENCE)
}
