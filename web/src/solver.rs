//! Solving problems.

use kinopt::Workspace;
use kinopt::ik::Restarts;
use kinopt::solver::Stopping;
use wasm_bindgen::prelude::*;

use crate::given::Given;
use crate::problem::{Problem, TargetsByName};
use crate::raise;
use crate::solution::Solution;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
export interface SolverOptions {
    /** Steps of one attempt. */
    maxIterations?: number;
    gradientTolerance?: number;
    stepTolerance?: number;
    /** Searches from different starts. */
    attempts?: number;
    seed?: number;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Options of a solver.
    #[wasm_bindgen(typescript_type = "SolverOptions")]
    pub type SolverOptions;
}

/// Solves problems by Levenberg-Marquardt within bounds, from several starts where one misses.
#[wasm_bindgen]
pub struct Solver {
    inner: kinopt::Solver,
    workspace: Workspace,
}

#[wasm_bindgen]
impl Solver {
    /// A solver; without options, as good ones as the library knows.
    #[wasm_bindgen(constructor)]
    pub fn new(options: Option<SolverOptions>) -> Result<Self, JsError> {
        const KNOWN: [&str; 5] = [
            "maxIterations",
            "gradientTolerance",
            "stepTolerance",
            "attempts",
            "seed",
        ];
        let options = options.map_or(JsValue::UNDEFINED, JsValue::from);
        let options = Given::new(options, "option of a solver", &KNOWN)?;
        let mut stopping = Stopping::default();
        if let Some(steps) = options.whole("maxIterations")? {
            stopping = stopping.with_max_iterations(steps as usize);
        }
        if let Some(tolerance) = options.number("gradientTolerance")? {
            stopping = stopping.with_gradient_tolerance(tolerance);
        }
        if let Some(tolerance) = options.number("stepTolerance")? {
            stopping = stopping.with_step_tolerance(tolerance);
        }
        let mut restarts = Restarts::default();
        if let Some(attempts) = options.whole("attempts")? {
            restarts = restarts.with_attempts(attempts as usize);
        }
        if let Some(seed) = options.whole("seed")? {
            restarts = restarts.with_seed(seed.into());
        }
        Ok(Self {
            inner: kinopt::Solver::default()
                .with_stopping(stopping)
                .with_restarts(restarts),
            workspace: Workspace::new(),
        })
    }

    /// Solves from a start, with targets moved by their tasks' names. A target that is missed is no exception: see
    /// `reached` and `explain()`.
    pub fn solve(
        &mut self,
        problem: &Problem,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] start: &[f64],
        targets: Option<TargetsByName>,
    ) -> Result<Solution, JsError> {
        let targets = problem.targets(targets)?;
        let question = problem.inner.with_targets(&targets).map_err(raise)?;
        let solution = self.inner.solve(question, start, &mut self.workspace);
        Ok(solution.map_err(raise)?.clone().into())
    }
}
