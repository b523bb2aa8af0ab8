//! Derivative of a solution with respect to its problem: the implicit function theorem with active limits.
//!
//! At a solution the cost is stationary, or required tasks are reached and soft tasks balance in their null space.
//! Differentiating these conditions by targets, weights and links gives one linear system ([`system`]). It is factored
//! once for any number of products.

mod active_set;
mod differentiability;
mod directions;
mod kkt_point;
mod products;
mod rows;
mod singular;
mod system;

use self::kkt_point::{Evaluator, KktPoint};
use self::singular::Flatness;
use self::system::System;
use super::SolveError;
use crate::problem::{ParameterScratch, ParameterVector, ProblemInstance, Scratch};
use crate::search::check_start;
pub use differentiability::{Differentiability, NoDerivative};
use kinopt_kinematics::model::Model;

/// Derivative of a solution by the targets, weights, postures and link lengths of its problem.
///
/// Velocities are those of [`Model::integrate`], in rad/s and m/s: three numbers for a ball joint, six for a free
/// joint. Parameter changes and gradients are [`ParameterVector`]s.
///
/// ```
/// use kinopt::ik::{DerivativeWorkspace, SolutionDerivative};
/// use kinopt::model::{Limits, Model};
/// use kinopt::problem::ParameterVector;
/// use kinopt::spatial::{Placement, Vector3};
/// use kinopt::task::Point;
/// use kinopt::{Problem, Solver};
///
/// let mut builder = Model::builder("two links");
/// let (z, limits) = (Vector3::new(0.0, 0.0, 1.0), Limits::new(-2.5, 2.5));
/// let link = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
/// let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, limits);
/// let elbow = builder.revolute("elbow", Some(shoulder), link, z, limits);
/// let tip = builder.frame("tip", Some(elbow), link);
/// let model = builder.build()?;
/// let mut tasks = Problem::builder(&model);
/// let hand = tasks.add(Point::new(tip, [1.0, 1.0, 0.0]));
/// let problem = tasks.build()?;
/// let solution = Solver::default().solve_once(&problem, &[0.1, 1.0])?;
///
/// let mut workspace = DerivativeWorkspace::default();
/// let mut derivative = SolutionDerivative::new(&problem, &solution.q, &mut workspace)?;
/// assert!(derivative.differentiability().is_unique());
/// // The target moves along y at 1 m/s.
/// let mut rates = ParameterVector::new(&problem);
/// rates.target_mut(hand.index())[1] = 1.0;
/// let mut v = [0.0; 2];
/// derivative.velocity(&rates, &mut v)?;
/// // The tip is straight above the elbow at (1, 0), which rotates about the shoulder at (0, 0).
/// assert!((v[0] - 1.0).abs() < 1e-5 && (v[1] + 1.0).abs() < 1e-5, "{v:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SolutionDerivative<'a> {
    instance: ProblemInstance<'a>,
    model: Option<&'a Model>,
    memory: &'a mut DerivativeWorkspace,
    differentiability: Differentiability,
}

/// Scratch memory of [`SolutionDerivative`]. Reuse it for the same problem to allocate little.
///
/// It keeps the last factored system, which [`resume`](SolutionDerivative::resume) uses again.
#[derive(Clone, Debug, Default)]
pub struct DerivativeWorkspace {
    scratch: Option<Scratch>,
    parts: Parts,
    differentiability: Option<Differentiability>,
}

/// All of the workspace but the evaluation memory.
#[derive(Clone, Debug, Default)]
struct Parts {
    point: KktPoint,
    system: System,
    parameters: ParameterScratch,
    /// By variable.
    rates: Vec<f64>,
    /// Along the free directions.
    slope: Vec<f64>,
    step: Vec<f64>,
    image: Vec<f64>,
    /// By row of all tasks.
    rows: Vec<f64>,
    /// Jacobian of one task's rows by its target.
    columns: Vec<f64>,
    gradient: ParameterVector,
}

/// Largest remaining Newton step of a stationary configuration, radians or metres.
const MAX_NEWTON_STEP: f64 = 1e-3;

impl<'a> SolutionDerivative<'a> {
    /// Creates the derivative at the solution `q` of a problem or of a [problem instance](ProblemInstance).
    ///
    /// Reached tasks, minimised tasks and active limits are determined from `q`, by the default settings of a solver.
    ///
    /// # Errors
    /// Returns an error if `q` has the wrong length or a number that is not finite.
    pub fn new(
        instance: impl Into<ProblemInstance<'a>>,
        q: &[f64],
        memory: &'a mut DerivativeWorkspace,
    ) -> Result<Self, SolveError> {
        let instance = instance.into();
        check_start(instance.problem(), q)?;
        let DerivativeWorkspace {
            scratch,
            parts,
            differentiability: stored_differentiability,
        } = &mut *memory;
        let fits = |scratch: &&mut Scratch| scratch.fits(instance.problem());
        if scratch.as_mut().filter(fits).is_none() {
            *scratch = Some(instance.scratch());
            parts.gradient = ParameterVector::new(instance.problem());
        }
        let differentiability = match scratch {
            Some(scratch) => {
                scratch.invalidate();
                parts.factorise(&mut Evaluator { instance, scratch }, q)
            }
            None => Differentiability::DoesNotExist(NoDerivative::NotFinite),
        };
        *stored_differentiability = Some(differentiability.clone());
        Ok(Self {
            instance,
            model: None,
            memory,
            differentiability,
        })
    }

    /// Continues with the last derivative that `memory` has factored, for more products.
    ///
    /// `instance` must be the instance of that derivative, with equal targets. Returns `None` if the memory has no
    /// derivative, or one of another problem.
    pub fn resume(
        instance: impl Into<ProblemInstance<'a>>,
        memory: &'a mut DerivativeWorkspace,
    ) -> Option<Self> {
        let instance = instance.into();
        let fits = |scratch: &Scratch| scratch.fits(instance.problem());
        let differentiability = memory.differentiability.clone()?;
        memory.scratch.as_ref().is_some_and(fits).then_some(Self {
            instance,
            model: None,
            memory,
            differentiability,
        })
    }

    /// Adds the origins of the joints of `model` to the parameters. `model` must be the model of the problem.
    ///
    /// # Errors
    /// Returns an error for a model of another shape.
    pub fn with_joint_origins(mut self, model: &'a Model) -> Result<Self, SolveError> {
        let problem = self.instance.problem();
        if !problem.is_of(model) {
            return Err(SolveError::ForeignModel {
                given: model.name().to_owned(),
                expected: problem.names().model.clone(),
            });
        }
        self.model = Some(model);
        Ok(self)
    }

    /// Differentiability of the solution. Check it before using any product.
    #[must_use]
    pub fn differentiability(&self) -> &Differentiability {
        &self.differentiability
    }

    /// Number of elements of a velocity.
    #[must_use]
    pub fn degrees_of_freedom(&self) -> usize {
        self.instance.problem().tangent().degrees_of_freedom()
    }

    /// Converts the gradient of a scalar by the configuration `q`, quaternions included, to the gradient by its
    /// velocity.
    ///
    /// [`gradient`](Self::gradient) takes the result.
    ///
    /// # Errors
    /// Returns an error if a slice has the wrong length.
    pub fn slope_by_velocity(&self, q: &[f64], slope_by_q: &[f64]) -> Result<Vec<f64>, SolveError> {
        let problem = self.instance.problem();
        let expected = problem.configuration_len();
        for given in [q.len(), slope_by_q.len()] {
            if given != expected {
                return Err(SolveError::ConfigurationLength { given, expected });
            }
        }
        let mut slope_by_v = vec![0.0; self.degrees_of_freedom()];
        problem
            .tangent()
            .slope_by_velocity(q, slope_by_q, &mut slope_by_v);
        Ok(slope_by_v)
    }

    /// Creates a zero parameter vector of this derivative's shape, with joint origins if a model is set.
    #[must_use]
    pub fn parameters(&self) -> ParameterVector {
        let parameters = ParameterVector::new(self.instance.problem());
        match self.model {
            Some(model) => parameters.with_joint_origins(model.joints().len()),
            None => parameters,
        }
    }
}

impl Parts {
    /// Evaluates a solution and factors its system.
    fn factorise(&mut self, evaluator: &mut Evaluator<'_, '_>, q: &[f64]) -> Differentiability {
        let instance = evaluator.instance;
        let Self { point, system, .. } = self;
        point.evaluate(evaluator, q);
        if !point.is_finite() {
            return Differentiability::DoesNotExist(NoDerivative::NotFinite);
        }
        let limits = system.select_active_limits(instance, point);
        let lost_ranks = system.lost_ranks(evaluator, point);
        let flat_directions = system.compute_hessian(evaluator, point);
        let step_size = self.newton_step_size();
        if step_size > MAX_NEWTON_STEP {
            return Differentiability::DoesNotExist(NoDerivative::NotStationary {
                distance: step_size,
            });
        }
        if lost_ranks > 0 {
            return Differentiability::DoesNotExist(NoDerivative::Singular {
                directions: lost_ranks,
            });
        }
        if let Some(reason) = limits.weak {
            return Differentiability::DoesNotExist(reason);
        }
        if let Some(task) = self.task_at_kink(evaluator) {
            return Differentiability::DoesNotExist(NoDerivative::AtKink { task });
        }
        let directions = match self.point.roles.minimised.is_empty() {
            true => limits.undecided,
            false => flat_directions,
        };
        match self.flatness(evaluator, flat_directions) {
            Flatness::Singular => {
                Differentiability::DoesNotExist(NoDerivative::Singular { directions })
            }
            Flatness::Undecided if directions > 0 => {
                Differentiability::ShortestOfMany { directions }
            }
            Flatness::Undecided => Differentiability::Unique,
        }
    }
}
