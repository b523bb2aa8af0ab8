//! Poses and armatures: local transforms of bones and their model transforms.
//!
//! An [`Armature`] is a tree of bones with a rest pose. A [`Pose`] has a [`LocalTransform`] for each bone: scale, then
//! rotation, then translation in the parent.

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

pub use armature::{Armature, ArmatureBone};
pub use local_transform::LocalTransform;
#[doc(hidden)]
pub use mirror::Mirror;
pub use pose::Pose;
pub use scale_note::ScaleNote;
#[doc(hidden)]
pub use stretch::Stretch;
