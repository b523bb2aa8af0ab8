//! A rig's mesh in a pose.

use glam::Affine3A;

use super::Rig;
use crate::animation::{Armature, Pose, SizeMismatch};
use crate::kinematics::KinematicsError;
use crate::mesh::TriangleMesh;
use crate::skeleton::{Posing, Skeleton};
use crate::skinning::{
    AutomaticWeights, AutomaticWeightsError, MeshWeights, SkinningError, SkinningMethod,
    single_precision_transform,
};

/// Poses the mesh of a rig again and again: its weights made ready once, and room for transforms.
#[derive(Clone, Debug)]
pub struct RigPosing<'a> {
    skeleton: &'a Skeleton,
    mesh: &'a TriangleMesh,
    method: SkinningMethod,
    weights: MeshWeights,
    automatic: bool,
    posing: Posing,
    armature: Armature,
    model_from_bone: Vec<Affine3A>,
    posed_from_rest: Vec<Affine3A>,
}

/// Why a rig's mesh cannot be posed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigPosingError {
    /// The rig is bones alone.
    #[error("the rig has no mesh")]
    NoMesh,
    /// The file has no weights, and none can be made.
    #[error("the rig has no skin weights, and none can be made up: {0}")]
    Weights(AutomaticWeightsError),
    /// A configuration of other bones, or one that is not finite.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// A pose of other bones.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// The skin and its transforms.
    #[error(transparent)]
    Skinning(#[from] SkinningError),
}

impl Rig {
    /// The mesh in the pose of the stacked angles `q` (radians), such as a
    /// [`Solution`](crate::Solution)'s: positions, and normals where the mesh has them.
    /// [`posing`](Self::posing) does the same for many poses.
    ///
    /// # Errors
    /// As [`posing`](Self::posing) and [`RigPosing::mesh`].
    pub fn posed_mesh(
        &self,
        q: &[f64],
        method: SkinningMethod,
    ) -> Result<TriangleMesh, RigPosingError> {
        self.posing(method)?.mesh(q)
    }

    /// Memory for posing the mesh by `method`. A mesh without weights gets some from the bones next to
    /// each vertex: [`RigPosing::has_automatic_weights`].
    ///
    /// # Errors
    /// The rig has no mesh, or no weights and none can be made.
    pub fn posing(&self, method: SkinningMethod) -> Result<RigPosing<'_>, RigPosingError> {
        let skeleton = &self.skeleton;
        let mesh = self.mesh.as_ref().ok_or(RigPosingError::NoMesh)?;
        let weights = match &self.weights {
            Some(weights) => weights.clone(),
            None => AutomaticWeights::default()
                .for_skeleton(mesh, skeleton)
                .map_err(RigPosingError::Weights)?,
        };
        Ok(RigPosing {
            skeleton,
            mesh,
            method,
            weights: weights.into(),
            automatic: self.weights.is_none(),
            posing: Posing::new(skeleton),
            armature: Armature::of_skeleton(skeleton),
            model_from_bone: Vec::new(),
            posed_from_rest: Vec::new(),
        })
    }
}

impl RigPosing<'_> {
    /// Whether the rig has no weights of its own, so that vertices follow the bones next to them.
    #[must_use]
    pub fn has_automatic_weights(&self) -> bool {
        self.automatic
    }

    /// The mesh for the stacked angles `q` (radians, one for each of the skeleton's).
    ///
    /// # Errors
    /// Another number of angles, or a number that is not finite.
    pub fn mesh(&mut self, q: &[f64]) -> Result<TriangleMesh, RigPosingError> {
        let pose = self.posing.pose(q)?;
        self.posed_from_rest.clear();
        let transforms = pose.skinning_transforms(self.skeleton);
        let transforms = transforms.map(|transform| single_precision_transform(&transform));
        self.posed_from_rest.extend(transforms);
        self.skin()
    }

    /// The mesh in a pose of the skeleton's [armature](Armature::of_skeleton), such as a clip's.
    ///
    /// # Errors
    /// A pose of another armature, or a number that is not finite.
    pub fn mesh_of_pose(&mut self, pose: &Pose) -> Result<TriangleMesh, RigPosingError> {
        let placed = &mut self.model_from_bone;
        self.armature.local_to_model(pose, placed)?;
        self.armature
            .skinning_transforms(placed, &mut self.posed_from_rest)?;
        self.skin()
    }

    fn skin(&self) -> Result<TriangleMesh, RigPosingError> {
        let transforms = &self.posed_from_rest;
        Ok(self.weights.mesh(self.method, self.mesh, transforms)?)
    }
}
