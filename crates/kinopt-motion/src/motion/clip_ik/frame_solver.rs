//! Solver of one frame: end effectors at their targets, all other joints as close to the clip as possible.

use glam::DVec3;

use super::ClipIkError;
use super::posed_bones::PosedBones;
use kinopt_animation::animation::{Armature, Corrected, Pose, ShearCorrection};
use kinopt_kinematics::kinematics::{Tree, TreeWorkspace};
use kinopt_kinematics::skeleton::BoneId;
use kinopt_kinematics::spatial::{Matrix3, Vector3};
use kinopt_solver::ik::{Restarts, Solver, Workspace};
use kinopt_solver::problem::{Problem, ProblemInstance, Targets, TaskId};
use kinopt_solver::task::{Orientation, Point, Posture, Quantity, Task};

/// Tolerance of the end effectors, in lengths of the longest limb: the resolution of single precision.
const TOLERANCE_RATIO: f64 = 1e-6;
/// Weight of a foot's orientation in the model relative to the posture of the joints.
const ORIENTATION_WEIGHT: f64 = 10.0;

/// Solver of frames. Each frame starts from the pose of the clip, so frames do not depend on each other.
#[derive(Debug)]
pub(super) struct FrameSolver {
    problem: Problem,
    targets: Targets,
    tree: Tree,
    tree_workspace: TreeWorkspace,
    /// Bones of `points`, in the same order.
    effectors: Vec<BoneId>,
    points: Vec<TaskId<Point>>,
    /// Bones that keep their orientation.
    orientations: Vec<(BoneId, TaskId<Orientation>)>,
    posture: TaskId<Posture>,
    /// Tolerance of an effector after shear correction, in the armature's unit of length.
    tolerance: f64,
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
        let (mut points, mut orientations, mut effector_bones) =
            (Vec::new(), Vec::new(), Vec::new());
        for &(bone, keeps_orientation) in effectors {
            let Some(frame) = bones.frame(bone) else {
                continue;
            };
            points.push(builder.add(Point::new(frame, [0.0; 3])));
            effector_bones.push(bone);
            if keeps_orientation {
                let orientation = Orientation::new(frame, Matrix3::identity());
                orientations.push((
                    bone,
                    builder.add(
                        Task::new(orientation)
                            .scale(ORIENTATION_WEIGHT)
                            .preference(),
                    ),
                ));
            }
        }
        let posture = builder.add(Posture::new(model, &q));
        if longest > 0.0 {
            builder.tolerance(Quantity::Metres, TOLERANCE_RATIO * longest);
        }
        let problem = builder.build()?;
        Ok(Self {
            targets: problem.targets(),
            tree: problem.tree().clone(),
            tree_workspace: TreeWorkspace::default(),
            problem,
            effectors: effector_bones,
            points,
            orientations,
            posture,
            tolerance: TOLERANCE_RATIO * longest,
            solver: Solver::default().with_restarts(Restarts::none()),
            workspace: Workspace::new(),
            q,
        })
    }

    /// Brings the effectors to `positions`, which are in the order of the effectors, with the root displaced by
    /// `moved`. Starts from the pose last taken by `bones` and writes the result to `pose`.
    ///
    /// Non-uniform scales shear bones that rotate below them, which no joint model represents. Such a frame is solved
    /// again from its updated joint positions until these converge.
    pub(super) fn solve(
        &mut self,
        (armature, bones): (&Armature, &mut PosedBones),
        positions: &[DVec3],
        moved: DVec3,
        pose: &mut Pose,
    ) -> Result<(), ClipIkError> {
        bones.place_joints(armature, moved, &mut self.q);
        self.set_points(positions)?;
        for (bone, task) in &self.orientations {
            self.targets
                .get_mut(*task)?
                .set_target(bones.orientation(*bone));
        }
        self.targets.get_mut(self.posture)?.set_reference(&self.q)?;
        self.solve_placed(bones)?;
        bones.pose(&self.q, moved, armature, pose);
        if bones.is_sheared() {
            self.correct((armature, bones), positions, moved, pose)?;
        }
        Ok(())
    }

    /// Solves again from a sheared pose until the effectors of the posed bones are at their targets.
    fn correct(
        &mut self,
        (armature, bones): (&Armature, &mut PosedBones),
        positions: &[DVec3],
        moved: DVec3,
        pose: &mut Pose,
    ) -> Result<(), ClipIkError> {
        let effectors = self.effectors.clone();
        let positions_of = |bones: &PosedBones| -> Vec<DVec3> {
            effectors
                .iter()
                .map(|bone| bones.effector_position(*bone))
                .collect()
        };
        bones.place_bones(pose);
        let mut correction = ShearCorrection::new(positions, &positions_of(bones));
        let mut nearest = pose.clone();
        let mut before = pose.clone();
        while !(correction.off() <= self.tolerance || correction.gives_up()) {
            // The pose already contains the displacement of the root.
            bones.place_joints(armature, DVec3::ZERO, &mut self.q);
            self.set_points(&correction.commands())?;
            let reached = self.solve_placed(bones)?;
            bones.pose(&self.q, moved, armature, pose);
            bones.place_bones(pose);
            let corrected = correction.learn(&positions_of(bones), reached);
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

    fn set_points(&mut self, positions: &[DVec3]) -> Result<(), ClipIkError> {
        for (point, position) in self.points.iter().zip(positions) {
            let position = Vector3::from(position.to_array());
            self.targets.get_mut(*point)?.set_target(position);
        }
        Ok(())
    }

    /// Solves from `q` with the joints at the current placements of the bones. Returns whether the effectors reached
    /// their targets.
    fn solve_placed(&mut self, bones: &PosedBones) -> Result<bool, ClipIkError> {
        self.tree.compile(
            bones.model(),
            self.problem.parameters(),
            &mut self.tree_workspace,
        );
        let instance = ProblemInstance::from(&self.problem);
        let instance = instance.with_targets(&self.targets).with_tree(&self.tree);
        let solution = self.solver.solve(instance, &self.q, &mut self.workspace)?;
        self.q.copy_from_slice(&solution.q);
        Ok(solution.reached)
    }
}
