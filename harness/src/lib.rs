//! Compares inverse kinematics solvers on the same problems.
//!
//! A [`ProblemSet`] is a model, the frames that have targets, and cases: targets with a start. An
//! [`Adapter`] is a solver under test; [`contenders::all`] are those of this project, and your own is
//! a type with two methods. A [`Bench`] asks every adapter every case, by every derivative route
//! that it can use, and judges each answer itself, by forward kinematics and the joint limits at the
//! configuration that came back. [`Results`] hold everything; [`report`] turns them into a table and
//! pictures.
//!
//! ```
//! use kinopt_harness::{Adapter, Answer, Bench, Budget, ProblemSet, Question, Trace};
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
//! /// Stays where it starts.
//! struct Lazy;
//!
//! impl Adapter for Lazy {
//!     fn name(&self) -> &str {
//!         "lazy"
//!     }
//!
//!     fn solve(&mut self, question: &Question<'_>, _trace: &Trace) -> Answer {
//!         Answer::at(question.start.to_vec())
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
//! # How times are taken
//!
//! By the processor time of the solver's thread where the system tells it (Linux), so that other
//! programs do not count, else by the wall clock; solvers themselves look at the wall clock for their time limit.
//!
//! Each question is asked twice. The plain ask is timed as a whole, watched by nobody; where it
//! takes less than 2 ms it is repeated and the shortest time counts, and where it takes less than
//! 50 µs sixteen at once are timed. The traced ask finds out when
//! which accuracy was reached: the adapter marks where it stands after each step, and the clock
//! stands still while a mark is taken; errors are computed when the search is over. What is left of the cost of
//! watching goes too: the traced times are scaled so that their end is the plain time.

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

pub use adapter::{Adapter, Answer, Question, attempts};
pub use bench::{Bench, Progress};
pub use budget::Budget;
pub use error::HarnessError;
pub use judge::{Judge, TaskError, Verdict};
pub use problem_set::{Case, ProblemSet, ProblemSetBuilder};
pub use results::{
    ConvergenceHistory, Machine, ModelSummary, Provenance, Record, Results, Run, Setting,
};
pub use trace::Trace;
