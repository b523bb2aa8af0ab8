//! Conversion of the library's errors to exceptions with the library's messages.

use kinopt::animation::{ClipError, LayerError};
use kinopt::io::{FormatError, ReadError, ReadProblem, WriteError};
use kinopt::model::UnknownName;
use kinopt::robot::RobotFileError;
use kinopt::skinning::UnknownSkinning;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// Exceptions of `kinopt.errors`.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// An invalid value: a subclass of `ValueError`.
    InvalidValue,
    /// An unknown name: a subclass of `ValueError` and `KeyError`.
    UnknownName,
    /// A file with invalid content: a subclass of `ValueError`.
    InvalidFile,
    /// A file that cannot be read or written: a subclass of `OSError`.
    File,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::InvalidValue => "InvalidValueError",
            Self::UnknownName => "UnknownNameError",
            Self::InvalidFile => "InvalidFileError",
            Self::File => "FileError",
        }
    }
}

/// Creates an exception of this kind.
pub(crate) fn raise(kind: Kind, message: impl Into<String>) -> PyErr {
    static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let message = message.into();
    Python::attach(|py| {
        let module = MODULE.get_or_try_init(py, || py.import("kinopt.errors").map(Bound::unbind));
        let class = module.and_then(|module| module.bind(py).getattr(kind.name()));
        match class.and_then(|class| class.call1((message,))) {
            Ok(error) => PyErr::from_value(error),
            Err(error) => error,
        }
    })
}

/// Creates an exception for an invalid value.
pub(crate) fn invalid(message: impl Into<String>) -> PyErr {
    raise(Kind::InvalidValue, message)
}

/// An error of the library.
pub(crate) trait Fault: std::error::Error + Sized {
    /// Kind of the exception.
    fn kind(&self) -> Kind {
        Kind::InvalidValue
    }
}

macro_rules! faults {
    ($($error:ty),* $(,)?) => {$(impl Fault for $error {})*};
}

faults!(
    kinopt::BadOption,
    kinopt::arm::QueryError,
    kinopt::animation::HandleError,
    kinopt::animation::SizeMismatch,
    kinopt::io::gltf::SceneError,
    kinopt::io::gltf::UnwritableScene,
    kinopt::ik::SolveError,
    kinopt::kinematics::KinematicsError,
    kinopt::mesh::MeshError,
    kinopt::motion::path::PathError,
    kinopt::animation::curve::KeyError,
    kinopt::problem::ProblemError,
    kinopt::skinning::SkinningError,
    serde_json::Error,
);

impl Fault for kinopt::model::ModelError {
    fn kind(&self) -> Kind {
        match self {
            Self::UnknownName(_) => Kind::UnknownName,
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for kinopt::collision::CollisionModelError {
    fn kind(&self) -> Kind {
        match self {
            Self::Unknown(_) => Kind::UnknownName,
            Self::MeshNotFound { .. } => Kind::File,
            Self::Mesh { source, .. } => source.kind(),
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for kinopt::arm::ArmError {
    fn kind(&self) -> Kind {
        match self {
            Self::UnknownName(_) => Kind::UnknownName,
            Self::Checker(error) => error.kind(),
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for ClipError {
    fn kind(&self) -> Kind {
        match self {
            Self::UnknownName(_) => Kind::UnknownName,
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for kinopt::collision::WorldError {
    fn kind(&self) -> Kind {
        match self {
            Self::Unknown { .. }
            | Self::NoObstacle { .. }
            | Self::Attached { .. }
            | Self::MayTouch { .. } => Kind::UnknownName,
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for LayerError {
    fn kind(&self) -> Kind {
        match self {
            Self::NoEffector(_) | Self::UnknownName(_) => Kind::UnknownName,
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for FormatError {
    fn kind(&self) -> Kind {
        match self {
            Self::Write(error) => error.kind(),
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for UnknownSkinning {
    fn kind(&self) -> Kind {
        Kind::UnknownName
    }
}

impl Fault for kinopt::motion::trajectory::MotionError {
    fn kind(&self) -> Kind {
        match self {
            Self::Name(_) => Kind::UnknownName,
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for kinopt::motion::clip_ik::ClipIkError {}

impl Fault for kinopt::motion::retarget::RetargetError {
    fn kind(&self) -> Kind {
        match self {
            Self::Name(_) => Kind::UnknownName,
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for kinopt::motion::retarget::folder::FolderError {
    fn kind(&self) -> Kind {
        match self {
            Self::NoFolder { .. } | Self::Empty { .. } => Kind::File,
            Self::Read(error) => error.kind(),
            Self::Write(error) => error.kind(),
            _ => Kind::InvalidValue,
        }
    }
}

impl Fault for UnknownName {
    fn kind(&self) -> Kind {
        Kind::UnknownName
    }
}

impl Fault for ReadError {
    fn kind(&self) -> Kind {
        match self.problem {
            ReadProblem::Io(_) => Kind::File,
            _ => Kind::InvalidFile,
        }
    }
}

impl Fault for WriteError {
    fn kind(&self) -> Kind {
        match self.problem.kind() {
            // The format cannot represent the data, or the file name is not allowed.
            std::io::ErrorKind::InvalidInput => Kind::InvalidValue,
            _ => Kind::File,
        }
    }
}

impl Fault for RobotFileError {
    fn kind(&self) -> Kind {
        match self {
            Self::Unreadable(error) => error.kind(),
            _ => Kind::InvalidFile,
        }
    }
}

/// Conversion of the library's results to those of Python.
pub(crate) trait OrRaise<T> {
    /// Returns the value, or an exception with the library's message.
    fn or_raise(self) -> PyResult<T>;
}

impl<T, E: Fault> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(|error| raise(error.kind(), error.to_string()))
    }
}
