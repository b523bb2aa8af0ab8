//! Scenes from and to glTF.

mod compressed_files;
mod external_files;
mod kept_files;
mod known_answers;
mod legal_files;
mod malformed;
mod meshes;
mod of_skeletons;
mod repairs;
mod round_trips;
mod sampled_curves;
mod written_scenes;
