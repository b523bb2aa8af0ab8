//! How a solution changes with what is asked: the implicit function theorem at the limits that hold it.
//!
//! A solution is where the cost is stationary, or where goals are reached and preferences balance within them,
//! and stays so as targets, weights and links change; differentiating that gives one linear system
//! ([`system`]), factored once for any number of products.

mod active_set;
mod directions;
mod existence;
mod place;
mod products;
mod rows;
mod singular;
mod system;

use self::place::{Evaluator, Place};
use self::singular::Flat;
use self::system::System;
use super::SolveError;
use crate::model::Model;
use crate::problem::{ParameterScratch, ParameterVector, Question, Scratch};
use crate::search::check_start;
pub use existence::{Existence, NoDerivative};

/// The derivative of a solution by the targets, weights, postures and link lengths of its problem.
///
/// The velocities here are those of [`Model::integrate`]: radians and metres, three numbers a ball, six a free
/// joint. A change of the parameters is a [`ParameterVector`], and so is a gradient by them.
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
/// assert!(derivative.existence().is_unique());
/// // The target goes along y at 1 m/s.
/// let mut rates = ParameterVector::new(&problem);
/// rates.target_mut(hand.index())[1] = 1.0;
/// let mut v = [0.0; 2];
/// derivative.velocity(&rates, &mut v)?;
/// // Straight up above the elbow at (1, 0), which turns about the shoulder at (0, 0).
/// assert!((v[0] - 1.0).abs() < 1e-5 && (v[1] + 1.0).abs() < 1e-5, "{v:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SolutionDerivative<'a> {
    question: Question<'a>,
    model: Option<&'a Model>,
    memory: &'a mut DerivativeWorkspace,
    existence: Existence,
}

/// The memory of [`SolutionDerivative`]: used again, a derivative of the same problem allocates little. It keeps the
/// factored system of the last one, which [`resume`](SolutionDerivative::resume) takes up.
#[derive(Clone, Debug, Default)]
pub struct DerivativeWorkspace {
    scratch: Option<Scratch>,
    parts: Parts,
    existence: Option<Existence>,
}

/// All but the memory to evaluate.
#[derive(Clone, Debug, Default)]
struct Parts {
    place: Place,
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
    /// A task's rows by its target's numbers.
    columns: Vec<f64>,
    gradient: ParameterVector,
}

/// The place may be so far from one where a search ends by itself, in radians or metres.
const NEAR: f64 = 1e-3;

impl<'a> SolutionDerivative<'a> {
    /// Of the solution `q` (a configuration of the problem's model) of a problem, or of a
    /// [question](Question) to it. It is differentiated as it stands: what is held, what pulls and which limits
    /// hold is seen from `q` itself, as a solver's search with default settings leaves it.
    ///
    /// # Errors
    /// A configuration of the wrong length, or one that is not finite.
    pub fn new(
        question: impl Into<Question<'a>>,
        q: &[f64],
        memory: &'a mut DerivativeWorkspace,
    ) -> Result<Self, SolveError> {
        let question = question.into();
        check_start(question.problem(), q)?;
        let DerivativeWorkspace {
            scratch,
            parts,
            existence: kept,
        } = &mut *memory;
        let fits = |scratch: &&mut Scratch| scratch.fits(question.problem());
        if scratch.as_mut().filter(fits).is_none() {
            *scratch = Some(question.scratch());
            parts.gradient = ParameterVector::new(question.problem());
        }
        let existence = match scratch {
            Some(scratch) => {
                scratch.forget();
                parts.settle(&mut Evaluator { question, scratch }, q)
            }
            None => Existence::DoesNotExist(NoDerivative::NotFinite),
        };
        *kept = Some(existence.clone());
        Ok(Self {
            question,
            model: None,
            memory,
            existence,
        })
    }

    /// Goes on with the derivative that `memory` has factored last, for more products with it. `question` must be the one
    /// that it was made of, with the same targets. None where the memory holds none, or one of another problem.
    pub fn resume(
        question: impl Into<Question<'a>>,
        memory: &'a mut DerivativeWorkspace,
    ) -> Option<Self> {
        let question = question.into();
        let fits = |scratch: &Scratch| scratch.fits(question.problem());
        let existence = memory.existence.clone()?;
        memory.scratch.as_ref().is_some_and(fits).then_some(Self {
            question,
            model: None,
            memory,
            existence,
        })
    }

    /// The same with the origins of `model`'s joints among the parameters; it is the model that the problem was
    /// stated on.
    ///
    /// # Errors
    /// A model of another shape.
    pub fn with_joint_origins(mut self, model: &'a Model) -> Result<Self, DerivativeError> {
        let problem = self.question.problem();
        if !problem.is_of(model) {
            return Err(DerivativeError::ForeignModel {
                given: model.name().to_owned(),
                expected: problem.names().model.clone(),
            });
        }
        self.model = Some(model);
        Ok(self)
    }

    getters! {
        /// Whether the derivative exists: look here before it is trusted.
        pub fn existence(&self) -> &Existence = &self.existence;
    }

    /// How many numbers a velocity has.
    #[must_use]
    pub fn degrees_of_freedom(&self) -> usize {
        self.question.problem().tangent().degrees_of_freedom()
    }

    /// Turns the slopes of a scalar by the numbers of the solution's configuration `q`, quaternions included, into
    /// the slope by its velocity that [`gradient`](Self::gradient) takes.
    ///
    /// # Errors
    /// A slice of another length.
    pub fn slope_by_velocity(&self, q: &[f64], by_q: &[f64]) -> Result<Vec<f64>, DerivativeError> {
        let problem = self.question.problem();
        let expected = problem.configuration_len();
        for given in [q.len(), by_q.len()] {
            if given != expected {
                return Err(DerivativeError::ConfigurationLength { given, expected });
            }
        }
        let mut by_v = vec![0.0; self.degrees_of_freedom()];
        problem.tangent().slope_by_velocity(q, by_q, &mut by_v);
        Ok(by_v)
    }

    /// A parameter vector of this derivative's shape, all zero: with joints' origins where they are asked for.
    #[must_use]
    pub fn parameters(&self) -> ParameterVector {
        let parameters = ParameterVector::new(self.question.problem());
        match self.model {
            Some(model) => parameters.with_joint_origins(model.joints().len()),
            None => parameters,
        }
    }
}

impl Parts {
    /// Goes to a solution and factors its system.
    fn settle(&mut self, evaluator: &mut Evaluator<'_, '_>, q: &[f64]) -> Existence {
        let question = evaluator.question;
        let Self { place, system, .. } = self;
        place.go(evaluator, q);
        if !place.is_finite() {
            return Existence::DoesNotExist(NoDerivative::NotFinite);
        }
        let limits = system.take_limits(question, place);
        let lost = system.lost_ranks(evaluator, place);
        let flat = system.take_hessian(evaluator, place);
        let left = self.distance_left();
        if left > NEAR {
            return Existence::DoesNotExist(NoDerivative::NotStationary { distance: left });
        }
        if lost > 0 {
            return Existence::DoesNotExist(NoDerivative::Singular { directions: lost });
        }
        if let Some(weak) = limits.weak {
            return Existence::DoesNotExist(weak);
        }
        if let Some(task) = self.task_at_kink(evaluator) {
            return Existence::DoesNotExist(NoDerivative::AtKink { task });
        }
        let directions = match self.place.roles.pulled.is_empty() {
            true => limits.undecided,
            false => flat,
        };
        match self.flatness(evaluator, flat) {
            Flat::Singular => Existence::DoesNotExist(NoDerivative::Singular { directions }),
            Flat::Undecided if directions > 0 => Existence::ShortestOfMany { directions },
            Flat::Undecided => Existence::Unique,
        }
    }
}

/// Why a product cannot be formed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DerivativeError {
    /// A velocity, or a slope by one, of the wrong length.
    #[error("{given} numbers were given for a velocity, which has {expected}")]
    Length {
        /// Numbers given.
        given: usize,
        /// The model's degrees of freedom.
        expected: usize,
    },
    /// A configuration, or slopes by one, of the wrong length.
    #[error("{given} numbers were given for a configuration, which has {expected}")]
    ConfigurationLength {
        /// Numbers given.
        given: usize,
        /// How many the model has.
        expected: usize,
    },
    /// Parameters of another problem, or with joints' origins where none are asked for.
    #[error("the parameters are not of this problem's shape: make them by `parameters`")]
    ForeignParameters,
    /// A task that is not there.
    #[error("there is no task {given}, the problem has {tasks}")]
    NoSuchTask {
        /// The position given.
        given: usize,
        /// How many there are.
        tasks: usize,
    },
    /// Another model than the problem's.
    #[error("joints of model `{given}` were given, the problem is of `{expected}`")]
    ForeignModel {
        /// The model given.
        given: String,
        /// The problem's.
        expected: String,
    },
}
