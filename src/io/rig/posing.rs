//! A rig's mesh in a pose.

use std::borrow::Borrow;
use std::sync::Arc;

use glam::Affine3A;

use super::Rig;
use crate::animation::{Armature, Pose, SizeMismatch};
use crate::kinematics::KinematicsError;
use crate::mesh::TriangleMesh;
use crate::skeleton::Posing;
use crate::skinning::{
    AutomaticWeights, AutomaticWeightsError, MeshWeights, PosedVertices, SkinningError,
    SkinningMethod, single_precision_transform,
};

/// Poses the mesh of a rig again and again: its weights made ready once, and room for transforms.
/// `R` is a `&Rig`, or what owns one, such as an `Arc<Rig>`.
#[derive(Clone, Debug)]
pub struct RigPosing<R> {
    rig: R,
    method: SkinningMethod,
    /// Shared by clones.
    weights: Arc<MeshWeights>,
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
    pub fn posing(&self, method: SkinningMethod) -> Result<RigPosing<&Self>, RigPosingError> {
        RigPosing::new(self, method)
    }
}

impl<R: Borrow<Rig>> RigPosing<R> {
    /// As [`Rig::posing`], which borrows the rig; this takes what owns it as well.
    ///
    /// # Errors
    /// As there.
    pub fn new(rig: R, method: SkinningMethod) -> Result<Self, RigPosingError> {
        let Rig {
            skeleton,
            mesh,
            weights,
            ..
        } = rig.borrow();
        let mesh = mesh.as_ref().ok_or(RigPosingError::NoMesh)?;
        let automatic = weights.is_none();
        let weights = match weights {
            Some(weights) => weights.clone(),
            None => AutomaticWeights::default()
                .for_skeleton(mesh, skeleton)
                .map_err(RigPosingError::Weights)?,
        };
        Ok(Self {
            method,
            weights: Arc::new(weights.into()),
            automatic,
            posing: Posing::new(skeleton),
            armature: Armature::of_skeleton(skeleton),
            model_from_bone: Vec::new(),
            posed_from_rest: Vec::new(),
            rig,
        })
    }

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
        self.place(q)?;
        self.skin()
    }

    /// As [`mesh`](Self::mesh), into buffers of the caller's: whichever of positions and normals are
    /// there. Rigs have no tangents.
    ///
    /// # Errors
    /// As there, or a buffer has not one entry for each of the mesh's.
    pub fn deform(&mut self, q: &[f64], posed: PosedVertices<'_>) -> Result<(), RigPosingError> {
        self.place(q)?;
        self.skin_into(posed)
    }

    /// The mesh in a pose of the skeleton's [armature](Armature::of_skeleton), such as a clip's.
    ///
    /// # Errors
    /// A pose of another armature, or a number that is not finite.
    pub fn mesh_of_pose(&mut self, pose: &Pose) -> Result<TriangleMesh, RigPosingError> {
        self.place_pose(pose)?;
        self.skin()
    }

    /// As [`mesh_of_pose`](Self::mesh_of_pose), into buffers of the caller's, as
    /// [`deform`](Self::deform) has it.
    ///
    /// # Errors
    /// As both.
    pub fn deform_to_pose(
        &mut self,
        pose: &Pose,
        posed: PosedVertices<'_>,
    ) -> Result<(), RigPosingError> {
        self.place_pose(pose)?;
        self.skin_into(posed)
    }

    /// Each bone's transform for `q`, rest → posed.
    fn place(&mut self, q: &[f64]) -> Result<(), RigPosingError> {
        let pose = self.posing.pose(q)?;
        self.posed_from_rest.clear();
        let transforms = pose.skinning_transforms(&self.rig.borrow().skeleton);
        let transforms = transforms.map(|transform| single_precision_transform(&transform));
        self.posed_from_rest.extend(transforms);
        Ok(())
    }

    /// Each bone's transform in a pose, rest → posed.
    fn place_pose(&mut self, pose: &Pose) -> Result<(), RigPosingError> {
        let placed = &mut self.model_from_bone;
        self.armature.local_to_model(pose, placed)?;
        self.armature
            .skinning_transforms(placed, &mut self.posed_from_rest)?;
        Ok(())
    }

    fn skin(&self) -> Result<TriangleMesh, RigPosingError> {
        let mesh = self.rest()?;
        let transforms = &self.posed_from_rest;
        Ok(self.weights.mesh(self.method, mesh, transforms)?)
    }

    fn skin_into(&self, posed: PosedVertices<'_>) -> Result<(), RigPosingError> {
        let mesh = self.rest()?;
        let rest = posed.wanted_of(mesh);
        let transforms = &self.posed_from_rest;
        Ok(self.weights.deform(self.method, transforms, rest, posed)?)
    }

    fn rest(&self) -> Result<&TriangleMesh, RigPosingError> {
        let mesh = self.rig.borrow().mesh.as_ref();
        mesh.ok_or(RigPosingError::NoMesh)
    }
}
