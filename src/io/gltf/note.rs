//! What reading changed or left out.

use std::fmt;

use crate::animation::ScaleNote;
use crate::io::Place;
use crate::skinning::WeightRepair;

/// Something about a file that its reader should know.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// A node without a name, or with one that another node has, got a name of its own.
    Named {
        /// The node's index in the file.
        node: usize,
        /// What it is called now.
        name: String,
    },
    /// Skin weights were put right.
    Weights {
        /// The mesh.
        mesh: String,
        /// What was done.
        repair: WeightRepair,
        /// How many weights were added to another one of the same vertex and joint.
        merged: usize,
        /// Number of vertices without weights, which follow their first joint.
        unweighted: usize,
    },
    /// Something else was put right.
    Repaired {
        /// Where.
        place: Place,
        /// What was done.
        what: String,
    },
    /// A bone's scale at rest is no scale of a skeleton's joints.
    Scaled(ScaleNote),
    /// Something is not in the result.
    LeftOut {
        /// Where.
        place: Place,
        /// What it is.
        what: String,
    },
}

impl Note {
    pub(super) fn repaired(path: impl Into<String>, what: impl Into<String>) -> Self {
        let place = Place::Json(path.into());
        let what = what.into();
        Self::Repaired { place, what }
    }

    pub(super) fn left_out(path: impl Into<String>, what: impl Into<String>) -> Self {
        let place = Place::Json(path.into());
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
