//! Problem in its own bounded variables, for argmin's derivative-free solvers and for kinopt's methods.

use argmin::core::{CostFunction, Error, OptimizationResult, State};
use nalgebra::{DMatrix, DVector};

use super::error::{BridgeError, check_length};
use super::pool::{EvaluationBuffers, Pool};
use super::solution::{StateParameters, solution_of};
use kinopt_solver::ik::{Solution, SolveError};
use kinopt_solver::problem::{Evaluation, ProblemInstance, TaskSubset};
use kinopt_solver::search::variables_at;
use kinopt_solver::solver::{ConfigurationSpace, LeastSquares};

/// Distance of the corners of an initial simplex from the start, as a fraction of the range.
const SIMPLEX_SIZE: f64 = 0.1;

/// A problem in its own variables x.
///
/// For argmin it implements only a cost, evaluated at the nearest point within the bounds. Outside the bounds the cost
/// is that of the bound, and every solution is within them. Nelder-Mead and particle swarm run on it. A solver that
/// needs derivatives does not compile, as they would be wrong outside the bounds.
///
/// For kinopt's methods it is a [`LeastSquares`] problem with its bounds. Run them with
/// [`ExecutorMethod`](super::ExecutorMethod).
#[derive(Clone, Debug)]
pub struct BoundedProblem<'p> {
    instance: ProblemInstance<'p>,
    pool: Pool,
}

impl<'p> BoundedProblem<'p> {
    /// Wraps a problem, or a [problem instance](ProblemInstance), for argmin.
    #[must_use]
    pub fn new(instance: impl Into<ProblemInstance<'p>>) -> Self {
        let instance = instance.into();
        Self {
            instance,
            pool: Pool::default(),
        }
    }

    /// Variables of the configuration `q` (shape: degrees of freedom), projected into the limits.
    ///
    /// # Errors
    /// Returns an error for a configuration of the wrong length or not finite.
    pub fn start(&self, q: &[f64]) -> Result<DVector<f64>, SolveError> {
        Ok(DVector::from_vec(variables_at(self.instance, q)?))
    }

    /// Lower and upper corner of the box to search from `q`, as particle swarm requires.
    ///
    /// They are the bounds; an unbounded variable has π radians, or the model's reach, to either side of the start.
    ///
    /// # Errors
    /// Returns the errors of [`start`](Self::start).
    pub fn search_box(&self, q: &[f64]) -> Result<(DVector<f64>, DVector<f64>), SolveError> {
        let start = self.start(q)?;
        let (mut lower, mut upper) = (start.clone(), start);
        for k in 0..lower.len() {
            (lower[k], upper[k]) = self.instance.sampling_range(k, lower[k]);
        }
        Ok((lower, upper))
    }

    /// Initial simplex of n + 1 corners for Nelder-Mead.
    ///
    /// They are the start, and a step of a tenth of the [box](Self::search_box) along each variable, towards the
    /// farther end.
    ///
    /// # Errors
    /// Returns the errors of [`start`](Self::start).
    pub fn simplex(&self, q: &[f64]) -> Result<Vec<DVector<f64>>, SolveError> {
        let start = self.start(q)?;
        let (lower, upper) = self.search_box(q)?;
        let mut corners = vec![start.clone()];
        for k in 0..start.len() {
            let mut corner = start.clone();
            let is_upward = upper[k] - start[k] >= start[k] - lower[k];
            let step = SIMPLEX_SIZE * (upper[k] - lower[k]);
            corner[k] += if is_upward { step } else { -step };
            corners.push(corner);
        }
        Ok(corners)
    }

    fn evaluate(&self, work: impl FnOnce(&mut Evaluation<'_>)) {
        let evaluate = |buffers: &mut EvaluationBuffers| {
            work(&mut Evaluation::new(self.instance, &mut buffers.scratch))
        };
        self.pool.with(self.instance, evaluate);
    }

    /// Solution at the best point of a run, evaluated at the returned `q`: errors, limits and costs.
    ///
    /// # Errors
    /// Returns an error for a run of another problem, or one without a parameter vector.
    pub fn solution<S, I>(
        &self,
        run: &OptimizationResult<Self, S, I>,
    ) -> Result<Solution, BridgeError>
    where
        I: State<Float = f64>,
        I::Param: StateParameters,
    {
        solution_of((self.instance, &self.pool), run, |x| x.as_slice().to_vec())
    }
}

impl CostFunction for BoundedProblem<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, x: &DVector<f64>) -> Result<f64, Error> {
        let instance = self.instance;
        check_length(x.len(), instance.variables())?;
        Ok(self.pool.with(instance, |buffers| {
            buffers.x.copy_from_slice(x.as_slice());
            instance.space().project(&mut buffers.x);
            Evaluation::new(instance, &mut buffers.scratch)
                .residual(&buffers.x, &mut buffers.residual);
            buffers.cost()
        }))
    }
}

impl LeastSquares for BoundedProblem<'_> {
    fn variables(&self) -> usize {
        self.instance.variables()
    }

    fn rows(&self) -> usize {
        self.instance.rows()
    }

    fn space(&self) -> ConfigurationSpace<'_> {
        self.instance.space()
    }

    fn lower(&self) -> &[f64] {
        self.instance.lower()
    }

    fn upper(&self) -> &[f64] {
        self.instance.upper()
    }

    fn stops_when_reached(&self) -> bool {
        !self.instance.problem().has_preferences()
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        self.evaluate(|evaluation| evaluation.residual(x, residual));
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.evaluate(|evaluation| evaluation.jacobian(x, jacobian));
    }

    fn gradient(
        &mut self,
        x: &[f64],
        residual: &[f64],
        gradient: &mut [f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        self.evaluate(|evaluation| evaluation.gradient(x, residual, gradient, jacobian));
    }

    fn is_reached(&self, residual: &[f64]) -> bool {
        let problem = self.instance.problem();
        problem.is_reached_by(TaskSubset::All, residual)
    }
}
