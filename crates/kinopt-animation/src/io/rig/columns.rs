//! Assignment of weight table columns to bones.

use nalgebra::DMatrix;

use super::check::error_at;
use super::json::RigFile;
use crate::io::{FileLocation, ReadError};
use crate::skinning::{SkinWeights, SkinningError};
use kinopt_mesh::mesh::TriangleMesh;

/// Assigns each column of the table to the bone with its `weight_id`.
pub(super) fn weights(
    file: &RigFile,
    table: &DMatrix<f64>,
    mesh: Option<&TriangleMesh>,
    name: &str,
) -> Result<SkinWeights, ReadError> {
    let (rows, columns) = table.shape();
    if let Some(vertices) = mesh
        .map(|mesh| mesh.positions().len())
        .filter(|count| *count != rows)
    {
        let problem = format!("has weights for {rows} vertices, but the mesh has {vertices}");
        return Err(error_at(name, "weights.file", problem));
    }
    let mut owners = vec![None; columns];
    for (bone, entry) in file.bones.iter().enumerate() {
        let id = entry.weight_id;
        if id == -1 {
            continue;
        }
        let path = || format!("bones[{bone}].weight_id");
        let column = usize::try_from(id).ok();
        let Some(owner) = column.and_then(|column| owners.get_mut(column)) else {
            let problem =
                format!("{id} is neither -1 nor one of the {columns} columns of the weights");
            return Err(error_at(name, path(), problem));
        };
        if let Some(other) = owner.replace(bone) {
            let problem = format!("column {id} is bone {other}'s already");
            return Err(error_at(name, path(), problem));
        }
    }
    let fail = |error: SkinningError| {
        let part = file.weights.as_ref().map_or("", |part| &part.file);
        let error = ReadError::new(part, FileLocation::File, error);
        ReadError::referred(name, FileLocation::Json("weights.file".into()), error)
    };
    let mut builder = SkinWeights::builder(rows, file.bones.len());
    for (index, (column, owner)) in table.column_iter().zip(&owners).enumerate() {
        match owner {
            Some(bone) => {
                for (vertex, &weight) in column.iter().enumerate() {
                    builder.add(vertex, *bone, weight).map_err(fail)?;
                }
            }
            None if column.iter().any(|&weight| weight != 0.0) => {
                let problem =
                    format!("column {index} has weights, but no bone has the weight_id {index}");
                return Err(error_at(name, "weights.file", problem));
            }
            None => {}
        }
    }
    builder.build().map_err(fail)
}
