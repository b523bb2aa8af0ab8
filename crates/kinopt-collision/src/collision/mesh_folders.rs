//! Resolution of mesh references in robot files.

use std::path::{Path, PathBuf};

use kinopt_kinematics::file::{ReadError, ReadProblem, read_bytes};
use kinopt_kinematics::file_access::AllowedFiles;

/// Name of the manifest of a ROS package, and the largest size that is read, bytes.
const MANIFEST: &str = "package.xml";
const MANIFEST_LIMIT: u64 = 1 << 20;

/// Resolves `package://NAME/…`, `model://NAME/…`, `file://…` and plain paths.
#[derive(Clone, Debug, Default)]
pub(super) struct MeshFolders {
    /// Folder of the robot's file.
    pub(super) robot_folder: Option<PathBuf>,
    /// Folders that contain packages or are packages.
    pub(super) packages: Vec<PathBuf>,
}

impl MeshFolders {
    /// The first existing file for a reference, or all candidate paths as the error.
    ///
    /// A package is a folder of its name, or else a folder whose `package.xml` states the name.
    pub(super) fn find(&self, reference: &str) -> Result<PathBuf, Vec<PathBuf>> {
        let mut paths = self.candidate_paths(reference);
        let is_file = |path: &&PathBuf| path.is_file();
        if let Some(path) = paths.iter().find(is_file) {
            return Ok(path.clone());
        }
        let declared = self.paths_by_manifest(reference, |_| true);
        if let Some(path) = declared.iter().find(is_file) {
            return Ok(path.clone());
        }
        paths.extend(declared);
        Err(paths)
    }

    /// [`find`](Self::find) restricted to allowed files: other meshes and manifests are not opened. The error is that
    /// of a file outside the allowed folders, or the paths searched.
    pub(super) fn find_allowed(
        &self,
        reference: &str,
        allowed: &AllowedFiles,
    ) -> Result<PathBuf, Result<ReadError, Vec<PathBuf>>> {
        let mut looked_at = Vec::new();
        let mut outside = None;
        let mut try_path = |path: PathBuf| {
            // A package is searched for in many folders, some not allowed; a plain path is at one place.
            if package_of(reference).is_some() && !allowed.are_above(&path) {
                return None;
            }
            match allowed.resolve(&path) {
                Ok(real) if real.is_file() => return Some(real),
                Err(error) if matches!(error.problem, ReadProblem::Outside { .. }) => {
                    outside.get_or_insert(error);
                }
                _ => looked_at.push(path),
            }
            None
        };
        let by_name = self
            .candidate_paths(reference)
            .into_iter()
            .find_map(&mut try_path);
        let is_allowed = |folder: &Path| allowed.resolve(&folder.join(MANIFEST)).is_ok();
        let path = by_name.or_else(|| {
            let declared = self.paths_by_manifest(reference, is_allowed);
            declared.into_iter().find_map(&mut try_path)
        });
        path.ok_or_else(|| outside.ok_or(looked_at))
    }

    /// Candidate paths in packages whose `package.xml` states the name. The packages are the folders above the robot's
    /// file, the folders next to its package, the given folders, and their subfolders. Only manifests in folders
    /// accepted by `is_allowed` are read.
    fn paths_by_manifest(
        &self,
        reference: &str,
        is_allowed: impl Fn(&Path) -> bool,
    ) -> Vec<PathBuf> {
        let Some((name, rest)) = package_of(reference) else {
            return Vec::new();
        };
        let above: Vec<PathBuf> = self.above().filter(|folder| is_allowed(folder)).collect();
        let package_folder = above.iter().find(|folder| folder.join(MANIFEST).is_file());
        let siblings = package_folder
            .and_then(|folder| folder.parent())
            .map(Path::to_owned);
        let subfolders = self
            .packages
            .iter()
            .chain(&siblings)
            .flat_map(|folder| folders_in(folder));
        let all = self
            .packages
            .iter()
            .cloned()
            .chain(above.clone())
            .chain(subfolders);
        all.filter(|folder| is_allowed(folder) && declares(folder, name))
            .map(|folder| folder.join(rest))
            .collect()
    }

    /// The folder of the robot's file and its ancestors.
    fn above(&self) -> impl Iterator<Item = PathBuf> {
        // A file name without a folder is relative to the working directory. Absolute paths keep all ancestors.
        let absolute = |folder: &PathBuf| {
            let absolute = std::path::absolute(Path::new(".").join(folder));
            absolute.unwrap_or_else(|_| folder.clone())
        };
        let folder = self.robot_folder.as_ref().map(absolute);
        let ancestors =
            |folder: PathBuf| -> Vec<PathBuf> { folder.ancestors().map(Path::to_owned).collect() };
        folder.map(ancestors).into_iter().flatten()
    }

    fn candidate_paths(&self, reference: &str) -> Vec<PathBuf> {
        let strip = |scheme: &str| reference.strip_prefix(scheme);
        let mut paths = Vec::new();
        if let Some((name, rest)) = package_of(reference) {
            for folder in &self.packages {
                paths.push(folder.join(name).join(rest));
                if is_named(folder, name) {
                    paths.push(folder.join(rest));
                }
            }
            // Upward from the robot's file: the package itself, or a package next to an ancestor.
            for folder in self.above() {
                if is_named(&folder, name) {
                    paths.push(folder.join(rest));
                }
                paths.push(folder.join(name).join(rest));
            }
            return paths;
        }
        let path = Path::new(strip("file://").unwrap_or(reference));
        if path.is_absolute() {
            return vec![path.to_owned()];
        }
        let folders = self.robot_folder.iter().chain(&self.packages);
        paths.extend(folders.map(|folder| folder.join(path)));
        paths
    }
}

/// The package name and the path within the package of `package://NAME/…` or `model://NAME/…`.
fn package_of(reference: &str) -> Option<(&str, &str)> {
    let strip = |scheme: &str| reference.strip_prefix(scheme);
    let path = strip("package://").or_else(|| strip("model://"))?;
    path.split_once('/')
}

/// True if the manifest of a folder states this package name.
fn declares(folder: &Path, name: &str) -> bool {
    let manifest = read_bytes(&folder.join(MANIFEST), MANIFEST_LIMIT);
    manifest.is_ok_and(|bytes| {
        let text = String::from_utf8_lossy(&bytes);
        let stated = text
            .split_once("<name>")
            .and_then(|(_, rest)| rest.split_once("</name>"));
        stated.is_some_and(|(stated, _)| stated.trim() == name)
    })
}

/// The subfolders of a folder, sorted by path.
fn folders_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .collect();
    folders.sort();
    folders
}

fn is_named(folder: &Path, name: &str) -> bool {
    folder
        .file_name()
        .is_some_and(|folder_name| folder_name == name)
}
