//! Masses of a skeleton from the volumes of its bones.

use super::BoneVolume;
use kinopt_kinematics::model::{Masses, ModelError, PointMass};
use kinopt_kinematics::skeleton::Skeleton;

/// The volume of each bone times `density`, as a point mass on its tail's frame. `volumes` are by bone, at rest.
///
/// # Errors
/// A density that is negative, 0 or not finite, or volumes that are all 0.
pub(crate) fn masses_of_volumes(
    skeleton: &Skeleton,
    volumes: &[BoneVolume],
    density: f64,
) -> Result<Masses, ModelError> {
    let bones = skeleton.bone_ids().zip(skeleton.bones()).zip(volumes);
    let masses = bones.map(|((id, bone), volume)| PointMass {
        frame: skeleton.tail(id),
        at: bone.model_from_rest.inverse().apply(volume.centre),
        mass: density * volume.volume,
    });
    Masses::new(skeleton.model(), masses)
}
