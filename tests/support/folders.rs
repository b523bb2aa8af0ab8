//! Temporary folders for tests that write files.

use std::path::PathBuf;

/// Folder of one test; it and its contents are removed on drop.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let folder_name = format!("kinopt-{name}-{}", std::process::id());
        let folder = std::env::temp_dir().join(folder_name);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    /// Path of a file or folder in this folder.
    pub fn path(&self, file: &str) -> PathBuf {
        self.0.join(file)
    }

    /// Names of its entries in alphabetical order.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<String> = entries.map(|e| name(e).into_string().unwrap()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
