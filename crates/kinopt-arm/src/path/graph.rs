//! Shortest path through the layers with the fewest reconfigurations.
//!
//! Dynamic programming over implicit edges. Two configurations of neighbouring stations are connected if no joint moves
//! further than allowed. All other pairs are connected by a reconfiguration.

use super::layers::{Layer, LayerGenerator};
use super::neighbour_index::NeighbourIndex;
use super::revolutions::Revolutions;

/// Cost of a path to a configuration: number of reconfigurations, then length.
type PathCost = (u32, f64);
const UNREACHABLE_COST: PathCost = (u32::MAX, f64::INFINITY);

/// Selected configurations, one per station, with their cost.
#[derive(Clone, Debug)]
pub(super) struct Selection {
    pub(super) indices: Vec<u32>,
    /// For each station, whether the step to it is no reconfiguration.
    pub(super) joined: Vec<bool>,
    pub(super) cost: PathCost,
}

impl Selection {
    fn none(stations: usize) -> Self {
        Self {
            indices: vec![0; stations],
            joined: vec![true; stations],
            cost: UNREACHABLE_COST,
        }
    }
}

/// Allowed configurations of the first and the last station; `None` allows all.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EndIndices {
    pub(super) first: Option<usize>,
    pub(super) last: Option<usize>,
}

/// Pair of configurations, by index, that are near each other but on different branches: at a station and the one
/// before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FalseEdge {
    pub(super) station: usize,
    pub(super) from: u32,
    pub(super) to: u32,
}

/// Returns the path with the fewest reconfigurations. `weights` weigh the joints. Pairs in `excluded_edges` are not
/// connected.
pub(super) fn fewest_reconfigurations(
    generator: &LayerGenerator<'_>,
    layers: &[Layer],
    weights: &[f64],
    end_indices: EndIndices,
    excluded_edges: &[FalseEdge],
) -> Selection {
    // Most paths need none, and edges with reconfigurations are all pairs.
    without_reconfiguration(generator, layers, weights, end_indices, excluded_edges).unwrap_or_else(
        || {
            let selection = best(
                generator,
                layers,
                weights,
                end_indices,
                excluded_edges,
                true,
            );
            selection.unwrap_or_else(|| Selection::none(layers.len()))
        },
    )
}

/// Returns the shortest path without reconfigurations, if there is one.
pub(super) fn without_reconfiguration(
    generator: &LayerGenerator<'_>,
    layers: &[Layer],
    weights: &[f64],
    end_indices: EndIndices,
    excluded_edges: &[FalseEdge],
) -> Option<Selection> {
    best(
        generator,
        layers,
        weights,
        end_indices,
        excluded_edges,
        false,
    )
}

/// Returns the best path, or `None` if it needs a reconfiguration and `may_reconfigure` is false.
fn best(
    generator: &LayerGenerator<'_>,
    layers: &[Layer],
    weights: &[f64],
    end_indices: EndIndices,
    excluded_edges: &[FalseEdge],
    may_reconfigure: bool,
) -> Option<Selection> {
    let n = weights.len();
    let weights: Vec<f32> = weights.iter().map(|weight| *weight as f32).collect();
    let counts = |station: usize| layers[station].count(n);
    let mut costs: Vec<PathCost> = vec![(0, 0.0); counts(0)];
    keep_only(end_indices.first, &mut costs);
    let mut predecessors: Vec<Vec<u16>> = Vec::with_capacity(layers.len());
    predecessors.push(Vec::new());
    let mut limits = Vec::new();
    let mut neighbours = NeighbourIndex::default();
    let mut padded = Vec::new();
    for to in 1..layers.len() {
        let stations = &generator.knots.stations;
        let knots = (stations[to - 1], stations[to]);
        generator
            .bounds
            .write(generator.knots, knots.0, knots.1, &mut limits);
        let limits: Vec<f32> = limits
            .iter()
            .map(|limit| *limit as f32 * 1.000_01)
            .collect();
        let time_limits = generator
            .bounds
            .time_limits(generator.knots, knots.0, knots.1);
        let time_limits = time_limits.into_iter().flatten();
        let time_limits: Vec<f32> = time_limits.map(|limit| limit as f32 * 1.000_01).collect();
        let excluded_edges: Vec<FalseEdge> = (excluded_edges.iter())
            .filter(|edge| edge.station == to)
            .copied()
            .collect();
        let from_layer = &layers[to - 1].q;
        neighbours.build(from_layer, &layers[to].q, &limits, &generator.revolutions);
        padded.clear();
        if n <= PADDED_JOINTS {
            padded.extend(from_layer.chunks_exact(n).map(|row| pad(row, 0.0)));
        }
        let step = StationStep {
            layer: &layers[to],
            excluded_edges: &excluded_edges,
            from: from_layer,
            padded: &padded,
            padded_limits: pad(&limits, f32::INFINITY),
            costs: &costs,
            limits: &limits,
            time_limits: &time_limits,
            weights: &weights,
            revolutions: &generator.revolutions,
            revolutions_ignored: generator.revolutions.any_ignored(),
            neighbours: &neighbours,
            cheapest: if may_reconfigure {
                cheapest(&costs)
            } else {
                Vec::new()
            },
        };
        // Most configurations continue in order, so the index after the last predecessor is a good guess.
        let mut guess = 0;
        let ends = layers[to].q.chunks_exact(n).enumerate();
        let ends = ends.map(|(index, q)| {
            let (cost, before) = step.best_to(index, q, guess);
            guess = usize::from(before & !RECONFIGURATION_BIT) + 1;
            (cost, before)
        });
        let (next, indices): (Vec<PathCost>, Vec<u16>) = ends.unzip();
        costs = next;
        if to + 1 == layers.len() {
            keep_only(end_indices.last, &mut costs);
        }
        if !may_reconfigure && costs.iter().all(|cost| *cost == UNREACHABLE_COST) {
            return None;
        }
        predecessors.push(indices);
    }
    let last = match end_indices.last {
        Some(last) => last,
        None => {
            let indices = 0..costs.len();
            let best = indices.min_by(|a, b| order(&costs[*a], &costs[*b]));
            best.unwrap_or(0)
        }
    };
    let mut selection = Selection::none(layers.len());
    selection.cost = costs.get(last).copied().unwrap_or(UNREACHABLE_COST);
    let mut index = last;
    for station in (0..layers.len()).rev() {
        selection.indices[station] = index as u32;
        if let Some(&before) = predecessors[station].get(index) {
            index = usize::from(before & !RECONFIGURATION_BIT);
            selection.joined[station] = before & RECONFIGURATION_BIT == 0;
        }
    }
    Some(selection)
}

/// Number of joints of a padded row, for SIMD comparison.
const PADDED_JOINTS: usize = 8;

/// Returns a row padded with `filler`.
fn pad(row: &[f32], filler: f32) -> [f32; PADDED_JOINTS] {
    let mut padded = [filler; PADDED_JOINTS];
    for (padded, value) in padded.iter_mut().zip(row) {
        *padded = *value;
    }
    padded
}

/// Excludes all configurations but the given one, if there is one.
fn keep_only(given: Option<usize>, costs: &mut [PathCost]) {
    let others = costs.iter_mut().enumerate();
    for (_, cost) in others.filter(|(index, _)| given.is_some_and(|given| given != *index)) {
        *cost = UNREACHABLE_COST;
    }
}

/// Bit set in a predecessor index if the step is a reconfiguration.
const RECONFIGURATION_BIT: u16 = 1 << 15;

/// One step between stations.
struct StationStep<'a> {
    layer: &'a Layer,
    excluded_edges: &'a [FalseEdge],
    from: &'a [f32],
    /// Padded rows of `from` and padded limits; `padded` is empty if the arm has more joints.
    padded: &'a [[f32; PADDED_JOINTS]],
    padded_limits: [f32; PADDED_JOINTS],
    costs: &'a [PathCost],
    limits: &'a [f32],
    /// Joint displacement limits from the path's times alone; empty if times do not count.
    time_limits: &'a [f32],
    weights: &'a [f32],
    revolutions: &'a Revolutions,
    revolutions_ignored: bool,
    neighbours: &'a NeighbourIndex,
    /// Predecessors with the fewest reconfigurations, sorted by length.
    cheapest: Vec<usize>,
}

/// Returns the configurations with the fewest reconfigurations, sorted by length.
fn cheapest(costs: &[PathCost]) -> Vec<usize> {
    let min_count = costs.iter().map(|cost| cost.0).min().unwrap_or(0);
    let mut cheapest: Vec<usize> = (0..costs.len())
        .filter(|index| costs[*index].0 == min_count)
        .collect();
    cheapest.sort_by(|a, b| costs[*a].1.total_cmp(&costs[*b].1));
    cheapest
}

impl StationStep<'_> {
    /// Returns the cost of the best path to a configuration, and its predecessor. `guess` is tried first.
    fn best_to(&self, index: usize, q: &[f32], guess: usize) -> (PathCost, u16) {
        let mut best = (UNREACHABLE_COST, 0);
        let link = self.layer.linked_to(index);
        if let Some(predecessor) =
            link.filter(|predecessor| self.is_within_time_limits(*predecessor, q))
        {
            self.consider(&mut best, (predecessor, index), q, true);
        }
        let padded = pad(q, 0.0);
        let mut step_from = |predecessor: usize| {
            if self.is_near(predecessor, q, &padded) && is_less(&self.costs[predecessor], &best.0) {
                self.consider(&mut best, (predecessor, index), q, true);
            }
        };
        if guess < self.costs.len() {
            step_from(guess);
        }
        self.neighbours.for_each_near(q, self.limits, step_from);
        self.consider_reconfigurations(&mut best, index, q);
        best
    }

    /// Considers reconfigurations from the predecessors with the fewest of them. Any other predecessor costs one more.
    fn consider_reconfigurations(&self, best: &mut (PathCost, u16), index: usize, q: &[f32]) {
        for &predecessor in &self.cheapest {
            let cost = self.costs[predecessor];
            let jump_cost = (cost.0.saturating_add(1), cost.1);
            // The remaining predecessors are longer.
            if !is_less(&jump_cost, &best.0) {
                break;
            }
            self.consider(best, (predecessor, index), q, false);
        }
    }

    /// Takes a step if it is better than the best known.
    fn consider(
        &self,
        best: &mut (PathCost, u16),
        (predecessor, index): (usize, usize),
        q: &[f32],
        joined: bool,
    ) {
        let cost = self.costs[predecessor];
        if cost == UNREACHABLE_COST || joined && self.are_apart(predecessor, index) {
            return;
        }
        let reconfigurations = match joined {
            true => cost.0,
            false => cost.0.saturating_add(1),
        };
        // The length is computed only if it can matter, and only up to the best known.
        if !is_less(&(reconfigurations, cost.1), &best.0) {
            return;
        }
        let max_length = match reconfigurations < best.0.0 {
            true => f32::INFINITY,
            false => (best.0.1 - cost.1) as f32 * 1.001,
        };
        let Some(length) = self.length_within(self.row(predecessor), q, max_length) else {
            return;
        };
        let length = cost.1 + f64::from(length);
        if reconfigurations < best.0.0 || length < best.0.1 {
            let reconfiguration_bit = if joined { 0 } else { RECONFIGURATION_BIT };
            *best = (
                (reconfigurations, length),
                predecessor as u16 | reconfiguration_bit,
            );
        }
    }

    fn row(&self, index: usize) -> &[f32] {
        let n = self.weights.len();
        &self.from[index * n..(index + 1) * n]
    }

    fn are_apart(&self, from: usize, to: usize) -> bool {
        let same = |edge: &FalseEdge| edge.from as usize == from && edge.to as usize == to;
        self.excluded_edges.iter().any(same)
    }

    /// Returns whether a step that was followed in parts respects the velocity limits.
    fn is_within_time_limits(&self, predecessor: usize, q: &[f32]) -> bool {
        let moves = self.row(predecessor).iter().zip(q).enumerate();
        let mut moves = moves.zip(self.time_limits);
        moves.all(|((joint, (a, b)), limit)| {
            self.revolutions.difference(joint, *a, *b).abs() <= *limit
        })
    }

    /// Returns whether a step is short enough to be on one branch.
    fn is_near(&self, predecessor: usize, q: &[f32], padded: &[f32; PADDED_JOINTS]) -> bool {
        if let (false, Some(row)) = (self.revolutions_ignored, self.padded.get(predecessor)) {
            // Compares all joints at once, without branches.
            let mut is_near = true;
            for joint in 0..PADDED_JOINTS {
                is_near &= (row[joint] - padded[joint]).abs() <= self.padded_limits[joint];
            }
            return is_near;
        }
        let moves = self.row(predecessor).iter().zip(q).zip(self.limits);
        let difference = |joint, from, to| self.revolutions.difference(joint, from, to).abs();
        (moves.enumerate()).all(|(joint, ((a, b), limit))| difference(joint, *b, *a) <= *limit)
    }

    /// Returns the length of a step, or `None` if it exceeds `max_length`.
    fn length_within(&self, a: &[f32], b: &[f32], max_length: f32) -> Option<f32> {
        let (mut sum, max_length) = (0.0, max_length * max_length);
        for (joint, ((a, b), weight)) in a.iter().zip(b).zip(self.weights).enumerate() {
            let difference = match self.revolutions_ignored {
                false => weight * (a - b),
                true => weight * self.revolutions.difference(joint, *b, *a),
            };
            sum += difference * difference;
            if sum > max_length {
                return None;
            }
        }
        Some(sum.sqrt())
    }
}

/// Returns whether one cost is less. Costs are never NaN.
fn is_less(a: &PathCost, b: &PathCost) -> bool {
    a.0 < b.0 || a.0 == b.0 && a.1 < b.1
}

fn order(a: &PathCost, b: &PathCost) -> std::cmp::Ordering {
    a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
}
