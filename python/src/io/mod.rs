//! Functions for files of meshes, tables and motion; rigs, scenes and captures have methods for theirs.

mod bvh;
mod dmat;
mod meshes;

use pyo3::prelude::*;

/// Files of meshes, tables and motion.
#[pymodule(submodule)]
pub(crate) mod io {
    #[pymodule_export]
    use super::bvh::{bvh_poses_to_text, bvh_to_text, bvh_write, bvh_write_poses};
    #[pymodule_export]
    use super::dmat::{dmat_from_bytes, dmat_read, dmat_to_bytes, dmat_write};
    #[pymodule_export]
    use super::meshes::{
        gltf_mesh_to_bytes, gltf_write_mesh, obj_to_text, obj_write, ply_from_bytes, ply_read,
        ply_to_bytes, ply_write,
    };
}
