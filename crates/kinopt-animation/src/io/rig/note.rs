//! Notes of reading a rig.

use std::fmt;

/// A fault of a rig's files that the reader tolerates.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RigNote {
    /// The weights file of the rig does not exist, so the rig has no weights.
    NoWeightsFile {
        /// Path of the file, as the rig states it.
        file: String,
    },
}

impl fmt::Display for RigNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::NoWeightsFile { file } = self;
        write!(
            f,
            "weights.file: {file} does not exist: there are no skin weights"
        )
    }
}
