//! Configurations of all knots, from those selected at stations.

use super::PathError;
use super::graph::{FalseEdge, Selection};
use super::layers::{FALLBACK_ATTEMPTS, Layer, LayerGenerator};
use super::step_bounds::StepBounds;
use crate::arm::Ends;

/// Joint path with one configuration per knot.
#[derive(Clone, Debug)]
pub(super) struct KnotPath {
    pub(super) q: Vec<f64>,
    /// For each knot, whether the step to it stays on its branch.
    pub(super) joined: Vec<bool>,
    /// For each knot, the allowed joint displacement of the step to it, relative to the bound. It exceeds 1 if a long
    /// step was followed in parts.
    pub(super) allowance: Vec<f64>,
    /// For each knot, whether its target is reached (and collision-free, as far as checked).
    pub(super) reached: Vec<bool>,
}

impl KnotPath {
    /// Number of unreached targets, and number of reconfigurations. Smaller is better.
    pub(super) fn rank(&self) -> (usize, usize) {
        let count = |flags: &[bool]| flags.iter().filter(|flag| !**flag).count();
        (count(&self.reached), count(&self.joined))
    }

    pub(super) fn row(&self, knot: usize, n: usize) -> &[f64] {
        &self.q[knot * n..(knot + 1) * n]
    }

    /// Returns the joint path through a subset of the knots (ascending, with the first). A step is joined if all steps
    /// between are.
    pub(super) fn through(&self, knots: &[usize], bounds: &StepBounds) -> Self {
        let n = self.q.len() / self.reached.len().max(1);
        let mut joint_path = Self {
            q: knots
                .iter()
                .flat_map(|knot| self.row(*knot, n))
                .copied()
                .collect(),
            joined: vec![true],
            allowance: vec![1.0],
            reached: knots.iter().map(|knot| self.reached[*knot]).collect(),
        };
        for step in knots.windows(2) {
            let joined = &self.joined[step[0] + 1..=step[1]];
            joint_path.joined.push(joined.iter().all(|joined| *joined));
            let [from, to] = [step[0], step[1]].map(|knot| self.row(knot, n));
            joint_path.allowance.push(bounds.allowance(from, to));
        }
        joint_path
    }
}

/// Returns the joint path through the selected configurations.
pub(super) fn fill(
    generator: &LayerGenerator<'_>,
    layers: &[Layer],
    selection: &Selection,
) -> Result<KnotPath, PathError> {
    let (knots, n) = (generator.knots, generator.middle.len());
    let mut joint_path = KnotPath {
        q: initial_guess(generator, layers, selection),
        joined: vec![true; knots.len()],
        allowance: vec![1.0; knots.len()],
        reached: vec![true; knots.len()],
    };
    for (station, joined) in selection.joined.iter().enumerate() {
        joint_path.joined[knots.stations[station]] = *joined;
    }
    let mut ends = Ends::default();
    let tool = |knot: usize| knots.tool(knot);
    generator
        .arms
        .continue_all(tool, &knots.targets, &joint_path.q, &mut ends)?;
    for (knot, outcome) in ends.outcomes.iter().enumerate() {
        joint_path.reached[knot] = outcome.reached;
        // An unreached knot keeps the interpolated configuration, or that of its station.
        if outcome.reached {
            let end = &ends.q[knot * n..(knot + 1) * n];
            joint_path.q[knot * n..(knot + 1) * n].copy_from_slice(end);
        }
    }
    restore_ends(generator, &mut joint_path);
    for (station, layer) in layers.iter().enumerate().skip(1) {
        let knot = knots.stations[station];
        let is_adjacent = knot == knots.stations[station - 1] + 1;
        let (index, before) = (selection.indices[station], selection.indices[station - 1]);
        if is_adjacent && layer.linked_to(index as usize) == Some(before as usize) {
            let (from, to) = (joint_path.row(knot - 1, n), joint_path.row(knot, n));
            joint_path.allowance[knot] = generator.bounds.allowance(from, to);
        }
    }
    repair_steps(generator, &mut joint_path)?;
    repair_unreached(generator, &mut joint_path)?;
    stay_on_branch(generator, &mut joint_path)?;
    Ok(joint_path)
}

/// Interpolates linearly between connected stations. Before a reconfiguration, the configuration stays constant.
fn initial_guess(
    generator: &LayerGenerator<'_>,
    layers: &[Layer],
    selection: &Selection,
) -> Vec<f64> {
    let (knots, n) = (generator.knots, generator.middle.len());
    let station_row = |station: usize| {
        let index = selection.indices[station] as usize;
        &layers[station].q[index * n..(index + 1) * n]
    };
    let mut q = Vec::with_capacity(knots.len() * n);
    q.extend(station_row(0).iter().map(|q| f64::from(*q)));
    for (station, ends) in knots.stations.windows(2).enumerate() {
        let (from, to) = (station_row(station), station_row(station + 1));
        let length = knots.arc_lengths[ends[1]] - knots.arc_lengths[ends[0]];
        for knot in ends[0] + 1..=ends[1] {
            let fraction = match (selection.joined[station + 1], length > 0.0) {
                _ if knot == ends[1] => 1.0,
                (true, true) => (knots.arc_lengths[knot] - knots.arc_lengths[ends[0]]) / length,
                _ => 0.0,
            };
            let moves = from.iter().zip(to);
            q.extend(moves.map(|(a, b)| {
                let (a, b) = (f64::from(*a), f64::from(*b));
                a + fraction * (b - a)
            }));
        }
    }
    let limits: Vec<_> = generator.arms.primary().limits().collect();
    for row in q.chunks_exact_mut(n) {
        for (value, limits) in row.iter_mut().zip(&limits) {
            *value = limits.clamp(*value);
        }
    }
    q
}

/// Restores the given ends. The ends of a cyclic path stay fixed until it is shortened.
fn restore_ends(generator: &LayerGenerator<'_>, joint_path: &mut KnotPath) {
    let n = generator.middle.len();
    if let Some(start) = generator.start {
        joint_path.q[..n].copy_from_slice(start);
        joint_path.reached[0] = true;
    }
    if let Some(end) = generator.end {
        let last = joint_path.reached.len() - 1;
        joint_path.q[last * n..].copy_from_slice(end);
        joint_path.reached[last] = true;
    }
}

/// Returns the connected steps between stations whose knots leave a branch.
pub(super) fn false_edges(
    generator: &LayerGenerator<'_>,
    selection: &Selection,
    joint_path: &KnotPath,
) -> Vec<FalseEdge> {
    let steps = generator.knots.stations.windows(2).enumerate();
    let breaks = steps.filter(|(before, knots)| {
        let joined = joint_path.joined[knots[0] + 1..=knots[1]]
            .iter()
            .all(|joined| *joined);
        selection.joined[before + 1] && !joined
    });
    let edge = |before: usize| FalseEdge {
        station: before + 1,
        from: selection.indices[before],
        to: selection.indices[before + 1],
    };
    breaks.map(|(before, _)| edge(before)).collect()
}

/// Marks reconfigurations as joined if shortening has made their step short enough.
pub(super) fn rejoin(generator: &LayerGenerator<'_>, joint_path: &mut KnotPath) {
    let n = generator.middle.len();
    for knot in 1..joint_path.reached.len() {
        let reached = joint_path.reached[knot - 1] && joint_path.reached[knot];
        let (from, to) = (joint_path.row(knot - 1, n), joint_path.row(knot, n));
        joint_path.joined[knot] |=
            reached && generator.bounds.allows(generator.knots, knot, from, to);
    }
}

/// Solves the knots of too long steps again, each from the previous knot.
fn repair_steps(
    generator: &LayerGenerator<'_>,
    joint_path: &mut KnotPath,
) -> Result<(), PathError> {
    let (knots, n) = (generator.knots, generator.middle.len());
    let mut ends = Ends::default();
    for knot in 1..knots.len() {
        let (before, after) = joint_path.q.split_at_mut(knot * n);
        let (from, to) = (&before[(knot - 1) * n..], &mut after[..n]);
        let allowance = joint_path.allowance[knot];
        let allowed = (generator.bounds).allows_scaled(allowance, knots, knot, from, to);
        if allowed && joint_path.reached[knot] {
            joint_path.joined[knot] = true;
            continue;
        }
        let fixed = knot + 1 == knots.len() && generator.end.is_some();
        if !fixed {
            let arm = generator.arms.arm(knots.tool(knot));
            let target = std::slice::from_ref(&knots.targets[knot]);
            arm.continue_all(target, from, &mut ends)?;
            let reached = ends.outcomes.first().is_some_and(|outcome| outcome.reached);
            let follows = generator.bounds.allows(knots, knot, from, &ends.q);
            // A reconfiguration moves to the station, but not to an earlier knot.
            let leaves = !joint_path.joined[knot] && knots.stations.binary_search(&knot).is_ok();
            if reached && !leaves && (follows || !joint_path.reached[knot]) {
                to.copy_from_slice(&ends.q);
                joint_path.reached[knot] = true;
            }
        }
        joint_path.joined[knot] =
            (generator.bounds).allows_scaled(allowance, knots, knot, from, to);
    }
    Ok(())
}

/// Solves unreached knots from the next knot, then from the previous one, because a branch may begin before its
/// station.
///
/// The search stays on the branch if possible.
fn repair_unreached(
    generator: &LayerGenerator<'_>,
    joint_path: &mut KnotPath,
) -> Result<(), PathError> {
    let last = generator.knots.len().saturating_sub(1);
    for next in (1..=last).rev() {
        reach_from(generator, joint_path, (next, next - 1))?;
    }
    for before in 0..last {
        reach_from(generator, joint_path, (before, before + 1))?;
    }
    Ok(())
}

/// Solves an unreached knot from a reached neighbour.
fn reach_from(
    generator: &LayerGenerator<'_>,
    joint_path: &mut KnotPath,
    (from, knot): (usize, usize),
) -> Result<(), PathError> {
    if joint_path.reached[knot] || !joint_path.reached[from] {
        return Ok(());
    }
    let (knots, n) = (generator.knots, generator.middle.len());
    let (arm, target) = (generator.arms.arm(knots.tool(knot)), &knots.targets[knot]);
    let mut ends = Ends::default();
    let start = joint_path.row(from, n);
    arm.continue_all(std::slice::from_ref(target), start, &mut ends)?;
    if !ends.outcomes.iter().any(|outcome| outcome.reached) && arm.falls_short(target).is_none() {
        arm.attempt_several(target, start, 1, FALLBACK_ATTEMPTS, &mut ends)?;
    }
    let distance_to = |q: &[f64]| -> f64 {
        let moves = q.iter().zip(start).zip(arm.scales());
        moves
            .map(|((a, b), scale)| ((a - b) * scale).abs())
            .fold(0.0, f64::max)
    };
    let results = ends.q.chunks_exact(n).zip(&ends.outcomes);
    let results = results.filter(|(_, outcome)| outcome.reached);
    let nearest = results.min_by(|(a, _), (b, _)| distance_to(a).total_cmp(&distance_to(b)));
    let Some((q, _)) = nearest else {
        return Ok(());
    };
    joint_path.q[knot * n..(knot + 1) * n].copy_from_slice(q);
    joint_path.reached[knot] = true;
    update_joined(generator, joint_path, knot);
    Ok(())
}

/// Updates whether the steps to and from a knot are short enough.
fn update_joined(generator: &LayerGenerator<'_>, joint_path: &mut KnotPath, knot: usize) {
    let (knots, n) = (generator.knots, generator.middle.len());
    for to in [knot, knot + 1] {
        if to > 0 && to < knots.len() {
            let (from, row_to) = (joint_path.row(to - 1, n), joint_path.row(to, n));
            let allowance = joint_path.allowance[to];
            joint_path.joined[to] =
                (generator.bounds).allows_scaled(allowance, knots, to, from, row_to);
        }
    }
}

/// Keeps one reconfiguration, the last, per run of unreached knots.
///
/// Each unreached knot before it is as near to its target as its branch allows without a jump, or stays constant.
fn stay_on_branch(
    generator: &LayerGenerator<'_>,
    joint_path: &mut KnotPath,
) -> Result<(), PathError> {
    let (knots, n) = (generator.knots, generator.middle.len());
    let mut ends = Ends::default();
    let mut first = 1;
    while first < knots.len() {
        if joint_path.reached[first] {
            first += 1;
            continue;
        }
        let unreached = joint_path.reached[first..]
            .iter()
            .take_while(|reached| !**reached);
        let after = first + unreached.count();
        let jumps = (first..=after.min(knots.len() - 1)).filter(|knot| !joint_path.joined[*knot]);
        let jumps: Vec<usize> = jumps.collect();
        if let [from, .., last] = jumps[..] {
            for knot in from..last {
                let arm = generator.arms.arm(knots.tool(knot));
                let (before, rest) = joint_path.q.split_at_mut(knot * n);
                let (from, to) = (&before[(knot - 1) * n..], &mut rest[..n]);
                if generator.bounds.allows(knots, knot, from, to) {
                    continue;
                }
                let target = std::slice::from_ref(&knots.targets[knot]);
                arm.continue_all(target, from, &mut ends)?;
                let follows = generator.bounds.allows(knots, knot, from, &ends.q);
                to.copy_from_slice(if follows { &ends.q } else { from });
                update_joined(generator, joint_path, knot);
            }
        }
        first = after;
    }
    Ok(())
}
