//! Promise: a missing feature is reported in one line, with the feature to enable.

#[test]
fn missing_bench_states_its_feature() {
    let how = "--features bench -- bench robot.urdf --problems random:3";
    refused!("bench robot.urdf --problems random:3 --json" => 1, "{how}");
}
