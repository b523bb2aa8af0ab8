//! Promise: `kinopt calibrate` writes a robot whose forward kinematics gives the measured poses.

use kinopt::Arm;
use kinopt::robot::{Robot, with_origin_corrections};
use kinopt::spatial::{Placement, Vector3};

use crate::forked_rig::*;

/// CSV rows of an arm whose wrist is 2 mm off, and the arm.
fn measured(has_rotations: bool) -> (String, Arm) {
    let text = std::fs::read_to_string(model("universal_ur5e.urdf")).unwrap();
    let robot = Robot::parse(&text, "ur5e.urdf").unwrap();
    let joint = robot.chain("base", "flange").unwrap()[4];
    let joint = robot.model().joints()[joint.index()].name.clone();
    let shift = Placement::translation(Vector3::new(0.002, -0.001, 0.0));
    let actual = with_origin_corrections(&text, "ur5e.urdf", &[(joint, shift)]).unwrap();
    let arm = Arm::new(
        &Robot::parse(&actual, "ur5e.urdf").unwrap(),
        "base",
        "flange",
    )
    .unwrap();
    let mut rows = "q1,q2,q3,q4,q5,q6,x,y,z\n".to_owned();
    if has_rotations {
        rows = "q1,q2,q3,q4,q5,q6,x,y,z,qw,qx,qy,qz\n".to_owned();
    }
    for row in 0..30 {
        let q: Vec<f64> = (0..6)
            .map(|k| 2.0 * f64::from(7 * row + 3 * k).sin())
            .collect();
        let tip = arm.base_from_tool(&q).unwrap();
        let mut numbers = q;
        numbers.extend(tip.translation.to_array());
        if has_rotations {
            let kinopt::spatial::Quaternion { w, v } =
                kinopt::spatial::Quaternion::from_matrix(&tip.rotation);
            numbers.extend([w, v.x, v.y, v.z]);
        }
        let cells: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        rows += &(cells.join(",") + "\n");
    }
    (rows, arm)
}

#[test]
fn calibrated_robot_has_the_measured_poses() {
    let folder = Folder::new("calibrate");
    let robot = model("universal_ur5e.urdf");
    for has_rotations in [true, false] {
        let (rows, actual) = measured(has_rotations);
        let (file, out) = (folder.file("measured.csv"), folder.file("calibrated.urdf"));
        std::fs::write(&file, rows).unwrap();
        let report = answer!(
            "calibrate {robot} {file} --base base --tip flange --parameters link_positions --out {out}"
        );
        assert!(number(&report["position_rms_before"]) > 1e-3);
        assert!(number(&report["position_rms"]) < 1e-5);
        let arm = Arm::new(&Robot::read(&out).unwrap(), "base", "flange").unwrap();
        let q = [0.3, -1.0, 0.9, 0.2, 1.1, -0.4];
        let [a, b] = [&arm, &actual].map(|arm| arm.base_from_tool(&q).unwrap().translation);
        assert!((a - b).norm() < 1e-5, "{a:?} {b:?}");
    }
}

#[test]
fn wrong_rows_are_named() {
    let folder = Folder::new("calibrate-errors");
    let robot = model("universal_ur5e.urdf");
    let file = folder.file("measured.csv");
    let refused = |rows: &str, message: &str| {
        std::fs::write(&file, rows).unwrap();
        let line = format!("calibrate {robot} {file} --base base --tip flange");
        crate::forked_rig::refused(&line, 1, message);
    };
    refused("1,2,3\n", "measured.csv:1 | 3 numbers | 6 joint positions");
    refused(
        "0,0,0,0,0,0,0,0\n",
        "after 6 joints | 3 numbers (x,y,z) or 7",
    );
    refused(
        "0,0,0,0,0,0,0,0,0\n0,0\n",
        "measured.csv:2: 2 numbers, the first row has 9",
    );
    refused(
        "0,0,0,0,0,0,0,0,0\n0,0,0,0,0,0,0,0,z\n",
        "measured.csv:2: invalid float",
    );
    refused("0,0,0,0,0,0,0,0,0\n", "1 measurements are too few");
}
