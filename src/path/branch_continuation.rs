//! Continuation of the configurations of one station to a neighbouring station.
//!
//! Each configuration starts with its last motion, which passes straight through points where branches meet. If that
//! fails, it starts at rest. If a long step fails too, it is followed in small parts along the path.

use super::knots::STATION_SPACING;
use super::layers::{Layer, LayerGenerator};
use super::linear_segment::interpolate;
use super::neighbour_index::NeighbourIndex;
use crate::arm::{Arm, Ends, QueryError};
use crate::spatial::Placement;

/// Fraction of the last motion added to the start of a step.
const MOMENTUM: f64 = 0.9;
/// Number of collision-free configurations by the sphere check below which the exact shapes are checked too.
pub(super) const MIN_FREE_COUNT: usize = 8;
/// Subdivisions of a part in which a joint moves far, as it does near points where branches meet.
pub(super) const PART_SUBDIVISIONS: usize = 20;
/// Maximum number of parts of a step.
pub(super) const MAX_PARTS: f64 = 10_000.0;

/// Scratch memory of the continuation.
#[derive(Debug, Default)]
pub(super) struct BranchContinuation {
    /// Range of the last continued configurations, with their motions.
    moving: std::ops::Range<usize>,
    motions: Vec<f64>,
    origins: Vec<f64>,
    starts: Vec<f64>,
    ends: Ends,
    retry_ends: Ends,
    limits: Vec<f64>,
    /// For each configuration: `None` if it failed, else whether it was followed in parts.
    continued: Vec<Option<bool>>,
    free: Vec<bool>,
    failed: Vec<usize>,
    /// Index of the configurations known at the next station.
    known: NeighbourIndex,
    end: Vec<f32>,
}

impl BranchContinuation {
    /// Discards the stored motions.
    pub(super) fn reset(&mut self) {
        self.motions.clear();
        self.moving = 0..0;
    }

    /// Continues the configurations of station `from`, starting with index `first`, to the neighbouring station `to`.
    ///
    /// Appends the results to the layer of `to`.
    pub(super) fn continue_layer(
        &mut self,
        generator: &LayerGenerator<'_>,
        layers: &mut [Layer],
        (from, to): (usize, usize),
        first: usize,
    ) -> Result<(), QueryError> {
        let n = generator.width();
        let max_count = match to > from {
            // A quarter is reserved for configurations continued backwards.
            true => generator.max_configurations - generator.max_configurations / 4,
            false => generator.max_configurations,
        };
        let q = layers[from].q.get(first * n..).unwrap_or(&[]);
        let count = q.len() / n;
        let relative = |index: usize| index.saturating_sub(first).min(count);
        let moving = relative(self.moving.start)..relative(self.moving.end);
        self.follow(generator, q, (from, to), moving)?;
        self.motions.clear();
        let first_new = layers[to].count(n);
        let (known, queries) = (&layers[to].q, &layers[from].q);
        self.known.build(
            known,
            queries,
            &generator.merge_distances,
            &generator.revolutions,
        );
        layers[to]
            .q
            .reserve(if first_new == 0 { self.ends.q.len() } else { 0 });
        for index in 0..self.continued.len() {
            let Some(in_parts) = self.continued[index] else {
                continue;
            };
            let q = &self.ends.q[index * n..(index + 1) * n];
            self.end.clear();
            self.end.extend(q.iter().map(|q| *q as f32));
            let known = generator.find_indexed(&layers[to], &self.known, &self.end);
            let to_index = match known {
                Some(to_index) => to_index,
                None if layers[to].count(n) < max_count => {
                    layers[to].push_folded(q, &generator.revolutions);
                    let to_index = layers[to].count(n) - 1;
                    self.known.insert(&layers[to].q[to_index * n..], to_index);
                    let origin = &self.origins[index * n..(index + 1) * n];
                    let motion = q.iter().zip(origin).map(|(a, b)| a - b);
                    self.motions.extend(motion);
                    to_index
                }
                None => {
                    layers[to].full = true;
                    continue;
                }
            };
            if in_parts || known.is_some() {
                match to > from {
                    true => layers[to].link(to_index, first + index),
                    false => layers[from].link(first + index, to_index),
                }
            }
        }
        self.moving = first_new..layers[to].count(n);
        Ok(())
    }

    /// Continues each configuration to the next station, into `ends` and `continued`. Those in `moving` start with
    /// their motion.
    fn follow(
        &mut self,
        generator: &LayerGenerator<'_>,
        from: &[f32],
        (station_from, station_to): (usize, usize),
        moving: std::ops::Range<usize>,
    ) -> Result<(), QueryError> {
        let (knots, n) = (generator.knots, generator.width());
        let ends = [knots.stations[station_from], knots.stations[station_to]];
        let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let arm = generator.arms.arm(knots.tool(ends[1]));
        self.origins.clear();
        self.origins.extend(from.iter().map(|q| f64::from(*q)));
        self.continued.clear();
        self.continued.resize(from.len() / n, None);
        if from.is_empty() {
            return Ok(());
        }
        generator.bounds.write(knots, low, high, &mut self.limits);
        self.starts.clear();
        self.starts.extend_from_slice(&self.origins);
        let starts = self.starts[moving.start * n..].iter_mut();
        for (q, delta) in starts.zip(&self.motions) {
            *q += MOMENTUM * delta;
        }
        let target = knots.targets[ends[1]];
        arm.carry_all(&target, &self.starts, &mut self.ends)?;
        self.accept_reached(n, false);
        self.failed.clear();
        let failed = moving.filter(|index| self.continued[*index].is_none());
        self.failed.extend(failed);
        if !self.failed.is_empty() {
            self.restart_failed(n);
            arm.carry_all(&target, &self.starts, &mut self.retry_ends)?;
            self.store_retries(n);
            self.accept_reached(n, false);
        }
        let length = knots.arc_lengths[high] - knots.arc_lengths[low];
        if high == low + 1 && length > STATION_SPACING && knots.has_segment_to(high) {
            self.failed.clear();
            let failed = (0..self.continued.len()).filter(|index| self.continued[*index].is_none());
            self.failed.extend(failed);
            self.follow_in_parts(generator, ends, length)?;
        }
        generator.mark_free(ends[1], &self.ends.q, false, &mut self.free)?;
        let both = self.continued.iter().zip(&self.free);
        let free_count = both
            .filter(|(continued, free)| continued.is_some() && **free)
            .count();
        if free_count < MIN_FREE_COUNT {
            // The spheres of the fast check enclose the shapes.
            generator.mark_free(ends[1], &self.ends.q, true, &mut self.free)?;
        }
        for (continued, free) in self.continued.iter_mut().zip(&self.free) {
            *continued = continued.filter(|_| *free);
        }
        Ok(())
    }

    /// Accepts results that reach the target within the joint limits of the step.
    fn accept_reached(&mut self, n: usize, in_parts: bool) {
        for (index, outcome) in self.ends.outcomes.iter().enumerate() {
            if self.continued[index].is_some() || !outcome.reached {
                continue;
            }
            let range = index * n..(index + 1) * n;
            let moves = self.ends.q[range.clone()].iter().zip(&self.origins[range]);
            let mut moves = moves.zip(&self.limits);
            if moves.all(|((a, b), limit)| (a - b).abs() <= *limit) {
                self.continued[index] = Some(in_parts);
            }
        }
    }

    /// Restarts the failed configurations without motion.
    fn restart_failed(&mut self, n: usize) {
        self.starts.clear();
        for &index in &self.failed {
            let origin = &self.origins[index * n..(index + 1) * n];
            self.starts.extend_from_slice(origin);
        }
    }

    fn store_retries(&mut self, n: usize) {
        let ends = self
            .retry_ends
            .q
            .chunks_exact(n)
            .zip(&self.retry_ends.outcomes);
        for ((q, outcome), &index) in ends.zip(&self.failed) {
            self.ends.q[index * n..(index + 1) * n].copy_from_slice(q);
            self.ends.outcomes[index] = *outcome;
        }
    }

    /// Follows the failed configurations in parts of a long step. Parts with a long joint move are subdivided.
    fn follow_in_parts(
        &mut self,
        generator: &LayerGenerator<'_>,
        ends: [usize; 2],
        length: f64,
    ) -> Result<(), QueryError> {
        let (knots, n) = (generator.knots, generator.width());
        let arm = generator.arms.arm(knots.tool(ends[1]));
        let parts = (length / STATION_SPACING).ceil().min(MAX_PARTS) as usize;
        let [from, to] = ends.map(|end| knots.targets[end]);
        let count = parts * PART_SUBDIVISIONS;
        let target = |step: usize| match step < count {
            true => interpolate(&from, &to, step as f64 / count as f64),
            false => to,
        };
        let mut followed = Followed::default();
        for &index in &self.failed {
            followed.add(index, &self.origins[index * n..(index + 1) * n]);
        }
        for begin in (0..count).step_by(PART_SUBDIVISIONS) {
            if followed.indices.is_empty() {
                break;
            }
            let end = begin + PART_SUBDIVISIONS;
            let mut lost = followed.advance(generator, arm, &target(end), &mut self.retry_ends)?;
            for step in begin + 1..=end {
                if lost.indices.is_empty() {
                    break;
                }
                lost.advance(generator, arm, &target(step), &mut self.retry_ends)?;
            }
            followed.append(lost);
        }
        for (&index, q) in followed.indices.iter().zip(followed.q.chunks_exact(n)) {
            self.ends.q[index * n..(index + 1) * n].copy_from_slice(q);
            self.continued[index] = Some(true);
        }
        Ok(())
    }
}

/// Configurations followed in parts of a step: their indices at its start, and their current values.
#[derive(Debug, Default)]
struct Followed {
    indices: Vec<usize>,
    q: Vec<f64>,
}

impl Followed {
    fn add(&mut self, index: usize, q: &[f64]) {
        self.indices.push(index);
        self.q.extend_from_slice(q);
    }

    fn append(&mut self, mut others: Self) {
        self.indices.append(&mut others.indices);
        self.q.append(&mut others.q);
    }

    /// Advances the configurations that reach the target. Returns those with a too long joint move, unchanged.
    fn advance(
        &mut self,
        generator: &LayerGenerator<'_>,
        arm: &Arm,
        target: &Placement<f64>,
        ends: &mut Ends,
    ) -> Result<Self, QueryError> {
        let n = generator.width();
        arm.carry_all(target, &self.q, ends)?;
        let Self { indices, q } = std::mem::take(self);
        let mut lost = Self::default();
        let steps = q.chunks_exact(n).zip(ends.q.chunks_exact(n));
        let ends = indices.into_iter().zip(steps).zip(&ends.outcomes);
        for ((index, (from, to)), _) in ends.filter(|(_, outcome)| outcome.reached) {
            match generator.bounds.allows_part(from.iter().zip(to)) {
                true => self.add(index, to),
                false => lost.add(index, from),
            }
        }
        Ok(lost)
    }
}
