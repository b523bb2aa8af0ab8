//! Errors of files, with file name, location and problem.

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

/// Largest file that is read if the caller sets no limit, bytes.
#[doc(hidden)]
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// A file that could not be read.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{file}: {place}{problem}")]
pub struct ReadError {
    /// Path of the file, or the name given to the bytes.
    pub file: String,
    /// Location in the file.
    pub place: FileLocation,
    /// The problem at that location.
    #[source]
    pub problem: ReadProblem,
}

/// A location in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileLocation {
    /// The file as a whole.
    File,
    /// A line, counted from 1.
    Line(usize),
    /// An offset in bytes from the start of the file.
    Byte(usize),
    /// An element of a list, counted from 0: a vertex, a face, a matrix entry.
    Element(&'static str, usize),
    /// A JSON path such as `bones[3].rest_T`.
    Json(String),
}

/// A problem at a location in a file.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadProblem {
    /// The operating system could not open or read the file.
    #[error("cannot be read: {0}")]
    Io(#[source] Arc<std::io::Error>),
    /// The file is longer than the limit.
    #[error("is longer than the {limit} bytes that are read of such a file")]
    TooLong {
        /// The limit in bytes.
        limit: u64,
    },
    /// A referenced file outside the folders from which references may be opened.
    #[error("is outside of the folders from which it may be opened{}", listed(.folders))]
    Outside {
        /// The allowed folders; empty if the reference must be below the folder of the file that contains it.
        folders: Vec<String>,
    },
    /// A referenced file that is not valid. Its contents are not quoted.
    #[error(
        "is damaged or of another format; the reason is reported where this file is read by itself"
    )]
    InvalidReferenced,
    /// A file that is shorter than its contents require.
    #[error("{what} need at least {needed} more bytes, but {available} are left in the file")]
    Truncated {
        /// Name of the missing contents.
        what: String,
        /// Smallest number of bytes they need; the largest `u64` if that is exceeded.
        needed: u64,
        /// Number of remaining bytes.
        available: usize,
    },
    /// Text or structure that violates the format.
    #[error("{0}")]
    Malformed(String),
    /// Well-formed but invalid contents, for example a `MeshError` or a
    /// `SkinningError`.
    #[error(transparent)]
    Invalid(Arc<dyn std::error::Error + Send + Sync>),
    /// A referenced file that cannot be read.
    #[error("{0}")]
    Referenced(#[source] Box<ReadError>),
}

/// A file that could not be written.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{file}: cannot be written: {problem}")]
#[non_exhaustive]
pub struct WriteError {
    /// Path of the file.
    pub file: String,
    /// The reason.
    #[source]
    pub problem: Arc<std::io::Error>,
}

fn listed(folders: &[String]) -> String {
    match folders.is_empty() {
        true => ": it must lead below the folder of the file that names it".to_owned(),
        false => format!(": {}", folders.join(", ")),
    }
}

impl From<std::io::Error> for ReadProblem {
    fn from(error: std::io::Error) -> Self {
        Self::Io(Arc::new(error))
    }
}

impl ReadProblem {
    /// Wraps an error about well-formed but invalid contents.
    #[doc(hidden)]
    pub fn invalid(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Invalid(Arc::new(error))
    }
}

impl WriteError {
    #[doc(hidden)]
    pub fn new(path: &Path, problem: std::io::Error) -> Self {
        Self {
            file: path.display().to_string(),
            problem: Arc::new(problem),
        }
    }
}

impl ReadError {
    #[doc(hidden)]
    pub fn new(file: &str, location: FileLocation, problem: impl Into<ReadProblem>) -> Self {
        Self {
            file: file.to_owned(),
            place: location,
            problem: problem.into(),
        }
    }

    /// True if the file does not exist.
    #[doc(hidden)]
    pub fn is_missing(&self) -> bool {
        matches!(&self.problem, ReadProblem::Io(error) if error.kind() == std::io::ErrorKind::NotFound)
    }

    /// An error for contents that the rest of the file cannot hold.
    #[doc(hidden)]
    pub fn truncated(
        file: &str,
        location: FileLocation,
        what: String,
        needed: u128,
        available: usize,
    ) -> Self {
        let needed = u64::try_from(needed).unwrap_or(u64::MAX);
        let problem = ReadProblem::Truncated {
            what,
            needed,
            available,
        };
        Self::new(file, location, problem)
    }

    /// The error without any contents of the file, for a referenced file that its referrer may not quote.
    #[doc(hidden)]
    pub fn without_contents(self) -> Self {
        let Self {
            file,
            place,
            problem,
        } = self;
        match problem {
            ReadProblem::Io(_) | ReadProblem::TooLong { .. } | ReadProblem::Outside { .. } => {
                Self {
                    file,
                    place,
                    problem,
                }
            }
            _ => Self {
                file,
                place: match place {
                    FileLocation::Json(_) => FileLocation::File,
                    place => place,
                },
                problem: ReadProblem::InvalidReferenced,
            },
        }
    }

    /// An error in another file, at the location that references it.
    #[doc(hidden)]
    pub fn referred(file: &str, location: FileLocation, error: Self) -> Self {
        Self::new(file, location, ReadProblem::Referenced(Box::new(error)))
    }

    /// An error about a file as a whole.
    #[doc(hidden)]
    pub fn of_file(file: &str, problem: impl Into<String>) -> Self {
        Self::malformed(file, FileLocation::File, problem)
    }

    #[doc(hidden)]
    pub fn malformed(file: &str, location: FileLocation, problem: impl Into<String>) -> Self {
        Self::new(file, location, ReadProblem::Malformed(problem.into()))
    }
}

impl fmt::Display for FileLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, "line {line}: "),
            Self::Byte(offset) => write!(f, "byte {offset}: "),
            Self::Element(name, index) => write!(f, "{name} {index}: "),
            Self::Json(path) => write!(f, "{path}: "),
        }
    }
}

/// Reads a whole file; rejects devices and pipes, which may never end, and files longer than `limit` bytes.
#[doc(hidden)]
pub fn read_bytes(path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    let name = path.display().to_string();
    let fail = |problem: ReadProblem| ReadError::new(&name, FileLocation::File, problem);
    let metadata = std::fs::metadata(path).map_err(|e| fail(e.into()))?;
    if !metadata.is_file() {
        return Err(fail(ReadProblem::Malformed("is not a regular file".into())));
    }
    if metadata.len() > limit {
        return Err(fail(ReadProblem::TooLong { limit }));
    }
    let mut bytes = Vec::new();
    // The file may grow while it is read.
    let length = File::open(path)
        .and_then(|file| file.take(limit.saturating_add(1)).read_to_end(&mut bytes))
        .map_err(|e| fail(e.into()))?;
    if length as u64 > limit {
        return Err(fail(ReadProblem::TooLong { limit }));
    }
    Ok(bytes)
}

/// Reads a whole file and parses its bytes; `parse` gets its name too.
#[doc(hidden)]
pub fn read_with<T>(
    path: &Path,
    limit: u64,
    parse: impl FnOnce(&[u8], &str) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    parse(&read_bytes(path, limit)?, &path.display().to_string())
}
