//! From the end of an argmin run to the truth about it.

use std::collections::HashMap;

use argmin::core::{State, TerminationReason, TerminationStatus};
use argmin::solver::particleswarm::Particle;
use nalgebra::DVector;

use super::pool::Pool;
use crate::ik::{Solution, SolveError, check_start};
use crate::problem::{Evaluation, Question};
use crate::solver::{Counts, LeastSquares, Termination, project, projected_gradient_norm};

/// A start counts as the optimum when the projected gradient is within this share of ‖∇cost‖'s own
/// scale, √(2 · cost) · the largest column norm of J, as in our solvers' default test.
const STATIONARY: f64 = 1e-9;

/// What an argmin state holds as its parameters: a vector, or a particle of a swarm.
pub trait Place {
    /// The variables.
    fn coordinates(&self) -> &DVector<f64>;
}

impl Place for DVector<f64> {
    fn coordinates(&self) -> &DVector<f64> {
        self
    }
}

impl Place for Particle<DVector<f64>, f64> {
    fn coordinates(&self) -> &DVector<f64> {
        &self.position
    }
}

/// The problem's variables of a configuration, within the bounds.
pub(super) fn start_of(question: Question<'_>, q: &[f64]) -> Result<Vec<f64>, SolveError> {
    let problem = question.problem();
    check_start(problem, q)?;
    let mut x = vec![0.0; problem.variables()];
    problem.parameters().reduce(q, &mut x);
    project(&mut x, question.lower(), question.upper());
    Ok(x)
}

/// Projects x, evaluates there, and reports; `run` is the state and the evaluations of a run,
/// `None` for one that failed where it started.
pub(super) fn solution_at<I: State>(
    question: Question<'_>,
    pool: &Pool,
    x: &[f64],
    run: Option<(&I, &HashMap<&'static str, u64>)>,
) -> Solution {
    let problem = question.problem();
    pool.with(question, |buffers| {
        buffers.x.copy_from_slice(x);
        project(&mut buffers.x, question.lower(), question.upper());
        Evaluation::new(question, &mut buffers.scratch).residual(&buffers.x, &mut buffers.residual);
        buffers.differentiate_cost(question);
        let projected_gradient = projected_gradient_norm(
            &buffers.x,
            &buffers.gradient,
            1.0,
            question.lower(),
            question.upper(),
        );

        let mut solution = Solution::default();
        solution.cost = buffers.cost();
        solution.projected_gradient = Some(projected_gradient);
        solution.attempts = 1;
        Evaluation::new(question, &mut buffers.scratch).jacobian(&buffers.x, &mut buffers.jacobian);
        let columns = buffers.jacobian.column_iter();
        let steepest = columns.map(|column| column.norm()).fold(0.0, f64::max);
        let negligible = STATIONARY * steepest * (2.0 * solution.cost).sqrt();
        solution.measure(
            &mut Evaluation::new(question, &mut buffers.scratch),
            &buffers.x,
            &buffers.residual,
            &buffers.gradient,
            negligible,
        );
        if let Some((state, counts)) = run {
            solution.iterations = usize::try_from(state.get_iter()).unwrap_or(usize::MAX);
            solution.counts = counts_from(counts);
        }
        let finished = solution.reached && !problem.has_preferences();
        solution.termination = match run.map(|(state, _)| state.get_termination_status()) {
            _ if !(solution.cost.is_finite() && projected_gradient.is_finite()) => {
                Termination::NonFinite
            }
            Some(status) => termination_of(status, finished),
            None if finished => Termination::Reached,
            None if projected_gradient <= negligible => Termination::Stationary,
            None => Termination::SmallStep,
        };
        solution
    })
}

/// Whether a run that failed where it started failed because there was nothing left to improve.
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

/// argmin's reasons in our words. `finished`: the goals are reached and nothing else is wanted.
fn termination_of(status: &TerminationStatus, finished: bool) -> Termination {
    let reason = match status {
        // Taken from a run that somebody interrupted.
        TerminationStatus::NotTerminated => return Termination::Cancelled,
        TerminationStatus::Terminated(reason) => reason,
    };
    match reason {
        TerminationReason::MaxItersReached => Termination::IterationLimit,
        TerminationReason::Timeout => Termination::TimeLimit,
        TerminationReason::Interrupt => Termination::Cancelled,
        _ if finished => Termination::Reached,
        TerminationReason::SolverConverged => Termination::Stationary,
        // The caller's own mark, which our tolerances do not know.
        TerminationReason::TargetCostReached => Termination::Cancelled,
        TerminationReason::SolverExit(why) if why == Termination::NonFinite.name() => {
            Termination::NonFinite
        }
        // A line search without an acceptable step, ours or argmin's.
        TerminationReason::SolverExit(_) => Termination::SmallStep,
    }
}
