//! What can be wrong with a collision model.

use std::path::PathBuf;

use super::CollisionObject;
use crate::SizeMismatch;
use crate::bad_option::BadOption;
use crate::collision::shape::LARGEST;
use crate::collision::{ShapeError, ShapeKind};
use crate::file::ReadError;
use crate::kinematics::KinematicsError;
use crate::model::UnknownName;

/// Why there is no such collision model.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CollisionModelError {
    /// A frame, link or pair that is not there.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// A shape that is none.
    #[error("link `{link}`: collision shape `{object}`: {source}")]
    Shape {
        /// The link.
        link: String,
        /// The shape.
        object: String,
        /// What is wrong with it.
        source: ShapeError,
    },
    /// A mesh that is in no place where it could be.
    #[error("link `{link}`: mesh `{file}` is not there; {}", looked(.looked_at))]
    MeshNotFound {
        /// The link.
        link: String,
        /// As the robot's file names it.
        file: String,
        /// Where it was looked for.
        looked_at: Vec<PathBuf>,
    },
    /// A mesh that cannot be read.
    #[error("link `{link}`: {source}")]
    Mesh {
        /// The link.
        link: String,
        /// What is wrong with its file.
        source: Box<ReadError>,
    },
    /// Placed by what is no rotation, or not finite.
    #[error("collision shape `{object}`: its place on its link is not rigid")]
    NotRigid {
        /// The shape.
        object: String,
    },
    /// Placed so far away that no distance could be told.
    #[error(
        "collision shape `{object}` is placed {metres:e} m from its link, which is more than {LARGEST:e}"
    )]
    TooFar {
        /// The shape.
        object: String,
        /// How far, metres.
        metres: f64,
    },
    /// Weights of another mesh or skeleton.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// No pieces at all.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// A configuration that is none.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// A parameter map of another model.
    #[error("the parameter map is for {given} coordinates, the model has {expected}")]
    ForeignMap {
        /// Those of the map.
        given: usize,
        /// Those of the model.
        expected: usize,
    },
    /// A half-space or a height field, which no link is.
    #[error(
        "collision shape `{object}`: a half-space or a height field cannot be carried by a link"
    )]
    Boundless {
        /// The shape.
        object: String,
    },
}

fn looked(places: &[PathBuf]) -> String {
    let names: Vec<String> = places
        .iter()
        .map(|place| place.display().to_string())
        .collect();
    match names.is_empty() {
        true => "it is relative, and the folder of the robot's file is not known".to_owned(),
        false => format!("looked for: {}", names.join(", ")),
    }
}

/// How far a rotation may be from one.
const ROUNDING: f64 = 1e-6;

pub(super) fn check(object: &CollisionObject) -> Result<(), CollisionModelError> {
    let name = || object.name.clone();
    if matches!(
        object.shape.kind(),
        ShapeKind::HalfSpace | ShapeKind::HeightField(_)
    ) {
        return Err(CollisionModelError::Boundless { object: name() });
    }
    let rigid = object.link_from_shape.check_rigid(ROUNDING);
    rigid.map_err(|_| CollisionModelError::NotRigid { object: name() })?;
    match object.link_from_shape.translation.norm() {
        metres if metres > LARGEST => Err(CollisionModelError::TooFar {
            object: name(),
            metres,
        }),
        _ => Ok(()),
    }
}
