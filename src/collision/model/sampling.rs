//! Which pairs never touch, and which always do.

use std::sync::Arc;

use super::CollisionModel;
use crate::collision::ROUNDING;
use crate::interruption::is_stopped;
use crate::kinematics::{ForwardKinematics, KinematicsError};
use crate::model::{FrameId, ModelError};
use crate::spatial::Placement;

/// A pair that touches in such a share of all samples is made to: as in MoveIt's setup assistant.
const ALWAYS: f64 = 0.95;
/// From so many samples, those where a pair came nearest, it is asked whether it can touch.
const NEAREST: usize = 3;

/// What samples say about a pair.
#[derive(Clone, Debug, Default)]
struct Seen {
    touched: u64,
    /// Of a pair that did not touch: how far it was apart, and in which sample, the nearest first.
    nearest: Vec<(f64, u64)>,
}

impl CollisionModel {
    /// The same model without the pairs that cannot touch, and without those that touch in at least 95 % of `samples` random
    /// configurations, as links beside a shared joint do (Sucan & Chitta, MoveIt's setup assistant). Of a pair that touches in none of them its
    /// distance is made less, within all limits, from the three in which it came nearest: it is left out only where that leads
    /// nowhere to a touch. Loops are not closed in what is sampled. Without samples all pairs stay.
    ///
    /// # Errors
    /// The model's lengths are no numbers.
    pub fn with_pairs_sampled(mut self, samples: u64, seed: u64) -> Result<Self, ModelError> {
        if samples == 0 {
            return Ok(self);
        }
        let shapes: Vec<_> = self.link_shapes().into_iter().map(Arc::new).collect();
        let mut seen = vec![Seen::default(); self.pairs.len()];
        self.visit_samples(samples, seed, |sample, placed| {
            for (pair, seen) in self.pairs.iter().zip(&mut seen) {
                let [a, b] = pair.map(|link| self.place_of(link));
                let found = shapes[a].apart(&placed[a], &shapes[b], &placed[b], seen.asked());
                if let Some(found) = found {
                    seen.take(sample, found.distance);
                }
            }
        })?;
        let always = ALWAYS * samples as f64;
        let mut kept = Vec::new();
        for (pair, seen) in self.pairs.iter().zip(&seen) {
            if is_stopped() {
                break;
            }
            let keep = match seen.touched {
                0 => {
                    let own = pair.map(|link| Arc::clone(&shapes[self.place_of(link)]));
                    let nearest = seen.nearest.iter().map(|(_, sample)| *sample);
                    self.can_touch(*pair, own, seed, nearest)?
                }
                touched => (touched as f64) < always,
            };
            kept.extend(keep.then_some(*pair));
        }
        self.pairs = kept;
        Ok(self)
    }

    /// Visits where the links with shapes stand in random configurations, within all limits and with followers where they belong, each with
    /// its number.
    ///
    /// # Errors
    /// The model's lengths are no numbers.
    pub(crate) fn visit_samples(
        &self,
        samples: u64,
        seed: u64,
        mut each: impl FnMut(u64, &[Placement<f64>]),
    ) -> Result<(), ModelError> {
        let mut kinematics = ForwardKinematics::of_configurations(&self.model, &self.links);
        let mut x = vec![0.0; self.map.variables()];
        for sample in 0..samples {
            if is_stopped() {
                break;
            }
            let mut q = self.draw(seed, sample, &mut x)?;
            self.map.expand_within_limits(&x, &mut q)?;
            if let Ok(placed) = kinematics.place(&q) {
                each(sample, placed);
            }
        }
        Ok(())
    }

    /// A sample by its number: its variables, and a configuration that has them, followers not yet where they belong.
    ///
    /// # Errors
    /// The model's lengths are no numbers.
    pub(super) fn draw(
        &self,
        seed: u64,
        sample: u64,
        x: &mut [f64],
    ) -> Result<Vec<f64>, ModelError> {
        let q = self.model.random_configuration(seed.wrapping_add(sample));
        self.map.reduce(&q, x)?;
        Ok(q)
    }

    /// The same model without the pairs that touch at a configuration, as where a figure rests or a robot is parked.
    ///
    /// # Errors
    /// A configuration of the wrong length, or one that is not finite.
    pub fn with_touching_ignored(mut self, q: &[f64]) -> Result<Self, KinematicsError> {
        let mut kinematics = ForwardKinematics::of_configurations(&self.model, &self.links);
        let placed = kinematics.place(q)?;
        let shapes = self.link_shapes();
        let touch = |pair: &[FrameId; 2]| {
            let [a, b] = pair.map(|link| self.place_of(link));
            let found = shapes[a].apart(&placed[a], &shapes[b], &placed[b], ROUNDING);
            found.is_some()
        };
        self.pairs = (self.pairs.iter().copied())
            .filter(|pair| !touch(pair))
            .collect();
        Ok(self)
    }

    /// Where a link stands among those with shapes.
    pub(crate) fn place_of(&self, link: FrameId) -> usize {
        self.links.binary_search(&link).unwrap_or(0)
    }
}

impl Seen {
    /// What is farther apart says nothing more about the pair.
    fn asked(&self) -> f64 {
        match self.nearest.get(NEAREST - 1) {
            _ if self.touched > 0 => ROUNDING,
            Some((farthest, _)) => *farthest,
            None => f64::INFINITY,
        }
    }

    fn take(&mut self, sample: u64, distance: f64) {
        if distance <= ROUNDING {
            self.touched += 1;
        } else if self.touched == 0 {
            let at = self
                .nearest
                .partition_point(|(known, _)| *known <= distance);
            self.nearest.insert(at, (distance, sample));
            self.nearest.truncate(NEAREST);
        }
    }
}
