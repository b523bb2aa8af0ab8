//! Shared part of kinopt's interfaces for other languages.
//!
//! An interface implements [`Value`] for the values of its language and [`Arguments`] for a set of named ones. This
//! crate then reads options and tasks by name, and classifies the library's errors.
//!
//! - [`option`]: options of arms, servos and solvers, with type, range, default and documentation
//! - [`method`]: methods of solvers, with their settings
//! - [`task`]: tasks by kind, and their targets
//! - [`problem`]: problems with tasks and targets by name
//! - [`clip_ik`]: targets of inverse kinematics over clips
//! - [`cones`]: limits of ball joints by bone
//! - [`hinges`]: hinges of bones by bone
//! - [`parameters`]: free, locked, coupled and narrowed joints
//! - [`per_joint`]: numbers by joint, as a list, one number or by name
//! - [`names`]: names of enum variants
//! - [`goal_set`]: criteria and results of goal sets
//! - [`shape`]: kinds and dimensions of the shapes of links
//! - [`coordinates`]: names and units of the numbers of a configuration
//! - [`placement`], [`coordinate_order`]: conversion of placements and configurations
//! - [`jobs`]: batches on several threads
//! - [`json`]: the values and arguments of JSON
//! - `problem_file`: targets, tasks and options of the command, in text and in JSON files
//! - [`retarget_folder`]: folders of motions to retarget, continued by another process
//! - `trajectory_file`: files of trajectories
//! - `motion_file`: files of robot motions, from any program
//! - [`error`]: kinds of errors

pub mod clip_ik;
pub mod cones;
pub mod coordinate_order;
pub mod coordinates;
pub mod error;
pub mod goal_set;
pub mod hinges;
pub mod jobs;
pub mod json;
pub mod method;
#[cfg(feature = "trajectory-files")]
pub mod motion_file;
pub mod names;
pub mod option;
pub mod parameters;
pub mod per_joint;
pub mod placement;
pub mod problem;
#[cfg(feature = "problem-files")]
pub mod problem_file;
mod quantities;
pub mod retarget_folder;
pub mod shape;
pub mod task;
#[cfg(feature = "trajectory-files")]
pub mod trajectory_file;
mod value;

pub use error::{Classify, ErrorKind};
pub use quantities::QuantityValues;
pub use value::{Arguments, ErrorOf, OrRaise, Ranges, Value};
