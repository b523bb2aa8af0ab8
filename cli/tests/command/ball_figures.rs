//! Promise: with `joints` of a problem file the bones of a figure have ball joints, within its `cones`. `--base-joint
//! free` adds a free root. The written pose equals the pose that the file's own format defines.

use crate::forked_rig::*;
use crate::motion_capture::WAVE;
use serde_json::json;

const HUMANOID: &str = "../models/humanoid/humanoid.json";

fn close(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6)
}

#[test]
fn captured_pose_is_a_configuration() {
    let folder = Folder::new("ball-capture");
    let file = folder.text("wave.bvh", WAVE);
    let balls = format!("{file} @model.joints=ball --base-joint free");
    let posed = answer!("fk {balls} --time 0.25");
    let half = 0.5_f64.sqrt();
    // The hips are rotated about y, the arm about z.
    let hips = [1.0, 2.0, 5.0, half, 0.0, half, 0.0];
    let expected = [&hips[..], &[half, 0.0, 0.0, half]].concat();
    let q = numbers(&posed["q"]);
    assert!(close(&q, &expected), "{q:?}");
    let names = ["Hips/x", "Hips/y", "Hips/z"]
        .into_iter()
        .map(str::to_owned);
    let names = names.chain(vec!["Hips/rotation".to_owned(); 4]);
    let names: Vec<String> = names.chain(vec!["Upper Arm".to_owned(); 4]).collect();
    assert_eq!(posed["joints"], json!(names));
    let tip = numbers(&posed["frames"]["Upper Arm/tip"]["position"]);
    assert!(close(&tip, &[1.0, 9.0, 5.0]), "{tip:?}");
    // `fk` reads the document again, with its names. The command without `joints` returns equal placements.
    let saved = folder.text("q.json", &posed);
    let again = answer!("fk {balls} --q-file {saved}");
    assert_eq!(again["frames"], posed["frames"]);
    let plain = answer!("fk {file} --time 0.25");
    let plain = numbers(&plain["frames"]["Upper Arm/tip"]["position"]);
    assert!(close(&plain, &tip));
    // A fixed root still rotates.
    let fixed = answer!("fk {file} @model.joints=ball --time 0.25");
    assert_eq!(list(&fixed["q"]).len(), 8);
    let tip = numbers(&fixed["frames"]["Upper Arm/tip"]["position"]);
    assert!(close(&tip, &[0.0, 7.0, 0.0]), "{tip:?}");
}

#[test]
fn solution_is_written_unchanged() {
    let folder = Folder::new("ball-written");
    let file = folder.text("wave.bvh", WAVE);
    let (out, target) = (folder.file("out.bvh"), "--target 'Upper Arm/tip=2,1,-4'");
    let solved = answer!(
        "solve {file} @model.joints=ball --base-joint free --hold none {target} --out {out}"
    );
    assert_eq!(solved["reached"], true);
    let written = answer!("fk {out} --time 0");
    let tip = numbers(&written["frames"]["Upper Arm/tip"]["position"]);
    assert!(close(&tip, &[2.0, 1.0, -4.0]), "{tip:?}");
    let mesh = folder.file("posed.obj");
    let hand = "--target left_hand=0.35,0.45,1.5";
    let solved = answer!("solve {HUMANOID} @model.joints=ball --lock head {hand} --out {mesh}");
    assert_eq!(solved["reached"], true);
    assert!(std::fs::read_to_string(mesh).unwrap().contains("\nf "));
}

/// A crouch keeps the whole soles on the ground and the knees within the shipped cones.
#[test]
fn figure_crouches_on_flat_feet() {
    let folder = Folder::new("ball-crouch");
    let figure = format!(
        "{HUMANOID} @model.joints=ball --base-joint free @model.cones={}",
        model("humanoid/cones.json")
    );
    let soles: Vec<String> = (["left_foot", "right_foot"].iter())
        .map(|foot| format!("--hold {foot} --balance {foot} --balance {foot}=-0.2,0,0"))
        .collect();
    let soles = soles.join(" ");
    let solved = answer!("body {figure} {soles} --start bent --target left_hand=0.35,0.35,0.3");
    assert_eq!(solved["reached"], true);
    let (rest, saved) = (answer!("fk {figure}"), folder.text("q.json", &solved));
    let posed = answer!("fk {figure} --q-file {saved}");
    for foot in ["left_foot", "right_foot"] {
        for part in ["tail", "tip", "quaternion"] {
            let [before, after] = [&rest, &posed].map(|all| numbers(&all["frames"][foot][part]));
            assert!(
                close(&before, &after),
                "{foot} {part}: {before:?} {after:?}"
            );
        }
    }
    let joints = list(&solved["joints"]);
    let at = joints
        .iter()
        .position(|joint| joint == "left_shin")
        .unwrap();
    let shin = &numbers(&solved["q"])[at..at + 4];
    let bend = 2.0 * shin[3].atan2(shin[0]);
    assert!(bend > 1.0 && bend < 135f64.to_radians() + 1e-6, "{bend}");
}

#[test]
fn solutions_stay_within_their_cones() {
    let folder = Folder::new("ball-cones");
    let cones = json!({
        "left_upper_arm": {"swing": 30, "twist": [-10, 10]},
        "left_forearm": {"swing": 1, "axis": [0, 0, 1], "twist": [0, 120]},
    });
    let cones = folder.text("cones.json", &cones);
    let info = answer!("info {HUMANOID} @model.cones={cones}");
    let joints = list(&info["joints"]);
    let arm = joints
        .iter()
        .find(|joint| joint["name"] == "left_upper_arm")
        .unwrap();
    let swing = 30f64.to_radians();
    assert_eq!(arm["kind"], "ball");
    has!(arm["cone"], {"swing": [swing, swing]});
    says!(text!("info {HUMANOID} @model.cones={cones}") => "a swing of 30.000, a twist of -10.000 to 10.000");
    let ask = format!(
        "solve {HUMANOID} @model.cones={cones} --hold none @model.only=[\"left_upper_arm\",\"left_forearm\"]"
    );
    let answer = answer!("{ask} --target left_hand=0.3,0.6,1.9");
    let first = usize::try_from(arm["coordinate"].as_u64().unwrap()).unwrap();
    let q = numbers(&answer["q"]);
    let [w, x, y, z] = [0, 1, 2, 3].map(|part| q[first + part]);
    // Swing and twist about the bone's own x.
    let tipped = 2.0 * (y * y + z * z).sqrt().atan2((w * w + x * x).sqrt());
    assert!(tipped <= swing + 1e-9 && tipped > swing - 1e-6, "{tipped}");
    assert!(2.0 * x.atan2(w).abs() <= 10f64.to_radians() + 1e-9);
    let limits: Vec<&str> = list(&answer["active_limits"])
        .iter()
        .map(|l| word(&l["joint"]))
        .collect();
    assert!(
        limits.iter().any(|name| name.starts_with("left_upper_arm")),
        "{limits:?}"
    );
}

#[test]
fn conflicting_options_are_rejected() {
    let folder = Folder::new("ball-refused");
    let file = folder.text("wave.bvh", WAVE);
    let robot = "../models/universal_ur5e.urdf";
    refused!("fk {robot} @model.joints=ball" => 2, "`joints` | rigs, scenes and motion capture");
    refused!("fk {HUMANOID} --base-joint free" => 2, "--base-joint | ball joints");
    refused!("fk {file} @model.joints=ball --base-joint planar" => 2, "free or fixed");
    refused!("fk {file} @model.joints=ball --lenient" => 2, "--lenient | robots");
    let cones = folder.text("cones.json", "{\"Uper Arm\": {\"swing\": 30}}");
    refused!("info {file} @model.cones={cones}" => 1, "cones.json | `Uper Arm` | Upper Arm");
    refused!("info {file} @model.joints=twist-bend-twist @model.cones={cones}" => 2, "`cones`");
    let cones = folder.text("wide.json", "{\"Hips\": {\"swing\": 300}}");
    refused!("info {file} @model.cones={cones}" => 1, "wide.json | Hips.swing | 300");
    let cones = folder.text("root.json", "{\"Hips\": {\"swing\": 30}}");
    refused!("info {file} @model.cones={cones} --base-joint free" => 1, "`Hips` | free root");
    refused!("fk {HUMANOID} @model.joints=ball --time 1" => 2, "--time | ball joints");
    refused!("solve {HUMANOID} @model.joints=ball --lock head=1 --target left_hand=0,0,1" => 2,
        "--lock | `head` | ball");
}
