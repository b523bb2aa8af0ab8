//! What a frame of a drag asks, and a solve of it.

use super::solver::Run;
use super::{MoveLimits, Solver, Workspace};
use crate::kinematics::{Tree, TreeWorkspace};
use crate::model::Model;
use crate::problem::{Problem, ProblemInstance, Targets};
use crate::solver::Silent;

/// Every so many frames that settle on a miss, a nudge tells a place of rest from a balance: an
/// arm that is stretched out to the bit does not feel a target that comes back along it.
pub(super) const NUDGE_EVERY: usize = 4;
/// A body whose joints move less in a frame rests, in radians.
pub(super) const REST: f64 = 1e-6;

/// What a frame asks: the targets as they are now, within its bounds.
pub(super) fn near<'a>(
    problem: &'a Problem,
    targets: &'a Targets,
    moves: &'a MoveLimits,
    moved: &'a MovedJoints,
) -> ProblemInstance<'a> {
    moved.question(problem, targets).near(moves)
}

/// The kinematics of a drag whose joints moved on their parents.
#[derive(Clone, Debug, Default)]
pub(super) struct MovedJoints(Option<Box<(Tree, TreeWorkspace)>>);

impl MovedJoints {
    /// Takes the positions of joints and frames from a model with the joints of the problem's.
    pub(super) fn take(&mut self, problem: &Problem, model: &Model) {
        let moved = self.0.get_or_insert_with(|| {
            let tree = problem.tree().clone();
            Box::new((tree, TreeWorkspace::default()))
        });
        let (tree, memory) = &mut **moved;
        tree.compile(model, problem.parameters(), memory);
    }

    /// Whether joints moved.
    pub(super) fn any(&self) -> bool {
        self.0.is_some()
    }

    /// The problem with these targets and joints.
    pub(super) fn question<'a>(
        &'a self,
        problem: &'a Problem,
        targets: &'a Targets,
    ) -> ProblemInstance<'a> {
        let question = ProblemInstance::from(problem).with_targets(targets);
        match &self.0 {
            Some(moved) => question.with_places(&moved.0),
            None => question,
        }
    }
}

/// A solve from a start of the right length. Where a number in it is not finite, which a residual of
/// the caller's may bring about, the last solution stays.
pub(super) fn solve(
    solver: &Solver,
    question: ProblemInstance<'_>,
    from: &[f64],
    workspace: &mut Workspace,
) {
    let mut run = Run {
        deadline: solver.stopping().deadline(),
        observer: &mut Silent,
        guard: None,
        clear: None,
    };
    let solved = solver.run(question, from, workspace, &mut run);
    debug_assert!(solved.is_ok(), "a start of its own that does not fit");
}
