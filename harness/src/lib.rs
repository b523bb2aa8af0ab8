//! Comparison of inverse kinematics solvers on equal problems.
//!
//! A [`ProblemSet`] is a model, the frames with targets, and cases: targets with a start. An [`Adapter`] is a solver
//! under test; [`contenders::all`] are those of this project, and a custom one is a type with two methods. A [`Bench`]
//! runs every adapter on every case, with every derivative mode that it supports. It judges each result by forward
//! kinematics and the joint limits. [`Results`] hold all data; [`report`] renders them as a table and pictures.
//!
//! ```
//! use kinopt_harness::{Adapter, Answer, Bench, Budget, ProblemSet, ProblemInstance, Trace};
//! # use kinopt::model::{Limits, Model};
//! # use kinopt::spatial::{Placement, Vector3};
//! # let mut builder = Model::builder("two links");
//! # let z = Vector3::new(0.0, 0.0, 1.0);
//! # let link = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
//! # let limits = Limits::new(-2.5, 2.5);
//! # let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, limits);
//! # let elbow = builder.revolute("elbow", Some(shoulder), link, z, limits);
//! # let tip = builder.frame("tip", Some(elbow), link);
//! # let model = builder.build()?;
//! /// Returns its start.
//! struct Lazy;
//!
//! impl Adapter for Lazy {
//!     fn name(&self) -> &str {
//!         "lazy"
//!     }
//!
//!     fn solve(&mut self, instance: &ProblemInstance<'_>, _trace: &Trace) -> Answer {
//!         Answer::at(instance.start.to_vec())
//!     }
//! }
//!
//! let set = ProblemSet::builder(&model).point(tip).build()?.with_random_cases(5, 1, None)?;
//! let mut bench = Bench::new(&set, Budget::default());
//! bench.add(Lazy);
//! let runs = bench.run(&mut |_| std::ops::ControlFlow::Continue(()))?;
//! assert!(runs.runs[0].records.iter().all(|record| !record.solved));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Measurement of times
//!
//! Times are the processor time of the solver's thread if the system reports it (Linux), which excludes other programs,
//! else the wall clock. Solvers use the wall clock for their time limit.
//!
//! Each problem is solved twice. The untraced solve is timed as a whole. Below 2 ms it is repeated and the shortest
//! time counts; below 50 µs sixteen solves are timed together. The traced solve measures when each accuracy was
//! reached: the adapter marks its configuration after each iteration, with the clock stopped during a mark; errors are
//! computed after the search. The remaining cost of tracing is removed: traced times are scaled so that their end
//! equals the untraced time.

mod adapter;
mod bench;
mod budget;
mod clock;
pub mod contenders;
mod error;
pub mod jacobian_cost;
mod judge;
mod problem_set;
pub mod profile;
pub mod report;
mod results;
mod route;
mod trace;

pub use adapter::{Adapter, Answer, ProblemInstance, attempts};
pub use bench::{Bench, Progress};
pub use budget::Budget;
pub use error::HarnessError;
pub use judge::{Judge, TaskError, Verdict};
pub use problem_set::{Case, ProblemSet, ProblemSetBuilder};
pub use results::{
    ConvergenceHistory, Machine, ModelSummary, Provenance, Record, Results, Run, Setting,
};
pub use trace::Trace;
