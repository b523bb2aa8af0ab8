//! Promise: what a build leaves out says in one line how to get it.

#[cfg(not(feature = "bench"))]
#[test]
fn bench_says_how_to_get_it() {
    use crate::forked_rig::{kinopt, stderr, stdout};
    let output = kinopt(&["bench", "robot.urdf", "--problems", "random:3", "--json"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stdout(&output), "");
    let reason = stderr(&output);
    assert_eq!(reason.lines().count(), 1, "{reason}");
    assert!(
        reason.contains("--features bench -- bench robot.urdf --problems random:3"),
        "{reason}"
    );
}

#[cfg(not(feature = "charts"))]
#[test]
fn the_picture_says_how_to_get_it() {
    use crate::forked_rig::{Folder, kinopt, stderr, stdout};
    let folder = Folder::new("no-picture");
    let file = folder.file("twist.svg");
    let output = kinopt(&["skin-report", "--out", &file]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(stdout(&output), "");
    let reason = stderr(&output);
    assert_eq!(reason.lines().count(), 1, "{reason}");
    assert!(reason.contains("--features charts"), "{reason}");
    assert!(!std::path::Path::new(&file).exists());
}
