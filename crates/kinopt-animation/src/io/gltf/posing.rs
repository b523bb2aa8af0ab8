//! Meshes of a scene in a pose.

use std::borrow::Borrow;
use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::{Scene, SceneMesh, Skin};
use crate::animation::{Pose, SizeMismatch};
use crate::io::FormatError;
use crate::skinning::{MeshWeights, PosedVertices, SkinWeights, SkinningError, SkinningMethod};
use kinopt_mesh::mesh::{MeshError, TriangleMesh};

/// Poses the meshes of one scene repeatedly, with prepared weights and reused memory. `S` is a `&Scene` or an owner
/// such as `Arc<Scene>`.
#[derive(Clone, Debug)]
pub struct ScenePosing<S> {
    scene: S,
    method: SkinningMethod,
    /// One per mesh; shared by clones.
    weights: Arc<[MeshWeights]>,
    model_from_bone: Vec<Affine3A>,
    posed_from_mesh: Vec<Affine3A>,
}

impl<S: Borrow<Scene>> ScenePosing<S> {
    /// Prepares posing of `scene`. Skins use `method`; with dual quaternions each joint stretches about its bind
    /// position. Meshes without a skin move with their bone, including its scale.
    ///
    /// # Errors
    /// The parts of a mesh differ in size or do not match the scene's armature.
    pub fn new(scene: S, method: SkinningMethod) -> Result<Self, FormatError> {
        let Scene {
            armature, meshes, ..
        } = scene.borrow();
        let mut weights = Vec::with_capacity(meshes.len());
        for mesh in meshes {
            mesh.check(armature)?;
            weights.push(match &mesh.skin {
                Some(skin) => weights_of(skin),
                None => all_of_one_bone(mesh)?.into(),
            });
        }
        Ok(Self {
            model_from_bone: vec![Affine3A::IDENTITY; armature.bones()],
            scene,
            method,
            weights: weights.into(),
            posed_from_mesh: Vec::new(),
        })
    }

    /// The meshes in a pose of the scene's armature, in the scene's frame.
    ///
    /// Morph targets apply first. A mesh with a skin then moves by Σ_j w_j W_j B_j⁻¹ over its joints; other meshes move
    /// with their bone. Triangles of a mesh on a mirroring bone are reversed, so that their outsides stay outside.
    ///
    /// # Errors
    /// The pose belongs to another armature, or a number is not finite. With dual quaternions also a joint that mirrors
    /// or is singular.
    pub fn meshes(&mut self, pose: &Pose) -> Result<Vec<TriangleMesh>, FormatError> {
        self.update_placements(pose)?;
        let meshes = 0..self.scene.borrow().meshes.len();
        meshes.map(|index| self.posed(index, pose)).collect()
    }

    /// Writes the vertices of all meshes, in their order, into the caller's buffers. The pose is that of
    /// [`meshes`](Self::meshes). Empty buffers of positions or normals are skipped.
    ///
    /// # Errors
    /// As [`meshes`](Self::meshes), or a buffer without one entry for each vertex or normal of all meshes.
    pub fn deform(&mut self, pose: &Pose, posed: PosedVertices<'_>) -> Result<(), FormatError> {
        self.update_placements(pose)?;
        let meshes = &self.scene.borrow().meshes;
        let total = |count: fn(&TriangleMesh) -> usize| meshes.iter().map(|m| count(&m.mesh)).sum();
        let sized = |what, given: usize, expected: usize| match given {
            0 => Ok(()),
            _ => SizeMismatch::check(what, given, expected),
        };
        let points = total(|mesh| mesh.positions().len());
        sized("posed positions", posed.positions.len(), points)?;
        let directions = total(|mesh| mesh.normals().len());
        sized("posed normals", posed.normals.len(), directions)?;
        let (mut positions, mut normals) = (posed.positions, posed.normals);
        for index in 0..meshes.len() {
            let mesh = &self.scene.borrow().meshes[index];
            let morphed = morphed(mesh, pose)?;
            let morphed = morphed.as_ref().unwrap_or(&mesh.mesh);
            let (mesh_positions, positions_after) =
                positions.split_at_mut(morphed.positions().len().min(positions.len()));
            let (mesh_normals, normals_after) =
                normals.split_at_mut(morphed.normals().len().min(normals.len()));
            let mesh_vertices = PosedVertices {
                positions: mesh_positions,
                normals: mesh_normals,
                tangents: &mut [],
            };
            let rest = mesh_vertices.rest_of(morphed);
            let method = self.method_of(mesh);
            update_mesh_transforms(mesh, &self.model_from_bone, &mut self.posed_from_mesh);
            self.weights[index]
                .deform(method, &self.posed_from_mesh, rest, mesh_vertices)
                .map_err(skinning_error(mesh))?;
            (positions, normals) = (positions_after, normals_after);
        }
        Ok(())
    }

    fn update_placements(&mut self, pose: &Pose) -> Result<(), FormatError> {
        let armature = &self.scene.borrow().armature;
        armature.rest().check_same_size(pose)?;
        armature.local_to_model(pose, &mut self.model_from_bone)?;
        Ok(())
    }

    /// A mesh without a skin moves with its bone, including its scale.
    fn method_of(&self, mesh: &SceneMesh) -> SkinningMethod {
        match mesh.skin {
            Some(_) => self.method,
            None => SkinningMethod::LinearBlend,
        }
    }

    /// As [`meshes`](Self::meshes), joined to one mesh: the vertices of all meshes in their order. It has normals if
    /// all meshes have them.
    ///
    /// # Errors
    /// As [`meshes`](Self::meshes).
    pub fn mesh(&mut self, pose: &Pose) -> Result<TriangleMesh, FormatError> {
        let meshes = self.meshes(pose)?;
        let with_normals = meshes
            .iter()
            .all(|mesh| mesh.positions().len() == mesh.normals().len());
        let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for mesh in &meshes {
            let first = positions.len() as u32;
            positions.extend_from_slice(mesh.positions());
            if with_normals {
                normals.extend_from_slice(mesh.normals());
            }
            triangles.extend(
                mesh.triangles()
                    .iter()
                    .map(|t| t.map(|index| first + index)),
            );
        }
        let joined = TriangleMesh::new(positions, normals, triangles);
        joined.map_err(mesh_error("all"))
    }

    fn posed(&mut self, index: usize, pose: &Pose) -> Result<TriangleMesh, FormatError> {
        let mesh = &self.scene.borrow().meshes[index];
        let method = self.method_of(mesh);
        update_mesh_transforms(mesh, &self.model_from_bone, &mut self.posed_from_mesh);
        let morphed = morphed(mesh, pose)?;
        let rest = morphed.as_ref().unwrap_or(&mesh.mesh);
        let moved = self.weights[index].mesh(method, rest, &self.posed_from_mesh);
        let moved = moved.map_err(skinning_error(mesh))?;
        let mirrors = |bone: &Affine3A| bone.matrix3.determinant() < 0.0;
        if mesh.skin.is_some() || !self.posed_from_mesh.iter().any(mirrors) {
            return Ok(moved);
        }
        let flipped = moved.triangles().iter().map(|&[a, b, c]| [a, c, b]);
        let (positions, normals) = (moved.positions().to_vec(), moved.normals().to_vec());
        let flipped = TriangleMesh::new(positions, normals, flipped.collect());
        flipped.map_err(mesh_error(&mesh.name))
    }
}

/// The transforms from the mesh to the pose, of the mesh's joints or of its bone.
fn update_mesh_transforms(
    mesh: &SceneMesh,
    model_from_bone: &[Affine3A],
    posed_from_mesh: &mut Vec<Affine3A>,
) {
    let placement = |bone: usize| model_from_bone.get(bone).copied().unwrap_or_default();
    posed_from_mesh.clear();
    match &mesh.skin {
        Some(skin) => {
            let joints = skin.joints.iter().zip(&skin.joint_from_mesh);
            let moved = joints.map(|(joint, bound)| placement(joint.index()) * *bound);
            posed_from_mesh.extend(moved);
        }
        None => posed_from_mesh.push(placement(mesh.bone.index())),
    }
}

/// The weights of a skin, with bind positions as pivots for joints that scale.
fn weights_of(skin: &Skin) -> MeshWeights {
    let weights = MeshWeights::from(skin.weights.clone());
    let bound = skin.joint_from_mesh.iter();
    let pivots: Vec<Vec3> = bound
        .map(|joint| joint.inverse().translation.into())
        .collect();
    match pivots.iter().all(|pivot| pivot.is_finite()) {
        true => weights.with_pivots(pivots),
        false => weights,
    }
}

/// The mesh with its morph targets applied; `None` if all weights are 0.
fn morphed(mesh: &SceneMesh, pose: &Pose) -> Result<Option<TriangleMesh>, FormatError> {
    let weights = pose
        .morph_weights()
        .get(mesh.morph_weights())
        .unwrap_or(&[]);
    if weights.iter().all(|&weight| weight == 0.0) {
        return Ok(None);
    }
    let mut positions: Vec<Vec3> = mesh.mesh.positions().to_vec();
    let mut normals: Vec<Vec3> = mesh.mesh.normals().to_vec();
    let applied = mesh
        .morph_targets
        .apply(weights, &mut positions, &mut normals, &mut []);
    applied.map_err(skinning_error(mesh))?;
    let morphed = mesh.mesh.with_vertices(positions, normals);
    morphed.map(Some).map_err(mesh_error(&mesh.name))
}

/// Weights of a mesh that moves with one bone.
fn all_of_one_bone(mesh: &SceneMesh) -> Result<SkinWeights, FormatError> {
    let vertices = mesh.mesh.positions().len();
    let mut builder = SkinWeights::builder(vertices, 1);
    let added = (0..vertices).try_for_each(|vertex| builder.add(vertex, 0, 1.0));
    let built = added.and_then(|()| builder.build());
    built.map_err(skinning_error(mesh))
}

/// Error of the skin, weights or morph targets of a mesh.
fn skinning_error(mesh: &SceneMesh) -> impl FnOnce(SkinningError) -> FormatError {
    let mesh = mesh.name.clone();
    |problem| FormatError::MeshSkinning { mesh, problem }
}

/// Error of a posed mesh.
fn mesh_error(name: &str) -> impl FnOnce(MeshError) -> FormatError {
    let mesh = name.to_owned();
    |problem| FormatError::Mesh { mesh, problem }
}
