//! Worlds from and to files.

use std::path::Path;

use super::{World, json, moveit};
use crate::file::{ReadError, WriteError};
use crate::file_access::FileAccess;
use crate::file_replacement::write_file;

impl World {
    /// Reads a world: our JSON from `.json`, a planning scene of MoveIt's from `.yaml` or `.yml`.
    ///
    /// JSON lists obstacles by kind, all lengths in metres, quaternions as w, x, y, z:
    ///
    /// ```json
    /// {
    ///   "boxes": [{"name": "table", "size": [1, 0.6, 0.04], "position": [0.5, 0, 0.4]}],
    ///   "cylinders": [{"name": "can", "radius": 0.03, "length": 0.14, "position": [0.5, 0, 0.49]}],
    ///   "spheres": [{"name": "ball", "radius": 0.1, "attached": "hand"}],
    ///   "capsules": [{"name": "pole", "radius": 0.02, "length": 1, "quaternion": [0.7071068, 0, 0.7071068, 0]}],
    ///   "planes": [{"name": "floor"}],
    ///   "meshes": [{"name": "shelf", "file": "shelf.stl", "scale": [0.001, 0.001, 0.001]}],
    ///   "points": [{"name": "cloud", "radius": 0.01, "positions": [[0.4, 0.2, 0.3]]}]
    /// }
    /// ```
    ///
    /// A `position` left out is the origin, a `quaternion` left out no turn; `attached` names a frame of the robot,
    /// in which the obstacle then stands, and `may_touch` lists the links and the obstacles that [may touch](Self::allow_touch) it;
    /// a list `may_be_missing` beside those of obstacles has those names among them that neither robot nor world needs to have. A mesh is a file below this one's folder (OBJ, STL, DAE or PLY) or has `vertices`
    /// and `triangles`; `convex` has `points`, and `height_fields` have `heights`, `columns` and `spacing`.
    /// Obstacles come in this order of kinds, or in that of a list `order` of all names.
    ///
    /// # Errors
    /// A file that cannot be read, is of neither kind or damaged, and obstacles that cannot be, each with its place.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        Self::read_with(path, &FileAccess::new())
    }

    /// Reads a world and the meshes it names, as far as `access` allows.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_with(path: impl AsRef<Path>, access: &FileAccess) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let end = path.extension().and_then(|end| end.to_str());
        let end = end.map(str::to_ascii_lowercase);
        access.read_with(path, |bytes, name| match end.as_deref() {
            Some("json") => json::parse(bytes, name, Some(&access.of_file(path))),
            Some("yaml" | "yml") => moveit::parse(bytes, name),
            _ => Err(ReadError::of_file(
                name,
                "its name ends neither in .json nor in .yaml or .yml, so it is not known what it holds",
            )),
        })
    }

    /// Reads a world from JSON's bytes; `name` stands for the file in errors. Meshes in files of their own are not
    /// opened: that is an error here.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_json(bytes: &[u8], name: &str) -> Result<Self, ReadError> {
        json::parse(bytes, name, None)
    }

    /// Reads a planning scene of MoveIt's from YAML's bytes; `name` stands for the file in errors.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_moveit(bytes: &[u8], name: &str) -> Result<Self, ReadError> {
        moveit::parse(bytes, name)
    }

    /// The world as JSON, meshes and clouds within; read again it is the same, to the bit.
    #[must_use]
    pub fn to_json(&self) -> String {
        json::text(self)
    }

    /// Writes the world as [`to_json`](Self::to_json) gives it.
    ///
    /// # Errors
    /// The file cannot be written, or its name does not end in .json, from which [`read`](Self::read) knows what it holds.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        let end = path.extension().and_then(|end| end.to_str());
        if !end.is_some_and(|end| end.eq_ignore_ascii_case("json")) {
            let told = "a world is written as JSON: its name must end in .json";
            let problem = std::io::Error::new(std::io::ErrorKind::InvalidInput, told);
            return Err(WriteError::new(path, problem));
        }
        write_file(path, self.to_json().as_bytes())
    }
}
