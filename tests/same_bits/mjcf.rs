//! Promise: so it is for robots that are read from MJCF: bodies, joints, sites, classes, couplings, loops, weights, what touches,
//! what is left out and every fault, with one thing of a document changed at a time.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{Checker, CollisionModel};
use kinopt::model::Limits;
use kinopt::robot::{BaseJoint, Robot};

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text, changed, told};

const WEIGHTS: &str = include_str!("robots/weights.xml");
const TOUCHING: &str = include_str!("robots/touching.xml");
const COUPLED: &str = include_str!("robots/coupled.xml");
const WALKER: &str = include_str!("../robot/mjcf/files/walker.xml");

const VALUES: [&str; 14] = [
    "", "nan", "0.5", "left", "0 0 0", "-1", "1 2", "true", "1 0 0 0", "1e400", "2 3 4", "0 0 0 0",
    "false", "0",
];

fn add(digest: &mut Digest, text: &str, file: &str) {
    match Robot::parse_mjcf(text, file) {
        Ok(robot) => add_text(digest, &told(&robot)),
        Err(error) => add_error(digest, &error),
    }
}

/// The document and, of those with one thing changed, one of so many.
fn each_change(text: &str, file: &str, of: usize) -> Value {
    let mut digest = Digest::new();
    add(&mut digest, text, file);
    for text in changed(text, &VALUES).iter().step_by(of) {
        add(&mut digest, text, file);
    }
    digest.value()
}

/// What touches what.
fn contacts() -> Value {
    let mut digest = Digest::new();
    let texts = changed(
        TOUCHING,
        &["1", "0", "ball", "disable", "3", "hand", "slide"],
    );
    for text in std::iter::once(TOUCHING.to_owned()).chain(texts) {
        let Ok(robot) = Robot::parse_mjcf(&text, "touching.xml") else {
            continue;
        };
        for repair in robot.repairs() {
            add_text(&mut digest, &repair.to_string());
        }
        add_text(&mut digest, &format!("{:?}", robot.passive_joints()));
        let shapes = match CollisionModel::of(&robot) {
            Ok(shapes) => shapes,
            Err(error) => {
                add_error(&mut digest, &error);
                continue;
            }
        };
        add_text(
            &mut digest,
            &format!(
                "{:?} {:?} {:?}",
                shapes.pairs(),
                shapes.notes(),
                shapes.links()
            ),
        );
        for plane in ["world", "post", "hand"] {
            for link in [
                "wall", "base", "post", "arm", "cap", "hand", "finger", "ball", "cube",
            ] {
                digest.word(match shapes.is_checked(plane, link) {
                    Ok(checked) => checked.into(),
                    Err(_) => 2,
                });
            }
        }
    }
    let robot = Robot::parse_mjcf(TOUCHING, "touching.xml").unwrap();
    let checker = Checker::new(CollisionModel::of(&robot).unwrap());
    for seed in 0..8 {
        let q = robot.model().random_configuration(seed);
        for near in checker.collisions(&q).unwrap() {
            add_text(&mut digest, &format!("{near:?}"));
        }
    }
    digest.value()
}

/// Documents of all options of the compiler, and words for the faults of few lines.
fn compilers() -> Value {
    let mut digest = Digest::new();
    let options = [
        "angle=\"degree\"",
        "eulerseq=\"ZYX\"",
        "eulerseq=\"xyXY\"",
        "eulerseq=\"xyw\"",
        "meshdir=\"a/b\"",
        "assetdir=\"c\"",
        "meshdir=\"a\" assetdir=\"c\"",
        "meshdir=\"\"",
        "strippath=\"false\"",
        "inertiafromgeom=\"true\"",
        "inertiafromgeom=\"false\"",
        "inertiafromgeom=\"auto\"",
        "inertiafromgeom=\"maybe\"",
        "inertiagrouprange=\"2 4\"",
        "settotalmass=\"10\"",
        "settotalmass=\"-1\"",
        "autolimits=\"false\"",
        "autolimits=\"true\"",
        "coordinate=\"global\"",
        "coordinate=\"local\"",
        "meshdir=\"/\"",
        "meshdir=\"a/\" strippath=\"false\"",
    ];
    for option in options {
        let compiler = format!("<compiler {option}/>\n  <worldbody");
        for (text, file) in [(WEIGHTS, "weights.xml"), (COUPLED, "coupled.xml")] {
            add(
                &mut digest,
                &text.replacen("<worldbody", &compiler, 1),
                file,
            );
        }
        if !(option.contains("inertia") || option.contains("total")) {
            continue;
        }
        // All of what weighs stated, so that a total scales it.
        let known = WEIGHTS.replace(
            "type=\"mesh\" mesh=\"flat\"",
            "type=\"box\" size=\"0.1 0.1 0.1\"",
        );
        let known = known.replace(" mesh=\"flat\"", " size=\"0.2\"");
        let known = known.replacen("<worldbody", &compiler, 1);
        add(&mut digest, &known, "known.xml");
        add(
            &mut digest,
            &known.replace("shellinertia=\"true\"", ""),
            "known.xml",
        );
        add(
            &mut digest,
            &known
                .replace("type=\"mesh\" mesh=\"hull\"", "size=\"0.1\"")
                .replace("shellinertia=\"true\"", ""),
            "known.xml",
        );
    }
    let body = |inner: &str| {
        format!("<mujoco><worldbody><body name=\"b\">{inner}</body></worldbody></mujoco>")
    };
    for inner in [
        "<joint type=\"free\"/>",
        "<freejoint/><joint/>",
        "<body><freejoint/></body>",
        "<replicate/>",
        "<frame><flexcomp/></frame>",
        "<attach/>",
        "<composite/>",
        "<joint type=\"ball\" range=\"0 3.2\"/>",
        "<joint type=\"ball\" range=\"0 180\"/>",
        "<joint type=\"ball\" range=\"0 179\"/>",
        "<joint type=\"ball\" range=\"10 20\"/>",
        "<joint type=\"ball\" range=\"0 181\"/>",
        "<joint type=\"ball\" limited=\"false\" range=\"0 20\"/>",
        "<joint type=\"ball\" axis=\"0 0 0\" ref=\"3\"/>",
        "<joint range=\"10 10\"/>",
        "<joint limited=\"true\"/>",
        "<joint limited=\"auto\" range=\"0 0\"/>",
        "<joint limited=\"false\" range=\"1 -1\"/>",
        "<joint actuatorfrcrange=\"-1 2\" actuatorfrclimited=\"false\"/>",
        "<joint actuatorfrcrange=\"0 0\"/>",
        "<joint actuatorfrcrange=\"-3 2\" actuatorfrclimited=\"auto\"/>",
        "<joint/><joint/><joint name=\"b/hinge/2\"/><site/><site/><site name=\"b\"/>",
        "<body/><body name=\"body/2\"/><body/>",
        "<joint name=\"j\"/><body><joint name=\"j\"/></body>",
        "<body name=\"world\"/>",
        "<site name=\"s\"/><site name=\"s\"/>",
        "<geom type=\"box\" size=\"1 -1 1\"/>",
        "<geom type=\"box\" size=\"1 1\"/>",
        "<geom/>",
        "<geom size=\"1\" density=\"-1\"/>",
        "<geom size=\"1\" mass=\"-1\"/>",
        "<geom type=\"mesh\" mesh=\"m\"/>",
        "<geom type=\"mesh\"/>",
        "<geom type=\"sdf\" mesh=\"m\"/>",
        "<geom type=\"hfield\"/>",
        "<geom size=\"1 2 3 4\"/>",
        "<geom size=\"a\"/>",
        "<geom type=\"capsule\" size=\"0.1\" fromto=\"1 1 1 1 1 1\"/>",
        "<geom type=\"cylinder\" size=\"0.1 0.4\" fromto=\"1 1 1 1 1 2\"/>",
        "<site fromto=\"0 0 0 0 0 2\" size=\"1\"/>",
        "<site fromto=\"0 0 2 0 0 0\"/>",
        "<inertial mass=\"1\"/>",
        "<inertial pos=\"0 0 0\"/>",
        "<inertial mass=\"1\" pos=\"0 0 0\" quat=\"0 0 0 0\"/>",
        "<body euler=\"90 0 0\" quat=\"1 0 0 0\"/>",
        "<body euler=\"90 0 0\" zaxis=\"1 0 0\"/>",
        "<body xyaxes=\"1 0 0 2 0 0\"/>",
        "<body xyaxes=\"0 0 0 2 0 0\"/>",
        "<body zaxis=\"0 0 -2\"/>",
        "<body zaxis=\"1e-11 0 2\"/>",
        "<body axisangle=\"1 0 0 90\"/>",
        "<body axisangle=\"0 0 0 90\"/>",
        "<body quat=\"0 0 0 1e-200\"/>",
        "<joint axis=\"1e-300 0 0\"/>",
    ] {
        add(&mut digest, &body(inner), "few.xml");
    }
    for text in [
        "<robot/>",
        "<mujoco",
        "<mujoco/>",
        "<mujoco><worldbody/><worldbody><body/></worldbody></mujoco>",
        "<include file=\"x\"/>",
        "<mujoco><default class=\"a\"/><default class=\"b\"/><worldbody><body><joint class=\"b\"/></body></worldbody></mujoco>",
        "<mujoco><default><default class=\"a\"/><default class=\"a\"/></default></mujoco>",
        "<mujoco><default><default class=\"\"/></default></mujoco>",
        "<mujoco>\n<default><default class=\"main\"/></default></mujoco>",
        "<mujoco><include file=\"nowhere.xml\"/></mujoco>",
        "<mujoco><include/></mujoco>",
        "\u{feff}<?xml version=\"1.0\"?><!-- a --><mujoco model=\"m\"/>",
    ] {
        add(&mut digest, text, "few.xml");
        match Robot::parse(text, "few.xml") {
            Ok(robot) => add_text(&mut digest, robot.name()),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    digest.value()
}

/// Files that include others, and their text with those put in.
fn included() -> Value {
    let mut digest = Digest::new();
    for name in ["gripper", "quoted", "walker"] {
        let path = format!("robot/mjcf/files/{name}.xml");
        let text = Robot::mjcf_reader()
            .text_with_includes(&path)
            .unwrap()
            .replace('\r', "");
        add_text(&mut digest, &text);
        let [read, whole] = [
            Robot::read_mjcf(&path).unwrap(),
            Robot::parse_mjcf(&text, "whole.xml").unwrap(),
        ];
        add_text(&mut digest, &told(&read));
        add_text(&mut digest, &told(&whole));
        for base in [
            BaseJoint::PLANAR,
            BaseJoint::FREE,
            BaseJoint::Free {
                room: [
                    Limits::new(-1.0, 2.0),
                    Limits::new(-3.0, 4.0),
                    Limits::new(0.0, 5.0),
                ],
            },
        ] {
            match read.clone().with_base_joint(base) {
                Ok(based) => add_text(&mut digest, &told(&based)),
                Err(error) => add_error(&mut digest, &error),
            }
        }
    }
    for part in ["stand", "finger_defaults", "quoted_part"] {
        let twice = format!(
            "<mujoco>\n<include file=\"{part}.xml\"/>\n<worldbody><include file=\"{part}.xml\"/></worldbody></mujoco>"
        );
        add(&mut digest, &twice, "robot/mjcf/files/parts/x.xml");
        let once =
            format!("<mujoco>\n<worldbody><include file=\"{part}.xml\"/></worldbody></mujoco>");
        add(&mut digest, &once, "robot/mjcf/files/parts/x.xml");
    }
    digest.value()
}

#[test]
fn of_bodies_and_couplings() {
    check(&[
        (
            "MJCF: a walker, some things changed",
            each_change(WALKER, "walker.xml", 3),
        ),
        (
            "MJCF: couplings and loops, each thing changed",
            each_change(COUPLED, "coupled.xml", 1),
        ),
        ("MJCF: files that include others", included()),
    ]);
}

#[test]
fn of_weights_and_contacts() {
    check(&[
        (
            "MJCF: weights and shapes, each thing changed",
            each_change(WEIGHTS, "weights.xml", 1),
        ),
        ("MJCF: what touches, each thing changed", contacts()),
        (
            "MJCF: every option of the compiler, and faults",
            compilers(),
        ),
    ]);
}
