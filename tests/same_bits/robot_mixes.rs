//! Promise: so it is for robots of which several things are changed at once, in their files, in what is said beside them, and in
//! what is asked of them afterwards.
#![allow(clippy::unwrap_used)]

use kinopt::model::{Limits, Loop};
use kinopt::robot::{BaseJoint, Robot, Srdf};
use kinopt::spatial::{Placement, Vector3};
use support::changed_text;
use support::changed_xml::Element;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text, told};

const TEXTS: [(&str, usize); 7] = [
    (include_str!("robots/joints.urdf"), 40),
    (include_str!("robots/chains.urdf"), 40),
    (include_str!("robots/links.urdf"), 30),
    (include_str!("robots/leg.urdf"), 30),
    (include_str!("robots/weights.xml"), 30),
    (include_str!("robots/coupled.xml"), 40),
    (include_str!("robots/touching.xml"), 40),
];
const LEG_SRDF: &str = include_str!("robots/leg.srdf");

/// Limits of some joints, as another file says them.
const LIMITS: &str = "joint_limits:\n  turn:\n    has_velocity_limits: true\n    max_velocity: 0.5\n    has_acceleration_limits: false\n    max_acceleration: 2\n    min_position: -1\n  slide: {max_velocity: 3, max_position: 0.25, has_position_limits: true}\n  first:\n    min_position: 0\n    max_position: 1\n    max_jerk: 7\n  \"round\": {has_acceleration_limits: 1, max_acceleration: 1e1}\n";

fn text_of(text: &str, random: &mut Random) -> String {
    match random.below(3) {
        0 => changed_text::changed(text, 1, random).remove(0),
        _ => {
            let mut own = Element::parse(text);
            for _ in 0..=random.below(2) {
                own.change(random);
            }
            own.text()
        }
    }
}

fn base(random: &mut Random) -> BaseJoint {
    let range = |random: &mut Random| {
        let ends = [-2.0, -0.5, 0.0, 0.5, 3.0];
        match random.below(4) {
            0 => Limits::UNBOUNDED,
            1 => Limits::new(ends[random.below(5)], 1.0),
            _ => Limits::new(-1.0, ends[random.below(5)]),
        }
    };
    let [x, y, z] = [range(random), range(random), range(random)];
    match random.below(5) {
        0 => BaseJoint::Fixed,
        1 => BaseJoint::FREE,
        2 => BaseJoint::Free { room: [x, y, z] },
        3 => BaseJoint::Planar {
            room: [x, y],
            yaw: z,
        },
        _ => BaseJoint::Sliding {
            axis: Vector3::new([0.0, 1.0, -2.0][random.below(3)], 0.5, 0.0),
            limits: x,
        },
    }
}

/// One after the other, what one may do to a robot; what is refused leaves it as it was.
fn changed(mut robot: Robot, digest: &mut Digest, random: &mut Random) -> Robot {
    for _ in 0..random.below(4) {
        let before = robot.clone();
        let names: Vec<String> = robot
            .model()
            .joints()
            .iter()
            .map(|own| own.name.clone())
            .collect();
        let frames: Vec<_> = robot.model().frame_ids().collect();
        let at =
            Placement::translation(Vector3::new(0.1, 0.2, [0.3, f64::NAN][random.below(9) / 8]));
        let told: Result<Robot, String> = match random.below(7) {
            0 => robot
                .with_base_joint(base(random))
                .map_err(|error| error.to_string()),
            1 => {
                let name = ["tool", "base", ""][random.below(9) % 3];
                let frame = frames[random.below(frames.len())];
                robot
                    .with_tool(name, frame, at)
                    .map_err(|error| error.to_string())
            }
            2 => {
                let ends = [(); 2].map(|()| frames[random.below(frames.len())]);
                let ring = match random.below(2) {
                    0 => Loop::weld("ring", ends),
                    _ => Loop::connect("ring", ends),
                };
                robot
                    .with_loop(ring.at([at, Placement::identity()]))
                    .map_err(|error| error.to_string())
            }
            3 => {
                let limits = changed_text::changed(LIMITS, 1, random).remove(0);
                let limits = if random.below(2) == 0 {
                    LIMITS.to_owned()
                } else {
                    limits
                };
                robot
                    .with_joint_limits_of(limits.as_bytes(), "l.yaml")
                    .map_err(|error| error.to_string())
            }
            4 => robot.with_soft_limits().map_err(|error| error.to_string()),
            5 => {
                let count = random.below(3).min(names.len());
                let passive: Vec<&str> = (0..count)
                    .map(|_| &*names[random.below(names.len())])
                    .collect();
                robot
                    .with_passive_joints(passive)
                    .map_err(|error| error.to_string())
            }
            _ => Ok(robot.without_loops()),
        };
        robot = told.unwrap_or_else(|error| {
            add_text(digest, &error);
            before
        });
    }
    robot
}

fn robots() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(961));
    for (text, count) in TEXTS {
        for round in 0..count {
            let own = if round % 3 == 0 {
                text.to_owned()
            } else {
                text_of(text, &mut random)
            };
            let reader = match random.below(2) {
                0 => Robot::reader(),
                _ => Robot::reader().lenient(),
            };
            match reader.parse(&own, "mixed.xml") {
                Ok(robot) => {
                    let robot = changed(robot, &mut digest, &mut random);
                    add_text(&mut digest, &told(&robot));
                    let [a, b] = [(); 2].map(|()| random.below(robot.model().frames().len()));
                    let frames: Vec<_> = robot.model().frame_ids().collect();
                    add_text(
                        &mut digest,
                        &format!("{:?}", robot.chain(frames[a], frames[b])),
                    );
                    digest.doubles(robot.moves_within(0.5));
                    let ends = Loop::connect("any", [frames[a], frames[b]]);
                    let of_loop = robot.model().loop_joints(&ends);
                    let moves = robot
                        .model()
                        .joint_ids()
                        .map(|id| robot.model().moves_a_loop(id));
                    add_text(
                        &mut digest,
                        &format!("{of_loop:?} {:?}", moves.collect::<Vec<_>>()),
                    );
                }
                Err(error) => add_error(&mut digest, &error),
            }
        }
    }
    digest.value()
}

/// What a file says of groups and states, of a robot on some base, with some of its joints freed or driven.
fn groups() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(962));
    let leg = Robot::parse(TEXTS[3].0, "leg.urdf").unwrap();
    for round in 0..90 {
        let robot = leg.clone().with_base_joint(base(&mut random));
        let robot = robot.unwrap_or_else(|_| leg.clone());
        let text = match round % 3 {
            0 => LEG_SRDF.replace(
                "1 2 3 0 0 0.6 0.8",
                ["1 2 3 0 0 0 0", "1 2", "0 0 0 0 0 0 1", "1 2 0.5"][round % 4],
            ),
            _ => text_of(LEG_SRDF, &mut random),
        };
        let reader = match random.below(2) {
            0 => Srdf::reader(),
            _ => Srdf::reader().lenient(),
        };
        let srdf = match reader.parse(&text, "leg.srdf", &robot) {
            Ok(srdf) => srdf,
            Err(error) => {
                add_error(&mut digest, &error);
                continue;
            }
        };
        add_text(&mut digest, &format!("{srdf:?}"));
        let q = robot.model().random_configuration(random.bits());
        for state in &srdf.states {
            match srdf.state(&state.name, &q) {
                Ok(q) => digest.doubles(q),
                Err(error) => add_error(&mut digest, &error),
            }
        }
        let driven = srdf.driven(&robot, &q).build();
        add_text(&mut digest, &format!("{driven:?}"));
        for group in &srdf.groups {
            let only = srdf.only(&robot, &group.name, &q).map(|map| map.build());
            add_text(&mut digest, &format!("{only:?}"));
        }
    }
    digest.value()
}

/// Links that hang on any other, on themselves, or in a ring that hangs on nothing.
fn trees() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(963));
    for _ in 0..60 {
        let mut text = "<robot name='t'><link name='root'/>".to_owned();
        (0..6).for_each(|link| text += &format!("<link name='l{link}'/>"));
        for link in 0..6 {
            let parent = match random.below(4) {
                0 => "root".to_owned(),
                _ => format!("l{}", random.below(6)),
            };
            let kind = ["fixed", "continuous"][random.below(2)];
            text += &format!(
                "\n<joint name='j{link}' type='{kind}'><parent link='{parent}'/><child link='l{link}'/></joint>"
            );
        }
        match Robot::parse(&format!("{text}</robot>"), "t.urdf") {
            Ok(robot) => add_text(
                &mut digest,
                &format!("{:?} {:?}", robot.tips(), robot.model().joints()),
            ),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    digest.value()
}

#[test]
fn of_mixed_robots() {
    check(&[
        ("robots, links that hang on any other", trees()),
        ("robots, several things changed", robots()),
        ("SRDF, several things changed", groups()),
    ]);
}
