//! Files that the command may open, by its options.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use clap::Args;
use kinopt::io::FileAccess;

use crate::failure::Outcome;
use crate::help_headings::MODEL;

/// Options of every subcommand that opens files.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct FileOptions {
    /// Folder with files that a scene, rig or world may name. Default: its own. Repeatable.
    #[arg(long = "allow-folder", value_name = "FOLDER", global = true, help_heading = MODEL, hide_short_help = true)]
    folders: Vec<PathBuf>,

    /// Largest size of a file, in bytes. Default: 1073741824.
    #[arg(long, value_name = "BYTES", global = true, help_heading = MODEL, hide_short_help = true)]
    max_file_bytes: Option<u64>,

    /// Open robot meshes and includes only below its folder and --package. Default: off.
    #[arg(long, global = true, help_heading = MODEL, hide_short_help = true)]
    confine: bool,
}

/// Options of this run.
static OPTIONS: OnceLock<(FileAccess, bool)> = OnceLock::new();

impl FileOptions {
    /// Sets the options of this run.
    pub(crate) fn hold(&self) {
        let folders = self
            .folders
            .iter()
            .fold(FileAccess::new(), |access, own| access.with_folder(own));
        let access = match self.max_file_bytes {
            Some(bytes) => folders.with_max_bytes(bytes),
            None => folders,
        };
        OPTIONS.get_or_init(|| (access, self.confine));
    }
}

/// Allowed file access.
pub(crate) fn allowed() -> FileAccess {
    OPTIONS
        .get()
        .map(|(access, _)| access.clone())
        .unwrap_or_default()
}

/// True if robots are confined to their folders.
pub(crate) fn confines() -> bool {
    OPTIONS.get().is_some_and(|(_, confine)| *confine)
}

/// Text of a file.
pub(crate) fn text(path: &Path) -> Outcome<String> {
    let bytes = allowed().read(path)?;
    String::from_utf8(bytes).map_err(|_| failure!("{}: is not UTF-8 text", path.display()))
}
