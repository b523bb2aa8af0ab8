//! Changes and omissions of the reader.

use std::fmt;

use crate::animation::ScaleNote;
use crate::io::FileLocation;
use crate::skinning::WeightRepair;

/// A change or an omission of the reader.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// A node without a name, or with the name of another node, got a unique name.
    Named {
        /// Index of the node in the file.
        node: usize,
        /// New name.
        name: String,
    },
    /// Skin weights were repaired.
    Weights {
        /// Name of the mesh.
        mesh: String,
        /// Repair of the weights.
        repair: WeightRepair,
        /// Number of weights that were added to another weight of the same vertex and joint.
        merged: usize,
        /// Number of vertices whose weights are all 0, which are bound to their first joint.
        unweighted: usize,
    },
    /// Another element was repaired.
    Repaired {
        /// Position in the file.
        place: FileLocation,
        /// Repair in words.
        what: String,
    },
    /// A bone's scale at rest is no scale of a skeleton's joints.
    Scaled(ScaleNote),
    /// Something is not in the result.
    LeftOut {
        /// Position in the file.
        place: FileLocation,
        /// Element in words.
        what: String,
    },
}

impl Note {
    pub(super) fn repaired(path: impl Into<String>, what: impl Into<String>) -> Self {
        let place = FileLocation::Json(path.into());
        let what = what.into();
        Self::Repaired { place, what }
    }

    pub(super) fn left_out(path: impl Into<String>, what: impl Into<String>) -> Self {
        let place = FileLocation::Json(path.into());
        let what = what.into();
        Self::LeftOut { place, what }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Named { node, name } => write!(f, "nodes[{node}]: is called `{name}`"),
            Self::Weights {
                mesh,
                repair,
                merged,
                unweighted,
            } => {
                let (negative, rescaled) = (repair.negative, repair.rescaled);
                let mut changes = Vec::new();
                if negative > 0 {
                    changes.push(format!("{negative} negative weights set to 0"));
                }
                if *merged > 0 {
                    changes.push(format!("{merged} added to another of their joint"));
                }
                if let Some((vertex, sum)) = repair.worst {
                    changes.push(format!(
                        "those of {rescaled} vertices scaled to sum to 1 (vertex {vertex} had {sum})"
                    ));
                }
                if *unweighted > 0 {
                    changes.push(format!(
                        "{unweighted} vertices without weights follow their first joint"
                    ));
                }
                write!(f, "mesh `{mesh}`: {}", changes.join(", "))
            }
            Self::Scaled(note) => note.fmt(f),
            Self::Repaired { place, what } => write!(f, "{place}{what}"),
            Self::LeftOut { place, what } => write!(f, "{place}{what}: left out"),
        }
    }
}
