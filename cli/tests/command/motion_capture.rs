//! Promise: `info` reports the content of a motion capture file. `fk` places its joints at rest and at any time.

use crate::forked_rig::*;
use serde_json::json;

pub(crate) const WAVE: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 4 Xposition Yposition Zposition Yrotation
  JOINT Upper Arm
  {
    OFFSET 0 4 0
    CHANNELS 2 Zrotation Xrotation
    End Site
    {
      OFFSET 3 0 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.25
1 2 3 0 0 0
1 2 5 90 90 0
1 2 5 90 90 0
";

fn wave(folder: &Folder) -> String {
    folder.text("wave.bvh", WAVE)
}

#[test]
fn info_lists_bones_frames_and_channels() {
    let folder = Folder::new("capture-info");
    let file = wave(&folder);
    let info = answer!("info {file}");
    has!(info, {"file": file, "kind": "motion capture", "size": 5.0});
    has!(info, {"clips": [{"name": "wave", "start": 0.0, "end": 0.5}]});
    has!(info, {"captured": {"frames": 3, "frame_time": 0.25, "channels": 6}});
    let arm = json!({
        "name": "Upper Arm",
        "parent": "Hips",
        "rest_position": [0.0, 4.0, 0.0],
        "channels": ["Zrotation", "Xrotation"],
    });
    assert_eq!(info["bones"][1], arm);
    has!(info["bones"][2], {"name": "Upper Arm/tip", "channels": []});

    let text = text!("info {file}");
    says!(text => "wave.bvh (motion capture) | wave, 0 s to 0.5 s | 6 on 2 bones");
    says!(text => "3, one every 0.25 s (4.000 a second) | Zrotation Xrotation | Upper Arm/tip");
}

#[test]
fn fk_places_joints_at_rest_and_at_a_time() {
    let folder = Folder::new("capture-fk");
    let file = wave(&folder);
    let tip = |more: &str, expected: [f64; 3]| {
        let fk = answer!("fk {file} '--frame=Upper Arm/tip' {more}");
        let frames = fk["frames"].as_object().unwrap();
        assert_eq!(frames.len(), 1);
        let at = numbers(&frames["Upper Arm/tip"]["position"]);
        assert!(distance(&at, &expected) < 1e-5, "{more:?}: {at:?}");
    };
    let half = 4.5_f64.sqrt();
    tip("", [3.0, 4.0, 0.0]);
    tip("--time=0", [4.0, 6.0, 3.0]);
    // The hips rotate by a quarter turn about y, which leaves the upward arm unchanged.
    tip("--time=0.25", [1.0, 9.0, 5.0]);
    tip("--time=7", [1.0, 9.0, 5.0]);
    // Half a period after the loop, halfway between two frames.
    tip("--time=0.625 --loop", [1.0 + 1.5, 6.0 + half, 4.0 - 1.5]);
    // In the arm's frame the tip does not move.
    tip("--time=0.1 '--base=Upper Arm'", [3.0, 0.0, 0.0]);

    let fk = answer!("fk {file} --time=0.25");
    assert_eq!(fk["time"], 0.25);
    let turned = numbers(&fk["frames"]["Hips"]["quaternion"]);
    let half = 0.5_f64.sqrt();
    assert!(
        distance(&turned, &[half, 0.0, half, 0.0]) < 1e-6,
        "{turned:?}"
    );

    let text = text!("fk {file} --time 0.25");
    let rows: Vec<&str> = text.lines().map(str::trim_start).collect();
    assert_eq!(rows.len(), 4, "{rows:?}");
    let row = rows
        .iter()
        .find(|row| row.starts_with("Upper Arm "))
        .unwrap();
    let words: Vec<&str> = row.split_whitespace().skip(2).take(3).collect();
    assert_eq!(words, ["1.000000", "6.000000", "5.000000"]);
}

#[test]
fn invalid_captures_and_options_are_rejected() {
    let folder = Folder::new("capture-errors");
    let file = wave(&folder);
    refused!("fk {file} --frame=Hand" => 1, "`Hand` | Upper Arm/tip");
    refused!("fk {file} --base=Hand" => 1, "`Hand` | Upper Arm");
    refused!("fk {file} --q=1,2,3" => 2, "wave.bvh: --q  | --time");
    let spline = "--interpolation=linear";
    refused!("fk {file} --time=0 {spline}" => 2, "--interpolation | --time");
    let out = folder.file("posed.obj");
    let target = "--target=Upper Arm/tip=1,2,3";
    refused!("solve {file} '{target}' --out {out}" => 1, "wave.bvh | mesh");
    refused!("solve {file} --target=Hand=1,2,3" => 1, "`Hand` | Upper Arm/tip");
    refused!("solve {file} '{target}' --search=nearest" => 2, "--search | motion capture | start or first");
    let rig = folder.rig();
    let capture = folder.file("posed.bvh");
    let tip = "--target=bone/2=-2,0,0";
    refused!("solve {rig} {tip} @model.time=1" => 2, "`time` | motion");
    refused!("solve {rig} {tip} --out {capture}" => 2, ".bvh | rig");
    let broken = folder.text("broken.BVH", WAVE.replace("5 90", "5 NaN"));
    refused!("info {broken}" => 1, "broken.BVH: line 20:  | `Hips` in frame 2 | `NaN`");
}

/// An arm of length 3 at hips 4 below it is solved for its tip, at a captured time and at rest.
#[test]
fn solve_starts_from_a_captured_pose() {
    let folder = Folder::new("capture-solve");
    let file = wave(&folder);
    let out = folder.file("posed.bvh");
    // At 0.25 s the hips are at (1, 2, 5), rotated by 90° about y.
    let target = "--target=Upper Arm/tip=1,9,5";
    let solved = answer!("solve {file} @model.time=0.25 '{target}' --out {out}");
    has!(solved, {"reached": true, "way": "own"});
    for (frame, at) in [
        ("Upper Arm/tip", [1.0, 9.0, 5.0]),
        ("Upper Arm", [1.0, 6.0, 5.0]),
        ("Hips", [1.0, 2.0, 5.0]),
    ] {
        let fk = answer!("fk {out} --time=0 --frame '{frame}'");
        assert!(distance(&numbers(&fk["frames"][frame]["position"]), &at) < 1e-4);
    }
    assert_eq!(answer!("info {out}")["captured"]["frames"], 1);

    // At rest the hips are at the origin, and an End Site does not rotate.
    let unreachable = answer!("solve {file} '--target=Upper Arm/tip=9,4,0'");
    has!(unreachable, {"reached": false, "way": "own"});
    assert_eq!(numbers(&unreachable["q"])[6..9], [0.0; 3]);
}
