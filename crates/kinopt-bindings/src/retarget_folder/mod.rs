//! Retargeting of folders of motions: output files, progress, and the settings of a folder.
//!
//! Settings are stored, so that another process can continue a folder. Files are written under [another
//! name](unfinished) first, so existing files are complete.

mod error;
mod folder_settings;
mod motion_folder;

pub use error::FolderError;
pub use folder_settings::FolderSettings;
pub use motion_folder::{FolderMotion, MotionFolder, unfinished};

/// Name of the file with the settings of a folder, which all its results share.
pub const SETTINGS_FILE: &str = "retarget.json";
