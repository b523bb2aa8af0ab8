//! Motions of a folder, with their output files.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use super::{FolderError, FolderSettings, SETTINGS_FILE};
use kinopt::io::write_file;

/// File extensions of motions.
const FILE_EXTENSIONS: [&str; 7] = ["npy", "npz", "c3d", "bvh", "glb", "gltf", "vrm"];

/// File extension of motions that outputs may have as well.
const TABLE_EXTENSION: &str = "npz";

/// Prefix of the names of unfinished files.
const UNFINISHED_PREFIX: &str = ".part.";

/// Motions in a folder and its subfolders, and the output folder with files of the same names.
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// use kinopt_bindings::retarget_folder::{FolderSettings, MotionFolder, unfinished};
/// use kinopt::motion::retarget::RetargetOptions;
/// use kinopt::robot::{BaseJoint, Robot};
///
/// # let into = std::env::temp_dir().join(format!("kinopt-movements-{}", std::process::id()));
/// let robot = Robot::read("models/aldebaran_nao.urdf")?.with_base_joint(BaseJoint::FREE)?;
/// let settings = FolderSettings::new(&robot, RetargetOptions::default());
/// let folder = MotionFolder::find("models/captures".as_ref(), &into, "csv")?;
/// for movement in folder.begin(&settings, false)?.iter().filter(|movement| !movement.done_before) {
/// // The motion is retargeted to the robot here.
///     let written = unfinished(&movement.out);
///     std::fs::write(&written, "0,0,0")?;
///     std::fs::rename(&written, &movement.out)?;
/// }
/// assert!(folder.begin(&settings, false)?.iter().all(|movement| movement.done_before));
/// # std::fs::remove_dir_all(&into)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MotionFolder {
    into: PathBuf,
    /// Sources and outputs, sorted by name.
    pairs: Vec<(PathBuf, PathBuf)>,
}

/// Motion of a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FolderMotion {
    /// Path of the source file.
    pub source: PathBuf,
    /// Path of the output file.
    pub out: PathBuf,
    /// True if the output file exists and is newer than its source.
    pub done_before: bool,
}

impl MotionFolder {
    /// Finds the motions in `source` (.npy, .npz, .c3d, .bvh, .glb, .gltf, .vrm; no hidden files) and determines their output files.
    ///
    /// Outputs have the same names in `into` with the extension `ending`. Nothing is written. If `source` is `into` and the
    /// extension is npz, files with that extension are no motions.
    ///
    /// # Errors
    /// Returns an error if `source` is not a folder, cannot be read, or has no motion. Returns an error if two motions
    /// have the same output, or if outputs would be read as motions.
    pub fn find(source: &Path, into: &Path, ending: &str) -> Result<Self, FolderError> {
        if !source.is_dir() {
            let folder = source.to_owned();
            return Err(FolderError::NoFolder { folder });
        }
        let output = fs::canonicalize(into).ok();
        let is_into = |folder: &Path| output.is_some() && fs::canonicalize(folder).ok() == output;
        let is_table = ending == TABLE_EXTENSION;
        if FILE_EXTENSIONS.contains(&ending) && !is_table && is_into(source) {
            let folder = into.to_owned();
            return Err(FolderError::IntoItself { folder });
        }
        let mut sources = movements(source, &is_into)?;
        if is_table && is_into(source) {
            // Outputs are next to the motions.
            sources.retain(|motion| motion.extension() != Some(OsStr::new(TABLE_EXTENSION)));
        }
        if sources.is_empty() {
            return Err(FolderError::Empty {
                folder: source.to_owned(),
                kinds: FILE_EXTENSIONS.map(|kind| format!(".{kind}")).join(", "),
            });
        }
        let mut outputs: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
        let mut pairs = Vec::with_capacity(sources.len());
        for second in sources {
            let name = second.strip_prefix(source).unwrap_or(&second);
            let out = into.join(name).with_extension(ending);
            if let Some(first) = outputs.insert(out.clone(), second.clone()) {
                return Err(FolderError::OneName { first, second, out });
            }
            pairs.push((second, out));
        }
        Ok(Self {
            into: into.to_owned(),
            pairs,
        })
    }

    /// Creates the output folder, stores the settings, and removes unfinished files. Returns all motions with their
    /// state.
    ///
    /// If `again` is set, all motions are to be done, and stored settings are replaced.
    ///
    /// # Errors
    /// Returns an error if the folder has results of other settings, or cannot be written.
    pub fn begin(
        &self,
        settings: &FolderSettings<'_>,
        again: bool,
    ) -> Result<Vec<FolderMotion>, FolderError> {
        create_folder(&self.into)?;
        let settings_path = self.into.join(SETTINGS_FILE);
        let text = settings.text();
        if settings_path.exists() && !again {
            let before = fs::read(&settings_path)
                .map_err(|error| FolderError::reading(&settings_path, error))?;
            if before != text.as_bytes() {
                return Err(FolderError::OtherQuestion {
                    folder: self.into.clone(),
                    differs: settings.differs(&before),
                });
            }
        } else {
            write_file(&settings_path, text.as_bytes()).map_err(|error| {
                let problem = std::io::Error::new(error.problem.kind(), error.problem.to_string());
                FolderError::writing(&settings_path, problem)
            })?;
        }
        let mut last: Option<&Path> = None;
        for folder in self.pairs.iter().filter_map(|(_, out)| out.parent()) {
            if last != Some(folder) {
                create_folder(folder)?;
                remove_unfinished(folder)?;
                last = Some(folder);
            }
        }
        let motions = self.pairs.iter().map(|(source, out)| FolderMotion {
            source: source.clone(),
            out: out.clone(),
            done_before: !again && is_newer(out, source),
        });
        Ok(motions.collect())
    }
}

/// Returns the path of an unfinished output file, in the same folder with the same extension.
#[must_use]
pub fn unfinished(out: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(UNFINISHED_PREFIX);
    name.push(out.file_name().unwrap_or_default());
    out.with_file_name(name)
}

/// Returns the motions in a folder and its subfolders, sorted, without the output folder.
fn movements(folder: &Path, is_into: &impl Fn(&Path) -> bool) -> Result<Vec<PathBuf>, FolderError> {
    let read_error = |error: std::io::Error| FolderError::reading(folder, error);
    let mut motions = Vec::new();
    for entry in fs::read_dir(folder).map_err(read_error)? {
        let path = entry.map_err(read_error)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with('.') {
            continue;
        }
        if path.is_dir() {
            if !is_into(&path) {
                motions.extend(movements(&path, is_into)?);
            }
            continue;
        }
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        if FILE_EXTENSIONS.contains(&ending.to_lowercase().as_str()) {
            motions.push(path);
        }
    }
    motions.sort();
    Ok(motions)
}

fn create_folder(folder: &Path) -> Result<(), FolderError> {
    fs::create_dir_all(folder).map_err(|error| FolderError::writing(folder, error))
}

/// Returns whether an output was written after its source.
fn is_newer(out: &Path, source: &Path) -> bool {
    let time = |path: &Path| fs::metadata(path).and_then(|file| file.modified()).ok();
    time(out)
        .zip(time(source))
        .is_some_and(|(out, source)| out >= source)
}

/// Removes the unfinished files of cancelled runs.
fn remove_unfinished(folder: &Path) -> Result<(), FolderError> {
    let write_error = |error: std::io::Error| FolderError::writing(folder, error);
    for entry in fs::read_dir(folder).map_err(write_error)? {
        let path = entry.map_err(write_error)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with(UNFINISHED_PREFIX) {
            fs::remove_file(&path).map_err(write_error)?;
        }
    }
    Ok(())
}
