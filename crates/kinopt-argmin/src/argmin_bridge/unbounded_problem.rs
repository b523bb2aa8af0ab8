//! Problem for argmin's solvers without bounds.

use argmin::core::{
    CostFunction, Error, Gradient, Hessian, Jacobian, Operator, OptimizationResult, State,
};
use nalgebra::{DMatrix, DVector};

use super::bounds_transform::{BoundsTransform, Image};
use super::error::{BridgeError, check_length};
use super::pool::{EvaluationBuffers, Pool};
use super::solution::{StateParameters, is_finished_at, solution_at, solution_of};
use kinopt_solver::ik::{Solution, SolveError};
use kinopt_solver::problem::{Evaluation, ProblemInstance};
use kinopt_solver::search::variables_at;
use kinopt_solver::solver::{LeastSquares, half_squared};

/// Smallest diagonal entry of the Hessian, relative to its largest: keeps it invertible for redundant arms.
const MIN_RELATIVE_DIAGONAL: f64 = 1e-10;

/// A problem over unbounded variables y: every y gives an x(y) within the bounds, and all derivatives are by y.
///
/// A variable with two bounds is x = mid + half · sin(y / half). One with one bound is x = bound ± (√(y² + 1) − 1). One
/// without bounds is y itself. At a bound dx/dy is 0: solvers approach a solution there quadratically, and would never
/// leave a start there. [`start`](Self::start) therefore moves it inwards. kinopt's methods need none of this, see
/// [`ExecutorMethod`](super::ExecutorMethod).
///
/// Implements argmin's `CostFunction` (½‖r‖²), `Gradient`, `Operator` (the weighted residual r), `Jacobian` (∂r/∂y) and
/// `Hessian`. The Hessian is Gauss-Newton's JᵀJ, plus the non-negative part of the exact term from the change of
/// variables, plus 1e-10 of its largest diagonal entry. It is positive definite, as the dogleg method requires, also
/// for redundant arms.
///
/// Clones share their memory. Several threads may evaluate at the same time.
#[derive(Clone, Debug)]
pub struct UnboundedProblem<'p> {
    instance: ProblemInstance<'p>,
    transforms: Vec<BoundsTransform>,
    pool: Pool,
}

impl<'p> UnboundedProblem<'p> {
    /// Wraps a problem, or a [problem instance](ProblemInstance), for argmin.
    #[must_use]
    pub fn new(instance: impl Into<ProblemInstance<'p>>) -> Self {
        let instance = instance.into();
        let bounds = instance.lower().iter().zip(instance.upper());
        Self {
            instance,
            transforms: bounds
                .map(|(&lower, &upper)| BoundsTransform::new(lower, upper))
                .collect(),
            pool: Pool::default(),
        }
    }

    /// The y of the configuration `q` (shape: degrees of freedom), projected into the limits.
    ///
    /// It stays off the limits by at least 1 % of half the range, or by 0.01 if there is only one limit.
    ///
    /// # Errors
    /// Returns an error for a configuration of the wrong length or not finite.
    pub fn start(&self, q: &[f64]) -> Result<DVector<f64>, SolveError> {
        let x = variables_at(self.instance, q)?;
        let y = self.transforms.iter().zip(x).map(|(t, x)| t.start(x));
        Ok(DVector::from_iterator(self.transforms.len(), y))
    }

    /// Variables x(y) of the problem, exactly within its bounds. NaN if y is not finite.
    #[must_use]
    pub fn variables_at(&self, y: &DVector<f64>) -> Vec<f64> {
        let mut x: Vec<f64> = self.images(y).map(|image| image.value).collect();
        self.instance.space().project(&mut x);
        x
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
        solution_of((self.instance, &self.pool), run, |y| self.variables_at(y))
    }

    /// Solution of a run as by [`solution`](Self::solution), also for a run that failed.
    ///
    /// argmin's line searches return an error if they start at the optimum. If nothing within the bounds improves on
    /// `start`, the y at which the run began, `start` is the solution.
    ///
    /// # Errors
    /// Returns the errors of [`solution`](Self::solution), and any other failure of the run.
    pub fn solution_from<S, I>(
        &self,
        start: &DVector<f64>,
        run: Result<OptimizationResult<Self, S, I>, Error>,
    ) -> Result<Solution, BridgeError>
    where
        I: State<Float = f64>,
        I::Param: StateParameters,
    {
        match run {
            Ok(run) => self.solution(&run),
            Err(error) => {
                BridgeError::check_variables(start.len(), self.transforms.len())?;
                let x = self.variables_at(start);
                let solution = solution_at(self.instance, &self.pool, &x, None::<(&I, _)>);
                if is_finished_at(&solution) {
                    Ok(solution)
                } else {
                    Err(BridgeError::Argmin(error.into()))
                }
            }
        }
    }

    fn images(&self, y: &DVector<f64>) -> impl Iterator<Item = Image> {
        let pairs = self.transforms.iter().zip(y.iter());
        pairs.map(|(transform, &y)| transform.image(y))
    }

    /// Evaluates x(y) and r(x), and calls `work` with them.
    fn evaluate<T>(
        &self,
        y: &DVector<f64>,
        work: impl FnOnce(ProblemInstance<'_>, &mut EvaluationBuffers) -> T,
    ) -> Result<T, Error> {
        check_length(y.len(), self.transforms.len())?;
        Ok(self.pool.with(self.instance, |buffers| {
            for (x, image) in buffers.x.iter_mut().zip(self.images(y)) {
                *x = image.value;
            }
            // Swings are within an ellipse, which a transform of single variables does not ensure.
            self.instance.space().project(&mut buffers.x);
            Evaluation::new(self.instance, &mut buffers.scratch)
                .residual(&buffers.x, &mut buffers.residual);
            work(self.instance, buffers)
        }))
    }

    /// ∂r/∂y for buffers that hold x.
    fn jacobian_of(&self, y: &DVector<f64>, buffers: &mut EvaluationBuffers) -> DMatrix<f64> {
        Evaluation::new(self.instance, &mut buffers.scratch)
            .jacobian(&buffers.x, &mut buffers.jacobian);
        let mut jacobian = buffers.jacobian.clone();
        for (mut column, image) in jacobian.column_iter_mut().zip(self.images(y)) {
            column *= image.slope;
        }
        jacobian
    }
}

impl EvaluationBuffers {
    /// Computes Jᵀr by x for buffers that hold x and r.
    pub(super) fn differentiate_cost(&mut self, instance: ProblemInstance<'_>) {
        Evaluation::new(instance, &mut self.scratch).gradient(
            &self.x,
            &self.residual,
            &mut self.gradient,
            &mut self.jacobian,
        );
    }

    pub(super) fn cost(&self) -> f64 {
        half_squared(&self.residual)
    }
}

impl CostFunction for UnboundedProblem<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, y: &DVector<f64>) -> Result<f64, Error> {
        self.evaluate(y, |_, buffers| buffers.cost())
    }
}

impl Gradient for UnboundedProblem<'_> {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(&self, y: &DVector<f64>) -> Result<DVector<f64>, Error> {
        self.evaluate(y, |problem, buffers| {
            buffers.differentiate_cost(problem);
            let slopes = self.images(y).map(|image| image.slope);
            let entries = buffers.gradient.iter().zip(slopes).map(|(g, s)| g * s);
            DVector::from_iterator(y.len(), entries)
        })
    }
}

impl Operator for UnboundedProblem<'_> {
    type Param = DVector<f64>;
    type Output = DVector<f64>;

    fn apply(&self, y: &DVector<f64>) -> Result<DVector<f64>, Error> {
        self.evaluate(y, |_, buffers| {
            DVector::from_column_slice(&buffers.residual)
        })
    }
}

impl Jacobian for UnboundedProblem<'_> {
    type Param = DVector<f64>;
    type Jacobian = DMatrix<f64>;

    fn jacobian(&self, y: &DVector<f64>) -> Result<DMatrix<f64>, Error> {
        self.evaluate(y, |_, buffers| self.jacobian_of(y, buffers))
    }
}

impl Hessian for UnboundedProblem<'_> {
    type Param = DVector<f64>;
    type Hessian = DMatrix<f64>;

    fn hessian(&self, y: &DVector<f64>) -> Result<DMatrix<f64>, Error> {
        self.evaluate(y, |problem, buffers| {
            let jacobian = self.jacobian_of(y, buffers);
            buffers.differentiate_cost(problem);
            let mut hessian = jacobian.tr_mul(&jacobian);
            for (k, image) in self.images(y).enumerate() {
                // ∂cost/∂x · d²x/dy²: positive if a bound holds the solution.
                hessian[(k, k)] += (buffers.gradient[k] * image.curvature).max(0.0);
            }
            let largest = hessian.diagonal().iter().copied().fold(0.0, f64::max);
            let floor = if largest > 0.0 { largest } else { 1.0 } * MIN_RELATIVE_DIAGONAL;
            for k in 0..y.len() {
                hessian[(k, k)] += floor;
            }
            hessian
        })
    }
}
