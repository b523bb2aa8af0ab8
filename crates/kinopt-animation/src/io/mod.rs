//! File formats: meshes (PLY, OBJ), matrices (DMAT), rigs, animation state machines and joint limits (JSON), motion
//! capture (BVH, SMPL), with feature `gltf` scenes (glTF 2.0), and with feature
//! `npz` NumPy's arrays; with feature `c3d` markers (C3D).
//!
//! Every reader has a function that takes bytes and a name for messages, and a function `read` that takes a path. A
//! count in a file is checked against the file's length before memory is allocated for it.

pub mod bvh;
pub mod c3d;
pub mod cones;
mod format_error;
#[cfg(feature = "gltf")]
pub mod gltf;
#[cfg(feature = "npz")]
pub mod numpy;
pub mod rig;
pub mod smpl;
pub mod state_machine;

pub use format_error::FormatError;
pub use kinopt_kinematics::file::{FileLocation, ReadError, ReadProblem, WriteError};
pub use kinopt_kinematics::file_access::FileAccess;
pub use kinopt_kinematics::file_replacement::write_file;
pub use kinopt_mesh::dmat;
pub use kinopt_mesh::obj;
pub use kinopt_mesh::ply;

use crate::skinning::SkinningError;
use kinopt_kinematics::file::{MAX_FILE_BYTES, read_with};
use kinopt_kinematics::file_replacement::write_files;

impl From<SkinningError> for ReadProblem {
    fn from(error: SkinningError) -> Self {
        Self::invalid(error)
    }
}
