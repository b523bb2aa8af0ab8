//! argmin's solvers that take derivatives, over unbounded variables.

use argmin::core::Executor;
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use argmin::solver::trustregion::{Steihaug, TrustRegion};
use kinopt::argmin_bridge::UnboundedProblem;
use kinopt::problem::Derivatives;

use super::{STEPS, marked_run};
use crate::{Adapter, Answer, Question, Trace, attempts};

/// How many past steps L-BFGS remembers.
const MEMORY: usize = 7;

/// argmin's L-BFGS with the line search of Moré and Thuente.
#[derive(Clone, Copy, Debug, Default)]
pub struct LbfgsAdapter;

/// argmin's trust region with Steihaug's conjugate gradients.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrustRegionAdapter;

/// One solver after another from random starts, each through argmin's executor.
macro_rules! run_unbounded {
    ($question:expr, $trace:expr, $solver:expr) => {{
        let (question, trace): (&Question<'_>, &Trace) = ($question, $trace);
        let unbounded = UnboundedProblem::new(question.problem);
        let steps = u64::try_from(STEPS).unwrap_or(u64::MAX);
        let answer = attempts(question, |start, _, left| {
            let Ok(y) = unbounded.start(start) else {
                return Answer::at(start.to_vec());
            };
            let executor = Executor::new(unbounded.clone(), $solver).configure(|state| {
                let state = state.param(y.clone()).max_iters(steps);
                state.target_cost(question.sufficient_cost())
            });
            let run = marked_run::run(executor, left, trace);
            match unbounded.solution_from(&y, run) {
                Ok(solution) => Answer::from(&solution),
                // A line search that found nothing took the run with it.
                Err(_) => Answer::at(start.to_vec()),
            }
        });
        trace.translate(|y| {
            let y = nalgebra::DVector::from_column_slice(y);
            question.set.configuration(&unbounded.variables_at(&y))
        });
        answer
    }};
}

impl Adapter for LbfgsAdapter {
    fn name(&self) -> &str {
        "argmin L-BFGS"
    }

    fn family(&self) -> &str {
        "argmin"
    }

    fn setting(&self) -> String {
        format!(
            "memory {MEMORY}, Moré-Thuente, at most {STEPS} steps an attempt; bounds by a change of variables"
        )
    }

    fn routes(&self) -> &[Derivatives] {
        &Derivatives::ALL
    }

    fn solve(&mut self, question: &Question<'_>, trace: &Trace) -> Answer {
        run_unbounded!(
            question,
            trace,
            LBFGS::new(MoreThuenteLineSearch::new(), MEMORY)
        )
    }
}

impl Adapter for TrustRegionAdapter {
    fn name(&self) -> &str {
        "argmin trust region"
    }

    fn family(&self) -> &str {
        "argmin"
    }

    fn setting(&self) -> String {
        format!(
            "Steihaug on the Gauss-Newton Hessian, at most {STEPS} steps an attempt; bounds by a change of variables"
        )
    }

    fn routes(&self) -> &[Derivatives] {
        &Derivatives::ALL
    }

    fn solve(&mut self, question: &Question<'_>, trace: &Trace) -> Answer {
        run_unbounded!(
            question,
            trace,
            TrustRegion::new(Steihaug::new().with_max_iters(20))
        )
    }
}
