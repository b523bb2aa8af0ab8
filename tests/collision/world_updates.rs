//! Promise: after any sequence of edits an updated checker and arm give bitwise the results of a rebuilt world. Those
//! of the earlier world are unchanged.

use kinopt::arm::Arm;
use kinopt::collision::{Checker, Shape, World};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::robot;
use support::random::{Random, case_count};

/// Largest number of edits between two comparisons.
const MAX_CHANGES: usize = 40;
/// Distance limit of nearest queries, metres.
const MAX_QUERY_DISTANCE: f64 = 0.1;

fn vector(random: &mut Random, size: f64) -> Vector3<f64> {
    let drawn = random.vector(size);
    Vector3::new(drawn.x, drawn.y, drawn.z)
}

fn random_placement(random: &mut Random) -> Placement<f64> {
    let turn = rotation_exp(vector(random, 2.0));
    loop {
        let at = vector(random, 1.2);
        // Not at the arm's base.
        if at.norm() > 0.5 {
            return Placement::new(turn, at);
        }
    }
}

fn shape(random: &mut Random) -> Shape {
    let size = |random: &mut Random| random.within(0.005, 0.03);
    match random.below(8) {
        0 => Shape::sphere(size(random)),
        1 => Shape::cylinder(size(random), size(random)),
        2 => Shape::capsule(size(random), size(random)),
        3 => {
            let corners: Vec<_> = (0..8).map(|_| vector(random, 0.03)).collect();
            Shape::convex(&corners)
        }
        4 => {
            let points = (0..50).map(|_| vector(random, 0.03)).collect();
            Shape::points(points, 0.005)
        }
        _ => Shape::cuboid([size(random), size(random), size(random)]),
    }
    .unwrap()
}

/// Rebuilds a world with the same obstacles in the same order.
fn rebuilt(world: &World) -> World {
    let mut anew = World::new();
    for obstacle in world.obstacles() {
        anew.add(&obstacle.name, obstacle.shape.clone(), obstacle.placement)
            .unwrap();
        if let Some(frame) = &obstacle.attached {
            anew.attach(&obstacle.name, frame, obstacle.placement)
                .unwrap();
        }
    }
    for obstacle in world.obstacles() {
        for other in &obstacle.allowed_collisions {
            anew.allow_collision(&obstacle.name, other).unwrap();
        }
    }
    anew
}

fn change(world: &mut World, added: &mut usize, random: &mut Random) {
    let any = |world: &World, random: &mut Random| {
        let at = random.below(world.len().max(1));
        world
            .obstacles()
            .nth(at)
            .map(|obstacle| obstacle.name.clone())
    };
    let Some(name) = any(world, random) else {
        return;
    };
    let attached = world.obstacle(&name).unwrap().attached.is_some();
    match random.below(12) {
        10 => {
            let links = ["link5", "hand", "link3", "finger_left"];
            let other = any(world, random).filter(|_| random.below(2) == 0);
            let other = other.unwrap_or_else(|| links[random.below(4)].to_owned());
            world.allow_collision(&name, &other).unwrap();
        }
        11 => {
            let let_touch = world
                .obstacles()
                .find(|obstacle| !obstacle.allowed_collisions.is_empty());
            if let Some(obstacle) = let_touch.cloned() {
                world
                    .forbid_collision(&obstacle.allowed_collisions[0], &obstacle.name)
                    .unwrap();
            }
        }
        0 | 1 => {
            *added += 1;
            let (shape, placement) = (shape(random), random_placement(random));
            world
                .add(&format!("added {added}"), shape, placement)
                .unwrap();
        }
        2 | 3 => world.remove(&name).unwrap(),
        4 if random.below(4) == 0 && !attached => {
            world
                .attach(&name, "hand", Vector3::new(0.0, 0.0, 0.15))
                .unwrap();
        }
        _ if attached => world.detach(&name, random_placement(random)).unwrap(),
        _ => world.move_to(&name, random_placement(random)).unwrap(),
    }
}

/// Reports of a checker and an arm at random configurations.
fn report(checker: &Checker, arm: &Arm, random: &mut Random) -> String {
    let mut text = String::new();
    let mut workspace = checker.workspace();
    let mut from = vec![0.0; checker.model().model().configuration_len()];
    let mut several = Vec::new();
    for index in 0..8 {
        let q = random.configuration(arm);
        several.extend_from_slice(&q);
        // Exact distances to hundreds of obstacles are slow in a debug build.
        if index >= case_count(8, 3) {
            continue;
        }
        let mut to = from.clone();
        to[..q.len()].copy_from_slice(&q);
        let collisions = checker.collisions(&to).unwrap();
        let nearest = checker
            .nearest(&mut workspace, &to, MAX_QUERY_DISTANCE)
            .unwrap();
        let motion = checker.check_motion(&mut workspace, &from, &to).unwrap();
        text += &format!("{collisions:?} {nearest:?} {motion:?}\n");
        from = to;
        if index % 4 == 0 {
            let target = arm.base_from_tool(&q).unwrap();
            let solution = arm.solve(target, &random.configuration(arm)).unwrap();
            let touched = solution.collisions();
            text += &format!("{:?} {:?} {touched:?}\n", solution.q, solution.reached);
        }
    }
    let mut clear = [false; 8];
    arm.clear_by_spheres(&several, &mut clear).unwrap();
    text + &format!("{clear:?}")
}

/// Starts with `count` obstacles and makes `rounds` of edits.
fn go_along(count: usize, rounds: usize, seed: u64) {
    let robot = robot("franka_panda");
    let plain = Checker::of(&robot).unwrap().with_margin(0.005).unwrap();
    let rest = robot.model().neutral();
    let mut random = Random::new(seed);
    let mut world = World::new();
    world
        .add_plane("floor", Vector3::new(0.0, 0.0, -0.5))
        .unwrap();
    for index in 0..count {
        let (shape, placement) = (shape(&mut random), random_placement(&mut random));
        world
            .add(&format!("obstacle {index}"), shape, placement)
            .unwrap();
    }
    let mut checker = plain.clone().with_world(&world).unwrap();
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let mut arm = arm.with_checker(&checker, &rest).unwrap();
    let (mut added, mut branch) = (0, world.clone());
    for round in 0..rounds {
        let mut fork = Random::new(1000 + round as u64);
        let new_random = || Random::new(round as u64);
        let before = report(&checker, &arm, &mut new_random());
        let known = (checker.clone(), arm.clone());
        for _ in 0..1 + random.below(MAX_CHANGES) {
            change(&mut world, &mut added, &mut random);
            if random.below(3) == 0 {
                checker = checker.with_world(&world).unwrap();
                arm = arm.with_world(&world, None).unwrap();
            }
        }
        checker = checker.with_world(&world).unwrap();
        arm = arm.with_world(&world, None).unwrap();
        let fresh = plain.clone().with_world(&rebuilt(&world)).unwrap();
        let fresh_arm = known.1.clone().with_checker(&fresh, &rest).unwrap();
        let expected = report(&fresh, &fresh_arm, &mut new_random());
        assert!(
            report(&checker, &arm, &mut new_random()) == expected,
            "round {round}"
        );
        assert!(
            report(&known.0, &known.1, &mut new_random()) == before,
            "round {round}"
        );
        // A copy from some rounds ago, with the same new names for other obstacles.
        let mut of_fork = added;
        for _ in 0..3 {
            change(&mut branch, &mut of_fork, &mut fork);
        }
        let branched = checker.clone().with_world(&branch).unwrap();
        let arm_there = arm.with_world(&branch, None).unwrap();
        let fresh = plain.clone().with_world(&rebuilt(&branch)).unwrap();
        let fresh_arm = known.1.with_checker(&fresh, &rest).unwrap();
        let expected = report(&fresh, &fresh_arm, &mut new_random());
        assert!(
            report(&branched, &arm_there, &mut new_random()) == expected,
            "round {round}"
        );
        if random.below(3) == 0 {
            branch = world.clone();
        }
    }
}

#[test]
fn few_obstacles_equal_a_rebuilt_world() {
    go_along(20, case_count(12, 3), 1);
}

#[test]
fn listed_obstacles_equal_a_rebuilt_world() {
    go_along(511, case_count(12, 3), 2);
}

#[test]
fn many_obstacles_equal_a_rebuilt_world() {
    go_along(1000, case_count(8, 2), 3);
}

fn add_small(world: &mut World, index: usize) {
    let at = Vector3::new(0.4, 0.0, 1.0) * (1.0 + 1e-4 * index as f64);
    let name = format!("small {index}");
    world.add_sphere(&name, 1e-4, at).unwrap();
}

fn add_big(world: &mut World) {
    let position = Vector3::new(0.3, 0.0, 0.6);
    world.add_sphere("big", 0.25, position).unwrap();
}

/// An arm without a world, and random configurations.
struct CheckedArm {
    plain: Checker,
    rest: Vec<f64>,
    arm: Arm,
    q: Vec<f64>,
}

impl CheckedArm {
    fn new() -> Self {
        let robot = robot("franka_panda");
        let arm = Arm::builder(&robot, "base", "flange").with_atlas(false);
        let arm = arm.build().unwrap();
        let mut random = Random::new(12);
        Self {
            plain: Checker::of(&robot).unwrap(),
            rest: robot.model().neutral(),
            q: (0..40).flat_map(|_| random.configuration(&arm)).collect(),
            arm,
        }
    }

    fn clear_among(&self, arm: &Arm) -> [bool; 40] {
        let mut clear = [false; 40];
        arm.clear_by_spheres(&self.q, &mut clear).unwrap();
        clear
    }

    /// Checks that an arm updated from one world to another equals one that never had the first.
    fn goes_along(&self, from: &World, to: &World) {
        let [known, fresh] = [from, &rebuilt(to)].map(|world| {
            let checker = self.plain.clone().with_world(world).unwrap();
            self.arm.clone().with_checker(&checker, &self.rest).unwrap()
        });
        let clear = self.clear_among(&known.with_world(to, None).unwrap());
        assert_eq!(clear, self.clear_among(&fresh));
        assert!(clear != self.clear_among(&known));
    }
}

/// Up to 512 obstacles are checked one by one, more through a tree.
#[test]
fn removal_holds_across_list_and_tree() {
    let case = CheckedArm::new();
    for (before, after) in [(513, 510), (510, 514), (520, 519), (20, 22)] {
        let mut world = World::new();
        add_big(&mut world);
        (0..before).for_each(|index| add_small(&mut world, index));
        let known = world.clone();
        world.remove("big").unwrap();
        for index in after..before {
            world.remove(&format!("small {index}")).unwrap();
        }
        (before..after).for_each(|index| add_small(&mut world, index));
        case.goes_along(&known, &world);
    }
}

#[test]
fn edits_of_a_diverged_copy_have_no_effect() {
    let mut one = World::new();
    (0..3).for_each(|index| add_small(&mut one, index));
    let mut other = one.clone();
    add_small(&mut one, 3);
    one.remove("small 3").unwrap();
    add_big(&mut one);
    add_small(&mut other, 4);
    let case = CheckedArm::new();
    case.goes_along(&one, &other);
    case.goes_along(&other, &one);
}

#[test]
fn names_are_found_in_any_order() {
    let mut random = Random::new(4);
    let mut world = World::new();
    let mut names: Vec<String> = Vec::new();
    for step in 0..3000 {
        let name = format!("ball {step}");
        world.add_sphere(&name, 0.1, Vector3::zero()).unwrap();
        assert!(world.add_sphere(&name, 0.1, Vector3::zero()).is_err());
        names.push(name);
        if random.below(5) < 2 {
            let gone = names.remove(random.below(names.len()));
            let before = world.clone();
            world.remove(&gone).unwrap();
            assert!(world.obstacle(&gone).is_err() && world.remove(&gone).is_err());
            assert!(before.obstacle(&gone).is_ok());
        }
    }
    assert_eq!(world.len(), names.len());
    assert_eq!(world.obstacles().len(), names.len());
    assert!(world.obstacles().map(|obstacle| &obstacle.name).eq(&names));
    assert!(
        names
            .iter()
            .all(|name| world.obstacle(name).unwrap().name == *name)
    );
    while let Some(name) = names.pop() {
        world.remove(&name).unwrap();
    }
    assert!(world.is_empty() && world.obstacles().next().is_none());
}
