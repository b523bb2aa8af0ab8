//! Files that the command may open.

use std::path::Path;
use std::sync::OnceLock;

use kinopt::io::FileAccess;
use kinopt_bindings::problem_file::FileSettings;

use crate::failure::Outcome;

/// Access of this run, and true if robots are confined to their folders.
static ACCESS: OnceLock<(FileAccess, bool)> = OnceLock::new();

/// Allows the files of the settings in this run.
pub(crate) fn allow(settings: &FileSettings) {
    let folders = settings.allow_folder.iter();
    let access = folders.fold(FileAccess::new(), |access, folder| {
        access.with_folder(folder)
    });
    let access = match settings.max_file_bytes {
        Some(bytes) => access.with_max_bytes(bytes),
        None => access,
    };
    ACCESS.get_or_init(|| (access, settings.confine));
}

/// Allowed file access.
pub(crate) fn allowed() -> FileAccess {
    ACCESS
        .get()
        .map(|(access, _)| access.clone())
        .unwrap_or_default()
}

/// True if robots are confined to their folders.
pub(crate) fn confines() -> bool {
    ACCESS.get().is_some_and(|(_, confine)| *confine)
}

/// Text of a file.
pub(crate) fn text(path: &Path) -> Outcome<String> {
    let bytes = allowed().read(path)?;
    String::from_utf8(bytes).map_err(|_| failure!("{}: is not UTF-8 text", path.display()))
}
