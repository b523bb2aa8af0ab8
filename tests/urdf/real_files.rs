//! Every URDF below the folder `KINOPT_URDFS` is read, or refused by name; which, and why, is
//! printed. Without that variable only the files of this repository are looked at.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::path::{Path, PathBuf};

use kinopt::robot::Robot;

fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_below(&path, found);
        } else if path.extension().is_some_and(|e| e == "urdf") {
            found.push(path);
        }
    }
}

#[test]
fn files_from_elsewhere_are_read_or_refused_by_name() {
    let folder = std::env::var("KINOPT_URDFS").unwrap_or_else(|_| {
        println!("KINOPT_URDFS is not set: only the shipped files are read");
        "models".to_owned()
    });
    let mut files = Vec::new();
    files_below(Path::new(&folder), &mut files);
    files.sort();
    let mut refused = 0;
    for file in &files {
        if let Err(error) = Robot::read(file) {
            refused += 1;
            println!("{error}");
        }
    }
    println!("{refused} of {} files refused", files.len());
    assert!(folder != "models" || refused == 0);
}
