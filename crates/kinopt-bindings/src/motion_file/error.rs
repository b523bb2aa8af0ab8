//! Errors of motion files.

use std::path::Path;

use kinopt::io::ReadError;

use crate::{Classify, ErrorKind};

/// Reason why a file is not the motion of a robot.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MotionFileError {
    /// The file cannot be read, or is damaged.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The extension is not that of a motion file.
    #[error("{file}: unsupported motion, expected .csv, .npz, .json, .glb or .gltf")]
    Extension {
        /// Path of the file.
        file: String,
    },
    /// The content is not a motion of the robot.
    #[error("{file}: {problem}")]
    Content {
        /// Path of the file.
        file: String,
        /// The reason.
        problem: String,
    },
}

impl MotionFileError {
    pub(super) fn new(path: &Path, problem: impl Into<String>) -> Self {
        Self::Content {
            file: path.display().to_string(),
            problem: problem.into(),
        }
    }

    pub(super) fn extension(path: &Path) -> Self {
        Self::Extension {
            file: path.display().to_string(),
        }
    }
}

impl Classify for MotionFileError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Read(error) => error.kind(),
            Self::Extension { .. } => ErrorKind::InvalidValue,
            Self::Content { .. } => ErrorKind::InvalidFile,
        }
    }
}
