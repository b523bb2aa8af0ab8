//! Promise: with --json standard output is one document with the specified fields.

use crate::forked_rig::*;
use serde_json::{Value, json};

/// Tip of bone/2 with an elbow bend of −1 rad.
const LEFT_TARGET: &str = "--target=bone/2=-2.5,0.5,0.2";

#[test]
fn every_subcommand_prints_one_document() {
    let (folder, rig) = Folder::with_rig("one-document");
    let out = folder.file("posed.ply");
    for line in [
        "info RIG --json",
        "--json info RIG",
        "fk RIG --json --time 0.7",
        // A configuration outside the limits causes a note on standard error.
        "fk RIG --json --q 9,9,9,0,0,0,0,0,0,0,0,0,0,0,0",
        "solve RIG --json LEFT --out OUT",
        "solve RIG --json --target=bone/2=-90,0,0",
    ] {
        let line = line.replace("RIG", &rig).replace("OUT", &out);
        let text = text!("{}", line.replace("LEFT", LEFT_TARGET));
        let document: Value = serde_json::from_str(&text).unwrap();
        assert!(document.is_object() && text.ends_with("}\n"), "{line}");
    }
}

#[test]
fn output_without_json_is_text() {
    let (_folder, rig) = Folder::with_rig("text");
    let info = text!("info {rig}");
    says!(info => "15 degrees of freedom, 10 of them free | bone/3/twist1 | -85.944 | -1.500000");
    says!(info => "20 vertices | 0.5 s to 2 s | the tips of bone/2, bone/4");
    says!(text!("fk {rig}") => "bone/4 | tip x | 3.000000");
    let reached = text!("solve {rig} {LEFT_TARGET}");
    says!(reached => "Reached | target bone/2 | hold bone/4 | bone/2/bend");
    let missed = text!("solve {rig} --target=bone/2=-90,0,0");
    says!(missed => "Not reached | target bone/2 misses by");
}

#[test]
fn info_lists_joints_frames_and_rig_parts() {
    let (_folder, rig) = Folder::with_rig("info");
    let info = answer!("info {rig}");
    has!(info, {"kind": "rig", "degrees_of_freedom": 15, "free": 10});
    let joints = list(&info["joints"]);
    assert_eq!(joints.len(), 15);
    for (index, joint) in joints.iter().enumerate() {
        assert_eq!(joint["coordinate"], index);
    }
    has!(info, {"joints/7/name": "bone/2/bend", "joints/7/free": true, "joints/0/free": false});
    assert!((number(&joints[7]["lower"]) + 2.2).abs() < 1e-12);
    let frames: Vec<_> = (0..5).map(|k| format!("bone/{k}")).collect();
    has!(info, {"frames": frames, "mesh/vertices": 20, "keyframes/end": 2.0});
    assert_eq!(info["constrained"], json!(["bone/2", "bone/4"]));
}

#[test]
fn fk_reports_tails_tips_and_axes() {
    let (_folder, rig) = Folder::with_rig("fk");
    // Right arm in its rest pose, then with the elbow bent by −90° about z.
    let fk = answer!("fk {rig}");
    let frames = &fk["frames"];
    assert_eq!(frames.as_object().unwrap().len(), 5);
    let (tail, tip, quaternion) = ([2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]);
    has!(frames["bone/4"], {"tail": tail, "tip": tip, "quaternion": quaternion});
    let q = "0,0,0 0,0,0 0,0,0 0,0,0 0,-90,0";
    let fk = answer!("fk {rig} --degrees --q '{q}' --frame bone/4 --frame bone/4/tip");
    let frames = &fk["frames"];
    assert_eq!(frames.as_object().unwrap().len(), 2);
    let half = 0.5_f64.sqrt();
    for (name, position) in [
        ("bone/4", [2.0, 0.0, 0.0]),
        ("bone/4/tip", [2.0, -1.0, 0.0]),
    ] {
        let frame = &frames[name];
        assert!(distance(&numbers(&frame["position"]), &position) < 1e-15);
        assert!(distance(&numbers(&frame["quaternion"]), &[half, 0.0, 0.0, -half]) < 1e-15);
        assert!(distance(&numbers(&frame["tip"]), &[2.0, -1.0, 0.0]) < 1e-15);
    }
    assert!((numbers(&fk["q"])[13] + std::f64::consts::FRAC_PI_2).abs() < 1e-15);
}

/// Distances are equal from any base bone. Quaternions have w ≥ 0.
#[test]
fn fk_is_relative_to_its_base() {
    let (_folder, rig) = Folder::with_rig("bases");
    let q = "0,100,0 30,-80,0 0,150,40 0,-120,0 20,-170,10";
    let bones = ["bone/0", "bone/1", "bone/2", "bone/3", "bone/4"];
    let apart = |base: &str| {
        let fk = answer!("fk {rig} --degrees --q '{q}' {base}");
        let part = |bone: &str, part: &str| numbers(&fk["frames"][bone][part]);
        let mut apart = Vec::new();
        for one in bones {
            assert!(part(one, "quaternion")[0] >= 0.0, "{base} {one}");
            for other in bones {
                let position = part(other, "position");
                let ends = ["tail", "tip"].map(|end| distance(&part(one, end), &position));
                apart.extend(ends);
            }
        }
        apart
    };
    let world = apart("");
    for bone in bones {
        let relative = apart(&format!("--base={bone}"));
        assert!(distance(&relative, &world) < 1e-12, "{bone}");
    }
}

#[test]
fn fk_at_a_time_samples_the_keyframes() {
    let (_folder, rig) = Folder::with_rig("time");
    let at = |time: &str| {
        let fk = answer!("fk {rig} --frame=bone/1 --time {time}");
        numbers(&fk["q"])[3..6].to_vec()
    };
    for (time, angles) in [
        ("0.5", [0.25, 0.0, -0.5]),
        ("1", [0.25, 1.0, -0.5]),
        ("-7", [0.25, 0.0, -0.5]),
        ("1e3", [0.25, -0.5, -0.5]),
    ] {
        assert!(distance(&at(time), &angles) < 1e-14, "{time}");
    }
    // A period is 1.5 s.
    let (once, again) = (at("0.8"), at("3.8 --loop"));
    assert!(distance(&once, &again) < 1e-13);
    assert!(distance(&once, &at("3.8")) > 0.1);
}

#[test]
fn solve_has_all_keys_and_a_consistent_q() {
    let (folder, rig) = Folder::with_rig("solve");
    let solution = answer!("solve {rig} {LEFT_TARGET}");
    has!(solution, {"reached": true, "termination": "reached", "agreeing_attempts": 0});
    assert!(number(&solution["cost"]) < 1e-12);
    for key in ["iterations", "attempts", "micros"] {
        assert!(number(&solution[key]) > 0.0, "{key}");
    }
    has!(solution, {"out_of_reach": false, "way": "own", "active_limits": []});
    assert!(count(&solution["evaluations"]["residuals"]) > 0);
    says!(word(&solution["explanation"]) => "Reached");

    let tasks = list(&solution["tasks"]);
    assert_eq!(tasks.len(), 2);
    has!(tasks[0], {"frame": "bone/2", "held": false, "reached": true});
    has!(tasks[1], {"frame": "bone/4", "held": true, "reached": true});
    assert!(number(&tasks[0]["position_error"]) < 1e-8);
    assert!(tasks[0]["orientation_error"].is_null());

    // The solution, read back from a file, has the tip at the target and the other tip in place.
    let file = folder.text("solved.json", &solution);
    let fk = answer!("fk {rig} --q-file {file}");
    assert_eq!(fk["q"], solution["q"]);
    let tip = |bone: &str| numbers(&fk["frames"][bone]["tip"]);
    assert!(distance(&tip("bone/2"), &[-2.5, 0.5, 0.2]) < 1e-8);
    assert!(distance(&tip("bone/4"), &[3.0, 0.0, 0.0]) < 1e-8);
}

#[test]
fn unreached_target_is_a_result() {
    let (_folder, rig) = Folder::with_rig("missed");
    let solution = answer!("solve {rig} --target=bone/2=-4,0,0");
    assert_eq!(solution["reached"], false);
    // The arm is stretched towards the target, with its tip at (−3, 0, 0).
    let error = number(&solution["tasks"][0]["position_error"]);
    assert!((error - 1.0).abs() < 1e-6, "{error}");

    // The elbow's lower limit is −2.2 rad, so the bone cannot fold back onto its parent.
    let straight = "--start=0,0,0,0,0,0,0,0,0,0,0,0,0,-2,0";
    let targets = "--target=bone/4=1,0,0 --target=bone/3=2,0,0";
    let solution = answer!("solve {rig} {targets} {straight} --hold none");
    assert_eq!(solution["reached"], false);
    let mut limits = list(&solution["active_limits"]).iter();
    let elbow = limits
        .find(|limit| limit["joint"] == "bone/4/bend")
        .unwrap();
    has!(elbow, {"side": "lower", "kind": "limit"});
    assert!((number(&elbow["value"]) + 2.2).abs() < 1e-12);
}

#[test]
fn free_option_releases_pinned_tips() {
    let (_folder, rig) = Folder::with_rig("free");
    let solution = answer!("solve {rig} --hold none {LEFT_TARGET}");
    assert_eq!(list(&solution["tasks"]).len(), 1);
    // Both pinned tips are targets, so none is held.
    let solution = answer!("solve {rig} {LEFT_TARGET} --target=bone/4/tip=2.5,0.5,0");
    let tasks = list(&solution["tasks"]);
    assert!(tasks.len() == 2 && tasks.iter().all(|task| task["held"] == false));
    assert_eq!(solution["reached"], true);
}

#[test]
fn rays_and_poses_are_targets() {
    let (folder, rig) = Folder::with_rig("rays");
    let solution = answer!("body {rig} --ray=bone/4=2.4,0.4,9:2.4,0.4,0");
    assert_eq!(solution["reached"], true);
    let file = folder.text("ray.json", &solution["q"]);
    let fk = answer!("fk {rig} --q-file {file}");
    let tip = numbers(&fk["frames"]["bone/4"]["tip"]);
    assert!(distance(&tip[..2], &[2.4, 0.4]) < 1e-8);

    // Pose with the elbow at −1 rad: the quaternion has half the angle.
    let (sin, cos) = 1.0_f64.sin_cos();
    let (half_sin, half_cos) = 0.5_f64.sin_cos();
    let pose = commas(&[2.0 + cos, -sin, 0.0, half_cos, 0.0, 0.0, -half_sin]);
    let solution = answer!("solve {rig} --target=bone/4={pose}");
    assert_eq!(solution["reached"], true);
    let task = &solution["tasks"][0];
    assert!(number(&task["position_error"]) < 1e-8);
    assert!(number(&task["orientation_error"]) < 1e-8);
}

#[test]
fn every_solver_and_derivative_route_can_be_chosen() {
    let (_folder, rig) = Folder::with_rig("choices");
    for method in METHODS {
        for route in ["analytic", "dual", "fd", "central"] {
            let chosen = format!("@solve.solver={method} @solve.jacobian={route}");
            let limits = "--tolerance 1e-3 @solve.max_iterations=1000";
            let solution = answer!("solve {rig} {LEFT_TARGET} {chosen} {limits}");
            assert_eq!(solution["reached"], true, "{chosen}");
        }
    }
}

#[test]
fn same_seed_gives_the_same_solution() {
    let (_folder, rig) = Folder::with_rig("seed");
    let q = |seed: u32| {
        let solution =
            answer!("solve {rig} {LEFT_TARGET} --hold none --start=random @solve.rng_seed={seed}");
        assert_eq!(solution["reached"], true);
        numbers(&solution["q"])
    };
    assert_eq!(q(5), q(5));
    assert_ne!(q(5), q(6));
}

/// Certainty of a miss: `out_of_reach` if proven, otherwise `agreeing_attempts` of `attempts`.
#[test]
fn unreached_target_states_its_certainty() {
    let (_folder, rig) = Folder::with_rig("sure-misses");
    let solve = |more: &str| answer!("solve {rig} --target=bone/2={more}");
    // Distance 90 from an arm of length 2.
    let beyond = solve("-90,0,0");
    has!(beyond, {"reached": false, "out_of_reach": true});
    says!(word(&beyond["explanation"]) => "Out of reach");

    // The target is within the arm's length, but outside its limits. This is not proven; the attempts agree.
    let blocked = solve("-1,0,0 @solve.global_search_on_miss=true");
    has!(blocked, {"reached": false, "out_of_reach": false});
    let [agreeing, all] = ["agreeing_attempts", "attempts"].map(|key| count(&blocked[key]));
    assert!(agreeing > 1 && agreeing <= all, "{blocked}");

    let alone = solve("-1,0,0 @solve.attempts=1");
    has!(alone, {"attempts": 1, "agreeing_attempts": 1});
    says!(word(&alone["explanation"]) => "Only one attempt was made");
}
