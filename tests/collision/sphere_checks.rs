//! Promise: batched sphere checks and exact shape checks never contradict each other. A configuration that is clear by
//! spheres is collision-free, with the margin, for any number of links and obstacles.

use kinopt::arm::{Arm, Search};
use kinopt::collision::{
    Checker, CollisionModel, CollisionObject, Resolution, Shape, SphereModel, World,
};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::checked_arms::{cluttered, panda};
use support::fault_tables::ExpectedError;
use support::random::{Random, case_count, cases};

#[test]
fn clear_by_spheres_is_collision_free() {
    let mut random = Random::new(9);
    let panda = panda(Search::Start).with_world(&cluttered(&mut random), 0.01);
    let count = case_count(1001, 101);
    let q: Vec<f64> = (0..count)
        .flat_map(|_| random.configuration(&panda.arm))
        .collect();
    let mut clear = vec![false; count];
    panda.arm.clear_by_spheres(&q, &mut clear).unwrap();
    for (index, (q, clear)) in q.chunks(7).zip(&clear).enumerate() {
        // Neighbouring lanes have no influence.
        let mut alone = [false];
        panda.arm.clear_by_spheres(q, &mut alone).unwrap();
        assert_eq!(alone, [*clear], "{index}");
        assert!(!clear || panda.arm.collisions(q).unwrap().is_empty());
    }
    assert!(clear.iter().any(|clear| *clear));
    let mut invalid = q[..7].to_vec();
    invalid[3] = f64::NAN;
    let refused = panda.arm.clear_by_spheres(&invalid, &mut [true]);
    refused.says("joint4");
    // The error names the joint, not the index among all numbers.
    let invalid = [&q[..14], &invalid].concat();
    let refused = panda.arm.clear_by_spheres(&invalid, &mut [true; 3]);
    refused.says("joint4");
    assert!(panda.arm.clear_by_spheres(&q[..6], &mut [true]).is_err());
}

/// Two plates 3 cm apart; the upper rotates on a shaft.
const PLATES: &str = r#"<robot name="plates"><link name="lower"><collision><geometry><box size="0.4 0.4 0.02"/></geometry></collision></link>
    <link name="shaft"/><link name="upper"><collision><geometry><box size="0.4 0.4 0.02"/></geometry></collision></link>
    <joint name="turn" type="continuous"><parent link="lower"/><child link="shaft"/><axis xyz="0 0 1"/></joint>
    <joint name="lift" type="prismatic"><parent link="shaft"/><child link="upper"/><origin xyz="0 0 0.05"/><axis xyz="0 0 1"/>
    <limit lower="-0.025" upper="0.02"/></joint></robot>"#;

/// Links too close for spheres to separate still keep the margin if the arm is clear.
#[test]
fn close_links_keep_the_margin() {
    let robot = Robot::parse(PLATES, "plates.urdf").unwrap();
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_checked("lower", "upper").unwrap();
    let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.03)).unwrap();
    let checker = Checker::new(bodies).with_spheres(spheres);
    let checker = checker.with_margin(0.02).unwrap();
    let arm = Arm::builder(&robot, "lower", "upper").with_atlas(false);
    let arm = arm
        .build()
        .unwrap()
        .with_checker(&checker, &[0.0; 2])
        .unwrap();
    for (lift, is_clear) in [
        (0.0, true),
        (0.015, true),
        (-0.009, true),
        (-0.011, false),
        (-0.02, false),
    ] {
        for turn in [0.0, 0.7, 2.0] {
            let mut clear = [!is_clear];
            arm.clear_by_spheres(&[turn, lift], &mut clear).unwrap();
            let touched = arm.collisions(&[turn, lift]).unwrap();
            assert_eq!(
                (clear[0], touched.is_empty()),
                (is_clear, is_clear),
                "{turn} {lift}"
            );
        }
    }
}

/// Two links on one base, one above the other.
const SIDES: &str = r#"<robot name="sides"><link name="middle"/>
    <link name="low"><collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
    <link name="high"><collision><origin xyz="0.5 0 1"/><geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="first" type="revolute"><parent link="middle"/><child link="low"/><axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint>
    <joint name="second" type="revolute"><parent link="middle"/><child link="high"/><axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint>
    </robot>"#;

#[test]
fn obstacles_are_checked_if_the_base_rotates() {
    let robot = Robot::parse(SIDES, "sides.urdf").unwrap();
    let mut world = World::new();
    for (name, height) in [("below", 0.0), ("above", 1.0)] {
        let at = Vector3::new(0.5 * 1.0_f64.cos(), 0.5 * 1.0_f64.sin(), height);
        world.add_sphere(name, 0.1, at).unwrap();
    }
    let checker = Checker::covered(CollisionModel::of(&robot).unwrap());
    let checker = checker.with_world(&world).unwrap();
    let arm = Arm::builder(&robot, "low", "high").with_atlas(false);
    let arm = arm.build().unwrap();
    let arm = arm.with_checker(&checker, &[0.0; 2]).unwrap();
    for first in [-1.0, 0.0, 0.4, 1.0, 1.7] {
        for second in [-1.0, 0.0, 0.4, 1.0, 1.7] {
            let mut clear = [false];
            arm.clear_by_spheres(&[first, second], &mut clear).unwrap();
            assert_eq!(clear[0], first != 1.0 && second != 1.0, "{first} {second}");
        }
    }
}

/// Spheres of a robot without one of its links say nothing about that link; its shapes decide.
#[test]
fn link_without_spheres_is_checked_by_shape() {
    let robot = Robot::parse(SIDES, "sides.urdf").unwrap();
    let model = robot.model();
    let [low, high] = ["low", "high"].map(|name| {
        let at = Vector3::new(0.5, 0.0, if name == "low" { 0.0 } else { 1.0 });
        let link = model.frame(name).unwrap();
        let ball = Shape::sphere(0.1).unwrap();
        CollisionObject::new(name, link, Placement::translation(at), ball)
    });
    let few = CollisionModel::new(model, vec![low.clone()]).unwrap();
    let spheres = SphereModel::of(&few, Resolution::MaxProtrusion(0.01)).unwrap();
    let mut world = World::new();
    let at = Vector3::new(0.5, 0.0, 1.0);
    world.add_sphere("above", 0.1, at).unwrap();
    let checker = Checker::new(CollisionModel::new(model, vec![low, high]).unwrap());
    let checker = checker.with_world(&world).unwrap().with_spheres(spheres);
    let arm = Arm::builder(&robot, "middle", "high").with_atlas(false);
    let arm = arm.build().unwrap();
    let arm = arm.with_checker(&checker, &[0.0; 2]).unwrap();
    for (turn, is_clear) in [(0.0, false), (0.2, false), (1.0, true)] {
        let mut clear = [!is_clear];
        arm.clear_by_spheres(&[turn], &mut clear).unwrap();
        assert_eq!(clear[0], is_clear, "{turn}");
    }
}

#[test]
fn obstacle_tree_equals_single_checks() {
    // Small boxes as in a wall, once as separate obstacles and once as one.
    let (mut many, mut one) = (World::new(), World::new());
    for y in -6..=6 {
        for z in 0..=12 {
            let at = Vector3::new(0.45, f64::from(y) * 0.1, f64::from(z) * 0.1);
            many.add_box(&format!("brick {y} {z}"), [0.1; 3], at)
                .unwrap();
        }
    }
    one.add_box("wall", [0.1, 1.3, 1.3], Vector3::new(0.45, 0.0, 0.6))
        .unwrap();
    let bricks = panda(Search::Start).with_world(&many, 0.0);
    let wall = panda(Search::Start).with_world(&one, 0.0);
    let mut random = Random::new(5);
    for _ in cases(60, 10) {
        let (goal, start) = (
            wall.collision_free_configuration(&mut random),
            random.configuration(&wall.arm),
        );
        let target = wall.arm.base_from_tool(&goal).unwrap();
        let [a, b] = [&bricks, &wall].map(|p| p.arm.solve(target, &start).unwrap());
        assert_eq!((a.q, a.reached), (b.q, b.reached));
    }
}

#[test]
fn large_worlds_equal_their_parts() {
    assert_equals_part_by_part([700, 4000], 0.01);
    // Few points as thick as a link.
    assert_equals_part_by_part([300, 120], 0.08);
}

/// Spheres, a point cloud and a floor; and the same in parts that are small enough to be checked one by one.
fn assert_equals_part_by_part([balls, points]: [usize; 2], thick: f64) {
    let mut random = Random::new(77);
    let balls: Vec<_> = (0..balls).map(|_| random_point(&mut random)).collect();
    let points: Vec<_> = (0..points).map(|_| random_point(&mut random)).collect();
    let floor = Placement::translation(Vector3::new(0.0, 0.0, -0.3));
    let mut whole = World::new();
    whole.add("floor", Shape::half_space(), floor).unwrap();
    whole
        .add(
            "cloud",
            Shape::points(points.clone(), thick).unwrap(),
            Vector3::zero(),
        )
        .unwrap();
    let mut parts = vec![World::new()];
    parts[0].add("floor", Shape::half_space(), floor).unwrap();
    for (index, &at) in balls.iter().enumerate() {
        whole
            .add_sphere(&format!("ball {index}"), 0.02, at)
            .unwrap();
        if index % 350 == 0 {
            parts.push(World::new());
        }
        let part = parts.last_mut().unwrap();
        part.add_sphere(&format!("ball {index}"), 0.02, at).unwrap();
    }
    for few in points.chunks(30) {
        let part = parts.last_mut().unwrap();
        let name = format!("cloud {}", part.obstacles().len());
        part.add(
            &name,
            Shape::points(few.to_vec(), thick).unwrap(),
            Vector3::zero(),
        )
        .unwrap();
    }
    let many = panda(Search::Start).with_world(&whole, 0.01);
    let parts: Vec<_> = (parts.iter())
        .map(|part| panda(Search::Start).with_world(part, 0.01))
        .collect();
    let drawn: Vec<f64> = (0..case_count(4000, 200))
        .flat_map(|_| random.configuration(&many.arm))
        .collect();
    let count = drawn.len() / 7;
    let mut by_parts = vec![true; count];
    let mut clear = vec![false; count];
    for part in &parts {
        part.arm.clear_by_spheres(&drawn, &mut clear).unwrap();
        for (all, clear) in by_parts.iter_mut().zip(&clear) {
            *all &= clear;
        }
    }
    // Cached data of the first query changes nothing.
    for _ in 0..2 {
        many.arm.clear_by_spheres(&drawn, &mut clear).unwrap();
        assert_eq!(clear, by_parts);
    }
    let free = clear.iter().filter(|clear| **clear).count();
    assert!(
        free > count / 20 && free < count - count / 20,
        "{free} of {count}"
    );
}

/// Random point within reach, off the base.
fn random_point(random: &mut Random) -> Vector3<f64> {
    loop {
        let at = Vector3::new(
            random.within(-0.9, 0.9),
            random.within(-0.9, 0.9),
            random.within(-0.2, 1.0),
        );
        if at.x.hypot(at.y) > 0.35 {
            return at;
        }
    }
}

#[test]
fn pairs_added_after_spheres_are_checked() {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let all: Vec<_> = bodies.pairs().to_vec();
    let none = all.iter().fold(bodies.clone(), |model, [a, b]| {
        model.with_ignored(*a, *b).unwrap()
    });
    let spheres = SphereModel::of(&none, Resolution::MaxProtrusion(0.03)).unwrap();
    let checker = Checker::new(bodies).with_spheres(spheres);
    let rest = vec![0.0; robot.model().configuration_len()];
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let arm = arm.with_checker(&checker, &rest).unwrap();
    let mut random = Random::new(8);
    let mut touching = 0;
    for _ in cases(200, 60) {
        let q = random.configuration(&arm);
        if arm.collisions(&q).unwrap().is_empty() {
            continue;
        }
        touching += 1;
        let solution = arm.solve(arm.base_from_tool(&q).unwrap(), &q).unwrap();
        assert_eq!(
            solution.reached,
            arm.collisions(&solution.q).unwrap().is_empty()
        );
    }
    assert!(touching > 2, "{touching}");
}

/// Links keep the whole margin, in either order of a pair.
#[test]
fn clear_by_spheres_keeps_a_wide_margin() {
    let mut random = Random::new(10);
    for margin in [0.05, 0.1, 0.15] {
        let mut panda = panda(Search::Start);
        // Disables pairs until some configuration has all others farther apart.
        loop {
            let checker = panda.checker.clone().with_margin(margin).unwrap();
            let mut q = panda.q_model.clone();
            let drawn = random.configuration(&panda.arm);
            panda.arm.configuration(&drawn, &mut q).unwrap();
            let touched = checker.collisions(&q).unwrap();
            let Some(pair) = touched.first() else {
                break;
            };
            let bodies = checker.model().clone();
            let ends = (pair.first.as_str(), pair.second.as_str());
            let bodies = bodies.with_ignored(ends.0, ends.1).unwrap();
            let spheres = checker.spheres().unwrap().clone();
            panda.checker = Checker::new(bodies).with_spheres(spheres);
        }
        // An earlier, smaller margin no longer applies.
        let mut panda = panda.with_world(&World::new(), 0.0);
        panda.arm = panda.arm.with_world(&World::new(), margin).unwrap();
        let count = case_count(1000, 200);
        let q: Vec<f64> = (0..count)
            .flat_map(|_| random.configuration(&panda.arm))
            .collect();
        let mut clear = vec![false; count];
        panda.arm.clear_by_spheres(&q, &mut clear).unwrap();
        let mut near = 0;
        for (q, clear) in q.chunks(7).zip(&clear) {
            let touched = panda.arm.collisions(q).unwrap();
            near += usize::from(!touched.is_empty());
            assert!(!clear || touched.is_empty(), "{margin}: {touched:?}");
        }
        assert!(
            near > 0 && clear.iter().any(|clear| *clear),
            "{margin}: {near}"
        );
    }
}

/// An arm without a checker reports no configuration as free.
#[test]
fn arm_without_checker_reports_an_error() {
    let plain = kinopt::Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let q = [0.0; 7];
    plain.collisions(&q).says("are unknown");
    assert!(plain.clear_by_spheres(&q, &mut [true]).is_err());
    let message = plain
        .with_world(&World::new(), None)
        .unwrap_err()
        .to_string();
    assert!(!message.contains("with_checker"), "{message}");
}
