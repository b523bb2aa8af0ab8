//! What reading a rig could do without.

use std::fmt;

/// Something about a rig's files that its reader should know.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RigNote {
    /// The file of skin weights that the rig names does not exist: the rig has none.
    NoWeightsFile {
        /// The file, as the rig names it.
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
