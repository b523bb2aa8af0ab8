//! Retargeting of folders of motions: output files, progress, and the settings of a folder.
//!
//! Settings are stored, so that another process can continue a folder. Files are written under [another
//! name](unfinished) first, so existing files are complete.

mod error;
mod folder_settings;
mod motion_folder;

pub use error::FolderError;
pub use folder_settings::FolderQuestion;
pub use motion_folder::{Movement, MovementFolder, unfinished};

/// Name of the file with the settings of a folder, which all its results share.
pub const QUESTION: &str = "retarget.json";
