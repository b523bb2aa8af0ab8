//! Solvers of problems.

use kinopt::Workspace;
use kinopt::ik::Restarts;
use kinopt::solver::Stopping;
use kinopt_bindings::option::{names, solver};
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::error::{Exception, raise};
use crate::problem::{Problem, TargetsByName};
use crate::solution::Solution;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
export interface SolverOptions {
    /** Largest number of steps of one attempt. Default: 200. */
    maxIterations?: number;
    /** Cosine between residual and Jacobian that counts as stationary. Default: 1e-9. */
    gradientTolerance?: number;
    /** Relative step that counts as zero. Default: 1e-15. */
    stepTolerance?: number;
    /** Number of steps in which the cost must halve, or the attempt ends. Default: unlimited. */
    patience?: number;
    /** Time limit of all attempts together, seconds. Results then depend on the machine. Default: none. */
    timeLimit?: number;
    /** Largest number of attempts from different starts. Default: 32; 512 for free bases with few free variables. */
    attempts?: number;
    /** Seed of random starts. Default: 0. */
    seed?: number;
    /** Number of attempts that agree on a miss before the search ends. Default: all; 3 with soft tasks. */
    agreeing?: number;
    /**
     * Total number of steps after which no new attempt starts. One continuation of the best attempt may follow.
     * Default: unlimited.
     */
    restartSteps?: number;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Options of a solver.
    #[wasm_bindgen(typescript_type = "SolverOptions")]
    pub type SolverOptions;
}

/// Solves problems by Levenberg-Marquardt with bounds, from several starts after a miss.
#[wasm_bindgen]
pub struct Solver {
    inner: kinopt::Solver,
    workspace: Workspace,
}

#[wasm_bindgen]
impl Solver {
    /// Creates a solver; missing options have their defaults.
    #[wasm_bindgen(constructor)]
    pub fn new(options: Option<SolverOptions>) -> Result<Self, Exception> {
        let names = names(&solver::options());
        let options = NamedArguments::of(options, "option of a solver", names)?;
        let patience = options.whole("patience")?;
        let options = solver::SolverOptions {
            patience: patience.map(|steps| Some(steps as usize)),
            ..solver::SolverOptions::of(&options)?
        };
        Ok(Self {
            inner: kinopt::Solver::default()
                .with_stopping(options.stopping(Stopping::default()))
                .with_restarts(options.restarts(Restarts::default())),
            workspace: Workspace::new(),
        })
    }

    /// Solves a problem from the configuration `start`. `targets` moves targets by the names of tasks. A missed target is
    /// no exception: see `reached` and `explain()`.
    pub fn solve(
        &mut self,
        problem: &Problem,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] start: &[f64],
        targets: Option<TargetsByName>,
    ) -> Result<Solution, Exception> {
        let targets = problem.targets(targets)?;
        let instance = problem.inner.with_targets(&targets).map_err(raise)?;
        let solution = self.inner.solve(instance, start, &mut self.workspace);
        Ok(solution.map_err(raise)?.clone().into())
    }
}
