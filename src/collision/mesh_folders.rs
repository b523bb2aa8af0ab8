//! Where the meshes that a robot's file names lie.

use std::path::{Path, PathBuf};

/// Resolves `package://NAME/…`, `model://NAME/…`, `file://…` and paths.
#[derive(Clone, Debug, Default)]
pub(super) struct MeshFolders {
    /// The folder of the robot's file.
    pub(super) beside: Option<PathBuf>,
    /// Folders that hold packages, or are one.
    pub(super) packages: Vec<PathBuf>,
}

impl MeshFolders {
    /// The first place with such a file, or all places that were looked at.
    pub(super) fn find(&self, reference: &str) -> Result<PathBuf, Vec<PathBuf>> {
        let places = self.places(reference);
        let found = places.iter().position(|place| place.is_file());
        match found {
            Some(at) => Ok(places[at].clone()),
            None => Err(places),
        }
    }

    fn places(&self, reference: &str) -> Vec<PathBuf> {
        let strip = |scheme: &str| reference.strip_prefix(scheme);
        let mut places = Vec::new();
        let package = strip("package://").or_else(|| strip("model://"));
        if let Some((name, rest)) = package.and_then(|path| path.split_once('/')) {
            for folder in &self.packages {
                places.push(folder.join(name).join(rest));
                if is_named(folder, name) {
                    places.push(folder.join(rest));
                }
            }
            // From the robot's file upward, beyond where a relative name begins: the package itself, or one beside.
            let whole = |folder: &PathBuf| {
                // The folder of a file without one is where the program runs.
                let whole = std::path::absolute(Path::new(".").join(folder));
                whole.unwrap_or_else(|_| folder.clone())
            };
            let beside = self.beside.as_ref().map(whole);
            for folder in beside.iter().flat_map(|folder| folder.ancestors()) {
                if is_named(folder, name) {
                    places.push(folder.join(rest));
                }
                places.push(folder.join(name).join(rest));
            }
            return places;
        }
        let path = Path::new(strip("file://").unwrap_or(reference));
        if path.is_absolute() {
            return vec![path.to_owned()];
        }
        let folders = self.beside.iter().chain(&self.packages);
        places.extend(folders.map(|folder| folder.join(path)));
        places
    }
}

fn is_named(folder: &Path, name: &str) -> bool {
    folder.file_name().is_some_and(|own| own == name)
}
