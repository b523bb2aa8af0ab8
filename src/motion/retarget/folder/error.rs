//! What can be wrong with a folder of movements.

use std::path::{Path, PathBuf};

use super::QUESTION;
use crate::io::{ReadError, WriteError};

/// Why a folder of movements cannot be begun, or gone on with.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// What is no folder.
    #[error("{} is no folder", folder.display())]
    NoFolder {
        /// What was given.
        folder: PathBuf,
    },
    /// A folder without movements.
    #[error("{}: there is no {kinds} in it", folder.display())]
    Empty {
        /// The folder.
        folder: PathBuf,
        /// What is looked for.
        kinds: String,
    },
    /// Two movements of one name.
    #[error("{} and {} would both be written to {}", first.display(), second.display(), out.display())]
    OneName {
        /// One movement.
        first: PathBuf,
        /// The other.
        second: PathBuf,
        /// Where both would go.
        out: PathBuf,
    },
    /// Movements that would be read again when the folder is gone on with.
    #[error("{}: what is written would be among the movements that are read", folder.display())]
    IntoItself {
        /// The folder.
        folder: PathBuf,
    },
    /// A folder whose movements answer another question.
    #[error("{} answers another question, as {QUESTION} in it says{}", folder.display(), differing(differs))]
    OtherQuestion {
        /// The folder.
        folder: PathBuf,
        /// What of the question is another: `whole`, say. None where what is noted is no question.
        differs: Vec<String>,
    },
    /// What cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// What cannot be written.
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
        Self::Read(ReadError::new(&name, crate::io::Place::File, problem))
    }

    pub(super) fn writing(path: &Path, problem: std::io::Error) -> Self {
        Self::Write(WriteError::new(path, problem))
    }
}
