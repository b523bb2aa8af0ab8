//! Triangle mesh files: OBJ, STL, COLLADA (DAE) and PLY.
//!
//! kinopt has readers of its own because mesh-loader 0.1.13 reads COLLADA wrongly. It multiplies nested transforms in
//! the wrong order, keeps only one instance of a geometry, and miscounts the vertices of merged parts.

mod dae;
mod dae_document;
mod dae_nodes;
mod obj;
mod parts;
mod stl;
mod text;

use std::collections::HashMap;
use std::path::Path;

use kinopt_kinematics::file::{FileLocation, ReadError, read_bytes};
use kinopt_kinematics::spatial::Vector3;

/// Largest file that is read, bytes.
const LENGTH_LIMIT: u64 = 512 << 20;
/// Largest number of triangle corners: nested instances could multiply without bound.
const CORNER_LIMIT: usize = 1 << 26;

/// The triangles of a mesh file, all parts merged. Lengths are in the file's unit, except COLLADA's, which are in
/// metres.
///
/// Indices are in range and coordinates are finite. Triangles may be degenerate, inside out, or leave holes.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshFile {
    /// Vertices.
    pub points: Vec<Vector3<f64>>,
    /// Vertex indices, counter-clockwise seen from outside if the file follows that convention.
    pub triangles: Vec<[u32; 3]>,
}

/// Supported formats, by file name extension.
const FORMATS: [&str; 4] = ["obj", "stl", "dae", "ply"];

impl MeshFile {
    /// Reads a file. The file name extension selects the format: `.obj`, `.stl`, `.dae` or `.ply`.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, has another format, is malformed, or has no triangles.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let bytes = read_bytes(path, LENGTH_LIMIT)?;
        Self::parse(&bytes, &path.display().to_string())
    }

    /// Parses the bytes of a file. The extension of `file` selects the format, and errors report `file`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(bytes: &[u8], file: &str) -> Result<Self, ReadError> {
        let malformed = |text: String| ReadError::of_file(file, text);
        let end = file.rsplit('.').next().unwrap_or_default();
        let mesh = match end.to_ascii_lowercase().as_str() {
            "obj" => obj::parse(bytes, file)?,
            "stl" => stl::parse(bytes, file)?,
            "dae" => dae::parse(bytes, file)?,
            "ply" => ply(bytes, file)?,
            _ => {
                let formats = FORMATS.join(", ");
                return Err(malformed(format!(
                    "is of no format that is read: its name must end in one of {formats}"
                )));
            }
        };
        if mesh.triangles.is_empty() {
            return Err(malformed("has no triangles".to_owned()));
        }
        if let Some(point) = mesh.points.iter().position(|point| !point.is_finite()) {
            let location = FileLocation::Element("point", point);
            return Err(ReadError::malformed(file, location, "is not finite"));
        }
        Ok(mesh)
    }

    /// The mesh scaled by factors along x, y and z. If the factors mirror it, the winding of the triangles is reversed.
    #[must_use]
    pub fn scaled(mut self, factors: [f64; 3]) -> Self {
        for point in &mut self.points {
            let [x, y, z] = point.to_array();
            *point = Vector3::new(x * factors[0], y * factors[1], z * factors[2]);
        }
        if factors.iter().product::<f64>() < 0.0 {
            for [_, b, c] in &mut self.triangles {
                std::mem::swap(b, c);
            }
        }
        self
    }

    /// Adds a polygon as a triangle fan around its first corner.
    fn add_polygon(&mut self, corners: &[u32]) {
        for pair in corners.get(1..).unwrap_or_default().windows(2) {
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
    }
}

fn ply(bytes: &[u8], file: &str) -> Result<MeshFile, ReadError> {
    let mesh = kinopt_mesh::ply::from_bytes(bytes, file)?;
    let point = |p: &glam::Vec3| Vector3::new(p.x.into(), p.y.into(), p.z.into());
    Ok(MeshFile {
        points: mesh.positions().iter().map(point).collect(),
        triangles: mesh.triangles().to_vec(),
    })
}

/// Vertices without duplicates, compared bitwise.
#[derive(Debug, Default)]
struct Points {
    index: HashMap<[u64; 3], u32>,
    points: Vec<Vector3<f64>>,
}

impl Points {
    fn index_of(&mut self, point: [f64; 3]) -> u32 {
        let next = self.points.len() as u32;
        // Makes −0 and +0 equal.
        let key = point.map(|x| (x + 0.0).to_bits());
        *self.index.entry(key).or_insert_with(|| {
            self.points.push(Vector3::from(point));
            next
        })
    }
}
