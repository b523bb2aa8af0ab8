//! Promise: every URDF below the folder `KINOPT_URDFS` is read, or rejected by name; the test prints which and why.
//! Without the variable only the files of this repository are read.
#![allow(clippy::print_stdout)]

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
fn external_files_are_read_or_rejected_by_name() {
    let folder = std::env::var("KINOPT_URDFS").unwrap_or_else(|_| {
        println!("KINOPT_URDFS is not set: only the shipped files are read");
        "../models".to_owned()
    });
    let mut files = Vec::new();
    files_below(Path::new(&folder), &mut files);
    files.sort();
    let (mut refused, mut noted) = ([0, 0], 0);
    for file in &files {
        let Err(error) = Robot::read(file) else {
            continue;
        };
        refused[0] += 1;
        println!("{error}");
        match Robot::reader().lenient().read(file) {
            Ok(robot) => {
                noted += 1;
                for repair in robot.repairs() {
                    println!("  mended: {repair}");
                }
            }
            Err(_) => refused[1] += 1,
        }
    }
    println!(
        "{} of {} files refused, {noted} of them mended by a lenient reader",
        refused[0],
        files.len()
    );
    assert!(folder != "../models" || refused == [0, 0]);
}
