//! Solvers of argmin through the bridge.

use argmin::core::Executor;
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::neldermead::NelderMead;
use argmin::solver::particleswarm::ParticleSwarm;
use argmin::solver::quasinewton::LBFGS;
use argmin::solver::trustregion::{Steihaug, TrustRegion};
use kinopt::argmin_bridge::{BoundedProblem, UnboundedProblem};
use kinopt::problem::Derivatives;
use rand::SeedableRng;
use rand::rngs::StdRng;

use super::{MAX_STEPS, marked_run};
use crate::{Adapter, Answer, ProblemInstance, Trace, attempts};

/// Number of past steps stored by L-BFGS.
const MEMORY: usize = 7;
/// Iterations of one simplex.
const SIMPLEX_ITERATIONS: u64 = 3000;
const PARTICLES: usize = 40;
/// Iterations of one swarm.
const SWARM_ITERATIONS: u64 = 250;

/// A solver of argmin with the restarts of the harness.
#[derive(Clone, Debug)]
pub struct ArgminAdapter {
    name: &'static str,
    setting: String,
    routes: &'static [Derivatives],
    solve: fn(&ProblemInstance<'_>, &Trace) -> Answer,
}

/// A solver with bounds, created for each attempt from its start and seed.
macro_rules! within_bounds {
    ($steps:expr, |$bounded:ident, $start:ident, $seed:ident| $solver:expr) => {
        |instance, trace| {
            let $bounded = BoundedProblem::new(instance.problem);
            let answer = attempts(instance, |$start, index, remaining| {
                let $seed = instance.seed.wrapping_add(index as u64);
                let Ok(solver) = $solver else {
                    return Answer::at($start.to_vec());
                };
                let executor = Executor::new($bounded.clone(), solver).configure(|state| {
                    let state = state.max_iters($steps);
                    state.target_cost(instance.sufficient_cost())
                });
                let run = marked_run::run(executor, remaining, trace);
                match run.map(|run| $bounded.solution(&run)) {
                    Ok(Ok(solution)) => Answer::from(&solution),
                    _ => Answer::at($start.to_vec()),
                }
            });
            trace.translate(|x| instance.set.configuration(x));
            answer
        }
    };
}

/// A solver over unbounded variables, created for each attempt.
macro_rules! over_unbounded {
    ($solver:expr) => {
        |instance, trace| {
            let unbounded = UnboundedProblem::new(instance.problem);
            let answer = attempts(instance, |start, _, remaining| {
                let Ok(y) = unbounded.start(start) else {
                    return Answer::at(start.to_vec());
                };
                let executor = Executor::new(unbounded.clone(), $solver).configure(|state| {
                    let state = state.param(y.clone()).max_iters(MAX_STEPS as u64);
                    state.target_cost(instance.sufficient_cost())
                });
                let run = marked_run::run(executor, remaining, trace);
                match unbounded.solution_from(&y, run) {
                    Ok(solution) => Answer::from(&solution),
                    // A failed line search ends the run without a state.
                    Err(_) => Answer::at(start.to_vec()),
                }
            });
            trace.translate(|y| {
                let y = nalgebra::DVector::from_column_slice(y);
                instance.set.configuration(&unbounded.variables_at(&y))
            });
            answer
        }
    };
}

impl ArgminAdapter {
    /// Nelder-Mead from the initial simplex of the bridge.
    #[must_use]
    pub fn nelder_mead() -> Self {
        Self {
            name: "argmin Nelder-Mead",
            setting: format!("at most {SIMPLEX_ITERATIONS} steps an attempt"),
            routes: &[],
            solve: within_bounds!(SIMPLEX_ITERATIONS, |bounded, start, _seed| bounded
                .simplex(start)
                .map(NelderMead::new)),
        }
    }

    /// Particle swarm over the joints' range. Each attempt is a new swarm.
    #[must_use]
    pub fn particle_swarm() -> Self {
        Self {
            name: "argmin particle swarm",
            setting: format!("{PARTICLES} particles, at most {SWARM_ITERATIONS} steps an attempt"),
            routes: &[],
            // Seeded here, because the generator of argmin is seeded by the system.
            solve: within_bounds!(SWARM_ITERATIONS, |bounded, start, seed| bounded
                .search_box(start)
                .map(|window| ParticleSwarm::new(window, PARTICLES)
                    .with_rng_generator(StdRng::seed_from_u64(seed)))),
        }
    }

    /// L-BFGS with the line search of Moré and Thuente.
    #[must_use]
    pub fn lbfgs() -> Self {
        Self {
            name: "argmin L-BFGS",
            setting: format!(
                "memory {MEMORY}, Moré-Thuente, at most {MAX_STEPS} steps an attempt; bounds by a change of variables"
            ),
            routes: &Derivatives::ALL,
            solve: over_unbounded!(LBFGS::new(MoreThuenteLineSearch::new(), MEMORY)),
        }
    }

    /// Trust region with Steihaug's conjugate gradients.
    #[must_use]
    pub fn trust_region() -> Self {
        Self {
            name: "argmin trust region",
            setting: format!(
                "Steihaug on the Gauss-Newton Hessian, at most {MAX_STEPS} steps an attempt; bounds by a change of variables"
            ),
            routes: &Derivatives::ALL,
            solve: over_unbounded!(TrustRegion::new(Steihaug::new().with_max_iters(20))),
        }
    }
}

impl Adapter for ArgminAdapter {
    fn name(&self) -> &str {
        self.name
    }

    fn family(&self) -> &str {
        "argmin"
    }

    fn setting(&self) -> String {
        self.setting.clone()
    }

    fn routes(&self) -> &[Derivatives] {
        self.routes
    }

    fn solve(&mut self, instance: &ProblemInstance<'_>, trace: &Trace) -> Answer {
        (self.solve)(instance, trace)
    }
}
