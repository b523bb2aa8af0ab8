//! Solutions from the results of argmin runs.

use std::collections::HashMap;

use argmin::core::{OptimizationResult, State, TerminationReason, TerminationStatus};
use argmin::solver::particleswarm::Particle;
use nalgebra::DVector;

use super::error::BridgeError;
use super::pool::{EvaluationBuffers, Pool};
use kinopt_solver::ik::Solution;
use kinopt_solver::problem::{Evaluation, ProblemInstance, TaskSubset};
use kinopt_solver::search::End;
use kinopt_solver::solver::{Counts, LeastSquares, SolverState, Stopping, Termination};

/// Parameters of an argmin state: a vector, or a particle of a swarm.
pub trait StateParameters {
    /// Variables of the point.
    fn coordinates(&self) -> &DVector<f64>;
}

impl StateParameters for DVector<f64> {
    fn coordinates(&self) -> &DVector<f64> {
        self
    }
}

impl StateParameters for Particle<DVector<f64>, f64> {
    fn coordinates(&self) -> &DVector<f64> {
        &self.position
    }
}

/// Solution at the best point of a run; `variables` converts its parameters to the problem's variables.
pub(super) fn solution_of<O, S, I>(
    (instance, pool): (ProblemInstance<'_>, &Pool),
    run: &OptimizationResult<O, S, I>,
    variables: impl FnOnce(&DVector<f64>) -> Vec<f64>,
) -> Result<Solution, BridgeError>
where
    I: State<Float = f64>,
    I::Param: StateParameters,
{
    let state = run.state();
    let best = state.get_best_param().or_else(|| state.get_param());
    let best = best.ok_or(BridgeError::NoParameters)?.coordinates();
    BridgeError::check_variables(best.len(), instance.variables())?;
    let run = Some((state, &run.problem.counts));
    Ok(solution_at(instance, pool, &variables(best), run))
}

/// Projects x, evaluates it, and returns the solution there.
///
/// `run` is the state and the evaluations of a run, or `None` for one that failed at its start.
pub(super) fn solution_at<I: State>(
    instance: ProblemInstance<'_>,
    pool: &Pool,
    x: &[f64],
    run: Option<(&I, &HashMap<&'static str, u64>)>,
) -> Solution {
    pool.with(instance, |buffers| {
        let EvaluationBuffers {
            scratch,
            x: projected_x,
            residual,
            ..
        } = buffers;
        projected_x.copy_from_slice(x);
        instance.space().project(projected_x);
        Evaluation::new(instance, scratch).residual(projected_x, residual);
        let end = End {
            question: instance,
            x: projected_x,
            share: TaskSubset::All,
            searched: residual,
            residual,
        };
        let mut solution = Solution::default();
        let memory = &mut SolverState::default();
        // The default test of kinopt's solvers decides if a start is the optimum.
        let slope = solution.measure(&end, &Stopping::default(), scratch, memory);
        solution.attempts = 1;
        if let Some((state, counts)) = run {
            solution.iterations = usize::try_from(state.get_iter()).unwrap_or(usize::MAX);
            solution.counts = counts_from(counts);
        }
        let is_finite = |norm: f64| norm.is_finite();
        let is_finite =
            solution.cost.is_finite() && solution.projected_gradient.is_none_or(is_finite);
        let is_finished = solution.reached && !instance.problem().has_preferences();
        solution.termination = match run.map(|(state, _)| state.get_termination_status()) {
            _ if !is_finite => Termination::NonFinite,
            Some(status) => termination_of(status, is_finished),
            None if is_finished => Termination::Reached,
            None if slope.is_some_and(|slope| slope.is_level) => Termination::Stationary,
            None => Termination::SmallStep,
        };
        solution.check_collisions(instance);
        solution
    })
}

/// Returns true if a run failed at its start because nothing was left to improve.
pub(super) fn is_finished_at(solution: &Solution) -> bool {
    matches!(
        solution.termination,
        Termination::Reached | Termination::Stationary
    )
}

fn counts_from(counts: &HashMap<&'static str, u64>) -> Counts {
    let count = |name: &str| {
        let count = counts.get(name).copied().unwrap_or(0);
        usize::try_from(count).unwrap_or(usize::MAX)
    };
    Counts {
        residuals: count("cost_count") + count("operator_count"),
        jacobians: count("jacobian_count") + count("hessian_count"),
        gradients: count("gradient_count"),
    }
}

/// Converts argmin's reasons. `is_finished` is true if the goals are reached and there are no soft tasks.
fn termination_of(status: &TerminationStatus, is_finished: bool) -> Termination {
    let reason = match status {
        // From a run that was interrupted.
        TerminationStatus::NotTerminated => return Termination::Cancelled,
        TerminationStatus::Terminated(reason) => reason,
    };
    match reason {
        TerminationReason::MaxItersReached => Termination::IterationLimit,
        TerminationReason::Timeout => Termination::TimeLimit,
        TerminationReason::Interrupt => Termination::Cancelled,
        _ if is_finished => Termination::Reached,
        TerminationReason::SolverConverged => Termination::Stationary,
        // A target cost of the caller, unrelated to the tolerances.
        TerminationReason::TargetCostReached => Termination::Cancelled,
        TerminationReason::SolverExit(text) if text == Termination::NonFinite.name() => {
            Termination::NonFinite
        }
        // A line search without an acceptable step, of kinopt or of argmin.
        TerminationReason::SolverExit(_) => Termination::SmallStep,
    }
}
