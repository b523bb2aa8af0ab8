//! Promise: `kinopt reach` finds a configuration for every reachable target, proves targets unreachable, and ranks
//! pairs of tool and target. `kinopt solve --search all` adds the self-motions of seven joints.

use crate::forked_rig::*;
use crate::seeded_robot::{Seeded, typed};
use serde_json::json;

/// The flange 0.8 m in front, pointing back to the base: proven unreachable in the Rust documentation.
const BACKWARDS: [f64; 7] = [0.8, 0.0, 0.3, 0.7071, 0.0, -0.7071, 0.0];

fn panda() -> Seeded {
    Seeded::new("franka_panda", "base", "flange")
}

#[test]
fn reachable_targets_have_configurations() {
    let folder = Folder::new("reach");
    for seeded in [panda(), Seeded::new("universal_ur5e", "base", "flange")] {
        let file = folder.text("targets.json", seeded.targets(15));
        let document = answer!("reach {seeded} --targets {file} --threads=2");
        has!(document["summary"], {"reached": 15, "undecided": 0, "total": 15});
        let solutions = list(&document["solutions"]);
        for (solution, pose) in solutions.iter().zip(seeded.poses(15)) {
            seeded.check(&numbers(&solution["q"]), &pose);
        }
        let values: Vec<f64> = list(&document["ranking"])
            .iter()
            .map(|pair| number(&solutions[pair[1].as_u64().unwrap() as usize]["value"]))
            .collect();
        assert!(values.len() == 15 && values.is_sorted(), "{values:?}");
    }
}

#[test]
fn unreachable_target_is_proven() {
    let panda = panda();
    let target = typed("flange", &BACKWARDS);
    let document = answer!("reach {panda} {target}");
    has!(document["summary"], {"reached": 0, "unreachable": 1});
    assert!(number(&document["solutions"][0]["boxes"]) > 1.0);
    let one_box = answer!("reach {panda} {target} --max-boxes=1");
    has!(one_box["solutions"][0], {"status": "undecided", "boxes": 1});
    says!(text!("reach {panda} {target}") => "unreachable | boxes of joint values");
    let missed = kinopt!("reach {panda} {target} --fail-on-miss");
    assert_eq!(missed.status.code(), Some(3));
}

#[test]
fn tools_are_ranked_by_the_criterion() {
    let folder = Folder::new("reach-tools");
    let panda = panda();
    let mut rows = panda.poses(4);
    rows.push(vec![5.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let file = folder.text(
        "targets.json",
        json!({"targets": rows, "tip_link": "flange", "base_link": "base"}),
    );
    let table = folder.file("reach.csv");
    let options = "--tool=0,0,0 --tool=0,0,0.1 --criterion=manipulability";
    let document = answer!("reach {panda} --targets {file} {options} --out {table}");
    has!(document, {"criterion": "manipulability", "summary/total": 10});
    let solutions = list(&document["solutions"]);
    assert_eq!(solutions[9]["status"], "unreachable");
    let value = |pair: &serde_json::Value| {
        let [tool, target] = [0, 1].map(|part| pair[part].as_u64().unwrap() as usize);
        number(&solutions[5 * tool + target]["value"])
    };
    let values: Vec<f64> = list(&document["ranking"]).iter().map(value).collect();
    assert!(values.len() >= 4 && values.is_sorted_by(|a, b| a >= b));
    let text = std::fs::read_to_string(&table).unwrap();
    assert_eq!(text.lines().count(), 11);
    assert!(text.starts_with("tool,target,status,manipulability,boxes,joint1,"));
    // A target that one tool reaches is not missed; the last one is.
    let missed = kinopt!("reach {panda} --targets {file} {options} --fail-on-miss");
    assert_eq!(missed.status.code(), Some(3));
    says!(stderr(&missed) => "1 of 5 targets");
}

#[test]
fn wrong_queries_are_rejected() {
    let panda = panda();
    let target = "--target=flange=0.4,0,0.5";
    refused!("reach {panda}" => 2, "--target | --targets");
    refused!("reach {panda} {target} --criterion=speed" => 2, "distance, manipulability, clearance");
    refused!("reach {panda} {target} --criterion=clearance" => 1, "without a world");
    refused!("reach {panda} {target} --out=reach.txt" => 2, ".csv or .json");
}

#[test]
fn search_all_returns_self_motions() {
    let iiwa = Seeded::new("kuka_iiwa14", "base", "flange");
    let pose = iiwa.pose(&iiwa.configuration(3));
    let target = typed("flange", &pose);
    let document = answer!("solve {iiwa} {target} --search=all");
    let curves = list(&document["self_motions"]);
    assert!(!curves.is_empty());
    for curve in curves {
        let rows: Vec<_> = list(&curve["q"]).iter().map(numbers).collect();
        for q in &rows {
            iiwa.check(q, &pose);
        }
        for pair in rows.windows(2) {
            assert!(
                pair[0]
                    .iter()
                    .zip(&pair[1])
                    .all(|(a, b)| (a - b).abs() <= 0.0501)
            );
        }
    }
    says!(text!("solve {iiwa} {target} --search=all") => "self-motion");
    let ur5e = Seeded::new("universal_ur5e", "base", "flange");
    let target = typed("flange", &ur5e.pose(&ur5e.configuration(3)));
    assert!(
        answer!("solve {ur5e} {target} --search=all")
            .get("self_motions")
            .is_none()
    );
}
