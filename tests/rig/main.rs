//! Rig and mesh files.

mod external_rigs;
mod malformed_meshes_and_tables;
mod mesh_file_round_trips;
mod posed_meshes;
mod rig_malformed;
mod rig_round_trip;
mod shipped_rigs;
mod triangle_mesh;
mod written_files;
