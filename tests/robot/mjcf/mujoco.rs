//! Promise: placements of bodies and sites equal MuJoCo's to 1e-12 at its `qpos`, and ranges, masses and loops are
//! equal too. `mujoco_placements.json` has the results of MuJoCo 4.0.0 for these files: see `mujoco_placements.py`.

use std::path::{Path, PathBuf};

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::JointKind;
use kinopt::model::LoopKind;
use kinopt::robot::{Inertial, Robot};
use kinopt::spatial::{Placement, Quaternion, Vector3};
use nalgebra::Matrix3;
use serde::Deserialize;

const TOLERANCE: f64 = 1e-12;

#[derive(Deserialize)]
struct Reference {
    mujoco: String,
    files: Vec<ReferenceFile>,
}

#[derive(Deserialize)]
struct ReferenceFile {
    file: String,
    joints: Vec<ReferenceJoint>,
    configurations: Vec<Configuration>,
    loops: Vec<Loop>,
    inertials: Vec<ReferenceInertial>,
}

#[derive(Deserialize)]
struct ReferenceJoint {
    name: Option<String>,
    #[serde(rename = "type")]
    kind: String,
    address: usize,
    range: Option<[f64; 2]>,
}

#[derive(Deserialize)]
struct Configuration {
    q: Vec<f64>,
    bodies: Vec<(Option<String>, [f64; 12])>,
    sites: Vec<(Option<String>, [f64; 12])>,
}

#[derive(Deserialize)]
struct Loop {
    weld: bool,
    sites: bool,
    data: [f64; 10],
}

#[derive(Deserialize)]
struct ReferenceInertial {
    mass: f64,
    centre: [f64; 3],
    moments: [f64; 3],
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("robot/mjcf")
}

fn reference() -> Vec<(Robot, ReferenceFile)> {
    let text = std::fs::read_to_string(folder().join("mujoco_placements.json")).unwrap();
    let reference: Reference = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (reference.mujoco.as_str(), reference.files.len()),
        ("4.0.0", 2)
    );
    let files = reference.files.into_iter();
    let read = |file: ReferenceFile| {
        let path = folder().join("files").join(&file.file);
        (Robot::read_mjcf(path).unwrap(), file)
    };
    files.map(read).collect()
}

/// Position, then the rotation's rows.
fn numbers(placement: &Placement<f64>) -> [f64; 12] {
    let Placement {
        rotation,
        translation,
    } = placement;
    let Vector3 { x, y, z } = *translation;
    let rows = rotation.transpose();
    let mut numbers = [x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for (index, row) in [rows.x, rows.y, rows.z].into_iter().enumerate() {
        numbers[3 + 3 * index..6 + 3 * index].copy_from_slice(&row.to_array());
    }
    numbers
}

#[test]
fn placements_of_bodies_and_sites_equal_mujoco() {
    let mut compared = 0;
    for (robot, file) in reference() {
        let model = robot.model();
        let mut kinematics = ForwardKinematics::new(model);
        for Configuration { q, bodies, sites } in &file.configurations {
            let placed = kinematics.place(q).unwrap();
            // Bodies come first, in MuJoCo's order, then sites, in the order of their bodies.
            let expected = bodies.iter().chain(sites);
            assert_eq!(placed.len(), bodies.len() + sites.len());
            for ((frame, placement), (name, expected)) in
                model.frames().iter().zip(placed).zip(expected)
            {
                let is_named =
                    |name: &String| frame.name == *name || frame.name == format!("site/{name}");
                assert!(
                    name.as_ref().is_none_or(is_named),
                    "{} {name:?}",
                    frame.name
                );
                for (actual, expected) in numbers(placement).iter().zip(expected) {
                    assert!(
                        (actual - expected).abs() < TOLERANCE,
                        "{}: {actual} {expected}",
                        frame.name
                    );
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 12 * 4 * (6 + 5 + 7 + 3));
}

#[test]
fn joint_order_and_ranges_equal_mujoco() {
    for (robot, file) in reference() {
        // Without it a mimic joint's limits contain all values of its source joint.
        let robot = robot.clone().with_mimic_limits().unwrap();
        let model = robot.model();
        assert_eq!(model.configuration_len(), file.configurations[0].q.len());
        for joint in file.joints {
            let id = model.moving_joints()[joint.address];
            let actual = &model.joints()[id.index()];
            let name = joint.name.as_deref();
            assert!(
                name.is_none_or(|name| actual.name == name || actual.name == format!("{name}/x"))
            );
            let kinds: &[JointKind] = match joint.kind.as_str() {
                "free" | "slide" => &[JointKind::Prismatic],
                "ball" => &[JointKind::Ball],
                _ => &[JointKind::Revolute, JointKind::Continuous],
            };
            assert!(
                kinds.contains(&actual.kind),
                "{} {:?}",
                actual.name,
                actual.kind
            );
            match joint.range {
                // Locked by an equality.
                _ if actual.limits.is_locked() => assert_eq!(actual.name, "turn"),
                _ if joint.kind == "ball" => assert!(actual.ball.is_some()),
                None => {
                    assert!(actual.limits.lower.is_infinite() && actual.limits.upper.is_infinite())
                }
                Some([lower, upper]) => {
                    assert!((actual.limits.lower - lower).abs() < TOLERANCE);
                    assert!((actual.limits.upper - upper).abs() < TOLERANCE);
                }
            }
        }
    }
}

#[test]
fn masses_equal_mujoco() {
    for (robot, file) in reference() {
        for (frame, expected) in robot.model().frame_ids().zip(&file.inertials) {
            let actual = robot.link(frame).unwrap().inertial;
            assert_eq!(actual.is_some(), expected.mass > 0.0);
            let Some(Inertial {
                mass,
                link_from_inertia,
                moments,
                ..
            }) = actual
            else {
                continue;
            };
            assert!((mass - expected.mass).abs() < TOLERANCE * mass);
            let centre = link_from_inertia.translation.to_array();
            for (actual, expected) in centre.iter().zip(expected.centre) {
                assert!((actual - expected).abs() < TOLERANCE);
            }
            // Principal moments: eigenvalues, in any axes.
            let matrix = Matrix3::from_fn(|row, column| moments[row][column]);
            let mut principal: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
            let mut expected = expected.moments;
            principal.sort_unstable_by(f64::total_cmp);
            expected.sort_unstable_by(f64::total_cmp);
            for (actual, expected) in principal.iter().zip(expected) {
                assert!(
                    (actual - expected).abs() < 1e-10 * mass,
                    "{actual} {expected}"
                );
            }
        }
    }
}

#[test]
fn loop_anchors_equal_mujoco() {
    let mut compared = 0;
    for (robot, file) in reference() {
        assert_eq!(robot.model().loops().len(), file.loops.len());
        for (actual, expected) in robot.model().loops().iter().zip(&file.loops) {
            assert_eq!(actual.kind == LoopKind::Weld, expected.weld);
            let [first, second] = actual.frame_from_place;
            let data = expected.data;
            let vector = |at: usize| Vector3::new(data[at], data[at + 1], data[at + 2]);
            let expected = match (expected.sites, expected.weld) {
                (true, _) => [Placement::identity(); 2],
                (false, false) => [vector(0), vector(3)].map(Placement::translation),
                (false, true) => {
                    // The second body's pose in the first, and a point on the second.
                    let (w, v) = (data[6], vector(7));
                    let turned = Placement::new(Quaternion { w, v }.to_matrix(), vector(3));
                    let anchor = Placement::translation(vector(0));
                    [turned * anchor, anchor]
                }
            };
            for (actual, expected) in [first, second].iter().zip(&expected) {
                for (actual, expected) in numbers(actual).iter().zip(numbers(expected)) {
                    assert!((actual - expected).abs() < TOLERANCE, "{actual} {expected}");
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 5 * 2 * 12);
}
