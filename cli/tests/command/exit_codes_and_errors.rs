//! Promise: exit codes.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | success |
//! | 1 | failure with a one-line reason |
//! | 2 | wrong usage |
//! | 3 | miss with `--fail-on-miss` (`fail_on_miss_sets_the_exit_code`) |
//!
//! Each error names the wrong item, lists valid names, and prints nothing on standard output.

use std::process::{Command, Stdio};

use crate::forked_rig::*;

const TARGET: &str = "--target=bone/2=-2.5,0.5,0";

#[test]
fn unknown_names_come_with_the_valid_ones() {
    let (_folder, rig) = Folder::with_rig("names");
    for target in ["--target=hand=1,2,3", "--ray=hand=0,0,1:0,0,0"] {
        refused!("body {rig} {target}" => 1, "bone/0 | bone/4 | /tip | `hand`");
    }
    refused!("solve {rig} --target=bone/5=1,2,3 --json" => 1, "`bone/5` | bone/4");
    refused!("fk {rig} --frame hand" => 1, "`hand` | bone/0");
    let solvers = "newton | levenberg-marquardt | gauss-newton | projected-gradient-bb";
    refused!("solve {rig} {TARGET} @solve.solver=newton" => 1, "solve: | {solvers}");
    let routes = "exact | analytic | dual | fd | central";
    refused!("solve {rig} {TARGET} @solve.jacobian=exact" => 1, "solve: | {routes}");
}

#[test]
fn wrong_usage_exits_with_two() {
    let (_folder, rig) = Folder::with_rig("usage");
    refused("", 2, "info | fk | solve");
    refused!("dance" => 2, "dance");
    refused!("follow robot.urdf" => 2, "`follow` | track MODEL --targets FILE");
    refused!("info" => 2, "MODEL");
    refused!("solve {rig}" => 2, "nothing to solve | --target | `tasks`");
    refused!("solve {rig} --json" => 2, "--target");
    refused!("solve {rig} {TARGET} --fast" => 2, "--fast");
    refused!("solve {rig} --target=bone/2=1,2" => 2, "bone/2=1,2 | not 2");
    refused!("solve {rig} --target=bone/2=1,2,nan" => 2, "`nan`");
    refused!("solve {rig} --target=bone/2=1,2,3,2,0,0,0" => 2, "length 2");
    refused!("body {rig} --ray=bone/2=1,2,3" => 2, "colon");
    refused!("solve {rig} {TARGET} --start home" => 2, "rest | random");
    refused!("solve {rig} {TARGET} --start=1,x" => 2, "`x`");
    refused!("solve {rig} {TARGET} --tolerance=-1" => 2, "`-1`");
    refused!("solve {rig} {TARGET} --time-limit 0" => 2, "above 0");
    refused!("solve {rig} {TARGET} --time-limit 1e300" => 2, "1e300");
    refused!("solve {rig} {TARGET} --out posed.stl" => 2, "posed.stl | .obj | .ply");
    refused!("fk {rig} --q 1,two" => 2, "`two`");
    refused!("fk {rig} --q 1,2,3" => 2, "--q | 3 numbers | 15 | 5 bones");
    refused!("solve {rig} {TARGET} --start 1" => 2, "--start | 1 numbers | 15");
    refused!("solve {rig} {TARGET} --max-move 1,2" => 2, "--max-move | 2 numbers | 15");
    refused!("fk {rig} --q=1 --time=1" => 2, "--time");
    refused!("fk {rig} --loop" => 2, "--time");
    // Options that another option excludes are errors, not ignored.
    refused!("fk {rig} --q=1 --loop" => 2, "--loop");
    refused!("fk {rig} --q=1 --interpolation=linear" => 2, "--interpolation");
    refused!("fk {rig} --time=1 --degrees" => 2, "--degrees");
}

/// A negative number is rejected as a value, not as an unknown option.
#[test]
fn negative_numbers_are_rejected_as_numbers() {
    let folder = Folder::new("negative");
    let (rig, panda) = (folder.rig(), model("franka_panda.urdf"));
    refused!("solve {rig} {TARGET} --max-move -1" => 1, "max_move | -1");
    for option in ["--tolerance", "--time-limit"] {
        refused!("solve {rig} {TARGET} {option} -1" => 2, "{option} | `-1`");
    }
    refused!("path {panda} weld.csv --max-step -1" => 2, "--max-step | `-1`");
    refused!("spheres {panda} --max-protrusion -1 --out s.yml" => 1, "--max-protrusion -1 | positive");
    refused!("animate {rig} --fps -24 --out frames" => 2, "--fps | `-24`");
    refused!("retarget walk.bvh {panda} --contact-speed -1 --out a.npz" => 2, "--contact-speed | `-1`");
    refused!("retarget walk.bvh {panda} --margin -1 --out a.npz" => 2, "--margin | `-1`");
}

#[test]
fn failures_exit_with_one() {
    let (folder, rig_file) = Folder::with_rig("failed");
    let missing = folder.file("missing.json");
    refused!("info {missing}" => 1, "missing.json");
    refused!("info arm.urdx" => 1, "arm.urdx | .urdx | .json");
    refused!("info arm" => 1, "extension | .json");
    let broken = folder.text("broken.json", "{\"bones\":\n[}");
    refused!("solve {broken} {TARGET}" => 1, "broken.json");

    for (name, content, reason) in [
        ("text.json", "hello", "JSON"),
        ("words.json", "{\"q\": [\"a\"]}", "list of numbers"),
        ("short.json", "[1, 2]", "2 numbers"),
    ] {
        let file = folder.text(name, content);
        refused!("fk {rig_file} --q-file {file}" => 1, "{name} | {reason}");
    }
    refused!("fk {rig_file} --q-file {missing}" => 1, "missing.json");

    let bare = folder.changed("bare.json", |rig| {
        (rig.weights, rig.clip) = (None, Default::default());
    });
    refused!("fk {bare} --time 1" => 1, "--time | keyframes");
    let out = folder.file("posed.obj");
    let meshless = folder.changed("meshless.json", |rig| {
        (rig.weights, rig.mesh) = (None, None)
    });
    refused!("solve {meshless} {TARGET} --out {out}" => 1, "--out | a mesh");
    assert!(!std::path::Path::new(&out).exists());

    let nowhere = folder.file("absent/posed.ply");
    refused!("solve {rig_file} {TARGET} --out {nowhere}" => 1, "absent/posed.ply");
}

#[test]
fn similar_name_is_suggested_with_a_short_list() {
    let folder = Folder::new("suggested");
    let (rig, ur5e) = (folder.rig(), model("universal_ur5e.urdf"));
    let meant = "did you mean `joint3`? valid names: joint1, ";
    for option in ["--lock=joint33", "@model.only=[\"joint1\",\"joint33\"]"] {
        let target = "--target=flange=0.4,0.1,0.5";
        refused!("solve {ur5e} {target} {option}" => 1, "{meant}");
    }
    // Without a similar name the error has only the list.
    refused!("solve {rig} {TARGET} --hold=tail" => 1, "; valid names: bone/0");
}

#[test]
fn names_are_checked_before_weights_are_computed() {
    let folder = Folder::new("names-first");
    let bare = folder.changed("bare.json", |rig| rig.weights = None);
    let out = folder.file("posed.obj");
    // The error is one line about the name; weights are not computed.
    for wrong in [
        "--target=hand=1,2,3",
        "--hold=hand",
        "--weight=hand=2",
        "--base=hand",
    ] {
        refused!("body {bare} {TARGET} {wrong} --out {out}" => 1, "`hand`");
    }
}

#[test]
fn numbers_whose_squares_overflow_are_rejected() {
    let (folder, rig) = Folder::with_rig("huge");
    let bound = "beyond 1e150";
    for huge in ["--target=bone/2=1e200,0,0", "--ray=bone/2=0,-1e151,3:0,0,0"] {
        refused!("body {rig} {huge}" => 2, "{bound} | e1");
    }
    refused!("solve {rig} {TARGET} --tool=1e200,0,0" => 2, "{bound}");
    let file = folder.text("far.json", "{\"targets\": [[0, 0, 0], [0, 1e200, 0]]}");
    let tip = "--tip=bone/2";
    refused!("batch {rig} {tip} --targets {file}" => 1, "far.json | targets[1][1] | {bound}");
    // Results for large accepted numbers are finite.
    let panda = model("franka_panda.urdf");
    for (model, target) in [
        (&rig, "--target=bone/2=1e150,-1e150,0"),
        (&panda, "--target=tool=1e150,0,-1e150"),
        (&panda, "--target=tool=1e150,0,-1e150,1,0,0,0"),
    ] {
        let solution = answer!("solve {model} {target}");
        assert_eq!(solution["reached"], false, "{target}");
        assert!(
            number(&solution["tasks"][0]["position_error"]) > 1e150,
            "{target}"
        );
    }
}

/// The error for an option that a subcommand does not have names its place.
#[test]
fn moved_options_are_found() {
    for (line, place) in [
        (
            "solve a.urdf --targets p.json --track",
            "kinopt batch, track, servo or reach",
        ),
        (
            "batch a.urdf --targets p.json --track",
            "--track: see kinopt track",
        ),
        ("solve a.urdf --servo 500", "kinopt servo --rate HZ"),
        ("solve a.urdf --balance foot", "kinopt body"),
        ("solve a.urdf --free-axis=z", "--interval"),
        ("solve a.urdf --restarts 0", "`attempts`"),
        (
            "solve a.urdf --max-iterations 9",
            r#"{"solve": {"max_iterations": …}} in the file of --problem"#,
        ),
        (
            "check a.urdf --package b",
            r#"{"collisions": {"package": …}}"#,
        ),
        (
            "path a.urdf b.csv --order w-last",
            r#"{"path": {"order": …}}"#,
        ),
        ("servo a.urdf --tasks t.json", "`tasks`"),
    ] {
        refused(line, 2, place);
    }
    let output = kinopt("solve a.urdf --fast");
    assert!(!stderr(&output).contains("see"), "{}", stderr(&output));
}

#[test]
fn closed_pipe_is_not_a_failure() {
    let (_folder, rig) = Folder::with_rig("pipe");
    for line in [
        "info RIG",
        "fk RIG --json",
        "solve RIG TARGET --json",
        "solve --help",
    ] {
        let line = line.replace("RIG", &rig).replace("TARGET", TARGET);
        let mut command = Command::new(env!("CARGO_BIN_EXE_kinopt"));
        let command = command.args(line.split(' ')).stdout(Stdio::piped());
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(
            (output.status.code(), stderr(&output)),
            (Some(0), ""),
            "{line}"
        );
    }
}
