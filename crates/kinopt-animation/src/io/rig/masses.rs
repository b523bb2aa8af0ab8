//! Masses of a rig, from the volume of its mesh.

use super::Rig;
use crate::skinning::{AutomaticWeights, bone_volumes, masses_of_volumes};
use kinopt_kinematics::kinematics::{KinematicsError, centre_of_mass};
use kinopt_kinematics::model::{Masses, ModelError};
use kinopt_kinematics::spatial::Vector3;

impl Rig {
    /// Masses of the bones: the volume that moves with each bone by its weights ([`bone_volumes`]), times `density`. A
    /// human body has about 1000 kg/m³, for a rig in metres. A mesh without weights gets automatic ones.
    ///
    /// # Errors
    /// No mesh, or a mesh that does not enclose a volume. Also a density that is negative, 0 or not finite.
    pub fn masses(&self, density: f64) -> Result<Masses, ModelError> {
        let no_volume = |reason: &dyn std::fmt::Display| ModelError::NoVolume(reason.to_string());
        let mesh = self.mesh.as_ref();
        let mesh = mesh.ok_or_else(|| no_volume(&"the rig has no mesh"))?;
        let computed;
        let weights = match &self.weights {
            Some(weights) => weights,
            None => {
                let automatic = AutomaticWeights::default().for_skeleton(mesh, &self.skeleton);
                computed = automatic.map_err(|error| no_volume(&error))?;
                &computed
            }
        };
        let volumes = bone_volumes(mesh, weights).map_err(|error| no_volume(&error))?;
        masses_of_volumes(&self.skeleton, &volumes, density)
    }

    /// Position of the centre of mass in the pose of the joint angles `q` (radians), for a uniform density. It is in
    /// the rig's frame and unit.
    ///
    /// # Errors
    /// As [`masses`](Self::masses), or an invalid configuration.
    pub fn centre_of_mass(&self, q: &[f64]) -> Result<Vector3<f64>, KinematicsError> {
        centre_of_mass(self.skeleton.model(), &self.masses(1.0)?, q)
    }
}
