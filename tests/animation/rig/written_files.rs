//! Promise: overwriting a file keeps its links and permissions and leaves no temporary file. Non-regular files and
//! files beyond the size limit are not read.

use std::path::Path;

use kinopt::io::ply::{self, PlyEncoding};
use kinopt::io::{FileLocation, ReadProblem, cones};
use support::folders::Folder;

fn written(path: &Path, encoding: PlyEncoding) -> Vec<u8> {
    let mesh = ply::from_bytes(support::small_rig::PLY.as_bytes(), "small.ply").unwrap();
    ply::write(&mesh, encoding, path).unwrap();
    ply::to_bytes(&mesh, encoding)
}

#[test]
fn overwriting_leaves_no_temporary_file() {
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
fn links_and_permissions_are_kept() {
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
    // A link to a missing file creates it.
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
fn non_regular_and_huge_files_are_not_read() {
    let folder = Folder::new("written-long");
    let of_folder = cones::read(folder.path("")).unwrap_err();
    assert_eq!(of_folder.place, FileLocation::File);
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

/// If the rig's JSON cannot be replaced, its mesh and weights are unchanged.
#[test]
fn files_of_a_rig_are_replaced_together() {
    let folder = Folder::new("written-rig");
    let mut rig = support::small_rig::SmallRig::with_json(support::small_rig::JSON)
        .parse()
        .unwrap();
    rig.write(folder.path("rig.json")).unwrap();
    assert_eq!(folder.names(), ["rig.dmat", "rig.json", "rig.ply"]);
    let bytes = |file: &str| std::fs::read(folder.path(file)).unwrap();
    let before = ["rig.dmat", "rig.ply"].map(bytes);
    std::fs::remove_file(folder.path("rig.json")).unwrap();
    std::fs::create_dir(folder.path("rig.json")).unwrap();
    (rig.mesh, rig.weights) = (None, None);
    let other = support::small_rig::PLY.replace("1 0 0", "9 0 0");
    rig.mesh = Some(ply::from_bytes(other.as_bytes(), "other.ply").unwrap());
    let error = rig.write(folder.path("rig.json")).unwrap_err();
    assert_eq!(error.file, folder.path("rig.json").display().to_string());
    assert_eq!(["rig.dmat", "rig.ply"].map(bytes), before);
    assert_eq!(folder.names(), ["rig.dmat", "rig.json", "rig.ply"]);
}

/// A guessed temporary name cannot redirect the output, and a new file appears complete.
#[cfg(unix)]
#[test]
fn temporary_file_follows_no_link() {
    let folder = Folder::new("written-guessed");
    let (path, victim) = (folder.path("mesh.ply"), folder.path("victim"));
    std::fs::write(&victim, "kept").unwrap();
    let first = format!(".part.{}-", std::process::id());
    for number in 0..40 {
        let guess = folder.path(&format!("{first}{number}"));
        std::os::unix::fs::symlink(&victim, guess).unwrap();
    }
    let bytes = written(&path, PlyEncoding::Ascii);
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    assert_eq!(std::fs::read(&victim).unwrap(), b"kept");
    assert!(!std::fs::symlink_metadata(&path).unwrap().is_symlink());
}

/// A link to a device is written through and kept.
#[cfg(target_os = "linux")]
#[test]
fn full_device_is_an_error() {
    let folder = Folder::new("written-full");
    let path = folder.path("mesh.ply");
    std::os::unix::fs::symlink("/dev/full", &path).unwrap();
    let mesh = ply::from_bytes(support::small_rig::PLY.as_bytes(), "small.ply").unwrap();
    let error = ply::write(&mesh, PlyEncoding::BinaryBigEndian, &path).unwrap_err();
    assert_eq!(error.file, path.display().to_string());
    assert!(std::fs::symlink_metadata(&path).unwrap().is_symlink());
    assert_eq!(folder.names(), ["mesh.ply"]);
}

/// Each has a separate temporary file until it is complete.
#[test]
fn concurrent_writes_to_a_folder_succeed() {
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
