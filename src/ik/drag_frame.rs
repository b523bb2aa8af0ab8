//! What a frame of a drag asks, and a solve of it.

use super::solver::Run;
use super::{MoveLimits, Solver, Workspace};
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
) -> ProblemInstance<'a> {
    ProblemInstance::from(problem)
        .with_targets(targets)
        .near(moves)
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
