//! Removal of reconfigurations by self-motion.
//!
//! For a redundant arm, the branches before and after a reconfiguration are often connected by a self-motion. A bridge
//! distributes that motion over the neighbouring knots.

use std::ops::Range;

use super::PathError;
use super::knot_configurations::KnotPath;
use super::layers::LayerGenerator;
use crate::arm::Ends;

/// Maximum number of knots between the reconfiguration and an end of its bridge. The shortest valid bridge is used.
const MAX_HALF_LENGTH: usize = 128;
/// Knot stride of the first, coarse check of a bridge.
const COARSE_STRIDE: usize = 8;

/// Bridges every reconfiguration that it can. Reached knots and continuous steps are preserved.
pub(super) fn bridge(
    generator: &LayerGenerator<'_>,
    joint_path: &mut KnotPath,
) -> Result<(), PathError> {
    let mut ends = Ends::default();
    for knot in 1..joint_path.joined.len() {
        if joint_path.joined[knot] || !is_on_path(generator, joint_path, knot) {
            continue;
        }
        let (mut half, mut tried) = (1, None);
        while half <= MAX_HALF_LENGTH && !joint_path.joined[knot] {
            half *= 2;
            let (first, last) = bridge_ends(generator, joint_path, knot, half);
            // A longer bridge has the same ends.
            if tried.replace((first, last)) == Some((first, last)) {
                break;
            }
            if let Some(rows) = bridging_rows(generator, joint_path, (first, last), &mut ends)? {
                let n = generator.width();
                joint_path.q[(first + 1) * n..last * n].copy_from_slice(&rows);
                joint_path.joined[knot] = true;
            }
        }
    }
    Ok(())
}

/// Returns whether the path leads to a knot from the one before, and both are reached.
pub(super) fn is_on_path(
    generator: &LayerGenerator<'_>,
    joint_path: &KnotPath,
    knot: usize,
) -> bool {
    joint_path.reached[knot - 1] && joint_path.reached[knot] && generator.knots.has_segment_to(knot)
}

/// Returns the end knots of a bridge: up to `half` knots away, without other reconfigurations or unreached knots in
/// between.
fn bridge_ends(
    generator: &LayerGenerator<'_>,
    joint_path: &KnotPath,
    knot: usize,
    half: usize,
) -> (usize, usize) {
    let is_continuous = |candidate: &usize| {
        joint_path.joined[*candidate] && is_on_path(generator, joint_path, *candidate)
    };
    let before = (1..knot)
        .rev()
        .take_while(is_continuous)
        .take(half - 1)
        .count();
    let after = knot + 1..joint_path.joined.len();
    let after = after.take_while(is_continuous).take(half - 1).count();
    (knot - 1 - before, knot + after)
}

/// Returns the configurations between two knots, guided by linear interpolation.
///
/// Returns `None` if a knot is not reached or in collision, or if a joint would have to move too far.
fn bridging_rows(
    generator: &LayerGenerator<'_>,
    joint_path: &KnotPath,
    (first, last): (usize, usize),
    ends: &mut Ends,
) -> Result<Option<Vec<f64>>, PathError> {
    let (knots, n) = (generator.knots, generator.width());
    let (from, to) = (joint_path.row(first, n), joint_path.row(last, n));
    let steps = (last - first) as f64;
    let tool = knots.tool(last);
    let mut rows = Vec::new();
    // Few knots are enough to reject most invalid bridges.
    for stride in [COARSE_STRIDE, 1] {
        let stops = (first + 1..last).filter(|knot| (knot - first).is_multiple_of(stride));
        let stops: Vec<usize> = stops.collect();
        let guesses = stops.iter().flat_map(|knot| {
            let fraction = (knot - first) as f64 / steps;
            (from.iter().zip(to)).map(move |(a, b)| a + fraction * (b - a))
        });
        let guesses: Vec<f64> = guesses.collect();
        let targets: Vec<_> = stops.iter().map(|knot| knots.targets[*knot]).collect();
        let arms = generator.arms;
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
            if !is_short(generator, joint_path, before..knot, pair) {
                return Ok(None);
            }
            before = knot;
        }
    }
    let inner = &rows[n..rows.len() - n];
    let mut free = Vec::new();
    generator.mark_free(last, inner, true, &mut free)?;
    Ok(free.iter().all(|free| *free).then(|| inner.to_vec()))
}

/// Returns whether the steps after these knots can lead from one configuration to the other. For one step the check is
/// exact.
fn is_short(
    generator: &LayerGenerator<'_>,
    joint_path: &KnotPath,
    knots: Range<usize>,
    pair: &[f64],
) -> bool {
    let (from, to) = pair.split_at(generator.width());
    let within_limits = || {
        let allowance = joint_path.allowance[knots.end];
        (generator.bounds).allows_scaled(allowance, generator.knots, knots.end, from, to)
    };
    let short = generator.bounds.max_relative_step(from, to) <= knots.len() as f64 + 1e-9;
    short && (knots.len() > 1 || within_limits())
}
