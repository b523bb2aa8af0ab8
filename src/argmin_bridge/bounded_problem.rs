//! A problem in its own variables: for argmin's derivative-free solvers, and for our methods.

use argmin::core::{CostFunction, Error, OptimizationResult, State};
use nalgebra::{DMatrix, DVector};

use super::error::{BridgeError, check_length};
use super::pool::{Buffers, Pool};
use super::solution::{Place, solution_of};
use crate::ik::{Solution, SolveError};
use crate::problem::{Evaluation, Question, Share};
use crate::search::variables_at;
use crate::solver::{ConfigurationSpace, LeastSquares};

/// How far the corners of a first simplex stand from the start, as a share of the range.
const SIMPLEX_SIZE: f64 = 0.1;

/// A problem in its own variables x.
///
/// To argmin it has a cost only, taken at the nearest point within the bounds: outside, the cost
/// is that of the bound, and a solution is always within. So Nelder-Mead and particle swarm run on
/// it, and a solver that needs derivatives, which would be wrong outside, does not compile.
///
/// To our methods it is a [`LeastSquares`] with its bounds: run them with
/// [`ExecutorMethod`](super::ExecutorMethod).
#[derive(Clone, Debug)]
pub struct BoundedProblem<'p> {
    question: Question<'p>,
    pool: Pool,
}

impl<'p> BoundedProblem<'p> {
    /// Offers a problem, or a [question](Question) to it, to argmin.
    #[must_use]
    pub fn new(question: impl Into<Question<'p>>) -> Self {
        let question = question.into();
        Self {
            question,
            pool: Pool::default(),
        }
    }

    /// The variables of the configuration `q` (shape: degrees of freedom), projected into the
    /// limits.
    ///
    /// # Errors
    /// A configuration of the wrong length or not finite.
    pub fn start(&self, q: &[f64]) -> Result<DVector<f64>, SolveError> {
        Ok(DVector::from_vec(variables_at(self.question, q)?))
    }

    /// Where a search from `q` may look: the bounds, or π radians or the model's reach to either
    /// side of the start where a variable has none. Lower corner, upper corner: what particle
    /// swarm asks for.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn search_box(&self, q: &[f64]) -> Result<(DVector<f64>, DVector<f64>), SolveError> {
        let start = self.start(q)?;
        let (mut low, mut high) = (start.clone(), start);
        for k in 0..low.len() {
            (low[k], high[k]) = self.question.sampling_range(k, low[k]);
        }
        Ok((low, high))
    }

    /// n + 1 corners for Nelder-Mead: the start, and one step of a tenth of the [box](Self::search_box) along each
    /// variable, towards the farther end.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn simplex(&self, q: &[f64]) -> Result<Vec<DVector<f64>>, SolveError> {
        let start = self.start(q)?;
        let (low, high) = self.search_box(q)?;
        let mut corners = vec![start.clone()];
        for k in 0..start.len() {
            let mut corner = start.clone();
            let forward = high[k] - start[k] >= start[k] - low[k];
            let step = SIMPLEX_SIZE * (high[k] - low[k]);
            corner[k] += if forward { step } else { -step };
            corners.push(corner);
        }
        Ok(corners)
    }

    fn evaluate(&self, work: impl FnOnce(&mut Evaluation<'_>)) {
        let evaluate =
            |own: &mut Buffers| work(&mut Evaluation::new(self.question, &mut own.scratch));
        self.pool.with(self.question, evaluate);
    }

    /// The best point of a run, measured: errors, limits and costs are those of the returned `q`.
    ///
    /// # Errors
    /// A run of another problem, or one without any parameter vector.
    pub fn solution<S, I>(
        &self,
        run: &OptimizationResult<Self, S, I>,
    ) -> Result<Solution, BridgeError>
    where
        I: State<Float = f64>,
        I::Param: Place,
    {
        solution_of((self.question, &self.pool), run, |x| x.as_slice().to_vec())
    }
}

impl CostFunction for BoundedProblem<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, x: &DVector<f64>) -> Result<f64, Error> {
        let question = self.question;
        check_length(x.len(), question.variables())?;
        Ok(self.pool.with(question, |buffers| {
            buffers.x.copy_from_slice(x.as_slice());
            question.space().project(&mut buffers.x);
            Evaluation::new(question, &mut buffers.scratch)
                .residual(&buffers.x, &mut buffers.residual);
            buffers.cost()
        }))
    }
}

impl LeastSquares for BoundedProblem<'_> {
    answers! {
        fn variables(&self) -> usize = self.question.variables();
        fn rows(&self) -> usize = self.question.rows();
        fn space(&self) -> ConfigurationSpace<'_> = self.question.space();
        fn lower(&self) -> &[f64] = self.question.lower();
        fn upper(&self) -> &[f64] = self.question.upper();
        fn stops_when_reached(&self) -> bool = !self.question.problem().has_preferences();
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        self.evaluate(|at| at.residual(x, residual));
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.evaluate(|at| at.jacobian(x, jacobian));
    }

    fn gradient(
        &mut self,
        x: &[f64],
        residual: &[f64],
        gradient: &mut [f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        self.evaluate(|at| at.gradient(x, residual, gradient, jacobian));
    }

    fn is_reached(&self, residual: &[f64]) -> bool {
        let problem = self.question.problem();
        problem.is_reached_by(Share::All, residual)
    }
}
