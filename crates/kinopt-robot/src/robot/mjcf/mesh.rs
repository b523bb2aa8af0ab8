//! `<asset><mesh>`: references to mesh files.

use std::collections::HashMap;

use super::attributes::Attributes;
use super::compiler::Compiler;
use super::defaults::Defaults;
use super::tree::Tag;
use crate::robot::Geometry;
use crate::robot::xml::{ParseIssue, Read, RobotFileError, rotation_of_wxyz};
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

/// A mesh asset.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    pub(super) geometry: Geometry,
    /// Transform from the coordinates of the mesh file to the shape.
    pub(super) shape_from_file: Placement<f64>,
}

/// The usable mesh assets of a document by name.
pub(super) fn read_all<'a>(
    root: Tag<'a>,
    compiler: &Compiler,
    defaults: &Defaults<'a>,
    left_out: &mut Vec<RobotFileError>,
) -> HashMap<String, Mesh> {
    let assets = root.children_named("asset");
    let tags = assets.flat_map(|asset| asset.children_named("mesh"));
    let mut meshes = HashMap::new();
    for tag in tags {
        match read(tag, compiler, defaults) {
            Ok(Some((name, mesh))) => {
                meshes.insert(name, mesh);
            }
            Ok(None) => {}
            Err(error) => left_out.push(error),
        }
    }
    meshes
}

fn read(
    tag: Tag<'_>,
    compiler: &Compiler,
    defaults: &Defaults<'_>,
) -> Read<Option<(String, Mesh)>> {
    let mesh = Attributes::of(tag, defaults, None)?;
    // A mesh with vertices in the document has no file.
    let Some(file) = tag.text("file") else {
        return Ok(None);
    };
    let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    let name = tag.text("name").unwrap_or(stem).to_owned();
    let scale = mesh.numbers::<3>("scale")?.unwrap_or([1.0; 3]);
    let origin = mesh.numbers::<3>("refpos")?.unwrap_or_default();
    let rotation = match mesh.numbers::<4>("refquat")? {
        None => Matrix3::identity(),
        Some(wxyz) => rotation_of_wxyz(wxyz).ok_or_else(|| {
            let attribute = "refquat";
            tag.fault(ParseIssue::ZeroLength { attribute })
        })?,
    };
    let is_uniform = scale[0] == scale[1] && scale[1] == scale[2];
    if rotation != Matrix3::identity() && !is_uniform {
        return Err(tag.fault(ParseIssue::UnsupportedMesh));
    }
    // MuJoCo translates points of the file by -refpos, rotates them by the inverse of refquat, then scales them.
    let inverse_rotation = rotation.transpose();
    let offset = inverse_rotation * -Vector3::from(origin);
    let offset = Vector3::new(
        offset.x * scale[0],
        offset.y * scale[1],
        offset.z * scale[2],
    );
    let geometry = Geometry::Mesh {
        file: compiler.mesh_file(file),
        scale,
    };
    let shape_from_file = Placement::new(inverse_rotation, offset);
    Ok(Some((
        name,
        Mesh {
            geometry,
            shape_from_file,
        },
    )))
}
