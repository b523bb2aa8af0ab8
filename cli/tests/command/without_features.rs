//! Promise: a missing feature is reported in one line, with the feature to enable.

#[test]
fn missing_bench_states_its_feature() {
    let how = "--features bench -- bench robot.urdf --problems random:3";
    refused!("bench robot.urdf --problems random:3 --json" => 1, "{how}");
}

#[cfg(not(feature = "charts"))]
#[test]
fn missing_charts_state_their_feature() {
    let folder = crate::forked_rig::Folder::new("no-picture");
    let file = folder.file("twist.svg");
    refused!("skin-report --out {file}" => 1, "--features charts");
    assert!(!std::path::Path::new(&file).exists());
}
