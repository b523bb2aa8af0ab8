//! Solver of one frame: end effectors at their targets, all other joints as close to the clip as possible.

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

/// Tolerance of the end effectors, in lengths of the longest limb: the resolution of single precision.
const TOLERANCE: f64 = 1e-6;
/// Weight of a foot's orientation in the model relative to the posture of the joints.
const KEPT_TURN: f64 = 10.0;

/// Solver of frames. Each frame starts from the pose of the clip, so frames do not depend on each other.
#[derive(Debug)]
pub(super) struct FrameSolver {
    problem: Problem,
    targets: Targets,
    tree: Tree,
    places: TreeWorkspace,
    /// Bones of `points`, in the same order.
    effectors: Vec<BoneId>,
    points: Vec<TaskId<Point>>,
    /// Bones that keep their orientation.
    turns: Vec<(BoneId, TaskId<Orientation>)>,
    posture: TaskId<Posture>,
    /// Tolerance of an effector after shear correction, in the armature's unit of length.
    close: f64,
    solver: Solver,
    workspace: Workspace,
    q: Vec<f64>,
}

impl FrameSolver {
    /// Creates a solver. `effectors` has each bone and whether it keeps its orientation; `longest` is the length of the
    /// longest limb.
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

    /// Brings the effectors to `places`, which are in the order of the effectors, with the root displaced by `moved`.
    /// Starts from the pose last taken by `bones` and writes the result to `pose`.
    ///
    /// Non-uniform scales shear bones that rotate below them, which no joint model represents. Such a frame is solved
    /// again from its updated joint positions until these converge.
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

    /// Solves again from a sheared pose until the effectors of the posed bones are at their targets.
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
            // The pose already contains the displacement of the root.
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

    /// Solves from `q` with the joints at the current placements of the bones. Returns whether the effectors reached
    /// their targets.
    fn solve_placed(&mut self, bones: &PosedBones) -> Result<bool, ClipIkError> {
        self.tree
            .compile(bones.model(), self.problem.parameters(), &mut self.places);
        let question = ProblemInstance::from(&self.problem);
        let question = question.with_targets(&self.targets).with_tree(&self.tree);
        let solution = self.solver.solve(question, &self.q, &mut self.workspace)?;
        self.q.copy_from_slice(&solution.q);
        Ok(solution.reached)
    }
}
