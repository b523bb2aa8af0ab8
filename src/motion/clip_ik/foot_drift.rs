//! Drift of feet in contact between the keys of a clip, where interpolated joints do not keep a foot in place.

use super::ClipIkError;
use super::plan::{Moment, Plan, dvec};
use super::posed_bones::PosedBones;
use super::sampling::Poses;
use super::solved_moments::SolvedMoments;
use crate::animation::Clip;

/// Largest allowed drift between keys, in lengths of the limb: 1 mm for a leg of 1 m.
const ALLOWED: f64 = 1e-3;
/// Number of equal parts of a key interval; the drift is measured between them.
const LOOKED_AT: usize = 4;
/// Largest number of parts into which one refinement splits a key interval.
const MOST_PARTS: f64 = 8.0;

/// Largest drift by foot and key interval, in the armature's unit of length; 0 without contact.
pub(super) struct Strays(Vec<Vec<f64>>);

impl Strays {
    /// Measures the drift of a clip with keys at these sample times.
    pub(super) fn measured(
        plan: &Plan<'_>,
        moments: &[Moment],
        clip: &Clip,
        posed: &mut PosedBones,
    ) -> Result<Self, ClipIkError> {
        let armature = plan.ik.armature;
        let mut poses = Poses::new(armature, clip);
        let gaps = moments.len().saturating_sub(1);
        let mut strays = vec![vec![0.0; gaps]; plan.feet.len()];
        for (gap, pair) in moments.windows(2).enumerate() {
            let stand = |foot: usize| plan.feet[foot].stands_from(pair[0].frame);
            if (0..plan.feet.len()).all(|foot| stand(foot).is_none()) {
                continue;
            }
            for look in pair[0].between(pair[1], LOOKED_AT) {
                posed.place_bones(poses.at(plan.time(look))?);
                for (foot, strays) in strays.iter_mut().enumerate() {
                    if let Some(place) = stand(foot) {
                        let at = posed.place(plan.request.bones[foot]);
                        strays[gap] = at.distance(dvec(place)).max(strays[gap]);
                    }
                }
            }
        }
        Ok(Self(strays))
    }

    /// Returns the largest drift of a foot between the sample times with indices `from` and `to`.
    pub(super) fn most(&self, foot: usize, from: usize, to: usize) -> f64 {
        self.0[foot][from..to].iter().copied().fold(0.0, f64::max)
    }

    /// Returns the sample times to add so that the drift stays within [`ALLOWED`]. The error of linear interpolation
    /// grows with the square of the interval. Errors at the keys themselves do not count, because more keys do not
    /// reduce them.
    pub(super) fn more_moments(&self, plan: &Plan<'_>, solved: &SolvedMoments<'_>) -> Vec<Moment> {
        let moments = solved.moments();
        let misses: Vec<Vec<f64>> = (0..self.0.len())
            .map(|foot| solved.misses(foot).collect())
            .collect();
        let parts = |gap: usize| {
            let feet = self.0.iter().enumerate();
            let beyond = feet.map(|(foot, strays)| {
                let off = misses[foot][gap].max(misses[foot][gap + 1]);
                (strays[gap] - off) / (ALLOWED * plan.limbs[foot].longest())
            });
            let most = beyond.fold(1.0, f64::max);
            most.sqrt().ceil().min(MOST_PARTS) as usize
        };
        let mut more = Vec::new();
        for (gap, pair) in moments.windows(2).enumerate() {
            let mut last = plan.time(pair[0]);
            for moment in pair[0].between(pair[1], parts(gap)) {
                let time = plan.time(moment);
                // Only sample times that differ in single precision.
                if last < time && time < plan.time(pair[1]) {
                    more.push(moment);
                    last = time;
                }
            }
        }
        more
    }
}
