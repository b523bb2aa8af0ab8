//! Solved sample times, and the keys from them.

use glam::{DVec3, Quat, Vec3A};

use super::ClipIkError;
use super::frame_solver::FrameSolver;
use super::plan::{Moment, Plan};
use super::posed_bones::PosedBones;
use super::sampling::{LimbWay, Poses};
use super::splice::NewKeys;
use crate::animation::Clip;
use crate::skeleton::BoneId;

/// Result at one sample time.
struct SolvedMoment {
    moment: Moment,
    /// Rotations of the bones that rotate.
    rotations: Vec<Quat>,
    /// Translation of the root, if there is one.
    translation: Option<Vec3A>,
    root_moves: bool,
    /// Distance of each bone with a target from its commanded position.
    misses: Vec<f64>,
}

/// Solved sample times of a clip, in order.
pub(super) struct SolvedMoments<'a> {
    plan: &'a Plan<'a>,
    clip: &'a Clip,
    solver: FrameSolver,
    turning: Vec<BoneId>,
    all: Vec<SolvedMoment>,
}

impl<'a> SolvedMoments<'a> {
    pub(super) fn none(
        plan: &'a Plan<'a>,
        clip: &'a Clip,
        posed: &PosedBones,
    ) -> Result<Self, ClipIkError> {
        let longest = plan.limbs.iter().map(LimbWay::longest).fold(0.0, f64::max);
        let effectors = plan.request.bones.iter().enumerate();
        let effectors: Vec<(BoneId, bool)> = effectors
            .map(|(k, bone)| (*bone, k < plan.feet.len()))
            .collect();
        Ok(Self {
            plan,
            clip,
            solver: FrameSolver::new(posed, &effectors, longest)?,
            turning: posed.turning().collect(),
            all: Vec::new(),
        })
    }

    /// Solves further sample times, which must increase.
    pub(super) fn add(
        &mut self,
        moments: impl IntoIterator<Item = Moment>,
        posed: &mut PosedBones,
    ) -> Result<(), ClipIkError> {
        let (armature, bones) = (self.plan.ik.armature, &self.plan.request.bones);
        let mut places = vec![DVec3::ZERO; bones.len()];
        let mut poses = Poses::new(armature, self.clip);
        for moment in moments {
            let pose = poses.at(self.plan.time(moment))?;
            let travelled = self.plan.travelled(moment);
            let moved = travelled + self.plan.moved(moment);
            let root_moves = moved != DVec3::ZERO;
            posed.take(pose);
            let mut is_asked = root_moves;
            for (k, place) in places.iter_mut().enumerate() {
                let free = posed.place(bones[k]) + travelled;
                let goal = self.plan.goal(k, moment, free);
                is_asked |= goal.1 > 0.0;
                *place = self.plan.place(moment, free, goal);
            }
            if is_asked {
                self.solver.solve((armature, posed), &places, moved, pose)?;
                posed.place_bones(pose);
            }
            let misses = bones.iter().zip(&places);
            let root = self.plan.request.root;
            self.all.push(SolvedMoment {
                moment,
                rotations: (self.turning.iter())
                    .map(|bone| pose.rotations()[bone.index()])
                    .collect(),
                translation: root.map(|root| pose.translations()[root.index()]),
                root_moves,
                misses: misses
                    .map(|(bone, place)| posed.place(*bone).distance(*place))
                    .collect(),
            });
        }
        self.all.sort_by(|a, b| a.moment.total_cmp(&b.moment));
        Ok(())
    }

    pub(super) fn moments(&self) -> Vec<Moment> {
        self.all.iter().map(|own| own.moment).collect()
    }

    /// Returns the distance of a bone from its commanded position, by sample time.
    pub(super) fn misses(&self, bone: usize) -> impl Iterator<Item = f64> + Clone + '_ {
        self.all.iter().map(move |own| own.misses[bone])
    }

    /// Returns the keys at all sample times.
    pub(super) fn keys(&self) -> NewKeys {
        let all = self.all.iter();
        let rotations = self.turning.iter().enumerate();
        let rotations = rotations.map(|(k, bone)| {
            let keys = all.clone().map(|own| own.rotations[k]);
            (*bone, keys.collect())
        });
        let moves = self.all.iter().any(|own| own.root_moves);
        let root = self.plan.request.root.filter(|_| moves);
        let translations = root.map(|root| {
            let keys = all.clone().filter_map(|own| own.translation);
            (root, keys.collect())
        });
        NewKeys {
            times: all.clone().map(|own| self.plan.time(own.moment)).collect(),
            rotations: rotations.collect(),
            translations: translations.into_iter().collect(),
        }
    }
}
