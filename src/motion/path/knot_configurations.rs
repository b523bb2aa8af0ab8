//! Configurations of all knots, from those selected at stations.

use super::PathError;
use super::graph::{Chosen, FalseEdge};
use super::layers::{Growth, LAST_ATTEMPTS, Layer};
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
        let mut way = Self {
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
            way.joined.push(joined.iter().all(|joined| *joined));
            let [from, to] = [step[0], step[1]].map(|knot| self.row(knot, n));
            way.allowance.push(bounds.allowance(from, to));
        }
        way
    }
}

/// Returns the joint path through the selected configurations.
pub(super) fn fill(
    growth: &Growth<'_>,
    layers: &[Layer],
    chosen: &Chosen,
) -> Result<KnotPath, PathError> {
    let (knots, n) = (growth.knots, growth.middle.len());
    let mut way = KnotPath {
        q: guess(growth, layers, chosen),
        joined: vec![true; knots.len()],
        allowance: vec![1.0; knots.len()],
        reached: vec![true; knots.len()],
    };
    for (station, joined) in chosen.joined.iter().enumerate() {
        way.joined[knots.stations[station]] = *joined;
    }
    let mut ends = Ends::default();
    let tool = |knot: usize| knots.tool(knot);
    growth
        .arms
        .continue_all(tool, &knots.targets, &way.q, &mut ends)?;
    for (knot, outcome) in ends.outcomes.iter().enumerate() {
        way.reached[knot] = outcome.reached;
        // An unreached knot keeps the interpolated configuration, or that of its station.
        if outcome.reached {
            let end = &ends.q[knot * n..(knot + 1) * n];
            way.q[knot * n..(knot + 1) * n].copy_from_slice(end);
        }
    }
    keep_ends(growth, &mut way);
    for (station, layer) in layers.iter().enumerate().skip(1) {
        let knot = knots.stations[station];
        let alone = knot == knots.stations[station - 1] + 1;
        let (place, before) = (chosen.places[station], chosen.places[station - 1]);
        if alone && layer.linked_to(place as usize) == Some(before as usize) {
            let (from, to) = (way.row(knot - 1, n), way.row(knot, n));
            way.allowance[knot] = growth.bounds.allowance(from, to);
        }
    }
    mend(growth, &mut way)?;
    mend_misses(growth, &mut way)?;
    stay_on_branch(growth, &mut way)?;
    Ok(way)
}

/// Interpolates linearly between connected stations. Before a reconfiguration, the configuration stays constant.
fn guess(growth: &Growth<'_>, layers: &[Layer], chosen: &Chosen) -> Vec<f64> {
    let (knots, n) = (growth.knots, growth.middle.len());
    let at = |station: usize| {
        let place = chosen.places[station] as usize;
        &layers[station].q[place * n..(place + 1) * n]
    };
    let mut q = Vec::with_capacity(knots.len() * n);
    q.extend(at(0).iter().map(|q| f64::from(*q)));
    for (station, ends) in knots.stations.windows(2).enumerate() {
        let (from, to) = (at(station), at(station + 1));
        let length = knots.way[ends[1]] - knots.way[ends[0]];
        for knot in ends[0] + 1..=ends[1] {
            let share = match (chosen.joined[station + 1], length > 0.0) {
                _ if knot == ends[1] => 1.0,
                (true, true) => (knots.way[knot] - knots.way[ends[0]]) / length,
                _ => 0.0,
            };
            let moves = from.iter().zip(to);
            q.extend(moves.map(|(a, b)| {
                let (a, b) = (f64::from(*a), f64::from(*b));
                a + share * (b - a)
            }));
        }
    }
    let limits: Vec<_> = growth.arms.own().limits().collect();
    for row in q.chunks_exact_mut(n) {
        for (value, limits) in row.iter_mut().zip(&limits) {
            *value = limits.clamp(*value);
        }
    }
    q
}

/// Restores the given ends. The ends of a cyclic path stay fixed until it is shortened.
fn keep_ends(growth: &Growth<'_>, way: &mut KnotPath) {
    let n = growth.middle.len();
    if let Some(start) = growth.start {
        way.q[..n].copy_from_slice(start);
        way.reached[0] = true;
    }
    if let Some(end) = growth.end {
        let last = way.reached.len() - 1;
        way.q[last * n..].copy_from_slice(end);
        way.reached[last] = true;
    }
}

/// Returns the connected steps between stations whose knots leave a branch.
pub(super) fn false_edges(growth: &Growth<'_>, chosen: &Chosen, way: &KnotPath) -> Vec<FalseEdge> {
    let steps = growth.knots.stations.windows(2).enumerate();
    let breaks = steps.filter(|(before, knots)| {
        let joined = way.joined[knots[0] + 1..=knots[1]]
            .iter()
            .all(|joined| *joined);
        chosen.joined[before + 1] && !joined
    });
    let edge = |before: usize| FalseEdge {
        station: before + 1,
        from: chosen.places[before],
        to: chosen.places[before + 1],
    };
    breaks.map(|(before, _)| edge(before)).collect()
}

/// Marks reconfigurations as joined if shortening has made their step short enough.
pub(super) fn rejoin(growth: &Growth<'_>, way: &mut KnotPath) {
    let n = growth.middle.len();
    for knot in 1..way.reached.len() {
        let reached = way.reached[knot - 1] && way.reached[knot];
        let (from, to) = (way.row(knot - 1, n), way.row(knot, n));
        way.joined[knot] |= reached && growth.bounds.allow(growth.knots, knot, from, to);
    }
}

/// Solves the knots of too long steps again, each from the previous knot.
fn mend(growth: &Growth<'_>, way: &mut KnotPath) -> Result<(), PathError> {
    let (knots, n) = (growth.knots, growth.middle.len());
    let mut ends = Ends::default();
    for knot in 1..knots.len() {
        let (before, after) = way.q.split_at_mut(knot * n);
        let (from, to) = (&before[(knot - 1) * n..], &mut after[..n]);
        let allowance = way.allowance[knot];
        let allowed = (growth.bounds).allow_times(allowance, knots, knot, from, to);
        if allowed && way.reached[knot] {
            way.joined[knot] = true;
            continue;
        }
        let fixed = knot + 1 == knots.len() && growth.end.is_some();
        if !fixed {
            let arm = growth.arms.of(knots.tool(knot));
            let target = std::slice::from_ref(&knots.targets[knot]);
            arm.continue_all(target, from, &mut ends)?;
            let reached = ends.outcomes.first().is_some_and(|outcome| outcome.reached);
            let follows = growth.bounds.allow(knots, knot, from, &ends.q);
            // A reconfiguration moves to the station, but not to an earlier knot.
            let leaves = !way.joined[knot] && knots.stations.binary_search(&knot).is_ok();
            if reached && !leaves && (follows || !way.reached[knot]) {
                to.copy_from_slice(&ends.q);
                way.reached[knot] = true;
            }
        }
        way.joined[knot] = (growth.bounds).allow_times(allowance, knots, knot, from, to);
    }
    Ok(())
}

/// Solves unreached knots from the next knot, then from the previous one, because a branch may begin before its
/// station.
///
/// The search stays on the branch if possible.
fn mend_misses(growth: &Growth<'_>, way: &mut KnotPath) -> Result<(), PathError> {
    let last = growth.knots.len().saturating_sub(1);
    for next in (1..=last).rev() {
        reach_from(growth, way, (next, next - 1))?;
    }
    for before in 0..last {
        reach_from(growth, way, (before, before + 1))?;
    }
    Ok(())
}

/// Solves an unreached knot from a reached neighbour.
fn reach_from(
    growth: &Growth<'_>,
    way: &mut KnotPath,
    (from, knot): (usize, usize),
) -> Result<(), PathError> {
    if way.reached[knot] || !way.reached[from] {
        return Ok(());
    }
    let (knots, n) = (growth.knots, growth.middle.len());
    let (arm, target) = (growth.arms.of(knots.tool(knot)), &knots.targets[knot]);
    let mut ends = Ends::default();
    let start = way.row(from, n);
    arm.continue_all(std::slice::from_ref(target), start, &mut ends)?;
    if !ends.outcomes.iter().any(|outcome| outcome.reached) && arm.falls_short(target).is_none() {
        arm.attempt_several(target, start, 1, LAST_ATTEMPTS, &mut ends)?;
    }
    let move_to = |q: &[f64]| -> f64 {
        let moves = q.iter().zip(start).zip(arm.scales());
        moves
            .map(|((a, b), scale)| ((a - b) * scale).abs())
            .fold(0.0, f64::max)
    };
    let found = ends.q.chunks_exact(n).zip(&ends.outcomes);
    let found = found.filter(|(_, outcome)| outcome.reached);
    let nearest = found.min_by(|(a, _), (b, _)| move_to(a).total_cmp(&move_to(b)));
    let Some((q, _)) = nearest else {
        return Ok(());
    };
    way.q[knot * n..(knot + 1) * n].copy_from_slice(q);
    way.reached[knot] = true;
    note_joined(growth, way, knot);
    Ok(())
}

/// Updates whether the steps to and from a knot are short enough.
fn note_joined(growth: &Growth<'_>, way: &mut KnotPath, knot: usize) {
    let (knots, n) = (growth.knots, growth.middle.len());
    for to in [knot, knot + 1] {
        if to > 0 && to < knots.len() {
            let (from, there) = (way.row(to - 1, n), way.row(to, n));
            let allowance = way.allowance[to];
            way.joined[to] = (growth.bounds).allow_times(allowance, knots, to, from, there);
        }
    }
}

/// Keeps one reconfiguration, the last, per run of unreached knots.
///
/// Each unreached knot before it is as near to its target as its branch allows without a jump, or stays constant.
fn stay_on_branch(growth: &Growth<'_>, way: &mut KnotPath) -> Result<(), PathError> {
    let (knots, n) = (growth.knots, growth.middle.len());
    let mut ends = Ends::default();
    let mut first = 1;
    while first < knots.len() {
        if way.reached[first] {
            first += 1;
            continue;
        }
        let misses = way.reached[first..].iter().take_while(|reached| !**reached);
        let after = first + misses.count();
        let leaps = (first..=after.min(knots.len() - 1)).filter(|knot| !way.joined[*knot]);
        let leaps: Vec<usize> = leaps.collect();
        if let [from, .., last] = leaps[..] {
            for knot in from..last {
                let arm = growth.arms.of(knots.tool(knot));
                let (before, own) = way.q.split_at_mut(knot * n);
                let (from, to) = (&before[(knot - 1) * n..], &mut own[..n]);
                if growth.bounds.allow(knots, knot, from, to) {
                    continue;
                }
                let target = std::slice::from_ref(&knots.targets[knot]);
                arm.continue_all(target, from, &mut ends)?;
                let follows = growth.bounds.allow(knots, knot, from, &ends.q);
                to.copy_from_slice(if follows { &ends.q } else { from });
                note_joined(growth, way, knot);
            }
        }
        first = after;
    }
    Ok(())
}
