//! Files: meshes (PLY, OBJ), matrices (DMAT), rigs and animation state machines (JSON),
//! motion capture (BVH), and with feature `gltf` scenes (glTF 2.0).
//!
//! Every reader has a core that takes bytes and a name for messages, and a `read` that takes a
//! path. A count that a file announces is checked against the file's length before anything is
//! allocated for it.

pub mod bvh;
pub mod dmat;
mod error;
#[cfg(feature = "gltf")]
pub mod gltf;
mod json;
pub mod obj;
pub mod ply;
pub mod rig;
pub mod state_machine;

pub use error::{Place, ReadError, ReadProblem, WriteError};
pub(crate) use error::{read_bytes, write_bytes};
