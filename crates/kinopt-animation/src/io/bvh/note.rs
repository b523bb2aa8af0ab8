//! Repairs made by the BVH reader.

use std::fmt;

/// Repair made by the BVH reader. Lines are counted from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BvhNote {
    /// The file has more frames than announced; the surplus is ignored.
    SurplusFrames {
        /// Line of the first surplus frame.
        line: usize,
        /// Number of frames announced.
        announced: usize,
        /// Number of surplus frames.
        surplus: usize,
    },
    /// The file ends before the last announced frame; its whole frames are read.
    MissingFrames {
        /// Last line of the file.
        line: usize,
        /// Number of frames announced.
        announced: usize,
        /// Number of whole frames.
        whole: usize,
    },
    /// A joint was renamed, because an earlier joint has its name.
    Renamed {
        /// Line of the joint.
        line: usize,
        /// Name in the file.
        name: String,
        /// Name of the bone.
        bone: String,
    },
    /// Bytes that are not UTF-8 were read as Latin-1.
    Latin1 {
        /// Line of the first such byte.
        line: usize,
    },
}

impl fmt::Display for BvhNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SurplusFrames {
                line,
                announced,
                surplus,
            } => {
                let frames = if *surplus == 1 { "frame" } else { "frames" };
                write!(
                    f,
                    "line {line}: {surplus} {frames} more than the {announced} announced: left out"
                )
            }
            Self::MissingFrames {
                line,
                announced,
                whole,
            } => {
                let frames = if *whole == 1 { "frame" } else { "frames" };
                write!(
                    f,
                    "line {line}: the file ends after {whole} whole {frames} of {announced} announced"
                )
            }
            Self::Renamed { line, name, bone } => write!(
                f,
                "line {line}: joint `{name}` is named `{bone}`, as another joint has its name"
            ),
            Self::Latin1 { line } => {
                write!(
                    f,
                    "line {line}: bytes that are not UTF-8 are read as Latin-1"
                )
            }
        }
    }
}
