//! Kinds of errors: the error class of every error of the library.

use crate::retarget_folder::FolderError;
use kinopt::io::{ReadError, ReadProblem, WriteError};
use kinopt::model::UnknownName;
use kinopt::robot::RobotFileError;

/// Error classes of the interfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// An invalid value.
    InvalidValue,
    /// An unknown name of a joint, frame, option or task.
    UnknownName,
    /// A file with invalid content.
    InvalidFile,
    /// A file that cannot be read or written.
    File,
}

/// An error of the library with its kind.
pub trait Classify: std::error::Error + Sized {
    /// Kind of the error.
    fn kind(&self) -> ErrorKind {
        ErrorKind::InvalidValue
    }
}

/// Returns the kind of an error enum with a variant for unknown names.
fn unknown_name_if(is_unknown_name: bool) -> ErrorKind {
    match is_unknown_name {
        true => ErrorKind::UnknownName,
        false => ErrorKind::InvalidValue,
    }
}

impl Classify for kinopt::BadOption {}
impl Classify for kinopt::SizeMismatch {}
impl Classify for kinopt::animation::HandleError {}
impl Classify for kinopt::animation::curve::KeyError {}
impl Classify for kinopt::arm::QueryError {}
impl Classify for kinopt::ik::SolveError {}
impl Classify for kinopt::kinematics::KinematicsError {}
impl Classify for kinopt::mesh::MeshError {}
impl Classify for kinopt::motion::clip_ik::ClipIkError {}
impl Classify for kinopt::motion::path::PathError {}
impl Classify for kinopt::problem::ProblemError {}
impl Classify for kinopt::skinning::SkinningError {}
impl Classify for serde_json::Error {}

#[cfg(feature = "gltf")]
impl Classify for kinopt::io::gltf::SceneError {}
#[cfg(feature = "gltf")]
impl Classify for kinopt::io::gltf::UnwritableScene {}

impl Classify for UnknownName {
    fn kind(&self) -> ErrorKind {
        ErrorKind::UnknownName
    }
}

impl Classify for kinopt::skinning::UnknownSkinning {
    fn kind(&self) -> ErrorKind {
        ErrorKind::UnknownName
    }
}

impl Classify for kinopt::model::ModelError {
    fn kind(&self) -> ErrorKind {
        unknown_name_if(matches!(self, Self::UnknownName(_)))
    }
}

impl Classify for kinopt::animation::ClipError {
    fn kind(&self) -> ErrorKind {
        unknown_name_if(matches!(self, Self::UnknownName(_)))
    }
}

impl Classify for kinopt::animation::LayerError {
    fn kind(&self) -> ErrorKind {
        unknown_name_if(matches!(self, Self::NoEffector(_) | Self::UnknownName(_)))
    }
}

impl Classify for kinopt::io::FormatError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Write(error) => error.kind(),
            _ => ErrorKind::InvalidValue,
        }
    }
}

impl Classify for kinopt::arm::ArmError {
    fn kind(&self) -> ErrorKind {
        match self {
            #[cfg(feature = "collision")]
            Self::Checker(error) => error.kind(),
            _ => unknown_name_if(matches!(self, Self::UnknownName(_))),
        }
    }
}

impl Classify for kinopt::arm::ReachMapError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Arm(error) => error.kind(),
            _ => ErrorKind::InvalidValue,
        }
    }
}

impl Classify for kinopt::calibration::CalibrationError {
    fn kind(&self) -> ErrorKind {
        unknown_name_if(matches!(self, Self::UnknownName(_)))
    }
}

impl Classify for kinopt::motion::trajectory::MotionError {
    fn kind(&self) -> ErrorKind {
        unknown_name_if(matches!(self, Self::Name(_)))
    }
}

impl Classify for kinopt::motion::posing::StandingDragError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::UnknownBone(_) => ErrorKind::UnknownName,
            Self::Model(error) => error.kind(),
            _ => ErrorKind::InvalidValue,
        }
    }
}

impl Classify for kinopt::motion::retarget::RetargetError {
    fn kind(&self) -> ErrorKind {
        unknown_name_if(matches!(self, Self::Name(_)))
    }
}

impl Classify for kinopt::motion::score::ScoreError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Map(error) => error.kind(),
            _ => unknown_name_if(matches!(self, Self::Name(_))),
        }
    }
}

impl Classify for FolderError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoFolder { .. } | Self::Empty { .. } => ErrorKind::File,
            Self::Read(error) => error.kind(),
            Self::Write(error) => error.kind(),
            _ => ErrorKind::InvalidValue,
        }
    }
}

impl Classify for ReadError {
    fn kind(&self) -> ErrorKind {
        match self.problem {
            ReadProblem::Io(_) => ErrorKind::File,
            _ => ErrorKind::InvalidFile,
        }
    }
}

impl Classify for WriteError {
    fn kind(&self) -> ErrorKind {
        match self.problem.kind() {
            // The format cannot represent the data, or the file name is not allowed.
            std::io::ErrorKind::InvalidInput => ErrorKind::InvalidValue,
            _ => ErrorKind::File,
        }
    }
}

impl Classify for RobotFileError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable(error) => error.kind(),
            _ => ErrorKind::InvalidFile,
        }
    }
}

#[cfg(feature = "collision")]
impl Classify for kinopt::collision::CollisionModelError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Unknown(_) => ErrorKind::UnknownName,
            Self::MeshNotFound { .. } => ErrorKind::File,
            Self::Mesh { source, .. } => source.kind(),
            _ => ErrorKind::InvalidValue,
        }
    }
}

#[cfg(feature = "collision")]
impl Classify for kinopt::collision::WorldError {
    fn kind(&self) -> ErrorKind {
        unknown_name_if(matches!(
            self,
            Self::Unknown { .. }
                | Self::NoObstacle { .. }
                | Self::Attached { .. }
                | Self::MayTouch { .. }
        ))
    }
}
