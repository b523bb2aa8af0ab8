//! Tasks for tips and rotations of many bones, solved after sampling a clip.

use std::collections::BTreeSet;

use glam::DVec3;

use super::euler_pose_map::EulerPoseMap;
use super::held_rotation::HeldRotation;
use super::posed_skeleton::PosedSkeleton;
use super::shear_correction::{Corrected, ShearCorrection};
use crate::animation::{LayerError, Pose, SizeMismatch};
use kinopt_kinematics::kinematics::{Tree, TreeWorkspace};
use kinopt_kinematics::model::UnknownName;
use kinopt_kinematics::skeleton::{BoneId, Skeleton};
use kinopt_kinematics::spatial::{Quaternion, Vector3};
use kinopt_solver::ik::{Restarts, Solution, Solver, Workspace};
use kinopt_solver::problem::{Problem, ProblemError, ProblemInstance, Targets, TaskId};
use kinopt_solver::solver::Stopping;
use kinopt_solver::task::{Point, Quantity};

/// Distance at which a tip counts as reached, as a fraction of the skeleton's size; the limit of single precision.
const TOLERANCE: f64 = 1e-6;

/// IK over an animated pose: weighted tasks for the tips of bones, on top of the sampled pose.
///
/// It is slower than a [`Limb`](super::Limb), but supports any bones, joint limits and several tips with a common
/// spine. The search starts at the clip's pose, so joints that do not help a tip do not move. Joints are placed by the
/// pose's own translations and scales, so tip errors are those of the posed bones: W (ℓ, 0, 0) for a bone of length ℓ.
///
/// Uneven scales shear the bones that rotate below them, which no joint does. Such a pose is solved repeatedly, with
/// updated joint positions, until the tips of the posed bones are at their targets. The solution reports the posed
/// bones even if this does not converge.
#[derive(Clone, Debug)]
pub struct ReachLayer {
    pose_map: EulerPoseMap,
    posed: PosedSkeleton,
    problem: Problem,
    targets: Targets,
    /// Joints of the problem, at their positions in the pose.
    tree: Tree,
    tree_workspace: TreeWorkspace,
    effectors: Vec<Effector>,
    held: Vec<HeldRotation>,
    /// Bones moved by the tasks, by index.
    moved: Vec<BoneId>,
    solver: Solver,
    /// Solver of corrections, starting at the end of the last solve.
    correction: Solver,
    /// Solver that evaluates a pose without a change.
    measurement: Solver,
    workspace: Workspace,
    q: Vec<f64>,
}

#[derive(Clone, Debug)]
struct Effector {
    bone: BoneId,
    task: TaskId<Point>,
    target: Vector3<f64>,
    weight: f64,
    /// Target after the weight is applied.
    goal: Vector3<f64>,
}

/// Error of a bone for which the layer has no task of this kind.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", UnknownName::new("effector of the layer", bone, effectors.iter().map(String::as_str)))]
#[non_exhaustive]
pub struct NoEffector {
    /// Name of the requested bone.
    pub bone: String,
    /// Names of the bones with such a task.
    pub effectors: Vec<String>,
}

/// Kind of a solve of one pose: the first, one after a shear correction, or an evaluation only.
#[derive(Clone, Copy, Debug)]
enum Pass {
    First,
    Correction,
    Measurement,
}

impl ReachLayer {
    /// Layer for the tips of these bones, all with weight 0 at first. Repeated bones count once.
    ///
    /// # Errors
    /// As [`ProblemBuilder::build`](kinopt_solver::problem::ProblemBuilder::build): no bones, or a bone of another skeleton.
    pub fn new(skeleton: &Skeleton, tips: &[BoneId], solver: Solver) -> Result<Self, ProblemError> {
        Self::holding(skeleton, tips, &[], solver)
    }

    /// Layer for the tips of some bones and the rotations of other bones, such as hands, feet and a head. Rotations in
    /// the model follow the clip until [set](Self::set_rotation).
    ///
    /// # Errors
    /// As [`ProblemBuilder::build`](kinopt_solver::problem::ProblemBuilder::build).
    pub fn holding(
        skeleton: &Skeleton,
        tips: &[BoneId],
        held: &[BoneId],
        solver: Solver,
    ) -> Result<Self, ProblemError> {
        let rest = skeleton.model().neutral();
        let mut builder = Problem::builder(skeleton.model());
        let effectors = unique(tips).map(|bone| Effector {
            bone,
            task: builder.add(Point::new(skeleton.tip(bone), Vector3::zero())),
            target: Vector3::zero(),
            weight: 0.0,
            goal: Vector3::zero(),
        });
        let effectors = effectors.collect();
        let held_rotations =
            unique(held).map(|bone| HeldRotation::new(skeleton, bone, &mut builder));
        let held_rotations = held_rotations.collect();
        let size = skeleton.size();
        if size > 0.0 {
            builder.tolerance(Quantity::Metres, TOLERANCE * size);
        }
        let problem = builder.build()?;
        let moved = with_ancestors(skeleton, tips.iter().chain(held));
        let correction = solver.clone().with_restarts(Restarts::none());
        let no_steps = Stopping::default().with_max_iterations(0);
        Ok(Self {
            pose_map: EulerPoseMap::new(skeleton),
            targets: problem.targets(),
            tree: problem.tree().clone(),
            problem,
            tree_workspace: TreeWorkspace::default(),
            posed: PosedSkeleton::new(skeleton, &moved),
            effectors,
            held: held_rotations,
            moved,
            solver,
            measurement: correction.clone().with_stopping(no_steps),
            correction,
            workspace: Workspace::new(),
            q: rest,
        })
    }

    /// Sets the target of a bone's tip in model coordinates and its weight. Weight 0 is the clip's position, weight 1
    /// the target. The weight is clamped to [0, 1]; NaN counts as 0.
    ///
    /// # Errors
    /// - The layer has no tip task for the bone; the error lists the bones.
    /// - The target is not finite; the previous target is kept.
    pub fn set_goal(
        &mut self,
        bone: BoneId,
        target: impl Into<Vector3<f64>>,
        weight: f64,
    ) -> Result<(), LayerError> {
        let target = target.into();
        let effector = self
            .effectors
            .iter_mut()
            .find(|effector| effector.bone == bone);
        if let Some(effector) = effector {
            if !target.to_array().into_iter().all(f64::is_finite) {
                return Err(self.not_finite(bone, "target is not finite"));
            }
            effector.target = target;
            effector.weight = clamped_weight(weight);
            return Ok(());
        }
        let effectors = self.effectors.iter().map(|effector| effector.bone);
        Err(self.no_effector(bone, effectors).into())
    }

    /// Sets the target rotation of a held bone in the model and its weight. Weight 0 is the clip's rotation, weight 1
    /// the target, by the shortest arc. The weight is clamped to [0, 1]; NaN counts as 0. The quaternion may have any
    /// length.
    ///
    /// # Errors
    /// - The layer has no rotation task for the bone; the error lists the bones.
    /// - The quaternion is zero or not finite; the previous rotation is kept.
    pub fn set_rotation(
        &mut self,
        bone: BoneId,
        rotation: impl Into<Quaternion<f64>>,
        weight: f64,
    ) -> Result<(), LayerError> {
        let held_rotation = self
            .held
            .iter_mut()
            .find(|held_rotation| held_rotation.bone == bone);
        if let Some(held_rotation) = held_rotation {
            return match held_rotation.set(rotation.into(), clamped_weight(weight)) {
                true => Ok(()),
                false => Err(self.not_finite(bone, "rotation is of length 0 or not finite")),
            };
        }
        let held = self.held.iter().map(|held_rotation| held_rotation.bone);
        Err(self.no_effector(bone, held).into())
    }

    fn not_finite(&self, bone: BoneId, what: &'static str) -> LayerError {
        let bone = self.no_effector(bone, std::iter::empty()).bone;
        LayerError::NotFinite { bone, what }
    }

    fn no_effector(&self, bone: BoneId, others: impl Iterator<Item = BoneId>) -> NoEffector {
        let name = |bone: BoneId| {
            let bones = self.posed.skeleton().bones();
            let bone = bones.get(bone.index()).map(|bone| bone.name.clone());
            bone.unwrap_or_default()
        };
        NoEffector {
            bone: name(bone),
            effectors: others.map(name).collect(),
        }
    }

    /// Rotates the bones of a pose, within joint limits, so that the tips move towards their targets by their weights.
    /// All tips and held bones are tasks: one with weight 0 keeps the clip's value. Bones without a task below them do
    /// not change. With all weights 0 no bone changes, even outside its limits.
    ///
    /// # Errors
    /// The number of bones differs from the skeleton's; the pose does not change. An unreached target is not an error;
    /// the solution reports its distance.
    pub fn apply(&mut self, pose: &mut Pose) -> Result<Option<&Solution>, LayerError> {
        let bones = self.posed.skeleton().bones();
        SizeMismatch::check("bones in the pose", pose.bones(), bones.len())?;
        let weights = self.effectors.iter().map(|effector| effector.weight);
        let mut weights = weights.chain(self.held.iter().map(|held| held.weight));
        if weights.all(|weight| weight == 0.0) {
            return Ok(None);
        }
        self.pose_map.angles_of(pose, &mut self.q)?;
        self.posed.update(pose, &self.moved);
        self.aim();
        self.solve(Pass::First, pose)?;
        if self.posed.has_shear() {
            self.correct(pose)?;
        }
        Ok(Some(self.workspace.solution()))
    }

    /// Sets the targets of the tasks from the pose last taken.
    fn aim(&mut self) {
        for effector in &mut self.effectors {
            if let Some(bone) = self.posed.bone(effector.bone) {
                let tip = Vector3::from(bone.tip.to_array());
                effector.goal = tip * (1.0 - effector.weight) + effector.target * effector.weight;
                if let Ok(task) = self.targets.get_mut(effector.task) {
                    task.set_target(effector.goal);
                }
            }
        }
        for held in &self.held {
            let bone = self.posed.bone(held.bone);
            if let Some((bone, task)) = bone.zip(self.targets.get_mut(held.task).ok()) {
                task.set_target(held.target(bone.rotation));
            }
        }
    }

    /// Solves from `q` with the joint positions of the pose last taken, and rotates the bones of `pose`.
    fn solve(&mut self, pass: Pass, pose: &mut Pose) -> Result<(), LayerError> {
        let solver = match pass {
            Pass::First => &self.solver,
            Pass::Correction => &self.correction,
            Pass::Measurement => &self.measurement,
        };
        let (model, map) = (self.posed.skeleton().model(), self.problem.parameters());
        self.tree.compile(model, map, &mut self.tree_workspace);
        let instance = ProblemInstance::from(&self.problem);
        let instance = instance.with_targets(&self.targets).with_tree(&self.tree);
        let solution = solver.solve(instance, &self.q, &mut self.workspace)?;
        self.q.copy_from_slice(&solution.q);
        for &bone in &self.moved {
            self.pose_map.pose_bone(bone, &self.q, pose);
        }
        Ok(())
    }

    /// Solves a sheared pose again until the tips of the posed bones are at their goals, and evaluates them there.
    fn correct(&mut self, pose: &mut Pose) -> Result<(), LayerError> {
        let goals = |effector: &Effector| DVec3::from(effector.goal.to_array());
        let goals: Vec<DVec3> = self.effectors.iter().map(goals).collect();
        let tolerance = TOLERANCE * self.posed.skeleton().size();
        self.posed.update(pose, &self.moved);
        let mut correction = ShearCorrection::new(&goals, &self.tips());
        let mut nearest = (pose.clone(), self.q.clone());
        let mut before = nearest.clone();
        let mut is_cut = self.workspace.solution().termination.is_cut();
        while !(is_cut || correction.off() <= tolerance || correction.gives_up()) {
            self.set_tips(&correction.commands());
            self.solve(Pass::Correction, pose)?;
            let solution = self.workspace.solution();
            is_cut = solution.termination.is_cut();
            let reached = solution.reached;
            self.posed.update(pose, &self.moved);
            let corrected = correction.learn(&self.tips(), reached);
            if corrected == Corrected::Undone {
                pose.copy_from(&before.0);
                self.q.copy_from_slice(&before.1);
                self.posed.update(pose, &self.moved);
                continue;
            }
            before.0.copy_from(pose);
            before.1.copy_from_slice(&self.q);
            if corrected == Corrected::Nearest {
                nearest.clone_from(&before);
            }
        }
        pose.copy_from(&nearest.0);
        self.q.copy_from_slice(&nearest.1);
        self.posed.update(pose, &self.moved);
        self.set_tips(&goals);
        self.solve(Pass::Measurement, pose)
    }

    /// Tip positions of the effectors in the pose last taken.
    fn tips(&self) -> Vec<DVec3> {
        let bones = self
            .effectors
            .iter()
            .map(|effector| self.posed.bone(effector.bone));
        bones
            .map(|bone| bone.map_or(DVec3::ZERO, |bone| bone.tip))
            .collect()
    }

    fn set_tips(&mut self, tips: &[DVec3]) {
        for (effector, tip) in self.effectors.iter().zip(tips) {
            if let Ok(task) = self.targets.get_mut(effector.task) {
                task.set_target(Vector3::from(tip.to_array()));
            }
        }
    }
}

/// Clamps a weight to [0, 1].
fn clamped_weight(weight: f64) -> f64 {
    if weight > 0.0 { weight.min(1.0) } else { 0.0 }
}

/// The distinct bones, in order of first occurrence.
fn unique(bones: &[BoneId]) -> impl Iterator<Item = BoneId> {
    let mut seen = BTreeSet::new();
    bones.iter().copied().filter(move |bone| seen.insert(*bone))
}

/// The bones given and all their ancestors.
fn with_ancestors<'a>(skeleton: &Skeleton, bones: impl Iterator<Item = &'a BoneId>) -> Vec<BoneId> {
    let mut bones_and_ancestors = BTreeSet::new();
    for &bone in bones {
        let mut next = Some(bone);
        while let Some(bone) = next.filter(|bone| bones_and_ancestors.insert(*bone)) {
            let entry = skeleton.bones().get(bone.index());
            next = entry.and_then(|entry| entry.parent);
        }
    }
    bones_and_ancestors.into_iter().collect()
}
