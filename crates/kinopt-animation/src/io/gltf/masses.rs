//! Masses of a scene's bones, from the volume of its meshes.

use super::{Scene, ScenePosing};
use crate::skinning::{SkinWeights, SkinningMethod, bone_volumes_within, masses_of_volumes};
use kinopt_kinematics::model::{Masses, ModelError};
use kinopt_kinematics::skeleton::Skeleton;

/// Largest fraction of open columns: clothes of characters are often open.
const MAX_OPEN_FRACTION: f64 = 0.5;

impl Scene {
    /// Masses of the bones of `skeleton`, the skeleton of this scene's armature: the volume of all meshes that moves
    /// with each bone, times `density`. A human body has about 1000 kg/m³, for a scene in metres.
    ///
    /// Overlapping meshes count once. Open parts of meshes, such as clothes, do not count.
    ///
    /// # Errors
    /// No mesh, or meshes that are mostly open. Also a density that is negative, 0 or not finite.
    pub fn masses(&self, skeleton: &Skeleton, density: f64) -> Result<Masses, ModelError> {
        let no_volume = |reason: &dyn std::fmt::Display| ModelError::NoVolume(reason.to_string());
        if self.meshes.is_empty() {
            return Err(no_volume(&"the scene has no mesh"));
        }
        let posing = ScenePosing::new(self, SkinningMethod::LinearBlend);
        let mesh = posing.and_then(|mut posing| posing.mesh(self.armature.rest()));
        let mesh = mesh.map_err(|error| no_volume(&error))?;
        let weights = self.bone_weights().map_err(|error| no_volume(&error))?;
        let volumes = bone_volumes_within(&mesh, &weights, MAX_OPEN_FRACTION);
        let volumes = volumes.map_err(|error| no_volume(&error))?;
        masses_of_volumes(skeleton, &volumes, density)
    }

    /// Weights of all bones on the vertices of all meshes, in their order.
    fn bone_weights(&self) -> Result<SkinWeights, crate::skinning::SkinningError> {
        let vertices = self.meshes.iter().map(|mesh| mesh.mesh.positions().len());
        let mut builder = SkinWeights::builder(vertices.sum(), self.armature.bones());
        let mut first = 0;
        for mesh in &self.meshes {
            let count = mesh.mesh.positions().len();
            for vertex in 0..count {
                match &mesh.skin {
                    None => builder.add(first + vertex, mesh.bone.index(), 1.0)?,
                    Some(skin) => {
                        for influence in skin.weights.influences(vertex) {
                            let joint = skin.joints.get(influence.bone as usize);
                            let bone = joint.map_or(mesh.bone, |joint| *joint);
                            builder.add(first + vertex, bone.index(), influence.weight)?;
                        }
                    }
                }
            }
            first += count;
        }
        Ok(builder.build_repaired()?.0)
    }
}
