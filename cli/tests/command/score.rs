//! Promise: `score` has equal figures for one motion in .csv, .npz, .json and .glb files and in MuJoCo's layout, and
//! ranks spoiled versions last. Files that do not fit the robot are errors.

use serde_json::Value;

use crate::forked_rig::*;
use crate::retarget_files::rows;

const SUBJECT: &str = "../models/captures/steps.bvh";

/// All numbers of a document, in a fixed order, with their paths.
fn numbers(value: &Value, path: &str, all: &mut Vec<(String, f64)>) {
    match value {
        Value::Number(number) => all.push((path.to_owned(), number.as_f64().unwrap())),
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                numbers(item, &format!("{path}[{index}]"), all);
            }
        }
        Value::Object(fields) => {
            for (name, field) in fields {
                numbers(field, &format!("{path}.{name}"), all);
            }
        }
        _ => {}
    }
}

/// Checks that all figures of two scores are equal up to the precision of a file.
fn assert_equal(expected: &Value, found: &Value, precision: f64, file: &str) {
    let [mut a, mut b] = [Vec::new(), Vec::new()];
    numbers(expected, "", &mut a);
    numbers(found, "", &mut b);
    assert_eq!(a.len(), b.len(), "{file}");
    for ((path, a), (_, b)) in a.into_iter().zip(b) {
        let difference = (a - b).abs();
        assert!(
            difference <= precision * (1.0 + a.abs()),
            "{file}{path}: {a} {b}"
        );
    }
}

#[test]
fn figures_are_equal_in_all_file_formats() {
    let folder = Folder::new("score-formats");
    let robot = model("aldebaran_nao.urdf");
    let retarget = format!("retarget {SUBJECT} {robot} --base-joint free --fps 30");
    // Single precision in a .glb: third differences at 30 frames per second multiply its rounding by up to 2e5.
    let cases = [
        ("steps.npz", "", 1e-12),
        ("steps.json", "", 1e-12),
        ("steps.csv", "", 1e-12),
        ("named.csv", "--header", 1e-12),
        ("qpos.npz", "--format qpos", 1e-12),
        ("steps.glb", "", 5e-3),
    ];
    let mut expected = None;
    for (file, options, precision) in cases {
        let path = folder.file(file);
        let _ = answer!("{retarget} {options} --out {path}");
        // The capture has 30.00003 frames per second, and bare rows have no rate.
        let score = answer!("score {path} {robot} --subject {SUBJECT} --fps 30 --subject-fps 30");
        let expected = expected.get_or_insert_with(|| score.clone());
        assert_equal(expected, &score, precision, file);
    }
    let expected = expected.unwrap();
    assert!(list(&expected["limbs"]).len() >= 8 && list(&expected["ends"]).len() == 4);
    // The report of the retargeting itself has the same figures.
    let report = answer!("{retarget} --out {}", folder.file("again.npz"));
    assert_equal(
        &expected["limbs"],
        &report["score"]["limbs"],
        1e-9,
        "report",
    );
    // Bare rows with MuJoCo's quaternion need its order.
    let path = folder.file("qpos.csv");
    let _ = answer!("{retarget} --format qpos --out {path}");
    let score = answer!(
        "score {path} {robot} --subject {SUBJECT} --quaternion wxyz --fps 30 --subject-fps 30"
    );
    assert_equal(&expected, &score, 1e-12, "qpos.csv");
    let (text, _) = crate::forked_rig::succeeds(&format!(
        "score {path} {robot} --subject {SUBJECT} --quaternion wxyz --fps 30 --subject-fps 30"
    ));
    says!(text => "left_forearm | foot sliding, cm/s | outside limits | total");
}

/// Rows of a .csv file, changed.
fn spoil(
    folder: &Folder,
    rows: &[Vec<f64>],
    name: &str,
    change: impl Fn(usize, &mut Vec<f64>),
) -> String {
    let mut text = String::new();
    for (frame, row) in rows.iter().enumerate() {
        let mut row = row.clone();
        change(frame, &mut row);
        let cells: Vec<String> = row.iter().map(ToString::to_string).collect();
        text += &(cells.join(",") + "\n");
    }
    folder.text(name, text)
}

#[test]
fn spoiled_motions_rank_last() {
    let folder = Folder::new("score-ranks");
    let robot = model("aldebaran_nao.urdf");
    let path = folder.file("steps.csv");
    let _ = answer!("retarget {SUBJECT} {robot} --base-joint free --fps 30 --out {path}");
    let good = rows(&path);
    let names = kinopt_robot_joints();
    let mirrored = |name: &str| {
        let other = match name.split_once('_') {
            Some(("left", joint)) => format!("right_{joint}"),
            Some(("right", joint)) => format!("left_{joint}"),
            _ => name.to_owned(),
        };
        names.iter().position(|known| *known == other).unwrap()
    };
    let order: Vec<usize> = names.iter().map(|name| mirrored(name)).collect();
    let late = &good[20..];
    let spoiled = [
        spoil(&folder, &good, "slide.csv", |frame, row| {
            row[0] += 0.005 * frame as f64
        }),
        spoil(&folder, &good, "jitter.csv", |frame, row| {
            let sign = [1.0, -1.0, -1.0][frame % 3];
            row[7..].iter_mut().for_each(|angle| *angle += 0.02 * sign);
        }),
        spoil(&folder, &good, "mirror.csv", |_, row| {
            let joints = row[7..].to_vec();
            for (joint, source) in order.iter().enumerate() {
                row[7 + joint] = joints[*source];
            }
        }),
        spoil(&folder, late, "late.csv", |_, _| ()),
    ];
    let total = |path: &str| {
        let score = answer!("score {path} {robot} --subject {SUBJECT} --fps 30 --subject-fps 30");
        score["total"].as_f64().unwrap()
    };
    let best = total(&path);
    for path in &spoiled {
        assert!(total(path) > 1.1 * best, "{path}: {} {best}", total(path));
    }
    // Without a subject, sliding and jitter show as well.
    let alone = |path: &str| {
        answer!("score {path} {robot} --fps 30")["total"]
            .as_f64()
            .unwrap()
    };
    let best = alone(&path);
    for path in &spoiled[..2] {
        assert!(alone(path) > best, "{path}: {} {best}", alone(path));
    }
}

/// Names of the NAO's joints after its base, in configuration order.
fn kinopt_robot_joints() -> Vec<String> {
    let robot = kinopt::robot::Robot::read(model("aldebaran_nao.urdf")).unwrap();
    let robot = robot.model();
    let joints = robot.moving_joints().iter();
    joints
        .map(|id| robot.joints()[id.index()].name.clone())
        .collect()
}

#[test]
fn motion_that_does_not_fit_is_reported() {
    let folder = Folder::new("score-errors");
    let robot = model("aldebaran_nao.urdf");
    let short = folder.text("short.csv", "0,0,0.3,0,0,0,1\n");
    refused!("score {short} {robot}" => 1, "rows of 7 numbers, expected 31");
    let text = folder.text("text.csv", "0,0,0.3\n0,x,1\n");
    refused!("score {text} {robot}" => 1, "line 2: `x` is not a number");
    let named = folder.text("named.csv", "time,root_joint/x\n0,1\n");
    refused!("score {named} {robot}" => 1, "columns are missing: root_joint/y");
    refused!("score {robot} {robot}" => 1, "unsupported motion, expected .csv");
    refused!("score {short} {robot} --weights limb=1" => 2, "did you mean `limbs`");
    let out = folder.file("steps.json");
    refused!("retarget {SUBJECT} {robot} --base-joint free --format qpos --out {out}" => 2, "applies to .csv and .npz");
    refused!("score {short} {robot} --heading north" => 2, "expected degrees, or `fit`");
}
