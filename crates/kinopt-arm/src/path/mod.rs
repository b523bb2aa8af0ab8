//! Cartesian paths of arms with the fewest reconfigurations, and their timing.
//!
//! A [`CartesianPath`] is a sequence of tool poses. A [`PathSolver`] computes a joint path with the fewest
//! reconfigurations, and among these the shortest. Its jumps are the reconfigurations. Its [`PathReport`] has unreached
//! points and an upper bound on the deviation between points.
//!
//! ```
//! # std::env::set_current_dir("../..")?;
//! # #[cfg(feature = "urdf")] {
//! use kinopt::Arm;
//! use kinopt::motion::path::{CartesianPath, PathSolver};
//! use kinopt::robot::Robot;
//! use kinopt::spatial::{Placement, Vector3};
//!
//! let robot = Robot::read("models/franka_panda.urdf")?;
//! let arm = Arm::new(&robot, "base", "flange")?;
//! let begin = arm.base_from_tool(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])?;
//! // 0.5 m sideways, with points 5 mm apart.
//! let along = |k: u32| Vector3::new(0.0, 0.005 * f64::from(k), 0.0);
//! let points = (0..=100).map(|k| Placement::new(begin.rotation, begin.translation + along(k)));
//! let path = CartesianPath::new(points.collect::<Vec<_>>())?;
//!
//! let solution = PathSolver::new(&arm).solve(&path)?;
//! assert!(solution.reached());
//! assert!(solution.report.largest_deviation.metres < 1e-4);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod basis;
mod branch_continuation;
mod bridge;
mod cartesian_path;
mod closing;
mod csv;
mod deviation;
mod error;
mod graph;
mod knot_configurations;
mod knots;
mod layers;
mod linear_segment;
mod neighbour_index;
mod option_checks;
mod path_report;
mod recording;
mod revolutions;
mod segments;
mod shorten;
mod solver;
mod sparse_waypoints;
mod spline;
mod step_bounds;
mod timing;
mod tools;
mod tracked_path;
mod tridiagonal;
mod winding;

pub use cartesian_path::{CartesianPath, Traversal};
pub use csv::{CsvColumns, QuaternionOrder};
pub use error::PathError;
pub use path_report::{Blocked, Deviation, MissReason, Missed, PathReport};
pub use segments::Curve;
pub use solver::PathSolver;
pub use timing::{TimedSpline, TimingLimits, TrajectoryPoint};
