//! Poses and armatures: local transforms of bones and their model transforms.

mod armature;
mod local_transform;
mod mirror;
mod model_space;
#[allow(clippy::module_inception, reason = "it is the pose itself")]
mod pose;
mod scale_note;
#[cfg(feature = "serde")]
mod serialised;
mod stretch;

pub use armature::{Armature, ArmatureBone, ArmatureError};
pub use local_transform::LocalTransform;
pub(crate) use mirror::Mirror;
pub use pose::{LocalError, Pose};
pub use scale_note::ScaleNote;
pub(crate) use stretch::Stretch;
