//! What can be wrong with an edit of a world.

use super::Obstacle;
use crate::bad_option::BadOption;
use crate::collision::shape::{LARGEST, ShapeError};
use crate::spatial::RigidDefect;

/// Why a world cannot be changed so.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// An obstacle of the name is there already.
    #[error("there is an obstacle {0:?} already")]
    Taken(String),
    /// A name without a letter.
    #[error("an obstacle needs a name, not {0:?}")]
    Unnamed(String),
    /// There is no obstacle of the name.
    #[error("there is no obstacle {name:?}; {}", listed(.valid))]
    Unknown {
        /// The name asked for.
        name: String,
        /// The first of those there are.
        valid: Vec<String>,
    },
    /// Neither of two names is an obstacle's.
    #[error("neither {:?} nor {:?} is an obstacle; {}", .names[0], .names[1], listed(.valid))]
    NoObstacle {
        /// The names.
        names: [String; 2],
        /// The first of those there are.
        valid: Vec<String>,
    },
    /// Two that may not touch.
    #[error("{:?} and {:?} are kept apart: nothing lets them touch", .0[0], .0[1])]
    KeptApart([String; 2]),
    /// An obstacle that stands in the world already.
    #[error("obstacle {0:?} is attached to nothing that it could be detached from")]
    NotAttached(String),
    /// A placement that is not rigid.
    #[error("the placement of obstacle {name:?} is not rigid: {defect}")]
    Placement {
        /// Whose.
        name: String,
        /// What is wrong with it.
        defect: RigidDefect,
    },
    /// Placed so far away that no distance could be told.
    #[error(
        "obstacle {name:?} is placed {metres:e} m from the origin, which is more than {LARGEST:e}"
    )]
    TooFar {
        /// Which.
        name: String,
        /// How far, metres.
        metres: f64,
    },
    /// A factor that no world can be scaled by.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// A shape that cannot be.
    #[error("obstacle {name:?}: {error}")]
    Shape {
        /// Whose.
        name: String,
        /// What is wrong with it.
        #[source]
        error: ShapeError,
    },
}

impl WorldError {
    pub(super) fn unknown<'a>(name: &str, all: impl Iterator<Item = &'a Obstacle>) -> Self {
        Self::Unknown {
            name: name.to_owned(),
            valid: first_names(all),
        }
    }

    pub(super) fn no_obstacle<'a>(
        names: [&str; 2],
        all: impl Iterator<Item = &'a Obstacle>,
    ) -> Self {
        Self::NoObstacle {
            names: names.map(str::to_owned),
            valid: first_names(all),
        }
    }
}

fn first_names<'a>(all: impl Iterator<Item = &'a Obstacle>) -> Vec<String> {
    // Worlds may have thousands; nobody reads more of them.
    const LISTED: usize = 30;
    all.take(LISTED).map(|o| o.name.clone()).collect()
}

fn listed(names: &[String]) -> String {
    match names {
        [] => "there is none at all".to_owned(),
        [only] => format!("the only one is {only:?}"),
        names => format!("there are {}", names.join(", ")),
    }
}
