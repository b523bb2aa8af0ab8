//! Atomic replacement of files: contents are written to a temporary file in the same folder, which is renamed.
//!
//! A reader gets the old contents or the new ones. If anything fails before the first rename, all files stay unchanged.

use std::fs::File;
use std::io::{Error, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::file::WriteError;

/// Largest number of symbolic links to a file, as in Linux.
const MAX_LINKS: usize = 40;
/// Largest number of attempted names for a temporary file.
const MAX_NAMES: usize = 100;

/// Writes a whole file to a temporary file, then renames that. Symbolic links are followed and kept.
///
/// # Errors
/// Returns a [`WriteError`] with the file's name; the file is unchanged.
pub fn write_file(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), WriteError> {
    write_files(&[(path.as_ref(), bytes)])
}

/// Writes related files: all temporary files are complete before the first is renamed.
#[doc(hidden)]
pub fn write_files(files: &[(&Path, &[u8])]) -> Result<(), WriteError> {
    let mut staged = Vec::with_capacity(files.len());
    for (path, bytes) in files {
        let staged_file =
            Staged::new(path, bytes).map_err(|problem| WriteError::new(path, problem))?;
        staged.push(staged_file);
    }
    for (staged_file, (path, bytes)) in staged.iter_mut().zip(files) {
        let result = staged_file.commit(bytes);
        result.map_err(|problem| WriteError::new(path, problem))?;
    }
    Ok(())
}

/// Contents before the rename.
struct Staged {
    target: PathBuf,
    /// The temporary file; `None` if the contents are written to the target directly.
    temporary: Option<PathBuf>,
}

impl Staged {
    fn new(path: &Path, bytes: &[u8]) -> std::io::Result<Self> {
        let target = without_links(path)?;
        let direct = |target: PathBuf| Self {
            target,
            temporary: None,
        };
        let permissions = match std::fs::metadata(&target) {
            Ok(old) if old.is_dir() => return Err(Error::from(ErrorKind::IsADirectory)),
            // A read-only file must not be replaced either.
            Ok(old) if old.is_file() => {
                File::options().write(true).open(&target)?;
                Some(old.permissions())
            }
            // A device or a pipe.
            Ok(_) => return Ok(direct(target)),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        let (mut file, temporary) = match create_temporary_file(&target) {
            Ok(created) => created,
            // The folder may not allow new files although this file can be written.
            Err(_) if permissions.is_some() => return Ok(direct(target)),
            Err(error) => return Err(error),
        };
        let staged = Self {
            target,
            temporary: Some(temporary),
        };
        file.write_all(bytes)?;
        if let Some(permissions) = permissions {
            file.set_permissions(permissions)?;
        }
        Ok(staged)
    }

    fn commit(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        match &self.temporary {
            None => std::fs::write(&self.target, bytes),
            Some(temporary) => {
                std::fs::rename(temporary, &self.target)?;
                self.temporary = None;
                Ok(())
            }
        }
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            let _ = std::fs::remove_file(temporary);
        }
    }
}

/// A new temporary file in the folder of another file.
fn create_temporary_file(target: &Path) -> std::io::Result<(File, PathBuf)> {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    let mut last_error = Error::from(ErrorKind::AlreadyExists);
    for _ in 0..MAX_NAMES {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        // A cleanup of animation folders deletes files with such names.
        let name = format!(".part.{}-{number}", std::process::id());
        let path = target.with_file_name(name);
        match File::options().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((file, path)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => last_error = error,
            Err(error) => return Err(error),
        }
    }
    Err(last_error)
}

/// The end of a chain of symbolic links; it need not exist.
fn without_links(path: &Path) -> std::io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(link) = std::fs::read_link(&path) else {
            return Ok(path);
        };
        path = path.parent().unwrap_or(Path::new("")).join(link);
    }
    Err(Error::other("too many symbolic links lead to it"))
}
