//! Robots with a chain of joints of every kind, and arms on them under options drawn at random: many at once, in any order, some twice,
//! some at the ends of their ranges, now and then one beyond.
#![allow(clippy::unwrap_used)]

use std::time::Duration;

use kinopt::arm::{Arm, ArmBuilder, Axis, Base, PoseBounds, Search};
use kinopt::collision::{Checker, CollisionModel, Resolution, SphereModel, World};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::random::Random;

use crate::drawn::one_of;
use crate::every_joint::{place, vector};

pub(crate) const INF: f64 = f64::INFINITY;

/// True once in so many times.
pub(crate) fn rarely(random: &mut Random, times: usize) -> bool {
    random.below(times) == 0
}

/// A chain from `l0` of so many joints, one of which may follow another, and a joint aside; every link has a shape.
pub(crate) fn robot(random: &mut Random, joints: usize) -> Robot {
    let mut text = String::from("<robot name=\"mixed\">");
    let follows = 1 + random.below(3 * joints);
    for k in 0..=joints + 1 {
        let name = if k > joints {
            "aside".to_owned()
        } else {
            format!("l{k}")
        };
        let shape = one_of(
            random,
            &[
                "<sphere radius=\"0.05\"/>",
                "<box size=\"0.06 0.08 0.1\"/>",
                "<cylinder radius=\"0.04\" length=\"0.12\"/>",
            ],
        );
        let up = random.within(0.0, 0.06);
        text += &format!(
            "<link name=\"{name}\"><collision><origin xyz=\"0 0 {up:.3}\"/><geometry>{shape}</geometry></collision></link>"
        );
    }
    for k in 0..=joints {
        let (name, parent, child) = match k == joints {
            true => ("b0".to_owned(), random.below(joints), "aside".to_owned()),
            false => (format!("j{k}"), k, format!("l{}", k + 1)),
        };
        let kind = match random.below(8) {
            0 => "prismatic",
            1 => "continuous",
            _ => "revolute",
        };
        let (lower, upper) = match kind {
            "prismatic" => (
                one_of(random, &[-0.3, -0.1, 0.0]),
                one_of(random, &[0.2, 0.5]),
            ),
            _ => (
                one_of(random, &[-7.0, -3.0, -2.0, -0.6]),
                one_of(random, &[0.5, 2.0, 3.0, 6.0]),
            ),
        };
        let axis = one_of(
            random,
            &["0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 -1 0.2", "2 1 0"],
        );
        let [x, z] = [
            one_of(random, &[0.0, 0.0, 0.1, -0.05]),
            one_of(random, &[0.15, 0.3, 0.2, 0.0]),
        ];
        let turned = one_of(random, &["0 0 0", "0 0 0", "1.5707963 0 0", "0.3 -0.2 1"]);
        let speed = one_of(random, &[0.4, 1.0, 3.0, 20.0]);
        text += &format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"l{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"{x} 0.01 {z}\" rpy=\"{turned}\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"{lower}\" upper=\"{upper}\" effort=\"1\" velocity=\"{speed}\"/>"
        );
        if k == follows && k < joints && kind == "revolute" {
            let ratio = one_of(random, &[1.0, -1.0, 0.5, -0.4, 0.0]);
            let leader = random.below(k);
            text += &format!("<mimic joint=\"j{leader}\" multiplier=\"{ratio}\" offset=\"0.1\"/>");
        }
        text += "</joint>";
    }
    Robot::reader()
        .parse(&(text + "</robot>"), "mixed.urdf")
        .unwrap()
}

fn goal(random: &mut Random) -> PoseBounds {
    let axis = one_of(random, &[Axis::X, Axis::Y, Axis::Z]);
    match random.below(7) {
        0 => PoseBounds::pose(),
        1 => PoseBounds::position(),
        2 => PoseBounds::free_about(axis),
        3 => PoseBounds::free_along(axis),
        4 => PoseBounds::within([INF, INF, INF, 0.0, 0.0, one_of(random, &[0.0, INF])]),
        _ => PoseBounds::within([(); 6].map(|()| one_of(random, &[0.0, 0.0, 0.05, 0.3, 4.0, INF]))),
    }
}

fn search(random: &mut Random) -> Search {
    match random.below(6) {
        0 => Search::Start,
        1 => Search::First,
        2 | 3 => Search::Nearest,
        _ => Search::Distinct {
            k: one_of(random, &[1, 2, 5]),
            distance: one_of(random, &[0.0, 0.2, 1.0, INF]),
        },
    }
}

/// One option of a chain of `n` free joints; `odd` beyond its range.
fn option<'m>(own: ArmBuilder<'m>, n: usize, random: &mut Random, odd: bool) -> ArmBuilder<'m> {
    let wrong = one_of(random, &[0.0, -1.0, f64::NAN, INF]);
    let or_wrong = |right: f64| if odd { wrong } else { right };
    let still = rarely(random, 3);
    let mut each = |values: &[f64]| -> Vec<f64> {
        let mut all: Vec<f64> = (0..n).map(|_| one_of(random, values)).collect();
        if odd {
            all[n - 1] = wrong;
        }
        all
    };
    let few = [0.0, 0.1, 0.4, 2.0, INF];
    let moves = each(if still { &few[..1] } else { &few });
    let weights = each(&[1.0, 1.0, 0.5, 2.0, 30.0, 1e-3]);
    let posture = each(&[0.0, 0.5, -0.7, 1.2, 1e6]);
    match random.below(15) {
        0 => own.with_tool(place(random, 0.2)),
        1 => own.with_position_tolerance(or_wrong(one_of(random, &[1e-6, 1e-4, 1e-2, 0.3]))),
        2 => own.with_orientation_tolerance(or_wrong(one_of(random, &[1e-6, 1e-3, 0.2, 4.0]))),
        3 => own.with_metres_per_radian(one_of(random, &[None, Some(or_wrong(0.1)), Some(2.0)])),
        4 | 5 => own.with_goal(goal(random)),
        6 | 7 => own.with_search(search(random)),
        8 => own.with_joint_weights(&weights),
        9 => own.with_max_move(&moves[usize::from(odd)..]),
        10 => own.with_posture(&posture),
        11 => own.with_iterations(one_of(
            random,
            &[None, Some(u32::from(!odd)), Some(15), Some(60), Some(700)],
        )),
        12 => own.with_global_search_on_miss(random.below(3) > 0),
        13 => own.with_limit_avoidance(or_wrong(one_of(random, &[0.0, 0.5, 4.0, 50.0]))),
        _ => match random.below(4) {
            0 => own.with_seed(one_of(random, &[0, 1, u64::MAX])),
            1 => own.with_attempts(one_of(
                random,
                &[None, Some(u32::from(!odd)), Some(3), Some(20)],
            )),
            2 => own.with_time_limit(one_of(
                random,
                &[None, Some(Duration::MAX), Some(Duration::from_secs(9000))],
            )),
            _ => own.with_atlas(false),
        },
    }
}

/// An arm of a robot between any two of its links under any options.
pub(crate) fn described<'m>(
    robot: &'m Robot,
    joints: usize,
    random: &mut Random,
) -> ArmBuilder<'m> {
    let (last, model) = (format!("l{joints}"), robot.model());
    let mut own = match random.below(9) {
        0 => Arm::builder(robot, Base::World, last.as_str()),
        1 => Arm::builder(robot, "aside", last.as_str()),
        2 => Arm::builder(robot, last.as_str(), "l0"),
        3 => Arm::builder(robot, "l1", last.as_str()),
        4 => Arm::builder(model, "l0", last.as_str()),
        _ => Arm::builder(robot, "l0", model.frame(&last).unwrap()),
    };
    own = own
        .with_atlas(false)
        .with_attempts(one_of(random, &[1, 2, 5, 9, 17]));
    let all = model.configuration_len();
    match random.below(8) {
        0 => own = own.with_locked("j1", one_of(random, &[0.2, 0.0, 9.0])),
        1 => own = own.with_locked("b0", 0.1).with_locked("j0", -0.05),
        2 => {
            let rest: Vec<f64> = (0..all)
                .map(|_| one_of(random, &[0.0, 0.3, -9.0]))
                .collect();
            own = own.with_only(
                ["j0", "j2", "j1"],
                &rest[random.below(all * 9) / (all * 9 - 1)..],
            );
        }
        _ => {}
    }
    let n = own.joints().map_or(1, |joints| joints.len());
    let n = if rarely(random, 30) { n + 1 } else { n };
    if rarely(random, 8) {
        // Nothing may move: all attempts end at one place.
        let search = Search::Distinct {
            k: 3,
            distance: 0.0,
        };
        own = own.with_max_move(&vec![0.0; n]).with_search(search);
    }
    for _ in 0..random.below(6) {
        let odd = rarely(random, 40);
        own = option(own, n, random, odd);
    }
    own
}

/// Obstacles about a robot, some of them in its way.
pub(crate) fn world(random: &mut Random) -> World {
    let mut world = World::new();
    for k in 0..random.below(4) {
        let at = Placement::new(place(random, 0.1).rotation, vector(random, 0.7));
        match random.below(4) {
            0 => world.add_box(&format!("box {k}"), [0.2, 0.1, 0.3], at),
            1 => world.add_sphere(&format!("ball {k}"), 0.08, at),
            2 => world.add_capsule(&format!("bar {k}"), 0.03, 0.3, at),
            _ => world.add_plane(&format!("floor {k}"), Vector3::new(0.0, 0.0, -0.3)),
        }
        .unwrap();
    }
    world
}

/// What keeps a robot clear of a world, by spheres or not, with a margin or not.
pub(crate) fn checker(robot: &Robot, random: &mut Random) -> Checker {
    let bodies = CollisionModel::of(robot).unwrap();
    let neutral = robot.model().neutral();
    let bodies = match random.below(3) {
        0 => bodies,
        _ => bodies.with_touching_ignored(&neutral).unwrap(),
    };
    let checker = match random.below(6) {
        1.. => Checker::new(bodies),
        0 => {
            let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.03)).unwrap();
            Checker::new(bodies).with_spheres(spheres)
        }
    };
    let margin = one_of(random, &[0.0, 0.0, 0.01, 0.05]);
    checker
        .with_world(&world(random))
        .unwrap()
        .with_margin(margin)
        .unwrap()
}
