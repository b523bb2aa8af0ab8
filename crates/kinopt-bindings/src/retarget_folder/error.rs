//! Errors of folders of motions.

use std::path::{Path, PathBuf};

use super::SETTINGS_FILE;
use kinopt::io::{ReadError, WriteError};

/// Reason why a folder of motions cannot be started or continued.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// The source is not a folder.
    #[error("{} is not a folder", folder.display())]
    NoFolder {
        /// Path of the source.
        folder: PathBuf,
    },
    /// The folder has no motions.
    #[error("{}: no motion file found, allowed are {kinds}", folder.display())]
    Empty {
        /// Path of the folder.
        folder: PathBuf,
        /// Supported file extensions.
        kinds: String,
    },
    /// Two motions have the same output file.
    #[error("{} and {} would both be written to {}", first.display(), second.display(), out.display())]
    OneName {
        /// First motion.
        first: PathBuf,
        /// Second motion.
        second: PathBuf,
        /// Path of the output file.
        out: PathBuf,
    },
    /// Output files would be read as motions when the folder is continued.
    #[error("{}: output files would be read as motions, so another output folder is needed", folder.display())]
    IntoItself {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// The folder has results of other settings.
    #[error("{} has results of other settings, as stored in its {SETTINGS_FILE}{}", folder.display(), differing(differs))]
    OtherQuestion {
        /// Path of the folder.
        folder: PathBuf,
        /// Names of the settings that differ, such as `whole`; empty if the stored settings are malformed.
        differs: Vec<String>,
    },
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

fn differing(differs: &[String]) -> String {
    match differs {
        [] => String::new(),
        names => format!(" ({})", names.join(", ")),
    }
}

impl FolderError {
    pub(super) fn reading(path: &Path, problem: std::io::Error) -> Self {
        let name = path.display().to_string();
        Self::Read(ReadError::new(
            &name,
            kinopt::io::FileLocation::File,
            problem,
        ))
    }

    pub(super) fn writing(path: &Path, problem: std::io::Error) -> Self {
        Self::Write(WriteError::new(path, problem))
    }
}
