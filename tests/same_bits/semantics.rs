//! Promise: so it is for what is said of a robot beside its own file: SRDF with one thing changed at a time, limits of joints, soft limits,
//! bases, tools, loops, ways through the tree.
#![allow(clippy::unwrap_used)]

use kinopt::model::{Limits, Loop};
use kinopt::robot::{BaseJoint, Robot, Srdf};
use kinopt::spatial::{Placement, Vector3, rotation_exp};

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text, changed, told};

const JOINTS: &str = include_str!("robots/joints.urdf");
const CHAINS: &str = include_str!("robots/chains.urdf");
const LINKS: &str = include_str!("robots/links.urdf");
const LEG: &str = include_str!("robots/leg.urdf");
const LEG_SRDF: &str = include_str!("robots/leg.srdf");

fn srdf() -> Value {
    let mut digest = Digest::new();
    let leg = Robot::parse(LEG, "leg.urdf").unwrap();
    let free = leg.clone().with_base_joint(BaseJoint::FREE).unwrap();
    let planar = leg.clone().with_base_joint(BaseJoint::PLANAR).unwrap();
    let planar_text = LEG_SRDF.replace("1 2 3 0 0 0.6 0.8", "1 2 0.5");
    let values = [
        "", "hip", "0 0 0 0", "all", "1", "nobody", "ring", "0 0 0 2",
    ];
    let mut add = |text: &str, robot: &Robot, whole: bool| {
        let q = robot.model().random_configuration(5);
        for reader in [Srdf::reader(), Srdf::reader().lenient()] {
            match reader.parse(text, "leg.srdf", robot) {
                Ok(srdf) => {
                    add_text(&mut digest, &format!("{srdf:?}"));
                    for state in &srdf.states {
                        digest.doubles(srdf.state(&state.name, &q).unwrap());
                        let of_group = format!("{}/{}", state.group, state.name);
                        digest.doubles(srdf.state(&of_group, &q).unwrap());
                    }
                    if !whole {
                        continue;
                    }
                    for q in [&q[..], &q[..4]] {
                        let groups = srdf.groups.iter().map(|group| group.name.as_str());
                        for group in groups.chain(["nobody"]) {
                            match srdf.only(robot, group, q) {
                                Ok(map) => add_text(&mut digest, &format!("{:?}", map.build())),
                                Err(unknown) => add_error(&mut digest, &unknown),
                            }
                        }
                        let driven = srdf.driven(robot, q).build();
                        add_text(&mut digest, &format!("{driven:?}"));
                    }
                    add_text(&mut digest, &format!("{:?}", srdf.state("nobody", &q)));
                    let passive = robot.clone().with_passive_joints(srdf.passive_joints);
                    let passive = passive.unwrap().with_base_joint(BaseJoint::PLANAR);
                    let passive = passive.map(|robot| robot.passive_joints().to_vec());
                    add_text(&mut digest, &format!("{passive:?}"));
                }
                Err(error) => add_error(&mut digest, &error),
            }
        }
    };
    add(LEG_SRDF, &free, true);
    add(LEG_SRDF, &leg, true);
    add(&planar_text, &planar, true);
    // One name in several groups, of which one names another's state by its own.
    let shared = LEG_SRDF.replace("\"apart\"", "\"crouch\"");
    add(&shared, &free, true);
    add(
        &shared.replace("\"crouch\" group=\"all\"", "\"leg/crouch\" group=\"all\""),
        &free,
        true,
    );
    add("<mujoco/>", &leg, false);
    add("\u{feff}<robot/>", &leg, false);
    for text in changed(LEG_SRDF, &values) {
        add(&text, &free, false);
    }
    digest.value()
}

/// Files of limits for some joints of a robot.
fn limits() -> Value {
    let mut digest = Digest::new();
    let robot = Robot::parse(JOINTS, "joints.urdf").unwrap();
    let entries = [
        "joint_limits:\n  turn: {max_velocity: 0.5, max_acceleration: 2.5, min_position: -1, max_position: 0.5}\n  slide: {max_velocity: 3, max_position: 0.25}\n",
        "joint_limits:\n  round: {min_position: -0.5, has_velocity_limits: false, has_acceleration_limits: true, max_acceleration: 4}\n",
        "joint_limits:\n  turn: {has_position_limits: false, min_position: 0, has_velocity_limits: false, max_velocity: 2}\n",
        "joint_limits:\n  turn: {has_position_limits: True, min_position: 0.25, has_velocity_limits: 1, max_velocity: 2}\n",
        "joint_limits:\n  turn: {has_velocity_limits: True}\n",
        "joint_limits:\n  turn: {has_velocity_limits: maybe}\n",
        "joint_limits:\n  turn: {has_acceleration_limits: 0, max_jerk: 3}\n",
        "joint_limits:\n  turn: {max_velocity: 0}\n",
        "joint_limits:\n  turn: {max_acceleration: -1}\n",
        "joint_limits:\n  turn: {max_position: .inf}\n",
        "joint_limits:\n  turn: {min_position: 3}\n",
        "joint_limits:\n  turn: {max_position: 1e400}\n",
        "joint_limits:\n  turn: {max_velocity: 1e400}\n",
        "joint_limits:\n  first: {min_position: 2.9}\n  turn: {max_position: 0}\n",
        "joint_limits:\n  nobody: {max_velocity: 1}\n",
        "joint_limits:\n",
        "joint_limits: []\n",
        "joint_limits: 3\n",
        "limits:\n",
        "joint_limits: {turn: {max_velocity: [1}}\n",
    ];
    for text in entries {
        match robot
            .clone()
            .with_joint_limits_of(text.as_bytes(), "limits.yaml")
        {
            Ok(limited) => add_text(&mut digest, &told(&limited)),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    let bad = robot
        .clone()
        .with_joint_limits_of(b"joint\xff", "limits.yaml");
    add_error(&mut digest, &bad.unwrap_err());
    let soft = robot.clone().with_soft_limits().unwrap();
    add_text(&mut digest, &told(&soft));
    digest.doubles(robot.moves_within(0.25));
    let narrow = JOINTS.replace("soft_upper_limit=\"2.25\"", "soft_upper_limit=\"-2\"");
    let none = Robot::parse(&narrow, "narrow.urdf")
        .unwrap()
        .with_soft_limits();
    add_error(&mut digest, &none.unwrap_err());
    digest.value()
}

/// Under every kind of base.
fn bases() -> Value {
    let mut digest = Digest::new();
    let [joints, chains] = [JOINTS, CHAINS].map(|text| Robot::parse(text, "x.urdf").unwrap());
    let joints = joints.with_passive_joints(["turn", "round"]).unwrap();
    let ranges = [
        ("x", Limits::new(-1.0, 2.0)),
        ("y", Limits::new(-3.0, 4.0)),
        ("z", Limits::new(-0.5, 0.75)),
        ("yaw", Limits::new(-2.0, 1.0)),
        ("x", Limits::new(-2.0, 1.5)),
        ("y", Limits::new(f64::NAN, 1.0)),
        ("y", Limits::new(0.0, 1.0)),
    ];
    for kind in BaseJoint::KINDS.into_iter().chain(["float"]) {
        let single = ranges.iter().map(std::slice::from_ref);
        for own in single.chain([
            &ranges[..0],
            &ranges[..2],
            &ranges[..3],
            &ranges[4..],
            &[ranges[0], ranges[4]],
            &[ranges[6], ranges[5]],
            &[ranges[1], ranges[3]],
        ]) {
            let base = match BaseJoint::named(kind, own.iter().copied()) {
                Ok(base) => base,
                Err(unknown) => {
                    add_error(&mut digest, &unknown);
                    continue;
                }
            };
            add_text(&mut digest, &format!("{base:?}"));
            if own.len() == 1 {
                continue;
            }
            for robot in [&joints, &chains] {
                match robot.clone().with_base_joint(base) {
                    Ok(based) => {
                        add_text(&mut digest, &told(&based));
                        let twice = based.with_base_joint(BaseJoint::PLANAR);
                        let twice = twice.map(|robot| robot.model().moving_joints().to_vec());
                        add_text(&mut digest, &format!("{twice:?}"));
                    }
                    Err(error) => add_error(&mut digest, &error),
                }
            }
        }
    }
    digest.value()
}

/// Ways through the tree, tools, and what asks for names.
fn ways() -> Value {
    let mut digest = Digest::new();
    let robots = [JOINTS, CHAINS, LINKS].map(|text| Robot::parse(text, "x.urdf").unwrap());
    for robot in &robots {
        let model = robot.model();
        for base in model.frame_ids() {
            for tip in model.frame_ids() {
                let way = robot.chain(base, tip).unwrap();
                add_text(&mut digest, &format!("{way:?}"));
            }
        }
        add_text(&mut digest, &format!("{:?}", robot.chain("base", "nobody")));
        add_text(
            &mut digest,
            &format!("{:?}", robot.joints(&["turn", "hinge"])),
        );
        add_text(&mut digest, &format!("{:?}", robot.map().variables()));
        let at = Placement::new(
            rotation_exp(Vector3::new(0.1, 0.2, 0.3)),
            Vector3::new(0.4, 0.5, 0.6),
        );
        let last = model.frames().last().unwrap().name.clone();
        let tooled = robot.clone().with_tool("tool", &last, at).unwrap();
        add_text(&mut digest, &told(&tooled));
        for (name, link) in [("tool", "nobody"), ("base", "base")] {
            let bad = robot.clone().with_tool(name, link, at).unwrap_err();
            add_error(&mut digest, &bad);
        }
        let ends = [model.frame("base").unwrap(), model.frame(&last).unwrap()];
        let closed = robot
            .clone()
            .with_loop(Loop::connect("pin", ends).at([at, at.inverse()]));
        match closed {
            Ok(closed) => {
                add_text(&mut digest, &told(&closed));
                add_text(&mut digest, &told(&closed.without_loops()));
            }
            Err(error) => add_error(&mut digest, &error),
        }
        let q = model.random_configuration(3);
        match robot.centre_of_mass(&q) {
            Ok(at) => digest.doubles(at.to_array()),
            Err(error) => add_error(&mut digest, &error),
        }
        if let Ok(jacobian) = robot.centre_of_mass_jacobian(&q) {
            digest.doubles(jacobian.iter().copied());
        }
        add_text(
            &mut digest,
            &format!("{:?}", robot.clone().with_file("a/b").file().is_some()),
        );
    }
    add_text(
        &mut digest,
        &format!(
            "{:?}",
            robots[0]
                .clone()
                .with_passive_joints(["turn", "nobody"])
                .map(|_| ())
        ),
    );
    digest.value()
}

#[test]
fn of_semantics_limits_and_bases() {
    check(&[
        ("SRDF: each thing changed", srdf()),
        ("limits of joints from YAML, and soft ones", limits()),
        ("robots on every base", bases()),
        ("ways through robots, tools and loops", ways()),
    ]);
}
