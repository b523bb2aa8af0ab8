//! Which files a reader may open.

use std::path::PathBuf;

use kinopt::io::FileAccess;

/// Files below the folder of the one that is read and below these folders, of at most so many bytes.
pub(crate) fn access(folders: Vec<PathBuf>, max_bytes: u64) -> FileAccess {
    let none = FileAccess::new().with_max_bytes(max_bytes);
    folders.into_iter().fold(none, FileAccess::with_folder)
}
