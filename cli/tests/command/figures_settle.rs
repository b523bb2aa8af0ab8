//! Promise: a figure settles from where it stands, as a drag does; it goes another way only where its own
//! misses and the other reaches, and says so.

use crate::forked_rig::{Folder, json, kinopt, says, stdout};
use serde_json::Value;

fn model(name: &str) -> String {
    format!(
        "{}/../models/{name}/{name}.json",
        env!("CARGO_MANIFEST_DIR")
    )
}

/// A pose of the arm from which its limits keep the gripper from the place below, unless it turns round.
const BENT: &str = "--start=0,0,0,1.8,0,0,0,1.6,0,0,-1.1,0,0,-0.7,0,-0.9,0,0";
const PLACE: &str = "--target=gripper=-0.09,-0.48,0.14";

#[test]
fn it_settles_where_it_can() {
    let humanoid = model("humanoid");
    let hand = "--target=left_hand=0.35,0.45,1.5";
    let settled = json(&["solve", &humanoid, hand, "--json"]);
    assert_eq!(settled["reached"], true);
    assert_eq!(settled["way"], "own");
    assert_eq!(settled["attempts"], 1);
    // It is what the default says it is.
    let start = json(&["solve", &humanoid, hand, "--search=start", "--json"]);
    assert_eq!(start["q"], settled["q"]);
    let searched = json(&["solve", &humanoid, hand, "--search=first", "--json"]);
    assert_eq!(
        (&searched["reached"], searched.get("way")),
        (&true.into(), None)
    );
}

#[test]
fn another_way_is_told() {
    let arm = model("robot-arm");
    let solve = |more: &[&str]| json(&[&["solve", &arm, PLACE, BENT, "--json"], more].concat());
    let another = solve(&[]);
    assert_eq!(another["reached"], true);
    assert_eq!(another["way"], "another");
    let own = solve(&["--restarts=0"]);
    assert_eq!(own["reached"], false);
    assert_eq!(own["way"], "own");
    assert_eq!(own["attempts"], 1);
    let output = kinopt(&["solve", &arm, PLACE, BENT]);
    says(stdout(&output), "own way missed");
    assert!(!stdout(&kinopt(&["solve", &arm, PLACE, BENT, "--restarts=0"])).contains("own way"));
}

#[test]
fn a_miss_stays_on_its_own_way_unless_asked() {
    let arm = model("robot-arm");
    let far = "--target=gripper=-0.9,-4.8,0.14";
    let solve = |more: &[&str]| json(&[&["solve", &arm, far, BENT, "--json"], more].concat());
    let alone = solve(&["--restarts=0"]);
    let default = solve(&[]);
    assert_eq!(default["reached"], false);
    assert_eq!(default["way"], "own");
    assert_eq!(default["q"], alone["q"]);
    assert!(default["attempts"].as_u64().unwrap() > 1);
    let anywhere = solve(&["--global-search-on-miss"]);
    let cost = |document: &Value| document["cost"].as_f64().unwrap();
    match anywhere["way"].as_str().unwrap() {
        "another" => {
            assert_eq!(default["lower_cost_elsewhere"], anywhere["cost"]);
            assert!(cost(&anywhere) < cost(&default));
        }
        _ => assert_eq!(anywhere["q"], default["q"]),
    }
}

#[test]
fn many_targets_settle_one_by_one_and_the_clock_ends_it() {
    let humanoid = model("humanoid");
    let folder = Folder::new("settled-many");
    let file = folder.file("targets.json");
    let targets = serde_json::json!({"targets": [[0.35, 0.45, 1.5], [0.3, 0.5, 1.4]]});
    std::fs::write(&file, targets.to_string()).unwrap();
    let tip = "--tip=left_hand";
    let many = json(&["solve", &humanoid, tip, "--targets", &file, "--json"]);
    let first = &many["solutions"][0];
    let hand = "--target=left_hand=0.35,0.45,1.5";
    let alone = json(&["solve", &humanoid, hand, "--json"]);
    assert_eq!((&first["way"], &first["q"]), (&"own".into(), &alone["q"]));
    let cut = json(&["solve", &humanoid, hand, "--time-limit=0.0001", "--json"]);
    assert_eq!(cut["way"], "own");
}

#[test]
fn a_step_of_a_path_goes_on_as_a_single_target_does() {
    let humanoid = model("humanoid");
    let folder = Folder::new("settled-path");
    let file = folder.file("targets.json");
    // Into a crouch: limits take turns in being met, and a frame is over before the end is near.
    let at = |k: f64| [0.0014 * k, 0.7824 - 0.0309 * k, 0.9086 + 0.0275 * k];
    let targets: Vec<_> = (0..5).map(|k| at(f64::from(k))).collect();
    std::fs::write(&file, serde_json::json!({ "targets": targets }).to_string()).unwrap();
    let solve = |way: &[&str]| {
        let all = ["solve", &humanoid, "--tip=left_hand", "--targets", &file];
        json(&[&all, way, &["--json"]].concat())["summary"]["solved"].clone()
    };
    assert_eq!((solve(&["--track"]), solve(&[])), (5.into(), 5.into()));
}

#[test]
fn a_flat_end_is_left_for_a_shorter_way() {
    // The README's first target took 8577 steps.
    let hand = "--target=left_hand=0.35,0.45,1.5";
    let settled = json(&["solve", &model("humanoid"), hand, "--json"]);
    assert_eq!(settled["reached"], true);
    assert!(settled["iterations"].as_u64().unwrap() < 2000, "{settled}");
}
