//! Poses: where bones stand in their parents, and from there to the model.

mod armature;
mod in_model;
mod local_transform;
#[allow(clippy::module_inception, reason = "it is the pose itself")]
mod pose;
#[cfg(feature = "serde")]
mod serialised;

pub use armature::{Armature, ArmatureBone, ArmatureError};
pub use local_transform::LocalTransform;
pub(crate) use local_transform::scales_evenly;
pub use pose::{LocalError, Pose};
