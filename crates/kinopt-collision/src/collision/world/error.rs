//! Errors of changes to a world.

use super::Obstacle;
use crate::collision::shape::{MAX_LENGTH, ShapeError};
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::model::UnknownName;
use kinopt_kinematics::spatial::RigidDefect;

/// Reason why a world cannot be changed, or a checker of a robot and a world cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// An obstacle of that name exists.
    #[error("obstacle name {0:?} is used already; names must be unique")]
    Taken(String),
    /// A blank name.
    #[error("an obstacle needs a name, not {0:?}")]
    Unnamed(String),
    /// No obstacle of that name exists.
    #[error("there is no obstacle {name:?}; {}", listed(.valid))]
    Unknown {
        /// Requested name.
        name: String,
        /// Names of obstacles, at most the first 30.
        valid: Vec<String>,
    },
    /// Neither of two names is an obstacle.
    #[error("neither {:?} nor {:?} is an obstacle; {}", .names[0], .names[1], listed(.valid))]
    NoObstacle {
        /// Requested names.
        names: [String; 2],
        /// Names of obstacles, at most the first 30.
        valid: Vec<String>,
    },
    /// The collision of the two is not allowed.
    #[error("{:?} and {:?} have no allowed collision", .0[0], .0[1])]
    KeptApart([String; 2]),
    /// The obstacle is not attached.
    #[error("obstacle {0:?} is not attached")]
    NotAttached(String),
    /// A placement that is not rigid.
    #[error("the placement of obstacle {name:?} is not rigid: {defect}")]
    Placement {
        /// Name of the obstacle.
        name: String,
        /// Deviation from a rigid placement.
        defect: RigidDefect,
    },
    /// A placement so far from the origin that distances would be inaccurate.
    #[error(
        "obstacle {name:?} is placed {metres:e} m from the origin, which is more than {MAX_LENGTH:e}"
    )]
    TooFar {
        /// Name of the obstacle.
        name: String,
        /// Distance from the origin, metres.
        metres: f64,
    },
    /// An invalid scale factor.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// An invalid shape.
    #[error("obstacle {name:?}: {error}")]
    Shape {
        /// Name of the obstacle.
        name: String,
        /// Reason why the shape is invalid.
        #[source]
        error: ShapeError,
    },
    /// An obstacle attached to a frame that the robot does not have.
    #[error("obstacle `{obstacle}`: it cannot be attached to the robot: {unknown}")]
    Attached {
        /// Name of the obstacle.
        obstacle: String,
        /// Name of the frame, and the valid names.
        unknown: UnknownName,
    },
    /// An obstacle that may collide with an unknown link or obstacle.
    #[error("obstacle `{obstacle}`: invalid allowed collision: {unknown}")]
    MayTouch {
        /// Name of the obstacle.
        obstacle: String,
        /// Unknown name, and the valid names.
        unknown: UnknownName,
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
    // Limits the length of the message for worlds with thousands of obstacles.
    const MAX_NAMES: usize = 30;
    all.take(MAX_NAMES).map(|o| o.name.clone()).collect()
}

fn listed(names: &[String]) -> String {
    match names {
        [] => "there are no obstacles".to_owned(),
        [only] => format!("the only one is {only:?}"),
        names => format!("there are {}", names.join(", ")),
    }
}
