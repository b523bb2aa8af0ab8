//! Solved sample times, and the keys from them.

use glam::{DVec3, Quat, Vec3A};

use super::ClipIkError;
use super::frame_solver::FrameSolver;
use super::plan::{Plan, SampleTime};
use super::posed_bones::PosedBones;
use super::sampling::{LimbMotion, Poses};
use super::splice::NewKeys;
use kinopt_animation::animation::Clip;
use kinopt_kinematics::skeleton::BoneId;

/// Result at one sample time.
struct SolvedSample {
    sample: SampleTime,
    /// Rotations of the bones that rotate.
    rotations: Vec<Quat>,
    /// Translation of the root, if there is one.
    translation: Option<Vec3A>,
    root_moves: bool,
    /// Distance of each bone with a target from its commanded position.
    errors: Vec<f64>,
}

/// Solved sample times of a clip, in order.
pub(super) struct SolvedSamples<'a> {
    plan: &'a Plan<'a>,
    clip: &'a Clip,
    solver: FrameSolver,
    rotating_bones: Vec<BoneId>,
    samples: Vec<SolvedSample>,
}

impl<'a> SolvedSamples<'a> {
    pub(super) fn empty(
        plan: &'a Plan<'a>,
        clip: &'a Clip,
        posed: &PosedBones,
    ) -> Result<Self, ClipIkError> {
        let max_length = plan
            .limbs
            .iter()
            .map(LimbMotion::max_length)
            .fold(0.0, f64::max);
        let effectors = plan.request.bones.iter().enumerate();
        let effectors: Vec<(BoneId, bool)> = effectors
            .map(|(k, bone)| (*bone, k < plan.feet.len()))
            .collect();
        Ok(Self {
            plan,
            clip,
            solver: FrameSolver::new(posed, &effectors, max_length)?,
            rotating_bones: posed.rotating_bones().collect(),
            samples: Vec::new(),
        })
    }

    /// Solves further sample times, which must increase.
    pub(super) fn add(
        &mut self,
        samples: impl IntoIterator<Item = SampleTime>,
        posed: &mut PosedBones,
    ) -> Result<(), ClipIkError> {
        let (armature, bones) = (self.plan.ik.armature, &self.plan.request.bones);
        let mut positions = vec![DVec3::ZERO; bones.len()];
        let mut poses = Poses::new(armature, self.clip);
        for sample in samples {
            let pose = poses.at(self.plan.time(sample))?;
            let travelled = self.plan.travelled(sample);
            let moved = travelled + self.plan.moved(sample);
            let root_moves = moved != DVec3::ZERO;
            posed.store_clip_pose(pose);
            let mut has_target = root_moves;
            for (k, position) in positions.iter_mut().enumerate() {
                let free = posed.effector_position(bones[k]) + travelled;
                let goal = self.plan.goal(k, sample, free);
                has_target |= goal.1 > 0.0;
                *position = self.plan.commanded_position(sample, free, goal);
            }
            if has_target {
                self.solver
                    .solve((armature, posed), &positions, moved, pose)?;
                posed.place_bones(pose);
            }
            let errors = bones.iter().zip(&positions);
            let root = self.plan.request.root;
            self.samples.push(SolvedSample {
                sample,
                rotations: (self.rotating_bones.iter())
                    .map(|bone| pose.rotations()[bone.index()])
                    .collect(),
                translation: root.map(|root| pose.translations()[root.index()]),
                root_moves,
                errors: errors
                    .map(|(bone, position)| posed.effector_position(*bone).distance(*position))
                    .collect(),
            });
        }
        self.samples.sort_by(|a, b| a.sample.total_cmp(&b.sample));
        Ok(())
    }

    pub(super) fn sample_times(&self) -> Vec<SampleTime> {
        self.samples.iter().map(|sample| sample.sample).collect()
    }

    /// Returns the distance of a bone from its commanded position, by sample time.
    pub(super) fn errors(&self, bone: usize) -> impl Iterator<Item = f64> + Clone + '_ {
        self.samples.iter().map(move |sample| sample.errors[bone])
    }

    /// Returns the keys at all sample times.
    pub(super) fn keys(&self) -> NewKeys {
        let samples = self.samples.iter();
        let rotations = self.rotating_bones.iter().enumerate();
        let rotations = rotations.map(|(k, bone)| {
            let keys = samples.clone().map(|sample| sample.rotations[k]);
            (*bone, keys.collect())
        });
        let moves = self.samples.iter().any(|sample| sample.root_moves);
        let root = self.plan.request.root.filter(|_| moves);
        let translations = root.map(|root| {
            let keys = samples.clone().filter_map(|sample| sample.translation);
            (root, keys.collect())
        });
        NewKeys {
            times: samples
                .clone()
                .map(|sample| self.plan.time(sample.sample))
                .collect(),
            rotations: rotations.collect(),
            translations: translations.into_iter().collect(),
        }
    }
}
