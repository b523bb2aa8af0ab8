//! Shortest path through the layers with the fewest reconfigurations.
//!
//! Dynamic programming over implicit edges. Two configurations of neighbouring stations are connected if no joint moves
//! further than allowed. All other pairs are connected by a reconfiguration.

use super::layers::{Growth, Layer};
use super::neighbour_index::Sorted;
use super::winding::Turns;

/// Cost of a path to a configuration: number of reconfigurations, then length.
type Cost = (u32, f64);
const NEVER: Cost = (u32::MAX, f64::INFINITY);

/// Selected configurations, one per station, with their cost.
#[derive(Clone, Debug)]
pub(super) struct Chosen {
    pub(super) places: Vec<u32>,
    /// For each station, whether the step to it is no reconfiguration.
    pub(super) joined: Vec<bool>,
    pub(super) cost: Cost,
}

impl Chosen {
    fn none(stations: usize) -> Self {
        Self {
            places: vec![0; stations],
            joined: vec![true; stations],
            cost: NEVER,
        }
    }
}

/// Allowed configurations of the first and the last station; `None` allows all.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Between {
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

/// Returns the path with the fewest reconfigurations. `weights` weigh the joints. Pairs in `apart` are not connected.
pub(super) fn fewest_reconfigurations(
    growth: &Growth<'_>,
    layers: &[Layer],
    weights: &[f64],
    between: Between,
    apart: &[FalseEdge],
) -> Chosen {
    // Most paths need none, and edges with reconfigurations are all pairs.
    without_reconfiguration(growth, layers, weights, between, apart).unwrap_or_else(|| {
        let chosen = best(growth, layers, weights, between, apart, true);
        chosen.unwrap_or_else(|| Chosen::none(layers.len()))
    })
}

/// Returns the shortest path without reconfigurations, if there is one.
pub(super) fn without_reconfiguration(
    growth: &Growth<'_>,
    layers: &[Layer],
    weights: &[f64],
    between: Between,
    apart: &[FalseEdge],
) -> Option<Chosen> {
    best(growth, layers, weights, between, apart, false)
}

/// Returns the best path, or `None` if it needs a reconfiguration and `may_leave` is false.
fn best(
    growth: &Growth<'_>,
    layers: &[Layer],
    weights: &[f64],
    between: Between,
    apart: &[FalseEdge],
    may_leave: bool,
) -> Option<Chosen> {
    let n = weights.len();
    let weights: Vec<f32> = weights.iter().map(|weight| *weight as f32).collect();
    let counts = |at: usize| layers[at].count(n);
    let mut costs: Vec<Cost> = vec![(0, 0.0); counts(0)];
    keep_only(between.first, &mut costs);
    let mut from: Vec<Vec<u16>> = Vec::with_capacity(layers.len());
    from.push(Vec::new());
    let mut limits = Vec::new();
    let mut sorted = Sorted::default();
    let mut padded = Vec::new();
    for to in 1..layers.len() {
        let stations = &growth.knots.stations;
        let knots = (stations[to - 1], stations[to]);
        growth
            .bounds
            .write(growth.knots, knots.0, knots.1, &mut limits);
        let limits: Vec<f32> = limits
            .iter()
            .map(|limit| *limit as f32 * 1.000_01)
            .collect();
        let in_time = growth.bounds.in_time(growth.knots, knots.0, knots.1);
        let in_time = in_time.into_iter().flatten();
        let in_time: Vec<f32> = in_time.map(|most| most as f32 * 1.000_01).collect();
        let apart: Vec<FalseEdge> = (apart.iter())
            .filter(|edge| edge.station == to)
            .copied()
            .collect();
        let from_layer = &layers[to - 1].q;
        sorted.take(from_layer, &layers[to].q, &limits, &growth.turns);
        padded.clear();
        if n <= PADDED {
            padded.extend(from_layer.chunks_exact(n).map(|row| pad(row, 0.0)));
        }
        let step = Step {
            layer: &layers[to],
            apart: &apart,
            from: from_layer,
            padded: &padded,
            padded_limits: pad(&limits, f32::INFINITY),
            costs: &costs,
            limits: &limits,
            in_time: &in_time,
            weights: &weights,
            turns: &growth.turns,
            turns_left_out: growth.turns.are_left_out(),
            sorted: &sorted,
            cheapest: if may_leave {
                cheapest(&costs)
            } else {
                Vec::new()
            },
        };
        // Most configurations continue in order, so the index after the last predecessor is a good guess.
        let mut guess = 0;
        let ends = layers[to].q.chunks_exact(n).enumerate();
        let ends = ends.map(|(place, q)| {
            let (cost, before) = step.best_to(place, q, guess);
            guess = usize::from(before & !JUMPED) + 1;
            (cost, before)
        });
        let (next, places): (Vec<Cost>, Vec<u16>) = ends.unzip();
        costs = next;
        if to + 1 == layers.len() {
            keep_only(between.last, &mut costs);
        }
        if !may_leave && costs.iter().all(|cost| *cost == NEVER) {
            return None;
        }
        from.push(places);
    }
    let last = match between.last {
        Some(last) => last,
        None => {
            let places = 0..costs.len();
            let best = places.min_by(|a, b| order(&costs[*a], &costs[*b]));
            best.unwrap_or(0)
        }
    };
    let mut chosen = Chosen::none(layers.len());
    chosen.cost = costs.get(last).copied().unwrap_or(NEVER);
    let mut place = last;
    for at in (0..layers.len()).rev() {
        chosen.places[at] = place as u32;
        if let Some(&before) = from[at].get(place) {
            place = usize::from(before & !JUMPED);
            chosen.joined[at] = before & JUMPED == 0;
        }
    }
    Some(chosen)
}

/// Number of joints of a padded row, for SIMD comparison.
const PADDED: usize = 8;

/// Returns a row padded with `filler`.
fn pad(row: &[f32], filler: f32) -> [f32; PADDED] {
    let mut padded = [filler; PADDED];
    for (padded, value) in padded.iter_mut().zip(row) {
        *padded = *value;
    }
    padded
}

/// Excludes all configurations but the given one, if there is one.
fn keep_only(given: Option<usize>, costs: &mut [Cost]) {
    let others = costs.iter_mut().enumerate();
    for (_, cost) in others.filter(|(place, _)| given.is_some_and(|given| given != *place)) {
        *cost = NEVER;
    }
}

/// Bit set in a predecessor index if the step is a reconfiguration.
const JUMPED: u16 = 1 << 15;

/// One step between stations.
struct Step<'a> {
    layer: &'a Layer,
    apart: &'a [FalseEdge],
    from: &'a [f32],
    /// Padded rows of `from` and padded limits; `padded` is empty if the arm has more joints.
    padded: &'a [[f32; PADDED]],
    padded_limits: [f32; PADDED],
    costs: &'a [Cost],
    limits: &'a [f32],
    /// Joint displacement limits from the path's times alone; empty if times do not count.
    in_time: &'a [f32],
    weights: &'a [f32],
    turns: &'a Turns,
    turns_left_out: bool,
    sorted: &'a Sorted,
    /// Predecessors with the fewest reconfigurations, sorted by length.
    cheapest: Vec<usize>,
}

/// Returns the configurations with the fewest reconfigurations, sorted by length.
fn cheapest(costs: &[Cost]) -> Vec<usize> {
    let least = costs.iter().map(|cost| cost.0).min().unwrap_or(0);
    let mut cheapest: Vec<usize> = (0..costs.len())
        .filter(|place| costs[*place].0 == least)
        .collect();
    cheapest.sort_by(|a, b| costs[*a].1.total_cmp(&costs[*b].1));
    cheapest
}

impl Step<'_> {
    /// Returns the cost of the best path to a configuration, and its predecessor. `guess` is tried first.
    fn best_to(&self, own: usize, q: &[f32], guess: usize) -> (Cost, u16) {
        let mut best = (NEVER, 0);
        let link = self.layer.linked_to(own);
        if let Some(place) = link.filter(|place| self.is_in_time(*place, q)) {
            self.consider(&mut best, (place, own), q, true);
        }
        let padded = pad(q, 0.0);
        let mut step_from = |place: usize| {
            if self.is_near(place, q, &padded) && is_less(&self.costs[place], &best.0) {
                self.consider(&mut best, (place, own), q, true);
            }
        };
        if guess < self.costs.len() {
            step_from(guess);
        }
        self.sorted.each_near(q, self.limits, step_from);
        self.leave_for(&mut best, own, q);
        best
    }

    /// Considers reconfigurations from the predecessors with the fewest of them. Any other predecessor costs one more.
    fn leave_for(&self, best: &mut (Cost, u16), own: usize, q: &[f32]) {
        for &place in &self.cheapest {
            let cost = self.costs[place];
            let left = (cost.0.saturating_add(1), cost.1);
            // The remaining predecessors are longer.
            if !is_less(&left, &best.0) {
                break;
            }
            self.consider(best, (place, own), q, false);
        }
    }

    /// Takes a step if it is better than the best known.
    fn consider(
        &self,
        best: &mut (Cost, u16),
        (place, own): (usize, usize),
        q: &[f32],
        joined: bool,
    ) {
        let cost = self.costs[place];
        if cost == NEVER || joined && self.are_apart(place, own) {
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
        let most = match reconfigurations < best.0.0 {
            true => f32::INFINITY,
            false => (best.0.1 - cost.1) as f32 * 1.001,
        };
        let Some(length) = self.length_within(self.row(place), q, most) else {
            return;
        };
        let length = cost.1 + f64::from(length);
        if reconfigurations < best.0.0 || length < best.0.1 {
            let jumped = if joined { 0 } else { JUMPED };
            *best = ((reconfigurations, length), place as u16 | jumped);
        }
    }

    fn row(&self, place: usize) -> &[f32] {
        let n = self.weights.len();
        &self.from[place * n..(place + 1) * n]
    }

    fn are_apart(&self, from: usize, to: usize) -> bool {
        let same = |edge: &FalseEdge| edge.from as usize == from && edge.to as usize == to;
        self.apart.iter().any(same)
    }

    /// Returns whether a step that was followed in parts respects the velocity limits.
    fn is_in_time(&self, place: usize, q: &[f32]) -> bool {
        let moves = self.row(place).iter().zip(q).enumerate();
        let mut moves = moves.zip(self.in_time);
        moves.all(|((joint, (a, b)), most)| self.turns.difference(joint, *a, *b).abs() <= *most)
    }

    /// Returns whether a step is short enough to be on one branch.
    fn is_near(&self, place: usize, q: &[f32], padded: &[f32; PADDED]) -> bool {
        if let (false, Some(row)) = (self.turns_left_out, self.padded.get(place)) {
            // Compares all joints at once, without branches.
            let mut near = true;
            for joint in 0..PADDED {
                near &= (row[joint] - padded[joint]).abs() <= self.padded_limits[joint];
            }
            return near;
        }
        let moves = self.row(place).iter().zip(q).zip(self.limits);
        let difference = |joint, from, to| self.turns.difference(joint, from, to).abs();
        (moves.enumerate()).all(|(joint, ((a, b), most))| difference(joint, *b, *a) <= *most)
    }

    /// Returns the length of a step, or `None` if it exceeds `most`.
    fn length_within(&self, a: &[f32], b: &[f32], most: f32) -> Option<f32> {
        let (mut sum, most) = (0.0, most * most);
        for (joint, ((a, b), weight)) in a.iter().zip(b).zip(self.weights).enumerate() {
            let by = match self.turns_left_out {
                false => weight * (a - b),
                true => weight * self.turns.difference(joint, *b, *a),
            };
            sum += by * by;
            if sum > most {
                return None;
            }
        }
        Some(sum.sqrt())
    }
}

/// Returns whether one cost is less. Costs are never NaN.
fn is_less(a: &Cost, b: &Cost) -> bool {
    a.0 < b.0 || a.0 == b.0 && a.1 < b.1
}

fn order(a: &Cost, b: &Cost) -> std::cmp::Ordering {
    a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
}
