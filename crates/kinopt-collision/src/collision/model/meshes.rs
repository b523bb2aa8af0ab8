//! Conversion of mesh files to collision shapes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::pieces::pieces;
use crate::collision::mesh_file::MeshFile;
use crate::collision::{Shape, ShapeError};
use kinopt_kinematics::file::ReadError;

/// Representation of meshes in collision checks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshUse {
    /// The convex hull, as in MuJoCo. Fast, but fills concavities.
    #[default]
    Hull,
    /// The convex hull of each connected part, for meshes that are already decomposed into convex parts.
    Parts,
    /// A convex decomposition into at most the given number of pieces, which together contain the mesh.
    Pieces(usize),
    /// The triangles, and the enclosed volume if the mesh is closed.
    Triangles,
}

/// Cache of the shapes of mesh files.
#[derive(Debug, Default)]
pub(super) struct MeshCache {
    cache: HashMap<(PathBuf, [u64; 3]), Vec<Shape>>,
}

/// Reason why a mesh gives no shape.
#[derive(Debug)]
pub(super) enum MeshFault {
    File(ReadError),
    Shape(ShapeError),
}

impl MeshCache {
    pub(super) fn shapes(
        &mut self,
        path: &Path,
        scale: [f64; 3],
        meshes: MeshUse,
    ) -> Result<&[Shape], MeshFault> {
        let key = (path.to_owned(), scale.map(f64::to_bits));
        if !self.cache.contains_key(&key) {
            let mesh = MeshFile::read(path).map_err(MeshFault::File)?.scaled(scale);
            let shapes = shapes(mesh, meshes).map_err(MeshFault::Shape)?;
            self.cache.insert(key.clone(), shapes);
        }
        Ok(self.cache.get(&key).map_or(&[], Vec::as_slice))
    }
}

fn shapes(mesh: MeshFile, meshes: MeshUse) -> Result<Vec<Shape>, ShapeError> {
    let hull = |mesh: &MeshFile| Shape::convex(&mesh.points);
    Ok(match meshes {
        MeshUse::Hull => vec![hull(&mesh.without_loose_points())?],
        MeshUse::Parts => {
            // A planar part has no convex hull, so it stays a mesh.
            let shape = |part: MeshFile| match hull(&part) {
                Err(_) => Shape::mesh(part.points, part.triangles),
                hull => hull,
            };
            mesh.parts()
                .into_iter()
                .map(shape)
                .collect::<Result<_, _>>()?
        }
        MeshUse::Pieces(max_pieces) => pieces(&mesh, max_pieces)?,
        MeshUse::Triangles => vec![Shape::mesh(mesh.points, mesh.triangles)?],
    })
}
