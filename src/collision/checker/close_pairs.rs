//! Pairs of links whose sphere covers nearly always overlap.

use super::sphere_cover::PlacedCover;
use super::{Checker, CheckerWorkspace};
use crate::collision::SphereModel;
use crate::kinematics::KinematicsError;

/// Number of random configurations.
const SAMPLES: u64 = 64;
const SEED: u64 = 1;
/// Share of samples with overlapping covers from which the cover test of a pair is skipped.
const MIN_OVERLAP_SHARE: f64 = 0.5;

impl Checker {
    /// Enabled pairs of links whose covers overlap in at least half of all configurations, as those of a wrist's
    /// links do.
    ///
    /// The indices are those of [`links`](crate::collision::CollisionModel::links). Such pairs need exact
    /// distances.
    #[must_use]
    pub(crate) fn close_pairs(&self) -> &[[usize; 2]] {
        &self.close_pairs
    }

    /// True if each of the given pairs of links is at least the margin apart at a configuration, by exact distances.
    ///
    /// # Errors
    /// As [`collisions`](Self::collisions).
    pub(crate) fn are_apart(
        &self,
        pairs: &[[usize; 2]],
        workspace: &mut CheckerWorkspace,
        q: &[f64],
    ) -> Result<bool, KinematicsError> {
        let (placements, scene_workspace) = workspace.place(self, q)?;
        self.scene.begin(scene_workspace);
        Ok(pairs.iter().all(|pair| {
            let separation =
                self.scene
                    .shape_separation(*pair, placements, self.margin, scene_workspace);
            separation.is_none_or(|separation| separation.distance >= self.min_distance())
        }))
    }

    /// Finds the pairs whose covers overlap too often. There are none if the spheres are the shapes themselves.
    pub(super) fn with_close_pairs_found(mut self, spheres: &SphereModel) -> Self {
        let mut overlaps = vec![0_u64; self.scene.pairs().len()];
        let samples = match spheres.max_protrusion() > 0.0 {
            true => SAMPLES,
            false => 0,
        };
        let mut covers: Vec<PlacedCover> = Vec::new();
        // If sampling fails, no pair is close.
        let _ = self.model.visit_samples(samples, SEED, |_, placed| {
            covers.clear();
            covers.resize_with(placed.len(), PlacedCover::default);
            for (pair, overlaps) in self.scene.pairs().iter().zip(&mut overlaps) {
                *overlaps += u64::from(self.scene.covers_meet(*pair, placed, 0.0, &mut covers));
            }
        });
        let min_overlaps = (MIN_OVERLAP_SHARE * SAMPLES as f64).ceil() as u64;
        let links = self.model.links().len();
        let close = self.scene.pairs().iter().zip(overlaps);
        let close = close
            .filter(|([a, b], overlaps)| *overlaps >= min_overlaps && *a < links && *b < links);
        self.close_pairs = close.map(|(pair, _)| *pair).collect();
        self
    }
}
