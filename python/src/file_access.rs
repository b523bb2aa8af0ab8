//! Files that a reader may open.

use std::path::PathBuf;

use kinopt::io::FileAccess;

/// Allows files below the folder of the file that is read and below these folders, of at most `max_bytes` bytes.
pub(crate) fn access(folders: Vec<PathBuf>, max_bytes: u64) -> FileAccess {
    let none = FileAccess::new().with_max_bytes(max_bytes);
    folders.into_iter().fold(none, FileAccess::with_folder)
}
