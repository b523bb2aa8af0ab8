//! Writing the mesh in a pose.

use std::path::{Path, PathBuf};

use kinopt::io::ply::PlyEncoding;
use kinopt::io::{obj, ply};
use kinopt::mesh::TriangleMesh;
use kinopt::skeleton::Skeleton;
use kinopt::skinning::{SkinWeights, SkinningMethod, single_precision_transform};

use crate::failure::{Failure, Outcome};
use crate::loaded_model::LoadedModel;

/// `--out`: where to write, and as what.
#[derive(Clone, Debug)]
pub(crate) struct MeshFile {
    path: PathBuf,
    format: MeshFormat,
}

#[derive(Clone, Copy, Debug)]
enum MeshFormat {
    Obj,
    Ply,
}

impl MeshFile {
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let path = PathBuf::from(text);
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let format = match extension.to_ascii_lowercase().as_str() {
            "obj" => MeshFormat::Obj,
            "ply" => MeshFormat::Ply,
            _ => return Err("meshes are written as .obj or .ply".to_owned()),
        };
        Ok(Self { path, format })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn write(&self, mesh: &TriangleMesh) -> Outcome<()> {
        match self.format {
            MeshFormat::Obj => obj::write(mesh, &self.path)?,
            MeshFormat::Ply => ply::write(mesh, PlyEncoding::BinaryLittleEndian, &self.path)?,
        }
        Ok(())
    }
}

/// A mesh that bones move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Skin<'a> {
    skeleton: &'a Skeleton,
    mesh: &'a TriangleMesh,
    weights: &'a SkinWeights,
}

impl LoadedModel {
    /// The model's mesh and its weights, both of which posing it needs.
    pub(crate) fn skin(&self) -> Outcome<Skin<'_>> {
        let lacks = |what: &str| {
            let (file, kind) = (&self.file, self.kind());
            Failure::new(format!(
                "{file}: --out needs {what}, and the {kind} has none"
            ))
        };
        let rig = self.rig.as_ref().ok_or_else(|| lacks("a mesh"))?;
        Ok(Skin {
            skeleton: &rig.skeleton,
            mesh: rig.mesh.as_ref().ok_or_else(|| lacks("a mesh"))?,
            weights: rig.weights.as_ref().ok_or_else(|| lacks("skin weights"))?,
        })
    }
}

impl Skin<'_> {
    /// The mesh for the stacked angles `q`, in radians.
    pub(crate) fn posed(&self, q: &[f64], method: SkinningMethod) -> Outcome<TriangleMesh> {
        let pose = self.skeleton.pose(q);
        let transforms = pose.skinning_transforms(self.skeleton);
        let transforms: Vec<_> = transforms.map(|t| single_precision_transform(&t)).collect();
        Ok(method.mesh(self.mesh, self.weights, &transforms)?)
    }
}
