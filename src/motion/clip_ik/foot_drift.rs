//! How far standing feet stray between the keys of a clip: its lines turn joints from key to key, and do not lead feet.

use super::ClipIkError;
use super::plan::{Moment, Plan, dvec};
use super::posed_bones::PosedBones;
use super::sampling::Poses;
use super::solved_moments::SolvedMoments;
use crate::animation::Clip;

/// How far a foot that stands may be off between keys, in lengths of its limb: a millimetre on a leg of a metre.
const ALLOWED: f64 = 1e-3;
/// So many equal parts from key to key: between them is looked.
const LOOKED_AT: usize = 4;
/// Into no more parts are two keys parted at once.
const MOST_PARTS: f64 = 8.0;

/// Foot by foot, how far it is from where it stands at most between each key and the next, 0 where it does not stand.
pub(super) struct Strays(Vec<Vec<f64>>);

impl Strays {
    /// Looks at a clip with keys at these moments.
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
                posed.take(armature, poses.at(plan.time(look))?)?;
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

    /// The most of a foot's between moments `from` and `to` of those looked at.
    pub(super) fn most(&self, foot: usize, from: usize, to: usize) -> f64 {
        self.0[foot][from..to].iter().copied().fold(0.0, f64::max)
    }

    /// As many more moments between two as bring a foot near enough that is not: a line's error goes with the square of its length. What a
    /// foot is off at both of them already, no more of them help.
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
                // What single precision tells apart.
                if last < time && time < plan.time(pair[1]) {
                    more.push(moment);
                    last = time;
                }
            }
        }
        more
    }
}
