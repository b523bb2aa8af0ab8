//! NLopt's gradient methods with bounds, on kinopt's kinematics.

use std::time::{Duration, Instant};

use nlopt::{Algorithm, Nlopt, Target};

use super::{Answer, Rival, timed};
use crate::{Failure, Limits, Objective, Query, Workload, until_deadline};

/// Name and algorithm.
pub type Setting = (&'static str, Algorithm);

/// The two suitable algorithms.
pub const SETTINGS: [Setting; 2] = [
    ("NLopt L-BFGS", Algorithm::Lbfgs),
    ("NLopt SLSQP", Algorithm::Slsqp),
];

/// Number of past steps of L-BFGS. NLopt's default depends on ten megabytes, which it allocates.
const MEMORY: usize = 10;

struct Local<'a> {
    workload: &'a Workload,
    limits: Limits,
    limit: Duration,
    setting: Setting,
}

/// Creates one algorithm for one robot.
pub fn new<'a>(workload: &'a Workload, limit: Duration, setting: Setting) -> Box<dyn Rival + 'a> {
    Box::new(Local {
        workload,
        limits: Limits::of(&workload.chain),
        limit,
        setting,
    })
}

impl Rival for Local<'_> {
    fn name(&self) -> String {
        self.setting.0.into()
    }

    fn answer(&mut self, query: &Query) -> Result<Answer, Failure> {
        let chain = &self.workload.chain;
        Ok(timed(|| {
            let deadline = Instant::now() + self.limit;
            let objective = Objective::new(chain, query.target);
            let evaluate = |q: &[f64], gradient: Option<&mut [f64]>, (): &mut ()| -> f64 {
                objective.at(q, gradient)
            };
            let joints = query.start.len();
            let mut solver = Nlopt::new(self.setting.1, joints, evaluate, Target::Minimize, ());
            // Stops at the goal, or when stalled: the criterion of OptIK for a stall.
            let set = (solver.set_lower_bounds(&self.limits.lower))
                .and(solver.set_upper_bounds(&self.limits.upper))
                .and(solver.set_stopval(Objective::GOAL))
                .and(solver.set_ftol_abs(1e-3 * Objective::GOAL))
                .and(solver.set_vector_storage(Some(MEMORY)));
            debug_assert!(set.is_ok());
            until_deadline(chain, &query.start, deadline, |q| {
                let remaining = deadline.saturating_duration_since(Instant::now());
                // NLopt treats 0 as no limit.
                let limited = solver.set_maxtime(remaining.as_secs_f64().max(1e-6));
                let value = match solver.optimize(q) {
                    Ok((_, value)) | Err((_, value)) => value,
                };
                limited.is_ok() && value <= Objective::GOAL
            })
        }))
    }
}
