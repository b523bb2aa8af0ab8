//! Cartesian paths of arms, with the fewest reconfigurations.
//!
//! A [`CartesianPath`] says where the tool is to be, point after point; a [`PathSolver`] finds joints for all of it: those that
//! leave their branch least often, and of these the shortest. The [`PathSolution`] says where a branch had to be left, how
//! far the tool strays from the path between two points (a bound, not a sample), and which points are missed.
//!
//! ```
//! # #[cfg(feature = "urdf")] {
//! use kinopt::Arm;
//! use kinopt::motion::path::{CartesianPath, PathSolver};
//! use kinopt::robot::Robot;
//! use kinopt::spatial::{Placement, Vector3};
//!
//! let robot = Robot::read("models/franka_panda.urdf")?;
//! let arm = Arm::new(&robot, "base", "flange")?;
//! let begin = arm.base_from_tool(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])?;
//! // Half a metre to the side, a point each five millimetres.
//! let along = |k: u32| Vector3::new(0.0, 0.005 * f64::from(k), 0.0);
//! let points = (0..=100).map(|k| Placement::new(begin.rotation, begin.translation + along(k)));
//! let path = CartesianPath::new(points.collect::<Vec<_>>())?;
//!
//! let solution = PathSolver::new(&arm).solve(&path)?;
//! assert!(solution.reconfigurations.is_empty() && solution.missed.is_empty());
//! assert!(solution.largest_deviation.metres < 1e-4);
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
mod long_steps;
mod option_checks;
mod report;
mod shorten;
mod solution;
mod solver;
mod sorted;
mod spline;
mod step_bounds;
mod straight_way;
mod timing;
mod tools;
mod tracked_path;
mod tridiagonal;
mod turns;

pub use cartesian_path::{CartesianPath, Traversal};
pub use csv::{CsvColumns, QuaternionOrder};
pub use error::PathError;
pub use solution::{Blocked, Deviation, MissReason, Missed, PathSolution, Reconfiguration};
pub use solver::PathSolver;
pub use timing::{TimingLimits, Trajectory, TrajectoryPoint};
