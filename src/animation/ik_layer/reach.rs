//! Any number of tips of a skeleton brought to points, and bones turned, by the optimiser, after
//! sampling.

use std::collections::BTreeSet;

use glam::DVec3;

use super::held_rotation::Held;
use super::pose_angles::EulerPoseMap;
use super::reach_error::ReachError;
use super::shear_correction::{Corrected, ShearCorrection};
use super::stance::Stances;
use crate::animation::{Pose, SizeMismatch};
use crate::ik::{Restarts, Solution, Solver, Workspace};
use crate::kinematics::{Tree, TreeWorkspace};
use crate::model::UnknownName;
use crate::problem::{Problem, ProblemError, ProblemInstance, Targets, TaskId};
use crate::skeleton::{BoneId, Skeleton};
use crate::solver::Stopping;
use crate::spatial::{Quaternion, Vector3};
use crate::task::{Point, Quantity};

/// Tips count as there within this share of the skeleton's size: what single precision can hold.
const TOLERANCE: f64 = 1e-6;

/// Inverse kinematics over an animated pose: tasks for the tips of bones, each with a weight, on top
/// of the pose that clips gave. Slower than a [`Limb`](super::Limb), but for any bones, with joint
/// limits, and several tips that share a spine. The search starts at the clip's pose, so what does not
/// help a tip stays. Joints stand where the pose's own translations and scales put them, so that what
/// the solution says of a tip is what the posed bones show: W (ℓ, 0, 0) for a bone of length ℓ.
///
/// Uneven scales shear the bones that turn below them, which no joint does. Such a pose is solved again with its joints at
/// their new positions until the tips of the posed bones are at their targets. The solution is that of the posed bones
/// also where this does not converge.
#[derive(Clone, Debug)]
pub struct ReachLayer {
    bridge: EulerPoseMap,
    stances: Stances,
    problem: Problem,
    targets: Targets,
    /// The problem's joints where the pose has them.
    tree: Tree,
    places: TreeWorkspace,
    effectors: Vec<Effector>,
    held: Vec<Held>,
    /// Those that the tasks move, by index.
    moved: Vec<BoneId>,
    solver: Solver,
    /// The solver of corrections: from where the last solve ended.
    correction: Solver,
    /// Measures a pose and does not move it.
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
    /// Where the weight has it.
    goal: Vector3<f64>,
}

/// A bone that the layer has no such task for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", UnknownName::new("effector of the layer", bone, effectors.iter().map(String::as_str)))]
#[non_exhaustive]
pub struct NoEffector {
    /// The bone asked for.
    pub bone: String,
    /// The bones that are.
    pub effectors: Vec<String>,
}

/// A solve of one pose: the first, one after a correction of shear, or one that only measures.
#[derive(Clone, Copy, Debug)]
enum Pass {
    First,
    Correction,
    Measurement,
}

impl ReachLayer {
    /// A layer for the tips of these bones, all with weight 0 at first. A bone named twice counts once.
    ///
    /// # Errors
    /// As [`ProblemBuilder::build`](crate::problem::ProblemBuilder::build): no bones, or one of another
    /// skeleton.
    pub fn new(skeleton: &Skeleton, tips: &[BoneId], solver: Solver) -> Result<Self, ProblemError> {
        Self::holding(skeleton, tips, &[], solver)
    }

    /// A layer for the tips of these bones, which also holds some bones turned in the model as the clip
    /// has them, or turns them as [asked](Self::set_rotation): hands, feet, a head.
    ///
    /// # Errors
    /// As [`ProblemBuilder::build`](crate::problem::ProblemBuilder::build).
    pub fn holding(
        skeleton: &Skeleton,
        tips: &[BoneId],
        held: &[BoneId],
        solver: Solver,
    ) -> Result<Self, ProblemError> {
        let rest = skeleton.model().neutral();
        let mut builder = Problem::builder(skeleton.model());
        let effectors = once(tips).map(|bone| Effector {
            bone,
            task: builder.add(Point::new(skeleton.tip(bone), Vector3::zero())),
            target: Vector3::zero(),
            weight: 0.0,
            goal: Vector3::zero(),
        });
        let effectors = effectors.collect();
        let turned = once(held).map(|bone| Held::new(skeleton, bone, &mut builder));
        let turned = turned.collect();
        let size = skeleton.size();
        if size > 0.0 {
            builder.tolerance(Quantity::Metres, TOLERANCE * size);
        }
        let problem = builder.build()?;
        let moved = above(skeleton, tips.iter().chain(held));
        let correction = solver.clone().with_restarts(Restarts::none());
        let no_steps = Stopping::default().with_max_iterations(0);
        Ok(Self {
            bridge: EulerPoseMap::new(skeleton),
            targets: problem.targets(),
            tree: problem.tree().clone(),
            problem,
            places: TreeWorkspace::default(),
            stances: Stances::new(skeleton, &moved),
            effectors,
            held: turned,
            moved,
            solver,
            measurement: correction.clone().with_stopping(no_steps),
            correction,
            workspace: Workspace::new(),
            q: rest,
        })
    }

    /// Sets where a bone's tip should be, in model coordinates, and how much of the way it goes: from
    /// 0, where the clip has it, to 1, the target. The weight is taken into [0, 1]; NaN counts as 0.
    ///
    /// # Errors
    /// A bone that is none of the layer's; the error lists them. A target that is not finite: the last one stays.
    pub fn set_goal(
        &mut self,
        bone: BoneId,
        target: impl Into<Vector3<f64>>,
        weight: f64,
    ) -> Result<(), ReachError> {
        let target = target.into();
        let own = self.effectors.iter_mut().find(|own| own.bone == bone);
        if let Some(own) = own {
            if !target.to_array().into_iter().all(f64::is_finite) {
                return Err(self.not_finite(bone, "target is not finite"));
            }
            own.target = target;
            own.weight = share(weight);
            return Ok(());
        }
        let effectors = self.effectors.iter().map(|own| own.bone);
        Err(self.none_of(bone, effectors).into())
    }

    /// Sets how a held bone should be turned in the model, and how much of the way it goes there by the
    /// shortest arc: from 0, as the clip has it, to 1. The weight is taken into [0, 1]; NaN counts as
    /// 0. The quaternion may be of any length.
    ///
    /// # Errors
    /// A bone that the layer does not hold; the error lists those that it does. A quaternion of length 0 or not
    /// finite: the last one stays.
    pub fn set_rotation(
        &mut self,
        bone: BoneId,
        rotation: impl Into<Quaternion<f64>>,
        weight: f64,
    ) -> Result<(), ReachError> {
        let own = self.held.iter_mut().find(|own| own.bone == bone);
        if let Some(own) = own {
            return match own.set(rotation.into(), share(weight)) {
                true => Ok(()),
                false => Err(self.not_finite(bone, "rotation is of length 0 or not finite")),
            };
        }
        let held = self.held.iter().map(|own| own.bone);
        Err(self.none_of(bone, held).into())
    }

    fn not_finite(&self, bone: BoneId, what: &'static str) -> ReachError {
        let bone = self.none_of(bone, std::iter::empty()).bone;
        ReachError::NotFinite { bone, what }
    }

    fn none_of(&self, bone: BoneId, others: impl Iterator<Item = BoneId>) -> NoEffector {
        let name = |bone: BoneId| {
            let bones = self.stances.skeleton().bones();
            let bone = bones.get(bone.index()).map(|bone| bone.name.clone());
            bone.unwrap_or_default()
        };
        NoEffector {
            bone: name(bone),
            effectors: others.map(name).collect(),
        }
    }

    /// Turns the bones of a pose so that the tips go their weights' shares of the way to their
    /// targets, within the joints' limits. All tips and held bones are tasks: one with weight 0 stays
    /// where the clip has it. Bones that none of them hangs on are left as they are; with all weights 0
    /// all are, also outside the limits.
    ///
    /// # Errors
    /// The pose has another number of bones than the skeleton; the pose stays as it is. Missing a target is no error; the
    /// solution says by how much.
    pub fn apply(&mut self, pose: &mut Pose) -> Result<Option<&Solution>, ReachError> {
        let bones = self.stances.skeleton().bones();
        SizeMismatch::check("bones in the pose", pose.bones(), bones.len())?;
        let weights = self.effectors.iter().map(|own| own.weight);
        let mut weights = weights.chain(self.held.iter().map(|own| own.weight));
        if weights.all(|weight| weight == 0.0) {
            return Ok(None);
        }
        self.bridge.angles_of(pose, &mut self.q)?;
        self.stances.take(pose, &self.moved);
        self.aim();
        self.solve(Pass::First, pose)?;
        if self.stances.shear() {
            self.correct(pose)?;
        }
        Ok(Some(self.workspace.solution()))
    }

    /// Sets the targets of the tasks by the pose last taken.
    fn aim(&mut self) {
        for own in &mut self.effectors {
            if let Some(stance) = self.stances.of(own.bone) {
                let tip = Vector3::from(stance.tip.to_array());
                own.goal = tip * (1.0 - own.weight) + own.target * own.weight;
                if let Ok(task) = self.targets.get_mut(own.task) {
                    task.set_target(own.goal);
                }
            }
        }
        for own in &self.held {
            let stance = self.stances.of(own.bone);
            if let Some((stance, task)) = stance.zip(self.targets.get_mut(own.task).ok()) {
                task.set_target(own.target(stance.rotation));
            }
        }
    }

    /// Solves from `q` with the joints where the pose last taken has them, and turns the bones of `pose`.
    fn solve(&mut self, pass: Pass, pose: &mut Pose) -> Result<(), ReachError> {
        let solver = match pass {
            Pass::First => &self.solver,
            Pass::Correction => &self.correction,
            Pass::Measurement => &self.measurement,
        };
        let (model, map) = (self.stances.skeleton().model(), self.problem.parameters());
        self.tree.compile(model, map, &mut self.places);
        let question = ProblemInstance::from(&self.problem);
        let question = question.with_targets(&self.targets).with_places(&self.tree);
        let solution = solver.solve(question, &self.q, &mut self.workspace)?;
        self.q.copy_from_slice(&solution.q);
        for &bone in &self.moved {
            self.bridge.pose_bone(bone, &self.q, pose);
        }
        Ok(())
    }

    /// Solves again from a pose whose bones scales shear until the tips of the posed bones are at their goals, and measures
    /// them there.
    fn correct(&mut self, pose: &mut Pose) -> Result<(), ReachError> {
        let goals = |own: &Effector| DVec3::from(own.goal.to_array());
        let goals: Vec<DVec3> = self.effectors.iter().map(goals).collect();
        let close = TOLERANCE * self.stances.skeleton().size();
        self.stances.take(pose, &self.moved);
        let mut correction = ShearCorrection::new(&goals, &self.tips());
        let mut nearest = (pose.clone(), self.q.clone());
        let mut before = nearest.clone();
        let mut is_cut = self.workspace.solution().termination.is_cut();
        while !(is_cut || correction.off() <= close || correction.gives_up()) {
            self.set_tips(&correction.commands());
            self.solve(Pass::Correction, pose)?;
            let solution = self.workspace.solution();
            is_cut = solution.termination.is_cut();
            let reached = solution.reached;
            self.stances.take(pose, &self.moved);
            let corrected = correction.learn(&self.tips(), reached);
            if corrected == Corrected::Undone {
                pose.copy_from(&before.0);
                self.q.copy_from_slice(&before.1);
                self.stances.take(pose, &self.moved);
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
        self.stances.take(pose, &self.moved);
        self.set_tips(&goals);
        self.solve(Pass::Measurement, pose)
    }

    /// The tips of the effectors in the pose last taken.
    fn tips(&self) -> Vec<DVec3> {
        let stances = self.effectors.iter().map(|own| self.stances.of(own.bone));
        stances
            .map(|own| own.map_or(DVec3::ZERO, |own| own.tip))
            .collect()
    }

    fn set_tips(&mut self, tips: &[DVec3]) {
        for (own, tip) in self.effectors.iter().zip(tips) {
            if let Ok(task) = self.targets.get_mut(own.task) {
                task.set_target(Vector3::from(tip.to_array()));
            }
        }
    }
}

/// A weight that animates, within [0, 1].
fn share(weight: f64) -> f64 {
    if weight > 0.0 { weight.min(1.0) } else { 0.0 }
}

/// Each bone once, in the order in which they are first named.
fn once(bones: &[BoneId]) -> impl Iterator<Item = BoneId> {
    let mut seen = BTreeSet::new();
    bones.iter().copied().filter(move |bone| seen.insert(*bone))
}

/// The bones given and all that they hang on.
fn above<'a>(skeleton: &Skeleton, bones: impl Iterator<Item = &'a BoneId>) -> Vec<BoneId> {
    let mut found = BTreeSet::new();
    for &bone in bones {
        let mut next = Some(bone);
        while let Some(bone) = next.filter(|bone| found.insert(*bone)) {
            let own = skeleton.bones().get(bone.index());
            next = own.and_then(|own| own.parent);
        }
    }
    found.into_iter().collect()
}
