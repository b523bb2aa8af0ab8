//! Promise: with --json there is one document on standard output and nothing else, and it says what
//! the design says it says.

use crate::forked_rig::{Folder, distance, json, kinopt, numbers, says, stdout};
use serde_json::Value;

/// bone/2's tip with bend −1 in the elbow.
const LEFT: &str = "--target=bone/2=-2.5,0.5,0.2";

#[test]
fn every_subcommand_prints_one_document() {
    let folder = Folder::new("one-document");
    let rig = folder.rig();
    let out = folder.file("posed.ply");
    for arguments in [
        vec!["info", &rig, "--json"],
        vec!["--json", "info", &rig],
        vec!["fk", &rig, "--json", "--time", "0.7"],
        // Outside the limits, which is worth a note on the other stream.
        vec!["fk", &rig, "--json", "--q", "9,9,9,0,0,0,0,0,0,0,0,0,0,0,0"],
        vec!["solve", &rig, "--json", LEFT, "--out", &out],
        vec!["solve", &rig, "--json", "--target=bone/2=-90,0,0"],
    ] {
        let output = kinopt(&arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(document.is_object());
        assert!(stdout(&output).ends_with("}\n"));
    }
}

#[test]
fn without_it_the_output_is_for_people() {
    let folder = Folder::new("text");
    let rig = folder.rig();
    for (line, words) in [
        (
            format!("info {rig}"),
            "15 degrees of freedom, 10 of them free | bone/3/twist1 | -85.944 | -1.500000",
        ),
        (
            format!("info {rig}"),
            "20 vertices | 0.5 s to 2 s | the tips of bone/2, bone/4",
        ),
        (format!("fk {rig}"), "bone/4 | tip x | 3.000000"),
        (
            format!("solve {rig} {LEFT}"),
            "Reached | target bone/2 | hold bone/4 | bone/2/bend",
        ),
        (
            format!("solve {rig} --target=bone/2=-90,0,0"),
            "Not reached | target bone/2 misses by",
        ),
    ] {
        let output = kinopt(&line);
        assert_eq!(output.status.code(), Some(0));
        says(stdout(&output), words);
    }
}

#[test]
fn info_lists_joints_frames_and_what_a_rig_has() {
    let folder = Folder::new("info");
    let info = json(&["info", &folder.rig(), "--json"]);
    assert_eq!(info["kind"], "rig");
    assert_eq!(info["degrees_of_freedom"], 15);
    assert_eq!(info["free"], 10);
    let joints = info["joints"].as_array().unwrap();
    assert_eq!(joints.len(), 15);
    for (index, joint) in joints.iter().enumerate() {
        assert_eq!(joint["coordinate"], index);
    }
    let bend = &joints[7];
    assert_eq!(bend["name"], "bone/2/bend");
    assert_eq!(bend["free"], true);
    assert!((bend["lower"].as_f64().unwrap() + 2.2).abs() < 1e-12);
    assert_eq!(joints[0]["free"], false);
    let frames: Vec<_> = (0..5).map(|k| format!("bone/{k}")).collect();
    assert_eq!(info["frames"], serde_json::json!(frames));
    assert_eq!(info["mesh"]["vertices"], 20);
    assert_eq!(info["keyframes"]["end"], 2.0);
    assert_eq!(info["constrained"], serde_json::json!(["bone/2", "bone/4"]));
}

#[test]
fn fk_gives_tails_tips_and_axes() {
    let folder = Folder::new("fk");
    let rig = folder.rig();
    // The right arm in its rest pose, then its elbow bent by −90 degrees about z.
    let fk = json(&["fk", &rig, "--json"]);
    let frames = fk["frames"].as_object().unwrap();
    assert_eq!(frames.len(), 5);
    assert_eq!(numbers(&frames["bone/4"]["tail"]), [2.0, 0.0, 0.0]);
    assert_eq!(numbers(&frames["bone/4"]["tip"]), [3.0, 0.0, 0.0]);
    assert_eq!(
        numbers(&frames["bone/4"]["quaternion"]),
        [1.0, 0.0, 0.0, 0.0]
    );
    let q = "0,0,0 0,0,0 0,0,0 0,0,0 0,-90,0";
    let fk = json(&format!(
        "fk {rig} --json --degrees --q '{q}' --frame bone/4 --frame bone/4/tip"
    ));
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

#[test]
fn fk_at_a_time_samples_the_keyframes() {
    let folder = Folder::new("time");
    let rig = folder.rig();
    let at = |arguments: &[&str]| {
        let mut all = vec!["fk", &rig, "--json", "--frame=bone/1"];
        all.extend(arguments);
        numbers(&json(&all)["q"])[3..6].to_vec()
    };
    for (time, angles) in [
        ("0.5", [0.25, 0.0, -0.5]),
        ("1", [0.25, 1.0, -0.5]),
        ("-7", [0.25, 0.0, -0.5]),
        ("1e3", [0.25, -0.5, -0.5]),
    ] {
        assert!(distance(&at(&["--time", time]), &angles) < 1e-14, "{time}");
    }
    // A period is 1.5 s.
    let (once, again) = (at(&["--time=0.8"]), at(&["--time=3.8", "--loop"]));
    assert!(distance(&once, &again) < 1e-13);
    assert!(distance(&once, &at(&["--time=3.8"])) > 0.1);
}

#[test]
fn solve_has_every_key_and_its_q_is_what_it_says() {
    let folder = Folder::new("solve");
    let rig = folder.rig();
    let solution = json(&["solve", &rig, "--json", LEFT]);
    assert_eq!(solution["reached"], true);
    assert_eq!(solution["termination"], "reached");
    assert!(solution["cost"].as_f64().unwrap() < 1e-12);
    for key in ["iterations", "attempts", "micros"] {
        assert!(solution[key].as_f64().unwrap() > 0.0, "{key}");
    }
    assert_eq!(solution["agreeing_attempts"], 0);
    assert_eq!(solution["out_of_reach"], false);
    assert_eq!(solution["way"], "own");
    assert!(solution["evaluations"]["residuals"].as_u64().unwrap() > 0);
    assert!(
        solution["explanation"]
            .as_str()
            .unwrap()
            .contains("Reached")
    );
    assert_eq!(solution["active_limits"], serde_json::json!([]));

    let tasks = solution["tasks"].as_array().unwrap();
    assert_eq!(tasks.len(), 2);
    assert_eq!(tasks[0]["frame"], "bone/2");
    assert_eq!(tasks[0]["held"], false);
    assert_eq!(tasks[1]["frame"], "bone/4");
    assert_eq!(tasks[1]["held"], true);
    assert!(tasks.iter().all(|task| task["reached"] == true));
    assert!(tasks[0]["position_error"].as_f64().unwrap() < 1e-8);
    assert!(tasks[0]["orientation_error"].is_null());

    // The q, fed back through a file, puts the tip on the target and the other where it was.
    let file = folder.file("solved.json");
    std::fs::write(&file, solution.to_string()).unwrap();
    let fk = json(&["fk", &rig, "--json", "--q-file", &file]);
    assert_eq!(fk["q"], solution["q"]);
    let tip = |bone: &str| numbers(&fk["frames"][bone]["tip"]);
    assert!(distance(&tip("bone/2"), &[-2.5, 0.5, 0.2]) < 1e-8);
    assert!(distance(&tip("bone/4"), &[3.0, 0.0, 0.0]) < 1e-8);
}

#[test]
fn a_missed_target_is_an_answer() {
    let folder = Folder::new("missed");
    let rig = folder.rig();
    let solution = json(&["solve", &rig, "--json", "--target=bone/2=-4,0,0"]);
    assert_eq!(solution["reached"], false);
    // The arm is stretched towards the target: its tip stays at (−3, 0, 0).
    let error = solution["tasks"][0]["position_error"].as_f64().unwrap();
    assert!((error - 1.0).abs() < 1e-6, "{error}");

    // The elbow bends down to −2.2 only, so the bone cannot fold back onto the one before it.
    let straight = "--start=0,0,0,0,0,0,0,0,0,0,0,0,0,-2,0";
    let target = "--target=bone/4=1,0,0";
    let held = "--target=bone/3=2,0,0";
    let solution = json(&["solve", &rig, "--json", target, held, straight, "--free"]);
    assert_eq!(solution["reached"], false);
    let limits = solution["active_limits"].as_array().unwrap();
    let elbow = limits
        .iter()
        .find(|limit| limit["joint"] == "bone/4/bend")
        .unwrap();
    assert_eq!(elbow["side"], "lower");
    assert_eq!(elbow["kind"], "limit");
    assert!((elbow["value"].as_f64().unwrap() + 2.2).abs() < 1e-12);
}

#[test]
fn free_lets_the_pinned_tips_go() {
    let folder = Folder::new("free");
    let rig = folder.rig();
    let solution = json(&["solve", &rig, "--json", "--free", LEFT]);
    assert_eq!(solution["tasks"].as_array().unwrap().len(), 1);
    // Both tips asked for: none is left to hold.
    let solution = json(&format!(
        "solve {rig} --json {LEFT} --target=bone/4/tip=2.5,0.5,0"
    ));
    let tasks = solution["tasks"].as_array().unwrap();
    assert!(tasks.len() == 2 && tasks.iter().all(|task| task["held"] == false));
    assert_eq!(solution["reached"], true);
}

#[test]
fn rays_and_poses() {
    let folder = Folder::new("rays");
    let rig = folder.rig();
    let solution = json(&["solve", &rig, "--json", "--ray=bone/4=2.4,0.4,9:2.4,0.4,0"]);
    assert_eq!(solution["reached"], true);
    let file = folder.file("ray.json");
    std::fs::write(&file, solution["q"].to_string()).unwrap();
    let fk = json(&["fk", &rig, "--json", "--q-file", &file]);
    let tip = numbers(&fk["frames"]["bone/4"]["tip"]);
    assert!(distance(&tip[..2], &[2.4, 0.4]) < 1e-8);

    // The pose that the elbow at −1 has: half an angle in the quaternion.
    let (sin, cos) = 1.0_f64.sin_cos();
    let (half_sin, half_cos) = 0.5_f64.sin_cos();
    let target = format!(
        "--target=bone/4={},{},0,{half_cos},0,0,{}",
        2.0 + cos,
        -sin,
        -half_sin
    );
    let solution = json(&["solve", &rig, "--json", &target]);
    assert_eq!(solution["reached"], true);
    let task = &solution["tasks"][0];
    assert!(task["position_error"].as_f64().unwrap() < 1e-8);
    assert!(task["orientation_error"].as_f64().unwrap() < 1e-8);
}

#[test]
fn every_solver_and_derivative_route_can_be_chosen() {
    let folder = Folder::new("choices");
    let rig = folder.rig();
    let methods = [
        "levenberg-marquardt",
        "levenberg-marquardt-error",
        "gauss-newton",
        "projected-gradient",
        "projected-gradient-bb",
    ];
    let routes = ["analytic", "dual", "fd", "central"];
    for method in methods {
        for route in routes {
            let solution = json(&[
                "solve",
                &rig,
                "--json",
                LEFT,
                "--solver",
                method,
                "--jacobian",
                route,
                "--tolerance",
                "1e-3",
                "--max-iterations",
                "1000",
            ]);
            assert_eq!(solution["reached"], true, "{method} {route}");
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_answer() {
    let folder = Folder::new("seed");
    let rig = folder.rig();
    let q = |seed: &str| {
        let start = ["--start=random", "--rng-seed", seed];
        let solution = json(&format!(
            "solve {rig} --json {LEFT} --free {} {} {}",
            start[0], start[1], start[2]
        ));
        assert_eq!(solution["reached"], true);
        numbers(&solution["q"])
    };
    assert_eq!(q("5"), q("5"));
    assert_ne!(q("5"), q("6"));
}

/// How sure a miss is: `out_of_reach` where it is certain, `agreeing_attempts` of `attempts` otherwise.
#[test]
fn a_miss_says_how_sure_it_is() {
    let folder = Folder::new("sure-misses");
    let rig = folder.rig();
    let solve = |more: &[&str]| json(&[&["solve", &rig, "--json"], more].concat());
    // 90 away from an arm that is 2 long.
    let beyond = solve(&["--target=bone/2=-90,0,0"]);
    assert_eq!(beyond["reached"], false);
    assert_eq!(beyond["out_of_reach"], true);
    let explained = beyond["explanation"].as_str().unwrap();
    assert!(explained.contains("Out of reach"), "{explained}");

    // Within the arm's length, but its limits keep it away: that is no proof, but attempts agree.
    let anywhere = "--global-search-on-miss";
    let blocked = solve(&["--target=bone/2=-1,0,0", anywhere]);
    assert_eq!(blocked["reached"], false);
    assert_eq!(blocked["out_of_reach"], false);
    let count = |document: &Value, key: &str| document[key].as_u64().unwrap();
    let agreeing = count(&blocked, "agreeing_attempts");
    assert!(
        agreeing > 1 && agreeing <= count(&blocked, "attempts"),
        "{blocked}"
    );

    let alone = solve(&["--target=bone/2=-1,0,0", "--attempts=1"]);
    assert_eq!(
        (
            count(&alone, "attempts"),
            count(&alone, "agreeing_attempts")
        ),
        (1, 1)
    );
    let explained = alone["explanation"].as_str().unwrap();
    says(explained, "Only one attempt was made");
}
