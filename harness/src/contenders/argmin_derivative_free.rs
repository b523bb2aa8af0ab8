//! argmin's solvers that look at the cost alone.

use argmin::core::Executor;
use argmin::solver::neldermead::NelderMead;
use argmin::solver::particleswarm::ParticleSwarm;
use kinopt::argmin_bridge::BoundedProblem;
use rand::SeedableRng;
use rand::rngs::StdRng;

use super::marked_run;
use crate::{Adapter, Answer, Question, Trace, attempts};

/// Steps of one simplex.
const SIMPLEX_STEPS: u64 = 3000;
const PARTICLES: usize = 40;
/// Steps of one swarm.
const SWARM_STEPS: u64 = 250;

/// argmin's Nelder-Mead from the simplex that the bridge proposes.
#[derive(Clone, Copy, Debug, Default)]
pub struct NelderMeadAdapter;

/// argmin's particle swarm across the joints' range. A further attempt is a new swarm.
#[derive(Clone, Copy, Debug, Default)]
pub struct ParticleSwarmAdapter;

impl Adapter for NelderMeadAdapter {
    fn name(&self) -> &str {
        "argmin Nelder-Mead"
    }

    fn family(&self) -> &str {
        "argmin"
    }

    fn setting(&self) -> String {
        format!("at most {SIMPLEX_STEPS} steps an attempt")
    }

    fn solve(&mut self, question: &Question<'_>, trace: &Trace) -> Answer {
        let bounded = BoundedProblem::new(question.problem);
        let answer = attempts(question, |start, _, left| {
            let Ok(simplex) = bounded.simplex(start) else {
                return Answer::at(start.to_vec());
            };
            let executor =
                Executor::new(bounded.clone(), NelderMead::new(simplex)).configure(|state| {
                    let state = state.max_iters(SIMPLEX_STEPS);
                    state.target_cost(question.sufficient_cost())
                });
            let run = marked_run::run(executor, left, trace);
            match run.map(|run| bounded.solution(&run)) {
                Ok(Ok(solution)) => Answer::from(&solution),
                _ => Answer::at(start.to_vec()),
            }
        });
        trace.translate(|x| question.set.configuration(x));
        answer
    }
}

impl Adapter for ParticleSwarmAdapter {
    fn name(&self) -> &str {
        "argmin particle swarm"
    }

    fn family(&self) -> &str {
        "argmin"
    }

    fn setting(&self) -> String {
        format!("{PARTICLES} particles, at most {SWARM_STEPS} steps an attempt")
    }

    fn solve(&mut self, question: &Question<'_>, trace: &Trace) -> Answer {
        let bounded = BoundedProblem::new(question.problem);
        let answer = attempts(question, |start, index, left| {
            let Ok(window) = bounded.window(start) else {
                return Answer::at(start.to_vec());
            };
            // argmin's own generator is seeded by the system.
            let index = u64::try_from(index).unwrap_or(u64::MAX);
            let random = StdRng::seed_from_u64(question.seed.wrapping_add(index));
            let swarm = ParticleSwarm::new(window, PARTICLES).with_rng_generator(random);
            let executor = Executor::new(bounded.clone(), swarm).configure(|state| {
                let state = state.max_iters(SWARM_STEPS);
                state.target_cost(question.sufficient_cost())
            });
            let run = marked_run::run(executor, left, trace);
            match run.map(|run| bounded.solution(&run)) {
                Ok(Ok(solution)) => Answer::from(&solution),
                _ => Answer::at(start.to_vec()),
            }
        });
        trace.translate(|x| question.set.configuration(x));
        answer
    }
}
