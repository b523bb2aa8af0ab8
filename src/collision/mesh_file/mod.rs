//! Triangle meshes from files: OBJ, STL, COLLADA (DAE) and PLY.
//!
//! Read here rather than by a crate: mesh-loader 0.1.13, which knows all three, multiplies a COLLADA node's
//! placement with its parents' in the wrong order, keeps one instance of a geometry that stands twice, and counts
//! vertices of merged parts from the last triangle. roxmltree is there already.

mod dae;
mod dae_document;
mod dae_nodes;
mod obj;
mod parts;
mod stl;
mod text;

use std::collections::HashMap;
use std::path::Path;

use crate::file::{FromFile, Place, ReadError, read_bytes};
use crate::spatial::Vector3;

/// The longest file that is read.
const LENGTH_LIMIT: u64 = 512 << 20;
/// So many corners of triangles at most: instances of instances may ask for any number.
const CORNER_LIMIT: usize = 1 << 26;

/// The triangles of a file, all its parts in one, in the file's own unit but COLLADA's, which says it in metres.
///
/// Indices are in range and numbers finite; triangles may be flat, turned inside out, or leave holes.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshFile {
    /// The corners.
    pub points: Vec<Vector3<f64>>,
    /// Indices into the points, counter-clockwise seen from outside where the file keeps to that.
    pub triangles: Vec<[u32; 3]>,
}

/// The formats that are read.
const FORMATS: [&str; 4] = ["obj", "stl", "dae", "ply"];

impl MeshFile {
    /// Reads a file, whose name's end says its format: `.obj`, `.stl`, `.dae` or `.ply`.
    ///
    /// # Errors
    /// A file that cannot be read, of another format, damaged, or without triangles.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let bytes = read_bytes(path, LENGTH_LIMIT)?;
        Self::parse(&bytes, &path.display().to_string())
    }

    /// Reads a file's bytes; `file` is its name, which says the format and stands in errors.
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
            let place = Place::Element("point", point);
            return Err(ReadError::malformed(file, place, "is not finite"));
        }
        Ok(mesh)
    }

    /// The same mesh with its lengths multiplied along x, y and z. One that is mirrored is turned inside out again.
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

    /// Adds a polygon as a fan around its first corner.
    fn add_polygon(&mut self, corners: &[u32]) {
        for pair in corners.get(1..).unwrap_or_default().windows(2) {
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
    }
}

fn ply(bytes: &[u8], file: &str) -> FromFile<MeshFile> {
    let mesh = crate::io::ply::from_bytes(bytes, file)?;
    let point = |p: &glam::Vec3| Vector3::new(p.x.into(), p.y.into(), p.z.into());
    Ok(MeshFile {
        points: mesh.positions().iter().map(point).collect(),
        triangles: mesh.triangles().to_vec(),
    })
}

/// Points that stand once, to the bit.
#[derive(Debug, Default)]
struct Points {
    index: HashMap<[u64; 3], u32>,
    points: Vec<Vector3<f64>>,
}

impl Points {
    fn index_of(&mut self, point: [f64; 3]) -> u32 {
        let next = self.points.len() as u32;
        // Adding zero makes one of the two zeros.
        let key = point.map(|x| (x + 0.0).to_bits());
        *self.index.entry(key).or_insert_with(|| {
            self.points.push(Vector3::from(point));
            next
        })
    }
}
