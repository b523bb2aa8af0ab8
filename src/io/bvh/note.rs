//! Repairs of a BVH file that was read.

use std::fmt;

/// A repair of a BVH file that was read. Lines are counted from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BvhNote {
    /// There are more frames than the file announces; those beyond are left out.
    SurplusFrames {
        /// Line of the first surplus frame.
        line: usize,
        /// Frames that the file announces.
        announced: usize,
        /// Frames beyond those.
        surplus: usize,
    },
    /// The file ends before the last announced frame; the whole frames are read.
    MissingFrames {
        /// The file's last line.
        line: usize,
        /// Frames that the file announces.
        announced: usize,
        /// Whole frames in the file.
        whole: usize,
    },
    /// A joint was renamed, as its name is that of a joint before it.
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
