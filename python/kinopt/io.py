"""Functions for files of meshes, tables and motion; rigs, scenes and captures have methods for theirs.

Function names consist of the format and the operation: ``ply_read`` reads a PLY file.
"""

from ._kinopt.io import (
    bvh_poses_to_text,
    bvh_to_text,
    bvh_write,
    bvh_write_poses,
    dmat_from_bytes,
    dmat_read,
    dmat_to_bytes,
    dmat_write,
    gltf_mesh_to_bytes,
    gltf_write_mesh,
    obj_to_text,
    obj_write,
    ply_from_bytes,
    ply_read,
    ply_to_bytes,
    ply_write,
)

__all__ = [
    "bvh_poses_to_text",
    "bvh_to_text",
    "bvh_write",
    "bvh_write_poses",
    "dmat_from_bytes",
    "dmat_read",
    "dmat_to_bytes",
    "dmat_write",
    "gltf_mesh_to_bytes",
    "gltf_write_mesh",
    "obj_to_text",
    "obj_write",
    "ply_from_bytes",
    "ply_read",
    "ply_to_bytes",
    "ply_write",
]
