//! Promise: so it is for whole paths under every option: where branches are left, ends that are given, tools, rings, paths that may be
//! entered anywhere, room that a goal leaves, what is out of reach or in the way, times that are kept.
#![allow(clippy::unwrap_used)]

use kinopt::Arm;
use kinopt::arm::{Axis, PoseBounds};
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::model::Limits;
use kinopt::motion::path::{CartesianPath, PathSolution, PathSolver, Traversal};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::{planar_with_hand, robot};
use support::follower_chains::follower_chain;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::robot_texts::add_text;

pub(crate) fn placement(random: &mut Random, size: f64) -> Placement<f64> {
    let [turn, at] =
        [1.5, size].map(|size| Vector3::from([(); 3].map(|()| random.within(-size, size))));
    Placement::new(rotation_exp(turn), at)
}

/// Without an atlas, which only takes time here.
pub(crate) fn bare_arm(robot: &Robot, base: &str, tip: &str) -> Arm {
    Arm::builder(robot, base, tip)
        .with_atlas(false)
        .build()
        .unwrap()
}

/// Where the tool is while the joints go straight through some configurations, so many steps each.
pub(crate) fn through(arm: &Arm, ends: &[Vec<f64>], steps: usize) -> Vec<Placement<f64>> {
    let mut points = vec![arm.base_from_tool(&ends[0]).unwrap()];
    for pair in ends.windows(2) {
        for step in 1..=steps {
            let share = step as f64 / steps as f64;
            let between = |(a, b): (&f64, &f64)| a + share * (b - a);
            let q: Vec<f64> = pair[0].iter().zip(&pair[1]).map(between).collect();
            points.push(arm.base_from_tool(&q).unwrap());
        }
    }
    points
}

pub(crate) fn some(arm: &Arm, random: &mut Random, near: Option<&[f64]>) -> Vec<f64> {
    let drawn = arm.limits().enumerate().map(|(joint, limits)| {
        let (low, high) = (limits.lower.max(-3.0), limits.upper.min(3.0));
        match near {
            Some(near) => (near[joint] + random.within(-0.6, 0.6)).clamp(low, high),
            None => random.within(low, high),
        }
    });
    drawn.collect()
}

/// A circle of some points across z.
pub(crate) fn circle(
    begin: &Placement<f64>,
    radius: f64,
    count: u32,
    turns: f64,
) -> Vec<Placement<f64>> {
    let point = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(count);
        let (sin, cos) = kinopt::Scalar::sin_cos(angle);
        let turned = rotation_exp(Vector3::new(0.0, 0.0, angle * turns));
        let by = Vector3::new(radius * (1.0 - cos), radius * sin, 0.0);
        Placement::new(begin.rotation * turned, begin.translation + by)
    };
    (0..count).map(point).collect()
}

pub(crate) fn add(digest: &mut Digest, found: &PathSolution) {
    let text = serde_json::to_string(found).unwrap();
    assert_eq!(&serde_json::from_str::<PathSolution>(&text).unwrap(), found);
    add_text(digest, &text);
    add_text(
        digest,
        &format!("{found:?} {} {}", found.is_whole(), found.rows().len()),
    );
}

/// Arms of six and seven joints and one with a slide through far configurations.
fn options() -> [Value; 2] {
    let (mut plain, mut asked, mut random) = (Digest::new(), Digest::new(), Random::new(41));
    for (name, samples) in [
        ("universal_ur5e", 64),
        ("franka_panda", 24),
        ("adept_cobra_s600", 64),
    ] {
        let robot = robot(name);
        let arm = bare_arm(&robot, "base", "flange");
        let n = arm.joint_count();
        let mut ends = vec![some(&arm, &mut random, None)];
        ends.push(some(&arm, &mut random, Some(&ends[0])));
        let solver = || PathSolver::new(&arm).with_samples(samples);
        let path = CartesianPath::new(through(&arm, &ends, 14)).unwrap();
        add(&mut plain, &solver().solve(&path).unwrap());
        let far = [ends[0].clone(), some(&arm, &mut random, None)];
        let far = CartesianPath::new(through(&arm, &far, 10)).unwrap();
        add(
            &mut plain,
            &solver().with_max_step(0.7).solve(&far).unwrap(),
        );
        let weights: Vec<f64> = (1..=n).map(|k| 1.0 / k as f64).collect();
        let times: Vec<f64> = (0..path.points().len()).map(|k| 0.02 * k as f64).collect();
        let timed = path.clone().with_times(times).unwrap();
        let times: Vec<f64> = (0..path.points().len()).map(|k| 0.006 * k as f64).collect();
        let hurried = path.clone().with_times(times).unwrap();
        for (solver, path) in [
            (solver().with_joint_weights(&weights), &path),
            (solver().with_start(&ends[0]).with_end(&ends[1]), &path),
            (
                solver()
                    .with_start(&ends[0])
                    .with_joint_weights(&weights)
                    .with_max_step(0.1),
                &path,
            ),
            (solver().with_samples(4), &path),
            (solver().with_times_kept(true), &timed),
            (solver().with_times_kept(true), &hurried),
        ] {
            add(&mut asked, &solver.solve(path).unwrap());
        }
    }
    [plain.value(), asked.value()]
}

/// Rings, and paths that may be entered anywhere.
fn rings() -> Value {
    let mut digest = Digest::new();
    let ur5e = robot("universal_ur5e");
    let q = [0.3, -1.2, 1.4, -1.6, -1.5, 0.0];
    let arm = bare_arm(&ur5e, "base", "flange");
    let begin = arm.base_from_tool(&q).unwrap();
    let planar = planar_with_hand(Limits::new(-3.0, 3.0));
    let flat = planar.base_from_tool(&[0.4, 0.8, 0.3]).unwrap();
    for way in [Traversal::Cyclic, Traversal::AnyStart] {
        for (arm, begin, radius, turns) in [
            (&arm, &begin, 0.05, 0.0),
            (&arm, &begin, 0.02, 1.0),
            (&planar, &flat, 0.2, 0.0),
            (&planar, &flat, 0.1, -1.0),
            (&planar, &flat, 0.9, 0.0),
        ] {
            let path = CartesianPath::new(circle(begin, radius, 20, turns)).unwrap();
            let solver = PathSolver::new(arm).with_samples(32).with_max_step(0.4);
            add(
                &mut digest,
                &solver.solve(&path.with_traversal(way)).unwrap(),
            );
        }
        let keys = circle(&begin, 0.1, 5, 0.0);
        let path = CartesianPath::spline(keys, None, 4)
            .unwrap()
            .with_traversal(way);
        add(
            &mut digest,
            &PathSolver::new(&arm).with_samples(16).solve(&path).unwrap(),
        );
    }
    let path = CartesianPath::new(circle(&begin, 0.05, 16, 0.0)).unwrap();
    let path = path.with_traversal(Traversal::Cyclic);
    add(
        &mut digest,
        &PathSolver::new(&arm).with_start(&q).solve(&path).unwrap(),
    );
    // Twice round and more, which the last joint does nowhere: another entry saves a reconfiguration, or makes it shorter.
    let panda = bare_arm(&robot("franka_panda"), "base", "flange");
    let wound = panda
        .base_from_tool(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
        .unwrap();
    for (count, turns, step) in [(16, 2.0, 0.9), (20, 3.0, 1.0)] {
        let path = CartesianPath::new(circle(&wound, 0.0, count, turns)).unwrap();
        let path = path.with_traversal(Traversal::AnyStart);
        let solver = PathSolver::new(&panda).with_samples(12).with_max_step(step);
        let found = solver.solve(&path).unwrap();
        assert_ne!(found.entry, 0);
        add(&mut digest, &found);
    }
    // Ends whose elbows are apart, so that it goes round on the way.
    let ends = [
        [0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8],
        [1.0, -0.4, -0.6, -1.9, 0.1, 1.7, 0.6],
    ];
    let keys = ends.map(|q| panda.base_from_tool(&q).unwrap()).to_vec();
    let path = CartesianPath::spline(keys, None, 18).unwrap();
    let solver = PathSolver::new(&panda)
        .with_start(&ends[0])
        .with_end(&ends[1]);
    add(&mut digest, &solver.with_samples(12).solve(&path).unwrap());
    let one = CartesianPath::new(vec![begin]).unwrap();
    for way in [Traversal::Open, Traversal::Cyclic, Traversal::AnyStart] {
        let path = one.clone().with_traversal(way);
        add(
            &mut digest,
            &PathSolver::new(&arm).with_samples(8).solve(&path).unwrap(),
        );
    }
    digest.value()
}

/// Several tools, goals that leave room, a path that stands still, one of two far points.
fn goals() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(43));
    let ur5e = robot("universal_ur5e");
    let q = [0.3, -1.2, 1.4, -1.6, -1.5, 0.0];
    let arm = bare_arm(&ur5e, "base", "flange");
    let [drill, saw] = [[0.0, 0.05, 0.02], [0.03, 0.0, -0.05]].map(|at| {
        let tool = Placement::new(rotation_exp(Vector3::new(0.2, 0.0, 0.3)), Vector3::from(at));
        arm.with_tool(tool).unwrap()
    });
    let ends = vec![q.to_vec(), some(&arm, &mut random, Some(&q))];
    let points = through(&arm, &ends, 17);
    let tools: Vec<usize> = (0..18).map(|k| [0, 0, 2, 2, 2, 1][k % 6]).collect();
    let path = CartesianPath::new(points.clone()).unwrap();
    let tooled = path.clone().with_tools(tools).unwrap();
    let solver = PathSolver::new(&arm)
        .with_tools([&drill, &saw])
        .with_samples(32);
    add(&mut digest, &solver.solve(&tooled).unwrap());
    add(
        &mut digest,
        &solver
            .solve(&tooled.with_traversal(Traversal::Cyclic))
            .unwrap(),
    );
    for goal in [
        PoseBounds::position(),
        PoseBounds::free_about(Axis::Z),
        PoseBounds::within([0.01, 0.0, 0.02, 0.0, 0.3, f64::INFINITY]),
    ] {
        let free = Arm::builder(&ur5e, "base", "flange")
            .with_atlas(false)
            .with_goal(goal);
        let free = free.build().unwrap();
        add(
            &mut digest,
            &PathSolver::new(&free)
                .with_samples(24)
                .solve(&path)
                .unwrap(),
        );
    }
    let still = CartesianPath::new(vec![points[0]; 5]).unwrap();
    add(
        &mut digest,
        &PathSolver::new(&arm).with_samples(8).solve(&still).unwrap(),
    );
    let leap = CartesianPath::new(vec![points[0], points[17]]).unwrap();
    add(
        &mut digest,
        &PathSolver::new(&arm).with_samples(16).solve(&leap).unwrap(),
    );
    let planar = planar_with_hand(Limits::new(-3.0, 3.0));
    let there = planar.base_from_tool(&[0.4, 0.8, 0.3]).unwrap();
    let waits = CartesianPath::new(vec![there; 1003]).unwrap();
    let found = PathSolver::new(&planar)
        .with_samples(4)
        .solve(&waits)
        .unwrap();
    digest.doubles([found.length, found.q[3008]]);
    digest.value()
}

/// Chains whose joints follow others.
fn followers() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(44));
    for number in [5, 11] {
        let (text, tip) = follower_chain(number);
        let robot = Robot::parse(&text, "chain.urdf").unwrap();
        let Ok(arm) = Arm::builder(&robot, "l0", tip.as_str())
            .with_atlas(false)
            .build()
        else {
            continue;
        };
        let first = some(&arm, &mut random, None);
        let ends = [first.clone(), some(&arm, &mut random, Some(&first))];
        let path = CartesianPath::new(through(&arm, &ends, 8)).unwrap();
        let solver = PathSolver::new(&arm).with_samples(16).with_start(&first);
        add(&mut digest, &solver.solve(&path).unwrap());
    }
    digest.value()
}

/// Points out of reach, among obstacles, and where only a limit is in the way.
fn misses() -> Value {
    let mut digest = Digest::new();
    let planar = planar_with_hand(Limits::new(-0.2, 0.6));
    let there = planar.base_from_tool(&[0.1, 1.2, 0.3]).unwrap();
    for step in [[0.15, 0.0, 0.0], [-0.1, 0.15, 0.0], [0.0, 0.0, 0.05]] {
        let point = |k: u32| {
            let along = Vector3::from(step) * f64::from(k);
            Placement::new(there.rotation, there.translation + along)
        };
        let path = CartesianPath::new((0..14).map(point).collect::<Vec<_>>()).unwrap();
        add(
            &mut digest,
            &PathSolver::new(&planar)
                .with_samples(16)
                .solve(&path)
                .unwrap(),
        );
    }
    let checked = two_links_by_a_wall();
    for (from, to) in [
        ([0.6, 1.2], [-0.6, 1.2]),
        ([1.5, -1.4], [-0.2, -0.9]),
        ([0.8, 0.4], [0.1, 1.0]),
    ] {
        let points = through(&checked, &[from.to_vec(), to.to_vec()], 12);
        let path = CartesianPath::new(points).unwrap();
        add(
            &mut digest,
            &PathSolver::new(&checked)
                .with_samples(8)
                .solve(&path)
                .unwrap(),
        );
    }
    digest.value()
}

/// Two links of half a metre with shapes beside a box, whose tool is a place.
pub(crate) fn two_links_by_a_wall() -> Arm {
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><collision><origin xyz=\"0.25 0 0\"/><geometry><box size=\"0.5 0.05 0.05\"/></geometry></collision></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str, x: f64| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/><origin xyz=\"{x} 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-2.5\" upper=\"2.5\"/></joint>"
        )
    };
    let text = format!(
        "<robot name=\"r\"><link name=\"base\"/>{}{}<link name=\"tip\"/>{}{}<joint name=\"end\" type=\"fixed\"><parent link=\"lower\"/><child link=\"tip\"/><origin xyz=\"0.5 0 0\"/></joint></robot>",
        link("upper"),
        link("lower"),
        joint("shoulder", "base", "upper", 0.0),
        joint("elbow", "upper", "lower", 0.5)
    );
    let robot = Robot::parse(&text, "r.urdf").unwrap();
    let world = World::from_json(
        br#"{"boxes": [{"name": "wall", "size": [0.2, 0.2, 0.4], "position": [0.75, 0.1, 0.0]}]}"#,
        "w.json",
    );
    let checker = Checker::new(CollisionModel::of(&robot).unwrap());
    let checker = checker.with_world(&world.unwrap()).unwrap();
    let arm = Arm::builder(&robot, "base", "tip")
        .with_goal(PoseBounds::position())
        .with_atlas(false);
    arm.build()
        .unwrap()
        .with_checker(&checker, &[0.0; 2])
        .unwrap()
}

#[test]
fn of_paths_under_options() {
    let [plain, asked] = options();
    check(&[
        ("paths through joints", plain),
        ("paths under options", asked),
    ]);
}

#[test]
fn of_rings_goals_and_misses() {
    check(&[
        ("paths round and round", rings()),
        ("paths of several tools, and with room", goals()),
        ("paths of joints that follow others", followers()),
        ("paths that are missed or in the way", misses()),
    ]);
}
