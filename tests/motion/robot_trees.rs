//! Promise: the body parts of a robot come from its kinematic tree. Neither the names of its links nor the direction in
//! which it looks matter.

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::retarget::{BodyMap, Capture};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::Vector3;

const NAO: &str = include_str!("../../models/aldebaran_nao.urdf");

fn steps() -> Capture {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap()
}

/// Positions of the driven points at neutral, by driving joint.
fn positions(robot: &Robot) -> Vec<(String, Vector3<f64>)> {
    let model = robot.model();
    let guess = BodyMap::guess(&steps(), model).unwrap();
    assert!(guess.from_tree, "{:?}", guess.notes);
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(&model.neutral()).unwrap();
    let drives = guess.map.drives.iter();
    let positions = drives.map(|drive| {
        let frame = model.frame(&drive.frame).unwrap();
        (
            drive.joint.clone(),
            placed[frame.index()].apply(drive.offset),
        )
    });
    positions.collect()
}

fn nao(text: &str) -> Robot {
    let robot = Robot::parse(text, "nao.urdf").unwrap();
    robot.with_base_joint(BaseJoint::FREE).unwrap()
}

/// Each link and joint gets a number as its name.
fn without_names(text: &str) -> String {
    let mut names: Vec<&str> = text
        .split("name=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect();
    names.sort_unstable();
    names.dedup();
    let number = |name: &str| names.iter().position(|other| *other == name);
    let mut result = String::new();
    for (k, part) in text.split('"').enumerate() {
        let part = match number(part).filter(|_| k % 2 == 1) {
            Some(number) => format!("n{number}"),
            None => part.to_owned(),
        };
        if k > 0 {
            result.push('"');
        }
        result.push_str(&part);
    }
    result
}

#[test]
fn names_of_links_do_not_matter() {
    let (named, unnamed) = (positions(&nao(NAO)), positions(&nao(&without_names(NAO))));
    assert_eq!(named.len(), 16);
    assert_eq!(named, unnamed);
}

#[test]
fn parts_are_at_the_joints_of_the_nao() {
    let found = positions(&nao(NAO));
    let at = |joint: &str| found.iter().find(|(name, _)| name == joint).unwrap().1;
    // Lengths of Aldebaran's documentation: thigh 100 mm, tibia 102.9 mm, hip offset 50 mm.
    for side in ["Left", "Right"] {
        let [hip, knee, ankle] = ["UpLeg", "Leg", "Foot"].map(|part| at(&format!("{side}{part}")));
        assert!(
            ((hip - knee).norm() - 0.1).abs() < 1e-3,
            "{side}: {:?}",
            hip - knee
        );
        assert!(
            ((knee - ankle).norm() - 0.1029).abs() < 1e-3,
            "{side}: {:?}",
            knee - ankle
        );
    }
    let hips = at("LeftUpLeg") - at("RightUpLeg");
    assert!(
        (hips - Vector3::new(0.0, 0.1, 0.0)).norm() < 1e-3,
        "{hips:?}"
    );
    let toe = at("LeftToeBase") - at("LeftFoot");
    assert!(toe.x > 0.03 && toe.y.abs() < 1e-3, "{toe:?}");
}
