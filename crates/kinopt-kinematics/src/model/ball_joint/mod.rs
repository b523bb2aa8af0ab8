//! Ball joints: limits of swing, twist and total angle, and the three variables of a rotation within them.
//!
//! The solver's sets of rotations, and steps along their edges, are in `solver/ball_joints` of kinopt-solver.

mod limits;
mod rotation_chart;
mod variables;

pub use limits::BallLimits;
pub use rotation_chart::RotationChart;
pub(super) use rotation_chart::sample_rotation;
pub use variables::BallVariables;
