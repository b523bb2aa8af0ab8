//! Methods of kinopt as solvers of argmin's executor.

use argmin::core::{
    ArgminError, Error, IterState, KV, Problem, Solver, TerminationReason, TerminationStatus,
};
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::executor_search::{ExecutorSearch, Running};
use crate::solver::{LeastSquares, Method, Progress, SolverState, Stopping, Termination};

/// State of the executor for kinopt's methods: parameters x, gradient Jᵀr and residuals r.
pub type MethodState = IterState<DVector<f64>, DVector<f64>, (), (), DVector<f64>, f64>;

/// A method of kinopt under argmin's `Executor`, on any [`LeastSquares`] such as a
/// [`BoundedProblem`](super::BoundedProblem).
///
/// It makes bitwise the same steps and tests as [`minimise`](crate::solver::minimise), with argmin's observers,
/// counters, timeout and checkpoints.
///
/// The start is the state's `param`, projected into the bounds. The executor counts and limits iterations (`max_iters`,
/// unlimited by default). The state holds `param`, `cost`, `residuals` and, if the goals are not reached, `gradient`.
/// Observers also receive these key-values:
/// - `control`: λ for Levenberg-Marquardt, the step length for the other methods.
/// - `projected_gradient`.
/// - `step`.
///
/// A search ends as `SolverConverged` if the goals are reached or no free variable lowers the cost. Otherwise it ends
/// as `SolverExit` with the name of the [`Termination`].
///
/// Settings and search serialise together between two iterations. A resumed run makes the same steps as an
/// uninterrupted one. Evaluations that it repeats are counted.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound(
    serialize = "M: Serialize, M::State: Serialize",
    deserialize = "M: Deserialize<'de>, M::State: Deserialize<'de>"
))]
pub struct ExecutorMethod<M: Method> {
    method: M,
    gradient_tolerance: f64,
    step_tolerance: f64,
    search: ExecutorSearch<M::State>,
    /// Termination of the search, if it has ended.
    ended: Option<Termination>,
}

impl<M: Method> ExecutorMethod<M> {
    /// Creates a solver from `method` with the default tolerances of [`Stopping`].
    #[must_use]
    pub fn new(method: M) -> Self {
        let stopping = Stopping::default();
        Self {
            method,
            gradient_tolerance: stopping.gradient_tolerance(),
            step_tolerance: stopping.step_tolerance(),
            search: ExecutorSearch::default(),
            ended: None,
        }
    }

    /// Sets the gradient and step tolerances to those of `stopping`.
    ///
    /// The executor sets the limits of iterations and time.
    #[must_use]
    pub fn with_tolerances_of(mut self, stopping: &Stopping) -> Self {
        self.gradient_tolerance = stopping.gradient_tolerance();
        self.step_tolerance = stopping.step_tolerance();
        self
    }

    /// Method with its settings.
    #[must_use]
    pub fn method(&self) -> &M {
        &self.method
    }

    /// Termination of the search; `None` while it runs, or if the executor ended it.
    #[must_use]
    pub fn termination(&self) -> Option<Termination> {
        self.ended
    }

    fn stopping(&self) -> Stopping {
        Stopping::default()
            .with_gradient_tolerance(self.gradient_tolerance)
            .with_step_tolerance(self.step_tolerance)
    }

    /// Evaluates the current point, tests for termination, and records the point in the state.
    fn evaluate_point<O: LeastSquares>(
        &mut self,
        problem: &mut Problem<O>,
        state: MethodState,
    ) -> Result<(MethodState, Option<KV>), Error> {
        let stopping = self.stopping();
        let least_squares = inner(problem)?;
        let method = &self.method;
        let Running {
            progress,
            state: solver_state,
            method_state,
        } = self.search.running(least_squares, method)?;
        if !progress.evaluate(least_squares, method, method_state, solver_state) {
            self.ended = Some(Termination::NonFinite);
        } else if self.ended.is_none() {
            self.ended = progress.termination(solver_state, &stopping);
        }

        let mut key_values = KV::new();
        key_values.insert("control", method.control(method_state).into());
        key_values.insert("step", progress.step_norm(solver_state).into());
        let mut state = state
            .param(DVector::from_column_slice(solver_state.x()))
            .cost(solver_state.cost())
            .residuals(DVector::from_column_slice(solver_state.residual()));
        if let Some(norm) = progress.projected_gradient {
            key_values.insert("projected_gradient", norm.into());
            state = state.gradient(DVector::from_column_slice(solver_state.gradient()));
        }
        let counts = solver_state.counts();
        for (name, count) in [
            ("cost_count", counts.residuals),
            ("jacobian_count", counts.jacobians),
            ("gradient_count", counts.gradients),
        ] {
            problem.counts.insert(name, count as u64);
        }
        Ok((state, Some(key_values)))
    }
}

impl<O: LeastSquares, M: Method> Solver<O, MethodState> for ExecutorMethod<M> {
    fn name(&self) -> &str {
        self.method.name()
    }

    fn init(
        &mut self,
        problem: &mut Problem<O>,
        mut state: MethodState,
    ) -> Result<(MethodState, Option<KV>), Error> {
        self.method.check()?;
        self.stopping().check()?;
        let least_squares = inner(problem)?;
        let (name, variables) = (self.method.name(), least_squares.variables());
        let start = state.take_param();
        let start = start.ok_or_else(|| ArgminError::NotInitialized {
            text: format!("`{name}` needs a start: configure the state's `param`"),
        })?;
        let (mut solver_state, mut method_state) = (SolverState::default(), M::State::default());
        (self.method).reserve(&mut method_state, least_squares.rows(), variables);
        let progress = Progress::start(least_squares, start.as_slice(), &mut solver_state);
        let progress = progress.ok_or_else(|| ArgminError::InvalidParameter {
            text: format!("`{name}` needs a start of {variables} finite numbers"),
        })?;
        self.search = ExecutorSearch::Running(Box::new(Running {
            progress,
            state: solver_state,
            method_state,
        }));
        self.ended = None;
        self.evaluate_point(problem, state)
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<O>,
        state: MethodState,
    ) -> Result<(MethodState, Option<KV>), Error> {
        let stopping = self.stopping();
        let least_squares = inner(problem)?;
        let method = &self.method;
        let running = self.search.running(least_squares, method)?;
        let (method_state, solver_state) = (&mut running.method_state, &mut running.state);
        self.ended =
            (running.progress).step(least_squares, method, method_state, solver_state, &stopping);
        self.evaluate_point(problem, state)
    }

    fn terminate(&mut self, _state: &MethodState) -> TerminationStatus {
        match self.ended {
            None => TerminationStatus::NotTerminated,
            Some(Termination::Reached | Termination::Stationary) => {
                TerminationStatus::Terminated(TerminationReason::SolverConverged)
            }
            Some(other) => TerminationStatus::Terminated(TerminationReason::SolverExit(
                other.name().to_owned(),
            )),
        }
    }
}

/// The problem of the executor, which argmin takes out at times, but not during a solver's step.
fn inner<O>(problem: &mut Problem<O>) -> Result<&mut O, ArgminError> {
    let inner = problem.problem.as_mut();
    inner.ok_or_else(|| ArgminError::NotInitialized {
        text: "the executor holds no problem".to_owned(),
    })
}
