//! Mesh of a rig in a pose.

use std::borrow::Borrow;
use std::sync::Arc;

use glam::Affine3A;

use super::Rig;
use crate::animation::{Armature, Pose};
use crate::io::FormatError;
use crate::skinning::{
    AutomaticWeights, MeshWeights, PosedVertices, SkinningMethod, single_precision_transform,
};
use kinopt_kinematics::skeleton::Posing;
use kinopt_mesh::mesh::TriangleMesh;

/// Poses the mesh of a rig repeatedly, with prepared weights and reused memory. `R` is a `&Rig` or an owner such as
/// `Arc<Rig>`.
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

impl Rig {
    /// The mesh in the pose of the joint angles `q` (radians), such as those of a [`Solution`](kinopt_solver::Solution):
    /// positions, and normals if the mesh has them. Use [`posing`](Self::posing) for many poses.
    ///
    /// # Errors
    /// As [`posing`](Self::posing) and [`RigPosing::mesh`].
    pub fn posed_mesh(
        &self,
        q: &[f64],
        method: SkinningMethod,
    ) -> Result<TriangleMesh, FormatError> {
        self.posing(method)?.mesh(q)
    }

    /// Prepares posing of the mesh by `method`. A mesh without weights gets automatic ones: see
    /// [`RigPosing::has_automatic_weights`].
    ///
    /// # Errors
    /// The rig has no mesh, or it has no weights and automatic weights failed.
    pub fn posing(&self, method: SkinningMethod) -> Result<RigPosing<&Self>, FormatError> {
        RigPosing::new(self, method)
    }
}

impl<R: Borrow<Rig>> RigPosing<R> {
    /// Prepares posing of a rig, which may be borrowed or owned: see [`Rig::posing`].
    ///
    /// # Errors
    /// As [`Rig::posing`].
    pub fn new(rig: R, method: SkinningMethod) -> Result<Self, FormatError> {
        let Rig {
            skeleton,
            mesh,
            weights,
            ..
        } = rig.borrow();
        let mesh = mesh.as_ref().ok_or(FormatError::NoMesh)?;
        let automatic = weights.is_none();
        let weights = match weights {
            Some(weights) => weights.clone(),
            None => AutomaticWeights::default()
                .for_skeleton(mesh, skeleton)
                .map_err(FormatError::NoWeights)?,
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

    /// Reports whether the weights are automatic, because the rig has none.
    #[must_use]
    pub fn has_automatic_weights(&self) -> bool {
        self.automatic
    }

    /// The mesh for the joint angles `q` (radians, as many as the skeleton has).
    ///
    /// # Errors
    /// A different number of angles, or a number that is not finite.
    pub fn mesh(&mut self, q: &[f64]) -> Result<TriangleMesh, FormatError> {
        self.update_transforms(q)?;
        self.skin()
    }

    /// As [`mesh`](Self::mesh), into the caller's buffers of positions and normals; empty buffers are skipped. Rigs
    /// have no tangents.
    ///
    /// # Errors
    /// As [`mesh`](Self::mesh), or a buffer without one entry per vertex.
    pub fn deform(&mut self, q: &[f64], posed: PosedVertices<'_>) -> Result<(), FormatError> {
        self.update_transforms(q)?;
        self.skin_into(posed)
    }

    /// The mesh in a pose of the skeleton's [armature](Armature::of_skeleton), such as a pose of a clip.
    ///
    /// # Errors
    /// A pose of another armature, or a number that is not finite.
    pub fn mesh_of_pose(&mut self, pose: &Pose) -> Result<TriangleMesh, FormatError> {
        self.update_transforms_of_pose(pose)?;
        self.skin()
    }

    /// As [`mesh_of_pose`](Self::mesh_of_pose), into the caller's buffers: see [`deform`](Self::deform).
    ///
    /// # Errors
    /// As [`mesh_of_pose`](Self::mesh_of_pose) and [`deform`](Self::deform).
    pub fn deform_to_pose(
        &mut self,
        pose: &Pose,
        posed: PosedVertices<'_>,
    ) -> Result<(), FormatError> {
        self.update_transforms_of_pose(pose)?;
        self.skin_into(posed)
    }

    /// Computes the transform of each bone for `q`, rest → posed.
    fn update_transforms(&mut self, q: &[f64]) -> Result<(), FormatError> {
        let pose = self.posing.pose(q)?;
        self.posed_from_rest.clear();
        let transforms = pose.skinning_transforms(&self.rig.borrow().skeleton);
        let transforms = transforms.map(|transform| single_precision_transform(&transform));
        self.posed_from_rest.extend(transforms);
        Ok(())
    }

    /// Computes the transform of each bone in a pose, rest → posed.
    fn update_transforms_of_pose(&mut self, pose: &Pose) -> Result<(), FormatError> {
        let placed = &mut self.model_from_bone;
        self.armature.local_to_model(pose, placed)?;
        self.armature
            .skinning_transforms(placed, &mut self.posed_from_rest)?;
        Ok(())
    }

    fn skin(&self) -> Result<TriangleMesh, FormatError> {
        let mesh = self.rest()?;
        let transforms = &self.posed_from_rest;
        Ok(self.weights.mesh(self.method, mesh, transforms)?)
    }

    fn skin_into(&self, posed: PosedVertices<'_>) -> Result<(), FormatError> {
        let mesh = self.rest()?;
        let rest = posed.rest_of(mesh);
        let transforms = &self.posed_from_rest;
        Ok(self.weights.deform(self.method, transforms, rest, posed)?)
    }

    fn rest(&self) -> Result<&TriangleMesh, FormatError> {
        let mesh = self.rig.borrow().mesh.as_ref();
        mesh.ok_or(FormatError::NoMesh)
    }
}
