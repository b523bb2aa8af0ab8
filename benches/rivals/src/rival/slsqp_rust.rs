//! The crate `slsqp`, a port of NLopt's SLSQP, on kinopt's kinematics.

use std::time::{Duration, Instant};

use slsqp::{Func, StopTols, minimize};

use super::{Answer, Rival, timed};
use crate::{Failure, Objective, Query, Workload, until_deadline};

struct Slsqp<'a> {
    workload: &'a Workload,
    bounds: Vec<(f64, f64)>,
    limit: Duration,
}

/// Creates the solver for one robot.
pub fn new(workload: &Workload, limit: Duration) -> Box<dyn Rival + '_> {
    let limits = crate::Limits::of(&workload.chain);
    Box::new(Slsqp {
        workload,
        bounds: limits.lower.into_iter().zip(limits.upper).collect(),
        limit,
    })
}

impl Rival for Slsqp<'_> {
    fn name(&self) -> String {
        "slsqp".into()
    }

    fn answer(&mut self, query: &Query) -> Result<Answer, Failure> {
        let chain = &self.workload.chain;
        Ok(timed(|| {
            let objective = Objective::new(chain, query.target);
            let evaluate = |q: &[f64], gradient: Option<&mut [f64]>, (): &mut ()| -> f64 {
                objective.at(q, gradient)
            };
            let unconstrained: [&dyn Func<()>; 0] = [];
            let deadline = Instant::now() + self.limit;
            until_deadline(chain, &query.start, deadline, |q| {
                // It has no goal value as a stopping criterion, only the change between iterates.
                let stop = StopTols {
                    ftol_abs: 1e-3 * Objective::GOAL,
                    ..StopTols::default()
                };
                let bounds = &self.bounds;
                let result = minimize(evaluate, q, bounds, &unconstrained, (), 200, Some(stop));
                let (solution, value) = match result {
                    Ok((_, solution, value)) | Err((_, solution, value)) => (solution, value),
                };
                q.copy_from_slice(&solution);
                value <= Objective::GOAL
            })
        }))
    }
}
