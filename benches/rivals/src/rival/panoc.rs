//! PANOC of the crate `optimization_engine` (OpEn), on kinopt's kinematics.

use std::time::{Duration, Instant};

use optimization_engine::Problem;
use optimization_engine::constraints::Rectangle;
use optimization_engine::panoc::{PANOCCache, PANOCOptimizer};

use super::{Answer, Rival, timed};
use crate::{Failure, Limits, Objective, Query, Workload, until_deadline};

/// Tolerance on the projected gradient step, radians: small enough that a converged attempt has reached the goal.
const DIFFERENCE_STEP: f64 = 1e-8;
/// Number of past steps, as in its examples.
const MEMORY: usize = 10;
/// Largest number of iterations of one attempt.
const MAX_ITERATIONS: usize = 200;

struct Panoc<'a> {
    workload: &'a Workload,
    limits: Limits,
    cache: PANOCCache,
    limit: Duration,
}

/// Creates the solver for one robot.
pub fn new(workload: &Workload, limit: Duration) -> Box<dyn Rival + '_> {
    Box::new(Panoc {
        workload,
        limits: Limits::of(&workload.chain),
        cache: PANOCCache::new(workload.chain.joints().len(), DIFFERENCE_STEP, MEMORY),
        limit,
    })
}

impl Rival for Panoc<'_> {
    fn name(&self) -> String {
        "OpEn PANOC".into()
    }

    fn answer(&mut self, query: &Query) -> Result<Answer, Failure> {
        let chain = &self.workload.chain;
        Ok(timed(|| {
            let objective = Objective::new(chain, query.target);
            let bounds = Rectangle::new(Some(&self.limits.lower), Some(&self.limits.upper));
            let deadline = Instant::now() + self.limit;
            let cache = &mut self.cache;
            until_deadline(chain, &query.start, deadline, |q| {
                let problem = Problem::new(
                    &bounds,
                    |q: &[f64], gradient: &mut [f64]| {
                        objective.at(q, Some(gradient));
                        Ok(())
                    },
                    |q: &[f64], value: &mut f64| {
                        *value = objective.at(q, None);
                        Ok(())
                    },
                );
                let remaining = deadline.saturating_duration_since(Instant::now());
                let mut solver = PANOCOptimizer::new(problem, cache)
                    .with_max_iter(MAX_ITERATIONS)
                    .with_max_duration(remaining);
                let solved = solver.solve(q);
                solved.is_ok() && objective.at(q, None) <= Objective::GOAL
            })
        }))
    }
}
