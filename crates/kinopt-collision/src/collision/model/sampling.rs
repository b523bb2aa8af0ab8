//! Sampling of the collision pairs that never touch or always touch.

use std::sync::Arc;

use super::CollisionModel;
use crate::collision::ROUNDING;
use kinopt_kinematics::interruption::is_stopped;
use kinopt_kinematics::kinematics::{ForwardKinematics, KinematicsError};
use kinopt_kinematics::model::{FrameId, ModelError};
use kinopt_kinematics::spatial::Placement;

/// Share of samples in contact from which a pair counts as always in contact, as in MoveIt's setup assistant.
const ALWAYS_IN_CONTACT_SHARE: f64 = 0.95;
/// Number of samples, those of least distance, from which a pair without contact is minimised.
const MAX_NEAREST_SAMPLES: usize = 3;

/// Results of the samples for one pair.
#[derive(Clone, Debug, Default)]
struct PairSamples {
    touched: u64,
    /// Distance, metres, and index of the closest samples, in order. Only of pairs without contact.
    nearest: Vec<(f64, u64)>,
}

impl CollisionModel {
    /// The model without the pairs that never touch, and without those that almost always touch.
    ///
    /// A pair in contact in at least 95 % of `samples` random configurations is disabled. Links next to a shared joint
    /// are an example (Sucan & Chitta, MoveIt's setup assistant). For a pair without contact, the distance is minimised
    /// within all limits from the three closest samples. The pair is disabled only if no minimisation reaches contact.
    /// Loops are not closed in the samples. Without samples all pairs remain.
    ///
    /// # Errors
    /// Returns an error if a sampled configuration is not finite.
    pub fn with_pairs_sampled(mut self, samples: u64, seed: u64) -> Result<Self, ModelError> {
        if samples == 0 {
            return Ok(self);
        }
        let shapes: Vec<_> = self.link_shapes().into_iter().map(Arc::new).collect();
        let mut pair_samples = vec![PairSamples::default(); self.pairs.len()];
        self.visit_samples(samples, seed, |sample, placed| {
            for (pair, pair_samples) in self.pairs.iter().zip(&mut pair_samples) {
                let [a, b] = pair.map(|link| self.place_of(link));
                let separation = shapes[a].separation(
                    &placed[a],
                    &shapes[b],
                    &placed[b],
                    pair_samples.max_distance(),
                );
                if let Some(separation) = separation {
                    pair_samples.record(sample, separation.distance);
                }
            }
        })?;
        let max_touched = ALWAYS_IN_CONTACT_SHARE * samples as f64;
        let mut enabled = Vec::new();
        for (pair, pair_samples) in self.pairs.iter().zip(&pair_samples) {
            if is_stopped() {
                break;
            }
            let is_enabled = match pair_samples.touched {
                0 => {
                    let link_shapes = pair.map(|link| Arc::clone(&shapes[self.place_of(link)]));
                    let nearest = pair_samples.nearest.iter().map(|(_, sample)| *sample);
                    self.can_touch(*pair, link_shapes, seed, nearest)?
                }
                touched => (touched as f64) < max_touched,
            };
            enabled.extend(is_enabled.then_some(*pair));
        }
        self.pairs = enabled;
        Ok(self)
    }

    /// Calls `visitor` with the number of a sample and the world placements of the links with shapes.
    ///
    /// The random configurations are within all limits and satisfy the mimic joints.
    ///
    /// # Errors
    /// Returns an error if a sampled configuration is not finite.
    pub(crate) fn visit_samples(
        &self,
        samples: u64,
        seed: u64,
        mut visitor: impl FnMut(u64, &[Placement<f64>]),
    ) -> Result<(), ModelError> {
        let mut kinematics = ForwardKinematics::of_configurations(&self.model, &self.links);
        let mut x = vec![0.0; self.map.variables()];
        for sample in 0..samples {
            if is_stopped() {
                break;
            }
            let mut q = self.sample_configuration(seed, sample, &mut x)?;
            self.map.expand_within_limits(&x, &mut q)?;
            if let Ok(placed) = kinematics.place(&q) {
                visitor(sample, placed);
            }
        }
        Ok(())
    }

    /// A sample by its number: its variables, and a configuration with them, in which mimic joints are not yet set.
    ///
    /// # Errors
    /// Returns an error if the sampled configuration contains NaN.
    pub(super) fn sample_configuration(
        &self,
        seed: u64,
        sample: u64,
        x: &mut [f64],
    ) -> Result<Vec<f64>, ModelError> {
        let q = self.model.random_configuration(seed.wrapping_add(sample));
        self.map.reduce(&q, x)?;
        Ok(q)
    }

    /// The model without the pairs that touch at a configuration, such as the rest pose or a parking position.
    ///
    /// # Errors
    /// Returns an error if the configuration has the wrong length or is not finite.
    pub fn with_touching_ignored(mut self, q: &[f64]) -> Result<Self, KinematicsError> {
        let mut kinematics = ForwardKinematics::of_configurations(&self.model, &self.links);
        let placed = kinematics.place(q)?;
        let shapes = self.link_shapes();
        let touch = |pair: &[FrameId; 2]| {
            let [a, b] = pair.map(|link| self.place_of(link));
            let separation = shapes[a].separation(&placed[a], &shapes[b], &placed[b], ROUNDING);
            separation.is_some()
        };
        self.pairs = (self.pairs.iter().copied())
            .filter(|pair| !touch(pair))
            .collect();
        Ok(self)
    }

    /// Index of a link among those with shapes.
    #[doc(hidden)]
    pub fn place_of(&self, link: FrameId) -> usize {
        self.links.binary_search(&link).unwrap_or(0)
    }
}

impl PairSamples {
    /// Largest distance that still matters for the pair, metres.
    fn max_distance(&self) -> f64 {
        match self.nearest.get(MAX_NEAREST_SAMPLES - 1) {
            _ if self.touched > 0 => ROUNDING,
            Some((farthest, _)) => *farthest,
            None => f64::INFINITY,
        }
    }

    fn record(&mut self, sample: u64, distance: f64) {
        if distance <= ROUNDING {
            self.touched += 1;
        } else if self.touched == 0 {
            let at = self
                .nearest
                .partition_point(|(other, _)| *other <= distance);
            self.nearest.insert(at, (distance, sample));
            self.nearest.truncate(MAX_NEAREST_SAMPLES);
        }
    }
}
