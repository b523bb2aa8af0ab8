//! Results of a query: errors, cost and the recorded solution.

use super::arm::Arm;
use super::workspace::{ArmWorkspace, Errors};
use crate::simd_ik::PoseOutcome;
use kinopt_kinematics::scalar::elementary;
use kinopt_solver::ik::{RowBlockReport, Solution};
use kinopt_solver::search::SearchResult;
use kinopt_solver::solver::{Counts, Termination};
use kinopt_solver::task::Quantity;

/// Search result of the SIMD solver's attempts. An unreached one has the termination `Stalled`.
pub(super) fn result_of(arm: &Arm, outcome: &PoseOutcome) -> SearchResult {
    SearchResult {
        termination: match outcome.reached {
            true => Termination::Reached,
            false => Termination::Stalled,
        },
        number: outcome.winner.unwrap_or(0) as usize,
        cost: cost_of(arm, Errors::of(outcome)),
        reached: outcome.reached,
        iterations: outcome.iterations as usize,
        attempts: outcome.attempts as usize,
        ..SearchResult::default()
    }
}

/// Updates the result with the cost and errors at the workspace's x.
pub(super) fn judge(arm: &Arm, workspace: &mut ArmWorkspace, result: &mut SearchResult) {
    let errors = workspace.judge_x();
    (result.cost, result.reached) = (cost_of(arm, errors), errors.reached);
}

/// Half the sum of the squared errors, m²; radians convert by `metres_per_radian`.
pub(super) fn cost_of(arm: &Arm, errors: Errors) -> f64 {
    // For goals with bounds, the cost has the chord of the angle.
    let chord = match arm.options.goal.is_full_pose() {
        true => errors.orientation,
        false => 2.0 * elementary::sin(0.5 * errors.orientation),
    };
    let chord = chord * arm.options.metres_per_radian;
    0.5 * (errors.position * errors.position + chord * chord)
}

/// Records the search result and the errors, without `q` and active limits.
pub(super) fn record(arm: &Arm, result: &SearchResult, errors: Errors, solution: &mut Solution) {
    let options = &arm.options;
    let metres = RowBlockReport::of_goal(
        Quantity::Metres,
        errors.position,
        options.position_tolerance,
    );
    let orientation_tolerance = options.orientation_tolerance;
    let radians =
        RowBlockReport::of_goal(Quantity::Radians, errors.orientation, orientation_tolerance);
    let metres = options.goal.has_position().then_some(metres);
    let radians = options.goal.has_orientation().then_some(radians);
    solution.record_errors(&arm.names, metres.into_iter().chain(radians));
    solution.cost = result.cost;
    solution.record(&SearchResult {
        // An iteration evaluates one residual and one Jacobian, in both solvers.
        counts: Counts {
            residuals: result.iterations,
            jacobians: result.iterations,
            gradients: 0,
        },
        projected_gradient: None,
        agreeing: 0,
        ..*result
    });
}

/// Records all results at the workspace's configuration; of an unreached one also the active limits.
pub(super) fn record_configuration(
    arm: &Arm,
    result: &SearchResult,
    workspace: &mut ArmWorkspace,
    solution: &mut Solution,
) {
    workspace.x.clone_into(&mut solution.q);
    record(arm, result, workspace.errors, solution);
    if !solution.reached {
        let negligible = workspace.compute_gradient();
        let (x, question) = (&workspace.x, workspace.question.instance());
        solution.record_active_limits(question, x, &workspace.gradient, negligible);
        solution.projected_gradient = Some(workspace.projected_gradient(x));
        solution.find_out_of_reach(question);
    }
}

/// Outcome of a query as the SIMD solver reports it.
pub(super) fn outcome_of(result: &SearchResult, errors: Errors) -> PoseOutcome {
    let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    PoseOutcome {
        reached: result.reached,
        position_error: errors.position,
        orientation_error: errors.orientation,
        iterations: count(result.iterations),
        attempts: count(result.attempts),
        winner: result.reached.then(|| count(result.number)),
    }
}
