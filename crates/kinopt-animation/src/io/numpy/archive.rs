//! Reader of NumPy's .npz files: ZIP archives of .npy files.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use std::path::Path;

use zip::ZipArchive;

use super::super::{FileLocation, MAX_FILE_BYTES, ReadError, ReadProblem, read_with};
use super::NumpyArray;
use kinopt_kinematics::model::UnknownName;

/// Largest size of all arrays of an archive after decompression, bytes.
const MAX_ARCHIVE_BYTES: u64 = 4 << 30;

/// Arrays of a .npz file by name.
#[derive(Clone, Debug, PartialEq)]
pub struct NumpyArchive {
    file: String,
    arrays: BTreeMap<String, NumpyArray>,
    /// Arrays of types that are not read, such as Python objects, with the reason.
    unreadable: BTreeMap<String, String>,
}

impl NumpyArchive {
    /// Reads a .npz file of at most 1 GiB.
    ///
    /// # Errors
    /// As [`from_bytes`](Self::from_bytes), or the file cannot be opened.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        read_with(path.as_ref(), MAX_FILE_BYTES, Self::from_bytes)
    }

    /// Reads a .npz file, compressed or not, from its bytes. `name` is used for messages. An array of an unsupported
    /// type is an error only if it is requested.
    ///
    /// # Errors
    /// Returns an error for a damaged archive, and for one of more than 4 GiB after decompression.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self, ReadError> {
        let invalid = |error: zip::result::ZipError| {
            ReadError::of_file(name, format!("not a .npz archive, or damaged: {error}"))
        };
        let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(invalid)?;
        let mut archive = Self {
            file: name.to_owned(),
            arrays: BTreeMap::new(),
            unreadable: BTreeMap::new(),
        };
        let mut left = MAX_ARCHIVE_BYTES;
        for index in 0..zip.len() {
            let mut entry = zip.by_index(index).map_err(invalid)?;
            let Some(key) = entry.name().strip_suffix(".npy").map(str::to_owned) else {
                continue;
            };
            let mut content = Vec::new();
            // One byte more than allowed shows that the entry is too long, whatever its header states.
            let read = entry.by_ref().take(left + 1).read_to_end(&mut content);
            let read = read.map_err(|error| ReadError::new(name, FileLocation::File, error))?;
            let too_long = ReadProblem::TooLong {
                limit: MAX_ARCHIVE_BYTES,
            };
            left = left
                .checked_sub(read as u64)
                .ok_or_else(|| ReadError::new(name, FileLocation::File, too_long))?;
            match NumpyArray::from_bytes(&content, &key) {
                Ok(array) => {
                    archive.arrays.insert(key, array);
                }
                Err(error) => {
                    archive.unreadable.insert(key, error.problem.to_string());
                }
            }
        }
        Ok(archive)
    }

    /// Names of the arrays, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let mut names: Vec<&str> = self
            .arrays
            .keys()
            .chain(self.unreadable.keys())
            .map(String::as_str)
            .collect();
        names.sort_unstable();
        names.into_iter()
    }

    /// Returns the array of a name, or `None` if there is none.
    ///
    /// # Errors
    /// Returns an error for an array of an unsupported type.
    pub fn get(&self, name: &str) -> Result<Option<&NumpyArray>, ReadError> {
        match self.unreadable.get(name) {
            Some(problem) => Err(ReadError::of_file(
                &self.file,
                format!("`{name}`: {problem}"),
            )),
            None => Ok(self.arrays.get(name)),
        }
    }

    /// Returns the array of a name.
    ///
    /// # Errors
    /// Returns an error that lists the names of the arrays if there is none, and an error for an array of an
    /// unsupported type.
    pub fn array(&self, name: &str) -> Result<&NumpyArray, ReadError> {
        let unknown = || {
            let error = UnknownName::new("array", name, self.names());
            ReadError::new(&self.file, FileLocation::File, ReadProblem::invalid(error))
        };
        self.get(name)?.ok_or_else(unknown)
    }

    /// Returns the numbers of the first array that exists, or `None`.
    ///
    /// # Errors
    /// Returns an error for an array of an unsupported type.
    pub fn first_of(&self, names: &[&str]) -> Result<Option<&NumpyArray>, ReadError> {
        for name in names {
            if let Some(array) = self.get(name)? {
                return Ok(Some(array));
            }
        }
        Ok(None)
    }
}
