//! Drift of feet in contact between the keys of a clip, where interpolated joints do not keep a foot in place.

use super::ClipIkError;
use super::plan::{Plan, SampleTime, dvec};
use super::posed_bones::PosedBones;
use super::sampling::Poses;
use super::solved_samples::SolvedSamples;
use kinopt_animation::animation::Clip;

/// Largest allowed drift between keys, in lengths of the limb: 1 mm for a leg of 1 m.
const MAX_DRIFT_RATIO: f64 = 1e-3;
/// Number of equal parts of a key interval; the drift is measured between them.
const CHECKED_PARTS: usize = 4;
/// Largest number of parts into which one refinement splits a key interval.
const MAX_PARTS: f64 = 8.0;

/// Largest drift by foot and key interval, in the armature's unit of length; 0 without contact.
pub(super) struct FootDrift(Vec<Vec<f64>>);

impl FootDrift {
    /// Measures the drift of a clip with keys at these sample times.
    pub(super) fn measure(
        plan: &Plan<'_>,
        samples: &[SampleTime],
        clip: &Clip,
        posed: &mut PosedBones,
    ) -> Result<Self, ClipIkError> {
        let armature = plan.ik.armature;
        let mut poses = Poses::new(armature, clip);
        let intervals = samples.len().saturating_sub(1);
        let mut drifts = vec![vec![0.0; intervals]; plan.feet.len()];
        for (interval, pair) in samples.windows(2).enumerate() {
            let contact_position =
                |foot: usize| plan.feet[foot].contact_position_from(pair[0].frame);
            if (0..plan.feet.len()).all(|foot| contact_position(foot).is_none()) {
                continue;
            }
            for sample in pair[0].between(pair[1], CHECKED_PARTS) {
                posed.place_bones(poses.at(plan.time(sample))?);
                for (foot, drifts) in drifts.iter_mut().enumerate() {
                    if let Some(contact) = contact_position(foot) {
                        let actual = posed.effector_position(plan.request.bones[foot]);
                        drifts[interval] = actual.distance(dvec(contact)).max(drifts[interval]);
                    }
                }
            }
        }
        Ok(Self(drifts))
    }

    /// Returns the largest drift of a foot between the sample times with indices `from` and `to`.
    pub(super) fn largest(&self, foot: usize, from: usize, to: usize) -> f64 {
        self.0[foot][from..to].iter().copied().fold(0.0, f64::max)
    }

    /// Returns the sample times to add so that the drift stays within [`MAX_DRIFT_RATIO`]. The error of linear
    /// interpolation grows with the square of the interval. Errors at the keys themselves do not count, because more
    /// keys do not reduce them.
    pub(super) fn additional_samples(
        &self,
        plan: &Plan<'_>,
        solved: &SolvedSamples<'_>,
    ) -> Vec<SampleTime> {
        let samples = solved.sample_times();
        let errors: Vec<Vec<f64>> = (0..self.0.len())
            .map(|foot| solved.errors(foot).collect())
            .collect();
        let parts = |interval: usize| {
            let feet = self.0.iter().enumerate();
            let ratios = feet.map(|(foot, drifts)| {
                let key_error = errors[foot][interval].max(errors[foot][interval + 1]);
                (drifts[interval] - key_error) / (MAX_DRIFT_RATIO * plan.limbs[foot].max_length())
            });
            let max_ratio = ratios.fold(1.0, f64::max);
            max_ratio.sqrt().ceil().min(MAX_PARTS) as usize
        };
        let mut additional = Vec::new();
        for (interval, pair) in samples.windows(2).enumerate() {
            let mut last = plan.time(pair[0]);
            for sample in pair[0].between(pair[1], parts(interval)) {
                let time = plan.time(sample);
                // Only sample times that differ in single precision.
                if last < time && time < plan.time(pair[1]) {
                    additional.push(sample);
                    last = time;
                }
            }
        }
        additional
    }
}
