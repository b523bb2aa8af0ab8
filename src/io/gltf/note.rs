//! What reading changed or left out.

use std::fmt;

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
                write!(
                    f,
                    "mesh `{mesh}`: {negative} negative weights set to 0, {merged} added to another \
                     of their joint, those of {rescaled} vertices scaled to sum to 1"
                )?;
                match repair.worst {
                    Some((vertex, sum)) => write!(f, " (vertex {vertex} had {sum})")?,
                    None => (),
                }
                match unweighted {
                    0 => Ok(()),
                    count => write!(
                        f,
                        "; {count} vertices without weights follow their first joint"
                    ),
                }
            }
            Self::Repaired { place, what } => write!(f, "{place}{what}"),
            Self::LeftOut { place, what } => write!(f, "{place}{what}: left out"),
        }
    }
}
