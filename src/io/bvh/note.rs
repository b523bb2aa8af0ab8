//! What reading left out.

use std::fmt;

/// Something about a BVH file that its reader should know.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BvhNote {
    /// There are more frames than the file announces; those beyond are left out.
    SurplusFrames {
        /// The line of the first one, from 1.
        line: usize,
        /// How many the file announces.
        announced: usize,
        /// How many there are besides.
        surplus: usize,
    },
}

impl fmt::Display for BvhNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::SurplusFrames {
            line,
            announced,
            surplus,
        } = self;
        let frames = if *surplus == 1 { "frame" } else { "frames" };
        write!(
            f,
            "line {line}: {surplus} {frames} more than the {announced} announced: left out"
        )
    }
}
