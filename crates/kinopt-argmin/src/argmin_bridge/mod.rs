//! Bridge to argmin: its solvers on kinopt's problems, and kinopt's methods under its executor (feature `argmin`).
//!
//! argmin passes a problem by shared reference and has no bounds. Two wrappers adapt a [`Problem`](kinopt_solver::Problem) to
//! it. The traits that a solver requires determine which wrapper it accepts:
//!
//! | wrapper | variables | for |
//! |---|---|---|
//! | [`UnboundedProblem`] | y, any real number; x(y) is always within the bounds | L-BFGS, trust region, conjugate gradients, …: cost, gradient, Jacobian, Hessian |
//! | [`BoundedProblem`] | x, those of the problem; evaluated at the nearest point within the bounds | Nelder-Mead and particle swarm (cost only), and kinopt's methods through [`ExecutorMethod`] |
//!
//! Both convert the result of a run to a [`Solution`](kinopt_solver::Solution) by one call.
//!
//! ```
//! use argmin::core::Executor;
//! use argmin::solver::linesearch::MoreThuenteLineSearch;
//! use argmin::solver::quasinewton::LBFGS;
//! use kinopt::Problem;
//! use kinopt::argmin_bridge::UnboundedProblem;
//! use kinopt::model::{Limits, Model};
//! use kinopt::spatial::{Placement, Vector3};
//! use kinopt::task::Point;
//!
//! let mut arm = Model::builder("two links");
//! let (along, up) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
//! let link = Placement::translation(along);
//! let shoulder = arm.revolute("shoulder", None, Placement::identity(), up, Limits::new(-2.0, 2.0));
//! let elbow = arm.revolute("elbow", Some(shoulder), link, up, Limits::new(0.0, 2.5));
//! let tip = arm.frame("tip", Some(elbow), link);
//! let arm = arm.build()?;
//! let mut builder = Problem::builder(&arm);
//! builder.add(Point::new(tip, [0.6, 1.2, 0.0]));
//! let problem = builder.build()?;
//!
//! let unbounded = UnboundedProblem::new(&problem);
//! let start = unbounded.start(&[0.0, 0.5])?;
//! let run = Executor::new(unbounded.clone(), LBFGS::new(MoreThuenteLineSearch::new(), 5))
//!     .configure(|state| state.param(start.clone()).max_iters(100))
//!     .run();
//! let solution = unbounded.solution_from(&start, run)?;
//! assert!(solution.reached, "{}", solution.explain());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bounded_problem;
mod bounds_transform;
mod error;
mod executor_method;
mod executor_search;
mod pool;
mod solution;
mod unbounded_problem;

pub use bounded_problem::BoundedProblem;
pub use error::BridgeError;
pub use executor_method::{ExecutorMethod, MethodState};
pub use solution::StateParameters;
pub use unbounded_problem::UnboundedProblem;
