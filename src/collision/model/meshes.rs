//! From the file of a mesh to shapes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::pieces::pieces;
use crate::collision::mesh_file::MeshFile;
use crate::collision::{Shape, ShapeError};
use crate::file::ReadError;

/// What a mesh counts as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshUse {
    /// Its convex hull, as in MuJoCo; that is quick, and fills hollows.
    #[default]
    Hull,
    /// The convex hull of each of its connected parts, for meshes that were split into convex pieces before.
    Parts,
    /// Convex pieces that together hold it, at most so many: boxes cut in two where their hulls are filled worst.
    Pieces(usize),
    /// Its triangles, and what they enclose where they are closed.
    Triangles,
}

/// The shapes of files, each made once.
#[derive(Debug, Default)]
pub(super) struct Meshes {
    made: HashMap<(PathBuf, [u64; 3]), Vec<Shape>>,
}

/// What can go wrong with a mesh.
#[derive(Debug)]
pub(super) enum MeshFault {
    File(ReadError),
    Shape(ShapeError),
}

impl Meshes {
    pub(super) fn shapes(
        &mut self,
        path: &Path,
        scale: [f64; 3],
        meshes: MeshUse,
    ) -> Result<&[Shape], MeshFault> {
        let key = (path.to_owned(), scale.map(f64::to_bits));
        if !self.made.contains_key(&key) {
            let mesh = MeshFile::read(path).map_err(MeshFault::File)?.scaled(scale);
            let shapes = shapes(mesh, meshes).map_err(MeshFault::Shape)?;
            self.made.insert(key.clone(), shapes);
        }
        Ok(self.made.get(&key).map_or(&[], Vec::as_slice))
    }
}

fn shapes(mesh: MeshFile, meshes: MeshUse) -> Result<Vec<Shape>, ShapeError> {
    let hull = |mesh: &MeshFile| Shape::convex(&mesh.points);
    Ok(match meshes {
        MeshUse::Hull => vec![hull(&mesh.without_loose_points())?],
        MeshUse::Parts => {
            // A part in one plane has no hull, but a surface.
            let shape = |part: MeshFile| match hull(&part) {
                Err(_) => Shape::mesh(part.points, part.triangles),
                hull => hull,
            };
            mesh.parts()
                .into_iter()
                .map(shape)
                .collect::<Result<_, _>>()?
        }
        MeshUse::Pieces(most) => pieces(&mesh, most)?,
        MeshUse::Triangles => vec![Shape::mesh(mesh.points, mesh.triangles)?],
    })
}
