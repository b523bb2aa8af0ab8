//! Promise: `path` solves a table of points. It reports the interpretation of the table, the reconfigurations of the
//! arm and the tool's deviation, and writes the rows.

use crate::forked_rig::*;
use serde_json::{Value, json};

const PANDA: &str = "../models/franka_panda.urdf";
const SEAM: &str = "../models/paths/pipe_seam.csv";

#[test]
fn seam_is_followed_without_reconfiguration() {
    let report = answer!("path {PANDA} {SEAM} --tip tool");
    has!(report, {"jumps": [], "points": 121, "entry": 0});
    has!(report, {"reached": true, "missed": [], "blocked": []});
    let rows = list(&report["q"]);
    assert_eq!(rows.len(), 121);
    assert_eq!(list(&rows[0]).len(), list(&report["joints"]).len());
    assert!(report["length"].as_f64().unwrap() > 0.5);
    let deviation = report["largest_deviation"].as_f64().unwrap();
    assert!(deviation > 0.0 && deviation < 1e-4, "{deviation}");
    // The last row reaches the last point of the table.
    let q: Vec<String> = list(&rows[120]).iter().map(Value::to_string).collect();
    let placed = answer!("fk {PANDA} --q {} --frame tool", q.join(","));
    let position = list(&placed["frames"]["tool"]["position"]);
    for (given, expected) in position.iter().zip([0.48, 0.103923048, 0.36]) {
        assert!((given.as_f64().unwrap() - expected).abs() < 2e-6);
    }
    let text = text!("path {PANDA} {SEAM} --tip tool");
    says!(text => "no reconfiguration | 121 of 121");
}

#[test]
fn interpretation_of_the_table_is_reported() {
    let run = kinopt!("path {PANDA} {SEAM} --tip tool --json");
    let messages = String::from_utf8(run.stderr).unwrap();
    says!(messages => "121 points; x, y, z from columns 2, 3, 4 | times from column 1");
}

#[test]
fn rows_are_written_as_a_table() {
    let folder = Folder::new("path-rows");
    let file = folder.file("rows.csv");
    text!("path {PANDA} {SEAM} --tip tool --interval rz=free --out {file}");
    let text = std::fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 122);
    assert!(lines[0].starts_with("time,"), "{}", lines[0]);
    let numbers = |line: &str| line.split(',').filter(|n| n.parse::<f64>().is_ok()).count();
    assert!(
        lines[1..]
            .iter()
            .all(|line| numbers(line) == lines[0].split(',').count())
    );
}

#[test]
fn traversals_and_unreached_points_are_reported() {
    let folder = Folder::new("path-courses");
    // Closed square in the air.
    let square = "x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0\n0,0.05,0,0,1,0,0\n0,0.05,0.05,0,1,0,0\n0,0,0.05,0,1,0,0\n";
    let path = folder.text("square.csv", square);
    let report = answer!("path {PANDA} {path} --tip tool --at 0.45,0,0.3 --traversal any-start");
    assert_eq!(list(&report["q"]).len(), 5);
    let report = answer!("path {PANDA} {path} --tip tool --at 0.45,0,0.3 --traversal cyclic");
    assert_eq!(
        (list(&report["q"]).len(), &report["jumps"]),
        (4, &json!([]))
    );
    let report = answer!("path {PANDA} {path} --tip tool --at 5,0,0.3");
    assert_eq!(list(&report["missed"]).len(), 4);
    let reason = report["missed"][0]["reason"].as_str().unwrap();
    says!(reason => "beyond reach");
    let text = text!("path {PANDA} {path} --tip tool --at 5,0,0.3");
    says!(text => "none between rows");
    let run = kinopt!("path {PANDA} {path} --tip tool --at 5,0,0.3 --fail-on-miss");
    assert_eq!(run.status.code(), Some(3));
}

#[test]
fn rows_are_keys_of_a_curve() {
    let folder = Folder::new("path-curves");
    let keys = "x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0\n0,0.05,0.05,0,1,0,0\n0,0.1,0,0,1,0,0\n";
    let path = folder.text("keys.csv", keys);
    let command = format!("path {PANDA} {path} --tip tool --at 0.45,0,0.3");
    // Two straight lines of 71 mm, and a half circle of 157 mm.
    for (curve, points) in [
        ("straight", 17),
        ("arc", 17),
        ("straight:0.05", 5),
        ("arc:0.005", 33),
    ] {
        let report = answer!("{command} --curve {curve}");
        has!(report, {"points": points, "reached": true});
    }
    let spline = answer!("{command} --curve spline");
    assert!(spline["points"].as_u64().unwrap() > 16);
    refused!("{command} --curve helix" => 2, "helix | straight");
    refused!("{command} --curve arc:0" => 2, "--curve");
    refused!("path {PANDA} {SEAM} --tip tool --curve arc" => 1, "times");
}

#[test]
fn unreached_rows_have_no_times() {
    let folder = Folder::new("path-unreached");
    let far = "x,y,z,qw,qx,qy,qz\n0.45,0,0.3,0,1,0,0\n4,0,0.3,0,1,0,0\n";
    let path = folder.text("far.csv", far);
    let report = answer!("path {PANDA} {path} --tip tool --accelerations 5");
    assert!(report.get("times").is_none() && list(&report["missed"]).len() == 1);
}

#[test]
fn invalid_paths_and_options_are_named() {
    let folder = Folder::new("path-wrong");
    let invalid = folder.text("bad.csv", "x,y,z\n1,2,3\n1,2,here\n");
    refused!("path {PANDA} {invalid} --tip tool" => 1, "line 3");
    refused!("path {PANDA} {SEAM} --tip hook" => 1, "hook");
    refused!("path {PANDA} {SEAM}" => 2, "--tip");
    refused!("path {PANDA} {SEAM} --tip tool --start 0,0,0" => 2, "--start");
    refused!("path {PANDA} {SEAM} --tip tool --start 0,0,0,-1,0,1,0" => 1, "start");
    refused!("path {PANDA} {SEAM} --tip tool @path.samples=1" => 1, "samples");
    refused!("path {PANDA} {SEAM} --tip tool --out rows.txt" => 2, ".csv");
}

#[test]
fn rows_are_timed_by_limits_of_a_file() {
    let folder = Folder::new("path-times");
    let (limits, file) = (folder.file("joint_limits.yaml"), folder.file("rows.csv"));
    let joints = (1..=7)
        .map(|joint| format!("  joint{joint}: {{max_velocity: 0.5, max_acceleration: 2}}\n"));
    std::fs::write(
        &limits,
        format!("joint_limits:\n{}", joints.collect::<String>()),
    )
    .unwrap();
    let report = answer!("path {PANDA} {SEAM} --tip tool --joint-limits {limits} --out {file}");
    let times: Vec<f64> = list(&report["times"])
        .iter()
        .filter_map(Value::as_f64)
        .collect();
    let rows = list(&report["q"]);
    assert_eq!((times.len(), times[0]), (rows.len(), 0.0));
    for (index, step) in times.windows(2).enumerate() {
        for (before, after) in list(&rows[index]).iter().zip(list(&rows[index + 1])) {
            // Rows are within 1e-5 of the trajectory that keeps the limits.
            let moved = after.as_f64().unwrap() - before.as_f64().unwrap();
            assert!(
                moved.abs() <= 0.5 * (step[1] - step[0]) + 2e-5,
                "row {index}"
            );
        }
    }
    let table = std::fs::read_to_string(&file).unwrap();
    let last = table.lines().last().unwrap().split(',').next().unwrap();
    assert_eq!(last.parse::<f64>().unwrap(), *times.last().unwrap());
    // One number applies to all joints. A limits file with an unknown joint name is an error.
    let slow = answer!("path {PANDA} {SEAM} --tip tool --accelerations 0.1");
    let end = |report: &Value| {
        list(&report["times"])
            .last()
            .and_then(Value::as_f64)
            .unwrap()
    };
    assert!(end(&slow) > end(&report));
    std::fs::write(&limits, "joint_limits: {elbow: {max_velocity: 1}}").unwrap();
    refused!("path {PANDA} {SEAM} --tip tool --joint-limits {limits}" => 1, "elbow");
}

#[test]
fn table_may_have_several_tools() {
    let folder = Folder::new("path-tools");
    let file = folder.file("two.csv");
    let rows = (0..20).map(|k| {
        let y = 0.005 * f64::from(k);
        format!("0.4,{y},0.4,0,1,0,0,{}\n", u8::from(k >= 10))
    });
    let table = "x,y,z,qw,qx,qy,qz,tool\n".to_owned() + &rows.collect::<String>();
    std::fs::write(&file, table).unwrap();
    let report =
        answer!("path {PANDA} {file} --tip flange --tool 0,0,0.1 @path.add_tool=[[0,0.05,0.2]]");
    has!(report, {"points": 20, "missed": []});
    for (row, offset) in [(9, [0.0, 0.1]), (10, [0.05, 0.2])] {
        let q: Vec<String> = list(&list(&report["q"])[row])
            .iter()
            .map(Value::to_string)
            .collect();
        let placed = answer!("fk {PANDA} --q {} --frame flange", q.join(","));
        let position = list(&placed["frames"]["flange"]["position"]);
        // The target is rotated by half a turn about x, so the tool's y and z are opposite to the base's.
        let expected = [0.4, 0.005 * row as f64 + offset[0], 0.4 + offset[1]];
        for (given, expected) in position.iter().zip(expected) {
            let given = given.as_f64().unwrap();
            assert!((given - expected).abs() < 2e-6, "row {row}: {position:?}");
        }
    }
    refused!("path {PANDA} {file} --tip flange" => 1, "point 10 is for tool 1");
}
