//! Promise: a file that is written again is the same file with other bytes: a link to it stays a link, who may read it stays, and
//! nothing is left beside; what is no file, or longer than any such file, is not read.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use kinopt::io::ply::{self, PlyEncoding};
use kinopt::io::{Place, ReadProblem, cones};
use support::folders::Folder;

fn written(path: &Path, encoding: PlyEncoding) -> Vec<u8> {
    let mesh = ply::from_bytes(support::small_rig::PLY.as_bytes(), "small.ply").unwrap();
    ply::write(&mesh, encoding, path).unwrap();
    ply::to_bytes(&mesh, encoding)
}

#[test]
fn a_file_is_written_again_and_nothing_is_left_beside() {
    let folder = Folder::new("written-again");
    let path = folder.path("mesh.ply");
    for encoding in [PlyEncoding::Ascii, PlyEncoding::BinaryBigEndian] {
        let bytes = written(&path, encoding);
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
        assert_eq!(folder.names(), ["mesh.ply"]);
    }
    let mesh = ply::read(&path).unwrap();
    for nowhere in [folder.path(""), folder.path("none/mesh.ply")] {
        let error = ply::write(&mesh, PlyEncoding::Ascii, &nowhere).unwrap_err();
        assert_eq!(error.file, nowhere.display().to_string());
    }
    assert_eq!(folder.names(), ["mesh.ply"]);
}

#[cfg(unix)]
#[test]
fn a_link_stays_a_link_and_rights_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = Folder::new("written-links");
    let (own, other) = (folder.path("own"), folder.path("other"));
    for part in [&own, &other] {
        std::fs::create_dir(part).unwrap();
    }
    let (file, link) = (own.join("mesh.ply"), other.join("link.ply"));
    written(&file, PlyEncoding::Ascii);
    std::fs::set_permissions(&file, PermissionsExt::from_mode(0o640)).unwrap();
    symlink("../own/mesh.ply", &link).unwrap();
    let bytes = written(&link, PlyEncoding::BinaryLittleEndian);
    assert_eq!(std::fs::read(&file).unwrap(), bytes);
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(
        std::fs::metadata(&file).unwrap().permissions().mode() & 0o777,
        0o640
    );
    // A link to what is not there yet makes it.
    let new = other.join("new.ply");
    symlink("../own/new.ply", &new).unwrap();
    let bytes = written(&new, PlyEncoding::Ascii);
    assert_eq!(std::fs::read(own.join("new.ply")).unwrap(), bytes);
    assert!(std::fs::symlink_metadata(&new).unwrap().is_symlink());
    for (part, count) in [(&own, 2), (&other, 2)] {
        assert_eq!(std::fs::read_dir(part).unwrap().count(), count);
    }
}

#[test]
fn what_is_no_file_or_too_long_is_not_read() {
    let folder = Folder::new("written-long");
    let of_folder = cones::read(folder.path("")).unwrap_err();
    assert_eq!(of_folder.place, Place::File);
    assert!(of_folder.to_string().ends_with(": is not a regular file"));
    let path = folder.path("long.json");
    let long = std::fs::File::create(&path).unwrap();
    for (length, is_too_long) in [(1 << 24, false), ((1 << 24) + 1, true)] {
        long.set_len(length).unwrap();
        let problem = cones::read(&path).unwrap_err().problem;
        let limit = match problem {
            ReadProblem::TooLong { limit } => Some(limit),
            _ => None,
        };
        assert_eq!(limit, is_too_long.then_some(1 << 24));
    }
}

/// What is written beside the file goes to where no byte fits.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_file_that_was_there() {
    let folder = Folder::new("written-full");
    let path = folder.path("mesh.ply");
    let bytes = written(&path, PlyEncoding::Ascii);
    let mesh = ply::read(&path).unwrap();
    std::os::unix::fs::symlink("/dev/full", folder.path(".part.mesh.ply")).unwrap();
    let error = ply::write(&mesh, PlyEncoding::BinaryBigEndian, &path).unwrap_err();
    assert_eq!(error.file, path.display().to_string());
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    assert_eq!(folder.names(), ["mesh.ply"]);
}

/// Each has a file of its own beside it until it is whole.
#[test]
fn files_of_one_folder_are_written_at_the_same_time() {
    let folder = Folder::new("written-together");
    let encodings = [PlyEncoding::Ascii, PlyEncoding::BinaryLittleEndian];
    let files = [0, 1].map(|own| folder.path(&format!("{own}.ply")));
    std::thread::scope(|scope| {
        for (path, encoding) in files.iter().zip(encodings) {
            scope.spawn(move || {
                for _ in 0..100 {
                    let bytes = written(path, encoding);
                    assert_eq!(std::fs::read(path).unwrap(), bytes);
                }
            });
        }
    });
    assert_eq!(folder.names(), ["0.ply", "1.ply"]);
}
