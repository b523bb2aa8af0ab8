//! Curves through rotations, and representations of rotations.

mod axis_angle;
mod euler;
pub(crate) mod exponential;
mod hermite;
mod keyed;
#[cfg(feature = "serde")]
mod serialised;
mod slerp;
mod squad;

pub use axis_angle::AxisAngle;
pub use euler::{EulerAngles, EulerOrder};
pub use hermite::{RotationHermite, mean_rates};
#[cfg(feature = "gltf")]
pub(crate) use keyed::BetweenRotations;
pub use keyed::RotationCurve;
pub use slerp::{nearer, nlerp, slerp, slerp_vectors};
pub use squad::{squad, squad_control};
