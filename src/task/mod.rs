//! What frames and joints should do: one residual a file.
//!
//! A frame that a task asks to be somewhere is an end effector. The joints between it and the root are
//! its kinematic chain: forward kinematics goes from their values to the frame, inverse kinematics
//! back, by minimising what the tasks measure. Several tasks make one sum: one tip on a viewing
//! [`Ray`] (or at a [`Pixel`]), others held at a [`Point`].
//!
//! A [`Residual`] is written once over the [`Scalar`](crate::Scalar); its derivatives follow
//! exactly; one that is known by its numbers alone is [`Numeric`]. A [`Task`] gives it weights, tolerances and a name.

mod by_dual_numbers;
mod centre_of_mass;
mod convex_polygon;
mod distance;
mod erased;
mod frame_goal;
mod frame_velocity;
mod gaze;
mod goal;
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
mod room;
mod smoothness;
mod support_polygon;
mod upright;
mod weighted;
mod within;

pub(crate) use by_dual_numbers::{CHUNK, DualScratch};
pub use centre_of_mass::CentreOfMass;
pub use distance::Distance;
pub(crate) use erased::ErasedResidual;
pub(crate) use frame_goal::FrameGoal;
pub use frame_velocity::FrameVelocity;
pub use gaze::Gaze;
pub use goal::{Axis, Goal};
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
pub use pose::Pose;
pub use posture::Posture;
pub(crate) use quantity::angle_of;
pub use quantity::{Quantity, Rows};
pub use ray::Ray;
pub use residual::{Residual, Role};
pub use room::Room;
pub use smoothness::Smoothness;
pub use support_polygon::SupportPolygon;
pub use weighted::Task;
pub use within::Within;
