//! Files of trajectories: tables for learning and analysis, and animations of figures.

mod figure;
mod npz;
mod table;

use std::path::Path;

pub use figure::{FigureFile, FigureFileError, write_figure};
pub use npz::{Column, npy, npz};
pub use table::{Contacts, TableLayout, TrajectoryTable};

/// Format of a trajectory's file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrajectoryFormat {
    /// NumPy arrays by name.
    Npz,
    /// One JSON object.
    Json,
    /// Comma-separated rows.
    Csv,
    /// Biovision motion of a figure.
    Bvh,
    /// Binary glTF of a figure, or of the links of a robot.
    Glb,
}

/// File extensions of the formats.
pub const EXTENSIONS: [(&str, TrajectoryFormat); 5] = [
    ("npz", TrajectoryFormat::Npz),
    ("json", TrajectoryFormat::Json),
    ("csv", TrajectoryFormat::Csv),
    ("bvh", TrajectoryFormat::Bvh),
    ("glb", TrajectoryFormat::Glb),
];

impl TrajectoryFormat {
    /// Format of a file; `None` for another extension. Letter case is ignored.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        let known = EXTENSIONS.iter().find(|(name, _)| *name == extension);
        known.map(|(_, format)| *format)
    }

    /// True for formats with bones or nodes: .bvh and .glb.
    pub fn has_bones(self) -> bool {
        matches!(self, Self::Bvh | Self::Glb)
    }
}
