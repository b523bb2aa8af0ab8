//! Rig and mesh files.

mod external_rigs;
mod posed_meshes;
mod rig_malformed;
mod rig_round_trip;
mod shipped_rigs;
mod written_files;
