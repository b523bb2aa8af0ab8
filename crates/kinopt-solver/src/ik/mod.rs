//! Solvers of a [`Problem`](crate::Problem), drags, loop closure and derivatives of solutions.

mod collision_avoidance;
mod collision_free_search;
mod depenetration;
mod drag;
mod drag_clear;
mod drag_frame;
mod drag_motion;
mod drag_to_rest;
mod escape;
mod hold_postures;
mod joint_interpolation;
mod joint_jump;
mod loop_closure;
mod minimiser;
mod motion_limits;
mod nearest_closure;
mod placement_relaxation;
mod priority;
mod solution_derivative;
mod solver;
mod stance;
mod step_guard;
mod workspace;

pub use crate::problem::LoopGap;
pub use crate::search::{
    ActiveLimit, BodyKind, BoundKind, Collision, MoveLimits, OpenLoop, Restarts, RowBlockReport,
    Side, Solution, SolveError, TaskReport,
};
pub use drag::Drag;
pub use hold_postures::hold_postures;
pub use joint_jump::JointJump;
pub use loop_closure::LoopClosure;
#[doc(hidden)]
pub use minimiser::Minimiser;
pub use motion_limits::MotionLimits;
pub use solution_derivative::{
    DerivativeWorkspace, Differentiability, NoDerivative, SolutionDerivative,
};
pub use solver::Solver;
pub use stance::crouched_configuration;
pub use workspace::Workspace;
