//! Access to referenced files: only below allowed folders, up to a size limit.
//!
//! A scene, a rig or a world may come from an untrusted source, so its references must not open arbitrary files. A
//! reference is resolved against the folder of the file that contains it. After symbolic links, the result must be
//! below that folder or below a folder that the caller lists.

use std::path::{Component, Path, PathBuf};

use crate::file::{FileLocation, MAX_FILE_BYTES, ReadError, ReadProblem, read_bytes};

/// Rules for the files that a reader may open: allowed folders and the largest size.
///
/// References below the folder of the file that contains them are always allowed. Symbolic links are followed first.
///
/// ```
/// use kinopt::io::FileAccess;
///
/// let access = FileAccess::new().with_folder("textures").with_max_bytes(1 << 20);
/// assert_eq!(access.max_bytes(), 1 << 20);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileAccess {
    folders: Vec<PathBuf>,
    max_bytes: u64,
}

impl Default for FileAccess {
    fn default() -> Self {
        Self {
            folders: Vec::new(),
            max_bytes: MAX_FILE_BYTES,
        }
    }
}

impl FileAccess {
    /// Access to the folder of the file that is read, for files of at most 1 GiB.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Allows references below this folder too.
    #[must_use]
    pub fn with_folder(mut self, folder: impl Into<PathBuf>) -> Self {
        self.folders.push(folder.into());
        self
    }

    /// Sets the largest file that is read, bytes.
    #[must_use]
    pub fn with_max_bytes(mut self, bytes: u64) -> Self {
        self.max_bytes = bytes;
        self
    }

    /// The allowed folders in addition to the file's own folder.
    #[must_use]
    pub fn folders(&self) -> &[PathBuf] {
        &self.folders
    }

    /// The largest file that is read, bytes.
    #[must_use]
    pub fn max_bytes(&self) -> u64 {
        self.max_bytes
    }

    /// Reads a whole regular file; checks its size first.
    ///
    /// # Errors
    /// Returns a [`ReadError`] with the file's name if it cannot be opened, is a device or a pipe, or is larger than
    /// [`max_bytes`](Self::max_bytes).
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Vec<u8>, ReadError> {
        read_bytes(path.as_ref(), self.max_bytes)
    }

    /// Parses a whole file from its bytes and its name.
    #[doc(hidden)]
    pub fn read_with<T>(
        &self,
        path: &Path,
        parse: impl FnOnce(&[u8], &str) -> Result<T, ReadError>,
    ) -> Result<T, ReadError> {
        crate::file::read_with(path, self.max_bytes, parse)
    }

    /// The files that a file may reference.
    #[doc(hidden)]
    pub fn of_file(&self, file: &Path) -> AllowedFiles {
        let folder = file.parent().unwrap_or(Path::new(""));
        AllowedFiles::new(folder, &self.folders, self.max_bytes)
    }
}

/// The files that one file may reference.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct AllowedFiles {
    /// The base folder of relative references.
    folder: PathBuf,
    /// The allowed folders.
    roots: Vec<PathBuf>,
    max_bytes: u64,
}

impl AllowedFiles {
    pub(crate) fn new(folder: &Path, others: &[PathBuf], max_bytes: u64) -> Self {
        let roots = std::iter::once(folder).chain(others.iter().map(PathBuf::as_path));
        Self {
            folder: folder.to_owned(),
            roots: roots.map(joinable).collect(),
            max_bytes,
        }
    }

    /// The files below these folders; references are absolute or relative to the working directory.
    #[doc(hidden)]
    pub fn below<'f>(folders: impl IntoIterator<Item = &'f Path>) -> Self {
        Self {
            folder: PathBuf::new(),
            roots: folders.into_iter().map(joinable).collect(),
            max_bytes: MAX_FILE_BYTES,
        }
    }

    /// The base folder of relative references.
    #[doc(hidden)]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The contents of a referenced file.
    #[doc(hidden)]
    pub fn open(&self, reference: &str) -> Result<Vec<u8>, ReadError> {
        let path = self.folder.join(reference);
        let renamed = |error: ReadError| ReadError {
            file: path.display().to_string(),
            ..error
        };
        // Read by its real path, so that no link is followed again.
        read_bytes(&self.resolve(&path)?, self.max_bytes).map_err(renamed)
    }

    /// Returns true if the text of a path is below an allowed folder. Links are not followed.
    #[doc(hidden)]
    pub fn are_above(&self, path: &Path) -> bool {
        let real_roots: Vec<PathBuf> = self.real_roots().collect();
        self.are_above_with(path, &real_roots)
    }

    fn are_above_with(&self, path: &Path, real_roots: &[PathBuf]) -> bool {
        let Some(absolute) = without_dots(path) else {
            return false;
        };
        let absolute_roots = self.roots.iter().filter_map(|root| without_dots(root));
        let mut all_roots = absolute_roots.chain(real_roots.iter().cloned());
        all_roots.any(|root| absolute.starts_with(root))
    }

    fn real_roots(&self) -> impl Iterator<Item = PathBuf> + '_ {
        self.roots
            .iter()
            .filter_map(|root| root.canonicalize().ok())
    }

    /// The real path of a file below the allowed folders. Nothing outside of them is looked at, as far as the path's text shows.
    #[doc(hidden)]
    pub fn resolve(&self, path: &Path) -> Result<PathBuf, ReadError> {
        let file = path.display().to_string();
        let fail = |problem: ReadProblem| ReadError::new(&file, FileLocation::File, problem);
        let outside = || {
            let folders = self.roots.iter().map(|root| root.display().to_string());
            fail(ReadProblem::Outside {
                folders: folders.collect(),
            })
        };
        let real_roots: Vec<PathBuf> = self.real_roots().collect();
        if !self.are_above_with(path, &real_roots) {
            return Err(outside());
        }
        let real = path.canonicalize().map_err(|error| fail(error.into()))?;
        match real_roots.iter().any(|root| real.starts_with(root)) {
            true => Ok(real),
            false => Err(outside()),
        }
    }
}

/// A folder in a form to which paths can be joined: an empty path becomes the working directory.
fn joinable(folder: &Path) -> PathBuf {
    match folder.as_os_str().is_empty() {
        true => PathBuf::from("."),
        false => folder.to_owned(),
    }
}

/// An absolute path without `.` and `..`, by its text only; `None` if `..` leaves the root.
fn without_dots(path: &Path) -> Option<PathBuf> {
    let mut absolute = PathBuf::new();
    for part in std::path::absolute(path).ok()?.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if !absolute.pop() => return None,
            Component::ParentDir => {}
            part => absolute.push(part),
        }
    }
    Some(absolute)
}

/// Restricts a caller's `open` function to references below the folder of the file that contains them.
///
/// It checks the text only, so it works for any file system.
#[doc(hidden)]
pub fn below_folder(
    mut open: impl FnMut(&str) -> Result<Vec<u8>, ReadError>,
) -> impl FnMut(&str) -> Result<Vec<u8>, ReadError> {
    move |reference| match is_below_folder(reference) {
        true => open(reference),
        false => {
            let folders = Vec::new();
            Err(ReadError::new(
                reference,
                FileLocation::File,
                ReadProblem::Outside { folders },
            ))
        }
    }
}

/// True if a reference stays below its base folder, by its text only.
///
/// It must be relative, without a drive, and no `..` may leave the folder. Both slashes are separators.
fn is_below_folder(reference: &str) -> bool {
    let absolute = reference.starts_with(['/', '\\']);
    let drive = reference.as_bytes().get(1) == Some(&b':');
    let mut depth = 0_usize;
    for part in reference.split(['/', '\\']) {
        depth = match part {
            "" | "." => depth,
            ".." => match depth.checked_sub(1) {
                Some(depth) => depth,
                None => return false,
            },
            _ => depth + 1,
        };
    }
    !absolute && !drive && !reference.contains('\0')
}
