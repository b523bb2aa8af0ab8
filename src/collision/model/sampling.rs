//! Which pairs never touch, and which always do.

use super::CollisionModel;
use crate::collision::sphere_model::enclosing;
use crate::collision::{Ball, ROUNDING, separation};
use crate::kinematics::{ForwardKinematics, KinematicsError};
use crate::model::{FrameId, ModelError};
use crate::spatial::Placement;

/// A pair that touches in such a share of all samples is made to: as in MoveIt's setup assistant.
const ALWAYS: f64 = 0.95;

impl CollisionModel {
    /// The same model without the pairs that touch in none of `samples` random configurations, or in at least 95 %
    /// of them, as links beside a shared joint do (Sucan & Chitta, MoveIt's setup assistant). Loops are not closed
    /// for that. More samples find rarer touches: 10 000 find one of a pair that touches in 0.1 % of the
    /// configurations but for 5 in 100 000 times.
    ///
    /// # Errors
    /// The model's lengths are no numbers.
    pub fn with_pairs_sampled(mut self, samples: u64, seed: u64) -> Result<Self, ModelError> {
        let bounds = self.bounds();
        let mut touched = vec![0_u64; self.pairs.len()];
        self.visit_samples(samples, seed, |placed| {
            for (pair, touched) in self.pairs.iter().zip(&mut touched) {
                let at = pair.map(|link| self.place_of(link));
                let [a, b] = at.map(|at| (&placed[at], &bounds[at]));
                *touched += u64::from(self.touch(*pair, a, b));
            }
        })?;
        let always = ALWAYS * samples as f64;
        let mut touched = touched.into_iter();
        self.pairs.retain(|_| {
            let count = touched.next().unwrap_or(0);
            samples == 0 || (count > 0 && (count as f64) < always)
        });
        Ok(self)
    }

    /// Visits where the links with shapes stand in random configurations, within all limits and with followers where they belong.
    ///
    /// # Errors
    /// The model's lengths are no numbers.
    pub(crate) fn visit_samples(
        &self,
        samples: u64,
        seed: u64,
        mut each: impl FnMut(&[Placement<f64>]),
    ) -> Result<(), ModelError> {
        let mut kinematics = ForwardKinematics::of_configurations(&self.model, &self.links);
        let mut x = vec![0.0; self.map.variables()];
        for sample in 0..samples {
            let mut q = self.model.random_configuration(seed.wrapping_add(sample));
            self.map.reduce(&q, &mut x)?;
            self.map.expand_within_limits(&x, &mut q)?;
            if let Ok(placed) = kinematics.place(&q) {
                each(placed);
            }
        }
        Ok(())
    }

    /// The same model without the pairs that touch at a configuration, as where a figure rests or a robot is parked.
    ///
    /// # Errors
    /// A configuration of the wrong length, or one that is not finite.
    pub fn with_touching_ignored(mut self, q: &[f64]) -> Result<Self, KinematicsError> {
        let mut kinematics = ForwardKinematics::of_configurations(&self.model, &self.links);
        let placed = kinematics.place(q)?;
        let bounds = self.bounds();
        let apart = self.pairs.iter().filter(|pair| {
            let at = pair.map(|link| self.place_of(link));
            let [a, b] = at.map(|at| (&placed[at], &bounds[at]));
            !self.touch(**pair, a, b)
        });
        self.pairs = apart.copied().collect();
        Ok(self)
    }

    /// Where a link stands among those with shapes.
    pub(crate) fn place_of(&self, link: FrameId) -> usize {
        self.links.binary_search(&link).unwrap_or(0)
    }

    /// Whether two links touch, each with its place and a ball around its shapes there.
    fn touch(
        &self,
        [a, b]: [FrameId; 2],
        (world_from_a, bound_a): (&Placement<f64>, &Ball),
        (world_from_b, bound_b): (&Placement<f64>, &Ball),
    ) -> bool {
        let between = world_from_a.apply(bound_a.centre) - world_from_b.apply(bound_b.centre);
        if between.norm() > bound_a.radius + bound_b.radius {
            return false;
        }
        self.objects_of(a).any(|first| {
            let world_from_first = *world_from_a * first.link_from_shape;
            self.objects_of(b).any(|second| {
                let world_from_second = *world_from_b * second.link_from_shape;
                let (a, b) = (&first.shape, &second.shape);
                separation(a, &world_from_first, b, &world_from_second).distance <= ROUNDING
            })
        })
    }

    /// By link: a ball around all its shapes.
    fn bounds(&self) -> Vec<Ball> {
        let bound = |link: &FrameId| {
            let balls: Vec<Ball> = (self.objects_of(*link).map(|object| {
                let Ball { centre, radius } = object.shape.bounding_sphere();
                let centre = object.link_from_shape.apply(centre);
                Ball { centre, radius }
            }))
            .collect();
            enclosing(&balls)
        };
        self.links.iter().map(bound).collect()
    }
}
