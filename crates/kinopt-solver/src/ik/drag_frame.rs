//! Problem instance of a frame of a drag, and its solve.

use super::placement_relaxation::Relaxation;
use super::solver::Run;
use super::{MoveLimits, Solver, Workspace};
use crate::problem::{Problem, ProblemInstance, Targets};
use crate::solver::Silent;
use kinopt_kinematics::kinematics::{Tree, TreeWorkspace};
use kinopt_kinematics::model::Model;

/// Number of consecutive frames that settle without reaching, per perturbation. A perturbation distinguishes a minimum
/// from a saddle point, such as a stretched arm whose target moves back along it.
pub(super) const FRAMES_PER_PERTURBATION: usize = 4;
/// Largest joint displacement of a frame at rest, radians.
pub(super) const MAX_REST_MOVE: f64 = 1e-6;

/// Returns the problem instance of a frame: current targets, within the bounds of the frame.
pub(super) fn frame_instance<'a>(
    problem: &'a Problem,
    targets: &'a Targets,
    moves: &'a MoveLimits,
    moved: &'a MovedJoints,
) -> ProblemInstance<'a> {
    moved.instance(problem, targets).near(moves)
}

/// Kinematics of a drag whose joints have moved on their parents.
#[derive(Clone, Debug, Default)]
pub(super) struct MovedJoints(Option<Box<MovedTree>>);

#[derive(Clone, Debug)]
struct MovedTree {
    tree: Tree,
    workspace: TreeWorkspace,
    relaxation: Relaxation,
}

impl MovedJoints {
    /// Moves joints and frames to their placements in a model with the joints of the problem's model. Moves them part of
    /// the way if placements oscillate.
    pub(super) fn follow_placements(&mut self, problem: &Problem, model: &Model) {
        let moved = self.0.get_or_insert_with(|| {
            Box::new(MovedTree {
                tree: problem.tree().clone(),
                workspace: TreeWorkspace::default(),
                relaxation: Relaxation::default(),
            })
        });
        let relaxed = moved.relaxation.relaxed(model);
        let model = relaxed.as_ref().unwrap_or(model);
        (moved.tree).compile(model, problem.parameters(), &mut moved.workspace);
    }

    /// Starts a new sequence of placements. The next ones are used as they are.
    pub(super) fn restart(&mut self) {
        if let Some(moved) = &mut self.0 {
            moved.relaxation = Relaxation::default();
        }
    }

    /// Returns whether joints have moved on their parents.
    pub(super) fn has_moved(&self) -> bool {
        self.0.is_some()
    }

    /// Returns the problem with these targets and joint placements.
    pub(super) fn instance<'a>(
        &'a self,
        problem: &'a Problem,
        targets: &'a Targets,
    ) -> ProblemInstance<'a> {
        let instance = ProblemInstance::from(problem).with_targets(targets);
        match &self.0 {
            Some(moved) => instance.with_tree(&moved.tree),
            None => instance,
        }
    }
}

/// Solves from a start of the right length. If the solution is not finite, for example because of a user-defined
/// residual, the previous solution is kept.
pub(super) fn solve(
    solver: &Solver,
    instance: ProblemInstance<'_>,
    from: &[f64],
    workspace: &mut Workspace,
) {
    let mut run = Run {
        deadline: solver.stopping().deadline(),
        observer: &mut Silent,
        guard: None,
        clear: None,
    };
    let solved = solver.run(instance, from, workspace, &mut run);
    debug_assert!(solved.is_ok(), "a start of its own that does not fit");
}
