//! Reading and writing of world files.

use std::path::Path;

use super::{World, json, moveit};
use kinopt_kinematics::file::{ReadError, WriteError};
use kinopt_kinematics::file_access::FileAccess;
use kinopt_kinematics::file_replacement::write_file;

impl World {
    /// Reads a world: kinopt's JSON from `.json`, a planning scene of MoveIt from `.yaml` or `.yml`.
    ///
    /// JSON lists obstacles by kind. Lengths are in metres, quaternions are w, x, y, z:
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
    /// The fields and lists:
    ///
    /// - `position`: default the origin. `quaternion`: default no rotation.
    /// - `attached`: name of a robot frame. The pose is then relative to that frame.
    /// - `may_touch`: names of the links and obstacles of [allowed collisions](Self::allow_collision).
    /// - `may_be_missing`: a list next to those of obstacles, with names in `may_touch` that need not exist.
    /// - `meshes`: a file (OBJ, STL, DAE or PLY) below the folder of this file, or `vertices` and `triangles`.
    /// - `convex`: `points`. `height_fields`: `heights`, `columns` and `spacing`.
    /// - `order`: a list of all names in the order of the obstacles. The default order is that of the kinds.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, has neither format, or is malformed. Returns an error for an
    /// invalid obstacle, with its position in the file.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        Self::read_with(path, &FileAccess::new())
    }

    /// Reads a world and its mesh files, as far as `access` allows.
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
                "unknown file type; the extension must be .json, .yaml or .yml",
            )),
        })
    }

    /// Parses a world from JSON. Errors report `name` as the file.
    ///
    /// A mesh in a file of its own is an error.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_json(bytes: &[u8], name: &str) -> Result<Self, ReadError> {
        json::parse(bytes, name, None)
    }

    /// Parses a planning scene of MoveIt from YAML. Errors report `name` as the file.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_moveit(bytes: &[u8], name: &str) -> Result<Self, ReadError> {
        moveit::parse(bytes, name)
    }

    /// The world as JSON, with meshes and point clouds included. It reads back exactly.
    #[must_use]
    pub fn to_json(&self) -> String {
        json::text(self)
    }

    /// Writes the world as [`to_json`](Self::to_json) to a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written, or if its name does not end in .json, which [`read`](Self::read)
    /// requires.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        let end = path.extension().and_then(|end| end.to_str());
        if !end.is_some_and(|end| end.eq_ignore_ascii_case("json")) {
            let message = "a world is written as JSON: its name must end in .json";
            let problem = std::io::Error::new(std::io::ErrorKind::InvalidInput, message);
            return Err(WriteError::new(path, problem));
        }
        write_file(path, self.to_json().as_bytes())
    }
}
