//! Links that stand so near each other that the spheres around them nearly always meet.

use super::sphere_cover::PlacedCover;
use super::{Checker, CheckerWorkspace};
use crate::collision::SphereModel;
use crate::kinematics::KinematicsError;

/// Random configurations that are looked at.
const SAMPLES: u64 = 64;
const SEED: u64 = 1;
/// Spheres that meet in such a share of them tell too little: what they say is not asked.
const OFTEN: f64 = 0.5;

impl Checker {
    getters! {
        /// The pairs of links, by their places in the [model](crate::collision::CollisionModel::links), whose spheres meet in half of all configurations or
        /// more though they are kept apart, as those of a wrist's links do: only their shapes can tell.
        pub(crate) fn close_pairs(&self) -> &[[usize; 2]] = &self.close_pairs;
    }

    /// Whether each of some pairs of links is at least the margin apart at a configuration of the model, by the exact distances of
    /// shapes.
    ///
    /// # Errors
    /// As [`collisions`](Self::collisions).
    pub(crate) fn are_apart(
        &self,
        pairs: &[[usize; 2]],
        workspace: &mut CheckerWorkspace,
        q: &[f64],
    ) -> Result<bool, KinematicsError> {
        let (placements, room) = workspace.place(self, q)?;
        self.scene.begin(room);
        Ok(pairs.iter().all(|pair| {
            let apart = self
                .scene
                .apart_by_shapes(*pair, placements, self.margin, room);
            apart.is_none_or(|separation| separation.distance >= self.least())
        }))
    }

    /// Finds the pairs whose spheres meet in too many configurations; none where they are the shapes themselves.
    pub(super) fn with_close_pairs_found(mut self, spheres: &SphereModel) -> Self {
        let mut met = vec![0_u64; self.scene.pairs().len()];
        let samples = match spheres.overhang() > 0.0 {
            true => SAMPLES,
            false => 0,
        };
        let mut covers: Vec<PlacedCover> = Vec::new();
        // Where nothing is drawn, no pair is close.
        let _ = self.model.visit_samples(samples, SEED, |_, placed| {
            covers.clear();
            covers.resize_with(placed.len(), PlacedCover::default);
            for (pair, met) in self.scene.pairs().iter().zip(&mut met) {
                *met += u64::from(self.scene.covers_meet(*pair, placed, 0.0, &mut covers));
            }
        });
        let often = (OFTEN * SAMPLES as f64).ceil() as u64;
        let links = self.model.links().len();
        let close = self.scene.pairs().iter().zip(met);
        let close = close.filter(|([a, b], met)| *met >= often && *a < links && *b < links);
        self.close_pairs = close.map(|(pair, _)| *pair).collect();
        self
    }
}
