//! Residuals and tasks for frames and joints; one residual per file.
//!
//! The target frame of a task is an end effector. The joints from the root to it are its kinematic chain. Forward
//! kinematics maps joint values to the frame; inverse kinematics minimises the weighted sum of all tasks. For example,
//! one end effector is on a viewing [`Ray`] or at a [`Pixel`], and others stay at a [`Point`].
//!
//! A [`Residual`] is written once over the [`Scalar`](kinopt_kinematics::Scalar), which gives exact derivatives. A residual known
//! by its values only is [`Numeric`]. A residual with inequalities is also an [`InequalityResidual`], one with a target a
//! [`DifferentiableTarget`]. A [`Task`] adds weights, tolerances and a name.

mod bounded;
mod by_dual_numbers;
mod centre_of_mass;
mod convex_polygon;
mod description;
mod differentiable_target;
mod distance;
mod erased;
mod extensions;
mod frame_goal;
mod frame_velocity;
mod gaze;
mod goal;
mod inequality;
mod inequality_residual;
mod inputs;
mod joint_coupling;
mod limit_centring;
mod local_jacobian;
mod look_at;
mod manipulability;
mod numeric;
mod orientation;
mod pixel;
mod plane;
mod point;
mod pose;
mod posture;
mod quantity;
mod ray;
mod residual;
mod smoothness;
mod support_polygon;
mod upright;
mod weighted;

pub use bounded::Bounded;
pub(crate) use by_dual_numbers::{CHUNK, DualScratch};
pub use centre_of_mass::CentreOfMass;
pub use description::Description;
pub use differentiable_target::DifferentiableTarget;
pub use distance::Distance;
pub(crate) use erased::ErasedResidual;
pub use extensions::Extensions;
pub(crate) use frame_goal::FrameGoal;
pub use frame_velocity::FrameVelocity;
pub use gaze::Gaze;
pub use goal::{Axis, PoseBounds};
pub use inequality::Inequality;
pub use inequality_residual::InequalityResidual;
pub use inputs::Inputs;
pub use joint_coupling::JointCoupling;
pub use limit_centring::LimitCentring;
pub use local_jacobian::LocalJacobian;
pub use look_at::LookAt;
pub use manipulability::Manipulability;
pub use numeric::{Numeric, NumericResidual};
pub use orientation::Orientation;
pub use pixel::{Camera, Pixel};
pub use plane::Plane;
pub use point::Point;
pub use pose::FramePose;
pub use posture::Posture;
#[doc(hidden)]
pub use quantity::angle_of;
pub use quantity::{Quantity, RowBlock};
pub use ray::Ray;
pub use residual::{Residual, Role};
pub use smoothness::Smoothness;
pub use support_polygon::SupportPolygon;
pub use weighted::Task;
