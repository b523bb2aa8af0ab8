//! Promise: eight configurations in lanes, by spheres about the links, and shapes one by one never contradict each other: what is clear by
//! its spheres touches nothing, and links and obstacles of any number are apart by the margin.

use kinopt::arm::{Arm, Search};
use kinopt::collision::{
    Checker, CollisionModel, CollisionObject, Resolution, Shape, SphereModel, World,
};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::random::Random;
use support::sample::cases;

use crate::arms_keep_clear::{cluttered, drawn, panda};

#[test]
fn what_is_clear_by_its_spheres_touches_nothing() {
    let mut random = Random::new(9);
    let panda = panda(Search::Start).among(&cluttered(&mut random), 0.01);
    let count = cases(1001, 101);
    let q: Vec<f64> = (0..count).flat_map(|_| panda.drawn(&mut random)).collect();
    let mut clear = vec![false; count];
    panda.arm.clear_by_spheres(&q, &mut clear).unwrap();
    for (place, (q, clear)) in q.chunks(7).zip(&clear).enumerate() {
        // Its neighbours in the lanes say nothing about it.
        let mut alone = [false];
        panda.arm.clear_by_spheres(q, &mut alone).unwrap();
        assert_eq!(alone, [*clear], "{place}");
        assert!(!clear || panda.arm.collisions(q).unwrap().is_empty());
    }
    assert!(clear.iter().any(|clear| *clear));
    let mut bad = q[..7].to_vec();
    bad[3] = f64::NAN;
    let refused = panda.arm.clear_by_spheres(&bad, &mut [true]);
    assert!(refused.unwrap_err().to_string().contains("joint4"));
    // Of several the joint is told, not the place among all numbers.
    let bad = [&q[..14], &bad].concat();
    let refused = panda.arm.clear_by_spheres(&bad, &mut [true; 3]);
    assert!(refused.unwrap_err().to_string().contains("joint4"));
    assert!(panda.arm.clear_by_spheres(&q[..6], &mut [true]).is_err());
}

/// Two plates three centimetres apart, the upper of which turns on a shaft.
const PLATES: &str = r#"<robot name="plates"><link name="lower"><collision><geometry><box size="0.4 0.4 0.02"/></geometry></collision></link>
    <link name="shaft"/><link name="upper"><collision><geometry><box size="0.4 0.4 0.02"/></geometry></collision></link>
    <joint name="turn" type="continuous"><parent link="lower"/><child link="shaft"/><axis xyz="0 0 1"/></joint>
    <joint name="lift" type="prismatic"><parent link="shaft"/><child link="upper"/><origin xyz="0 0 0.05"/><axis xyz="0 0 1"/>
    <limit lower="-0.025" upper="0.02"/></joint></robot>"#;

/// Links so close that spheres do not tell them apart are as far apart as the margin says, too, where an arm is clear.
#[test]
fn close_links_keep_the_margin() {
    let robot = Robot::parse(PLATES, "plates.urdf").unwrap();
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_checked("lower", "upper").unwrap();
    let spheres = SphereModel::of(&bodies, Resolution::Overhang(0.03)).unwrap();
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

/// Two sides that turn on one middle, one above the other.
const SIDES: &str = r#"<robot name="sides"><link name="middle"/>
    <link name="low"><collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
    <link name="high"><collision><origin xyz="0.5 0 1"/><geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="first" type="revolute"><parent link="middle"/><child link="low"/><axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint>
    <joint name="second" type="revolute"><parent link="middle"/><child link="high"/><axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint>
    </robot>"#;

#[test]
fn what_stands_is_met_where_it_is_though_a_joint_of_the_arm_turns_its_base() {
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

/// Spheres that were made of a robot without one of its links say nothing of that link: the shapes do.
#[test]
fn a_link_that_has_no_spheres_is_met_by_its_shape() {
    let robot = Robot::parse(SIDES, "sides.urdf").unwrap();
    let model = robot.model();
    let [low, high] = ["low", "high"].map(|name| {
        let at = Vector3::new(0.5, 0.0, if name == "low" { 0.0 } else { 1.0 });
        let link = model.frame(name).unwrap();
        let ball = Shape::sphere(0.1).unwrap();
        CollisionObject::new(name, link, Placement::translation(at), ball)
    });
    let few = CollisionModel::new(model, vec![low.clone()]).unwrap();
    let spheres = SphereModel::of(&few, Resolution::Overhang(0.01)).unwrap();
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
fn many_obstacles_are_found_through_their_tree_as_one_by_one() {
    // As many small boxes as a wall has, once as obstacles of their own and once as one.
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
    let bricks = panda(Search::Start).among(&many, 0.0);
    let wall = panda(Search::Start).among(&one, 0.0);
    let mut random = Random::new(5);
    for _ in 0..cases(60, 10) {
        let (goal, start) = (wall.free(&mut random), wall.drawn(&mut random));
        let target = wall.arm.base_from_tool(&goal).unwrap();
        let [a, b] = [&bricks, &wall].map(|p| p.arm.solve(target, &start).unwrap());
        assert_eq!((a.q, a.reached), (b.q, b.reached));
    }
}

#[test]
fn what_stands_in_thousands_is_found_as_it_is_part_by_part() {
    found_as_part_by_part([700, 4000], 0.01);
    // Few points that are as thick as a link.
    found_as_part_by_part([300, 120], 0.08);
}

/// Balls, a cloud of points so thick and a floor; in parts so small that each is looked at one after another.
fn found_as_part_by_part([balls, points]: [usize; 2], thick: f64) {
    let mut random = Random::new(77);
    let balls: Vec<_> = (0..balls).map(|_| beside(&mut random)).collect();
    let points: Vec<_> = (0..points).map(|_| beside(&mut random)).collect();
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
    let many = panda(Search::Start).among(&whole, 0.01);
    let parts: Vec<_> = (parts.iter())
        .map(|part| panda(Search::Start).among(part, 0.01))
        .collect();
    let drawn: Vec<f64> = (0..cases(4000, 200))
        .flat_map(|_| many.drawn(&mut random))
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
    // What is remembered of the first time changes nothing.
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

/// Somewhere within reach, but not at the base.
fn beside(random: &mut Random) -> Vector3<f64> {
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
fn pairs_that_are_added_after_the_spheres_were_made_are_kept_apart_too() {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let all: Vec<_> = bodies.pairs().to_vec();
    let none = all.iter().fold(bodies.clone(), |model, [a, b]| {
        model.with_ignored(*a, *b).unwrap()
    });
    let spheres = SphereModel::of(&none, Resolution::Overhang(0.03)).unwrap();
    let checker = Checker::new(bodies).with_spheres(spheres);
    let rest = vec![0.0; robot.model().configuration_len()];
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let arm = arm.with_checker(&checker, &rest).unwrap();
    let mut random = Random::new(8);
    let mut touching = 0;
    for _ in 0..cases(200, 60) {
        let q = drawn(&arm, &mut random);
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

/// Links are kept apart by the whole margin, whichever of two is looked at first.
#[test]
fn what_is_clear_by_its_spheres_is_clear_by_a_wide_margin() {
    let mut random = Random::new(10);
    for margin in [0.05, 0.1, 0.15] {
        let mut panda = panda(Search::Start);
        // Pairs are left out until some configuration has all others farther apart.
        loop {
            let checker = panda.checker.clone().with_margin(margin).unwrap();
            let mut q = panda.q_model.clone();
            let drawn = panda.drawn(&mut random);
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
        // A narrower one of before counts no more.
        let mut panda = panda.among(&World::new(), 0.0);
        panda.arm = panda.arm.with_world(&World::new(), margin).unwrap();
        let count = cases(1000, 200);
        let q: Vec<f64> = (0..count).flat_map(|_| panda.drawn(&mut random)).collect();
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

/// An arm that keeps clear of nothing does not call anything free.
#[test]
fn of_a_plain_arm_it_is_not_known_what_it_touches() {
    let plain = kinopt::Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let q = [0.0; 7];
    let told = plain.collisions(&q).unwrap_err().to_string();
    assert!(told.contains("not known"), "{told}");
    assert!(plain.clear_by_spheres(&q, &mut [true]).is_err());
    let told = plain
        .with_world(&World::new(), None)
        .unwrap_err()
        .to_string();
    assert!(!told.contains("with_checker"), "{told}");
}
