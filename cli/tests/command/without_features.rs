//! Promise: what a build leaves out says in one line how to get it.

#[test]
fn bench_says_how_to_get_it() {
    let how = "--features bench -- bench robot.urdf --problems random:3";
    refused!("bench robot.urdf --problems random:3 --json" => 1, "{how}");
}

#[cfg(not(feature = "charts"))]
#[test]
fn the_picture_says_how_to_get_it() {
    let folder = crate::forked_rig::Folder::new("no-picture");
    let file = folder.file("twist.svg");
    refused!("skin-report --out {file}" => 1, "--features charts");
    assert!(!std::path::Path::new(&file).exists());
}
