//! One frame: effectors brought to where they should be, the rest as near to the clip as that allows.

use glam::DVec3;

use super::ClipIkError;
use super::posed_bones::PosedBones;
use crate::animation::{Armature, Corrected, Pose, ShearCorrection};
use crate::ik::{Restarts, Solver, Workspace};
use crate::kinematics::{Tree, TreeWorkspace};
use crate::problem::{Problem, ProblemInstance, Targets, TaskId};
use crate::skeleton::BoneId;
use crate::spatial::{Matrix3, Vector3};
use crate::task::{Orientation, Point, Posture, Quantity, Task};

/// Effectors count as there within this share of the longest limb: what single precision can hold.
const TOLERANCE: f64 = 1e-6;
/// How much more a foot keeps its turn in the model than joints keep theirs.
const KEPT_TURN: f64 = 10.0;

/// Solves frames one by one, each from the clip's own pose, so that frames do not depend on each other.
#[derive(Debug)]
pub(super) struct FrameSolver {
    problem: Problem,
    targets: Targets,
    tree: Tree,
    places: TreeWorkspace,
    /// The bones of the points.
    effectors: Vec<BoneId>,
    points: Vec<TaskId<Point>>,
    /// Of those that keep their turn.
    turns: Vec<(BoneId, TaskId<Orientation>)>,
    posture: TaskId<Posture>,
    /// Distance at which a corrected effector is there.
    close: f64,
    solver: Solver,
    workspace: Workspace,
    q: Vec<f64>,
}

impl FrameSolver {
    /// For effectors, of which some keep how they are turned, on limbs of this length.
    pub(super) fn new(
        bones: &PosedBones,
        effectors: &[(BoneId, bool)],
        longest: f64,
    ) -> Result<Self, ClipIkError> {
        let model = bones.model();
        let q = model.neutral();
        let mut builder = Problem::builder(model);
        let (mut points, mut turns, mut own) = (Vec::new(), Vec::new(), Vec::new());
        for &(bone, keeps_turn) in effectors {
            let Some(frame) = bones.frame(bone) else {
                continue;
            };
            points.push(builder.add(Point::new(frame, [0.0; 3])));
            own.push(bone);
            if keeps_turn {
                let kept = Orientation::new(frame, Matrix3::identity());
                turns.push((
                    bone,
                    builder.add(Task::new(kept).scale(KEPT_TURN).preference()),
                ));
            }
        }
        let posture = builder.add(Posture::new(model, &q));
        if longest > 0.0 {
            builder.tolerance(Quantity::Metres, TOLERANCE * longest);
        }
        let problem = builder.build()?;
        Ok(Self {
            targets: problem.targets(),
            tree: problem.tree().clone(),
            places: TreeWorkspace::default(),
            problem,
            effectors: own,
            points,
            turns,
            posture,
            close: TOLERANCE * longest,
            solver: Solver::default().with_restarts(Restarts::none()),
            workspace: Workspace::new(),
            q,
        })
    }

    /// Brings the effectors, in their order, to `places`, with the root moved by `moved`, from the pose that the bones have
    /// last taken, and writes it into that pose.
    ///
    /// Uneven scales shear the bones that turn below them, which no joint does. Such a frame is solved again with its joints
    /// at their new positions until they stay.
    pub(super) fn solve(
        &mut self,
        (armature, bones): (&Armature, &mut PosedBones),
        places: &[DVec3],
        moved: DVec3,
        pose: &mut Pose,
    ) -> Result<(), ClipIkError> {
        bones.stand(armature, moved, &mut self.q);
        self.set_points(places)?;
        for (bone, turn) in &self.turns {
            self.targets.get_mut(*turn)?.set_target(bones.turn(*bone));
        }
        self.targets.get_mut(self.posture)?.set_reference(&self.q)?;
        self.solve_placed(bones)?;
        bones.pose(&self.q, moved, armature, pose);
        if bones.shear() {
            self.correct((armature, bones), places, moved, pose)?;
        }
        Ok(())
    }

    /// Solves again from a pose whose bones scales shear until the effectors of the posed bones are at their places.
    fn correct(
        &mut self,
        (armature, bones): (&Armature, &mut PosedBones),
        places: &[DVec3],
        moved: DVec3,
        pose: &mut Pose,
    ) -> Result<(), ClipIkError> {
        let effectors = self.effectors.clone();
        let shown = |bones: &PosedBones| -> Vec<DVec3> {
            effectors.iter().map(|bone| bones.place(*bone)).collect()
        };
        bones.place_bones(pose);
        let mut correction = ShearCorrection::new(places, &shown(bones));
        let mut nearest = pose.clone();
        let mut before = pose.clone();
        while !(correction.off() <= self.close || correction.gives_up()) {
            // The pose has the root where it moved.
            bones.stand(armature, DVec3::ZERO, &mut self.q);
            self.set_points(&correction.commands())?;
            let reached = self.solve_placed(bones)?;
            bones.pose(&self.q, moved, armature, pose);
            bones.place_bones(pose);
            let corrected = correction.learn(&shown(bones), reached);
            if corrected == Corrected::Undone {
                pose.copy_from(&before);
                bones.place_bones(pose);
                continue;
            }
            before.copy_from(pose);
            if corrected == Corrected::Nearest {
                nearest.copy_from(pose);
            }
        }
        pose.copy_from(&nearest);
        Ok(())
    }

    fn set_points(&mut self, places: &[DVec3]) -> Result<(), ClipIkError> {
        for (point, place) in self.points.iter().zip(places) {
            let place = Vector3::from(place.to_array());
            self.targets.get_mut(*point)?.set_target(place);
        }
        Ok(())
    }

    /// Solves from `q` with the joints where the bones are placed. Returns whether the effectors are there.
    fn solve_placed(&mut self, bones: &PosedBones) -> Result<bool, ClipIkError> {
        self.tree
            .compile(bones.model(), self.problem.parameters(), &mut self.places);
        let question = ProblemInstance::from(&self.problem);
        let question = question.with_targets(&self.targets).with_places(&self.tree);
        let solution = self.solver.solve(question, &self.q, &mut self.workspace)?;
        self.q.copy_from_slice(&solution.q);
        Ok(solution.reached)
    }
}
