//! Errors of collision models.

use std::path::PathBuf;

use super::CollisionObject;
use crate::collision::shape::MAX_LENGTH;
use crate::collision::{ShapeError, ShapeKind};
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::file::ReadError;
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_kinematics::model::UnknownName;

/// Reason why a collision model cannot be made.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CollisionModelError {
    /// An unknown frame, link or pair.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// An invalid shape.
    #[error("link `{link}`: collision shape `{object}`: {source}")]
    Shape {
        /// Name of the link.
        link: String,
        /// Name of the shape.
        object: String,
        /// Reason why the shape is invalid.
        source: ShapeError,
    },
    /// A mesh file that was not found.
    #[error("link `{link}`: mesh `{file}` not found; {}", searched_paths(.looked_at))]
    MeshNotFound {
        /// Name of the link.
        link: String,
        /// Reference to the mesh, as the robot's file writes it.
        file: String,
        /// Paths that were searched.
        looked_at: Vec<PathBuf>,
    },
    /// A mesh file that cannot be read.
    #[error("link `{link}`: {source}")]
    Mesh {
        /// Name of the link.
        link: String,
        /// Read error of the file.
        source: Box<ReadError>,
    },
    /// A placement that is not rigid or not finite.
    #[error("collision shape `{object}`: its placement on the link is not rigid")]
    NotRigid {
        /// Name of the shape.
        object: String,
    },
    /// A placement so far from its link that distances would be inaccurate.
    #[error(
        "collision shape `{object}` is placed {metres:e} m from its link, which is more than {MAX_LENGTH:e}"
    )]
    TooFar {
        /// Name of the shape.
        object: String,
        /// Distance from the link, metres.
        metres: f64,
    },
    /// Skin weights that do not match the mesh or the skeleton.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// An invalid number of pieces.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// An invalid configuration.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// A parameter map of another model.
    #[error("the parameter map is for {given} coordinates, the model has {expected}")]
    ForeignMap {
        /// Number of coordinates of the map.
        given: usize,
        /// Number of coordinates of the model.
        expected: usize,
    },
    /// A half-space or a height field, which a link cannot carry.
    #[error(
        "collision shape `{object}`: a half-space or a height field cannot be attached to a link"
    )]
    Boundless {
        /// Name of the shape.
        object: String,
    },
}

fn searched_paths(paths: &[PathBuf]) -> String {
    let names: Vec<String> = paths
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    match names.is_empty() {
        true => "its path is relative, and the folder of the robot's file is unknown".to_owned(),
        false => format!("looked for: {}", names.join(", ")),
    }
}

/// Tolerance of rigid rotations.
const RIGIDITY_TOLERANCE: f64 = 1e-6;

pub(super) fn check(object: &CollisionObject) -> Result<(), CollisionModelError> {
    let name = || object.name.clone();
    if matches!(
        object.shape.kind(),
        ShapeKind::HalfSpace | ShapeKind::HeightField(_)
    ) {
        return Err(CollisionModelError::Boundless { object: name() });
    }
    let rigid = object.link_from_shape.check_rigid(RIGIDITY_TOLERANCE);
    rigid.map_err(|_| CollisionModelError::NotRigid { object: name() })?;
    match object.link_from_shape.translation.norm() {
        metres if metres > MAX_LENGTH => Err(CollisionModelError::TooFar {
            object: name(),
            metres,
        }),
        _ => Ok(()),
    }
}
