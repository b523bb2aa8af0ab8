//! Promise: so it is for arms that keep clear, with all that arms and checkers can be told drawn at random: spheres of every kind, margins,
//! few and many obstacles, some attached and some that may touch; asked alone, together, in a row, by servo and as a path, in one world after the other.
#![allow(clippy::unwrap_used)]

use kinopt::Solution;
use kinopt::arm::{Arm, Axis, PoseBounds, Search};
use kinopt::collision::{Checker, CollisionModel, Resolution, Shape, SphereModel, World};
use kinopt::motion::path::{CartesianPath, PathSolver, Traversal};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;

use crate::checker_mixes::spheres;
use crate::digest::{Digest, Value, check};
use crate::every_joint::{place, vector};
use crate::shape_mixes::shape;
use support::random::Random;

/// Not where an arm is mounted.
fn aside(random: &mut Random) -> Placement<f64> {
    loop {
        let at = place(random, 0.9);
        if at.translation.norm() > 0.45 {
            return at;
        }
    }
}

fn world(random: &mut Random, count: usize, size: f64) -> World {
    let mut world = World::new();
    for k in 0..count {
        let kind = match count > 100 {
            true => [0, 3][k % 2],
            false => random.below(6),
        };
        let own = shape(random, kind, size);
        world
            .add(&format!("thing {k}"), own, aside(random))
            .unwrap();
    }
    world
}

/// One change, of those that a cell sees.
fn change(world: &mut World, random: &mut Random, links: &[&str]) {
    let link = links[random.below(links.len())];
    let new = format!("new {}", world.revision());
    let at = random.below(world.len().clamp(1, 8));
    let name = world.obstacles().nth(at).map(|own| own.name.clone());
    let name = name.unwrap_or_default();
    let hand = Placement::translation(Vector3::new(0.0, 0.0, 0.1) + vector(random, 0.05));
    // What is refused leaves the world as it is.
    let _ = match random.below(if world.len() > 100 { 9 } else { 7 }) {
        0 => world.add(&new, shape(random, 12, 1.0), Vector3::new(0.0, 0.0, -0.02)),
        1 => world.allow_collision(&name, link),
        2 => world.attach(&name, links[links.len() - 1], hand),
        3 => world.detach(&name, aside(random)),
        4 => world.remove(&name),
        5 => world.move_to(&name, aside(random)),
        7 => {
            let grid = (0..64).map(|_| 0.1 * random.unit()).collect();
            let hill = Shape::height_field(grid, 8, [0.1; 2]).unwrap();
            world.add(&new, hill, aside(random))
        }
        8 => world.add(&new, shape(random, 10, 0.3), aside(random)),
        _ => world.add_sphere(&new, 0.05, aside(random)),
    };
}

fn checker(bodies: &CollisionModel, covering: &SphereModel, random: &mut Random) -> Checker {
    match random.below(5) {
        0 => Checker::new(bodies.clone()),
        1 => {
            let share = [0.5, 0.8][random.below(2)];
            Checker::new(bodies.clone()).with_spheres(spheres(bodies, share))
        }
        _ => Checker::new(bodies.clone()).with_spheres(covering.clone()),
    }
}

/// An arm with some of its options.
fn arm(robot: &Robot, tip: &str, random: &mut Random) -> Arm {
    let mut own = Arm::builder(robot, "base", tip).with_atlas(false);
    let attempts = [1_u32, 8, 12, 24][random.below(4)];
    own = own.with_attempts(attempts);
    if random.below(3) == 0 {
        own = own.with_locked(robot.model().moving_joints()[1 + random.below(2)], 0.3);
    }
    let n = own.joints().unwrap().len();
    if random.below(4) == 0 {
        let weights: Vec<f64> = (0..n).map(|_| random.within(0.3, 2.0)).collect();
        own = own.with_joint_weights(&weights);
    }
    if random.below(5) == 0 {
        own = own.with_max_move(&vec![1.2; n]);
    }
    if random.below(5) == 0 {
        own = own.with_posture(&vec![0.4; n]);
    }
    if random.below(5) == 0 {
        own = own.with_iterations([20, 200][random.below(2)]);
    }
    if random.below(3) == 0 {
        own = own.with_tool(Placement::translation(Vector3::new(0.0, 0.02, 0.1)));
    }
    own = own.with_goal(match random.below(5) {
        0 => PoseBounds::free_about(Axis::Z),
        1 => PoseBounds::position(),
        _ => PoseBounds::default(),
    });
    let distinct = Search::Distinct {
        k: 1 + random.below(3),
        distance: 0.1,
    };
    own = own.with_search(match random.below(5) {
        0 => Search::First,
        1 => Search::Nearest,
        2 => distinct,
        _ => Search::Start,
    });
    let own = own.with_global_search_on_miss(random.below(2) == 0);
    // Not all go together.
    own.clone()
        .build()
        .or_else(|_| own.with_search(Search::Start).build())
        .unwrap()
}

/// A walk of so many steps from a place.
fn walk(arm: &Arm, from: &[f64], to: &[f64], steps: u32, share: f64) -> Vec<Placement<f64>> {
    let at = |k: u32| {
        let share = share * f64::from(k) / f64::from(steps);
        let q: Vec<f64> = from
            .iter()
            .zip(to)
            .map(|(a, b)| a + share * (b - a))
            .collect();
        arm.base_from_tool(&q).unwrap()
    };
    (0..=steps).map(at).collect()
}

/// One door of an arm, of the first so many.
fn ask(digest: &mut Digest, arm: &Arm, doors: usize, random: &mut Random) {
    let mut drawn = Random::split_mix(random.bits());
    let n = arm.joint_count();
    let [start, there, other] = [(); 3].map(|()| drawn.configuration(arm));
    let mut target = arm.base_from_tool(&there).unwrap();
    match random.below(doors) {
        0 => digest.told(&arm.solve(target, &start).unwrap()),
        1 | 2 => {
            // Out of reach.
            target.translation = target.translation * [1.0, 3.0][random.below(2)];
            let mut solution = Solution::default();
            for start in [&start, &other] {
                arm.solve_into(target, start, &mut solution).unwrap();
                digest.told(&solution);
            }
        }
        3 => {
            let targets = [target, arm.base_from_tool(&other).unwrap(), target];
            let starts = [&start[..], &start, &there].concat();
            for solution in arm.solve_batch(&targets, &starts).unwrap() {
                digest.told(&solution);
            }
            for solution in arm.solve_all(target, &start).unwrap() {
                digest.told(&solution);
            }
        }
        4 => {
            let track = arm
                .track(&walk(arm, &start, &there, 8, 0.3), &start)
                .unwrap();
            track.solutions.iter().for_each(|own| digest.told(own));
            digest.noted(&track.jumps);
        }
        5 | 7 => {
            let mut follower = arm.follower(&start).unwrap();
            let mut solution = Solution::default();
            for target in walk(arm, &start, &there, 5, 0.2) {
                let jump = follower.advance(target, &mut solution).unwrap();
                digest.noted(&jump);
                digest.told(&solution);
            }
            digest.doubles(follower.q().iter().copied());
        }
        6 | 8 => {
            let mut servo = arm.servo(&start, 0.05).unwrap();
            for target in walk(arm, &start, &there, 6, 0.3) {
                let step = servo.step(target).unwrap();
                digest.doubles(step.q.iter().chain(step.velocity).copied());
                digest.doubles([step.position_error, step.orientation_error]);
                digest.noted(&(step.status, step.collisions, step.reached()));
                step.held().for_each(|held| digest.noted(&held));
            }
        }
        _ => {
            let way = [Traversal::Open, Traversal::Cyclic, Traversal::AnyStart];
            let path = CartesianPath::new(walk(arm, &start, &there, 5, 0.1)).unwrap();
            let path = path.with_traversal(way[random.below(3)]);
            let mut solver = PathSolver::new(arm).with_samples(4 + 4 * random.below(2));
            if random.below(3) == 0 {
                solver = solver.with_start(&start);
            }
            if random.below(4) == 0 {
                solver = solver.with_joint_weights(&vec![0.5; n]);
            }
            match solver.solve(&path) {
                Ok(found) => digest.bytes(format!("{found:?} {}", found.is_whole())),
                Err(error) => digest.text(error.to_string()),
            }
        }
    }
    digest.noted(&arm.collisions(&there).unwrap());
}

/// A floor under the base, which only just stands farther from it than the margin, or right at it.
fn floor(world: &mut World, bodies: &CollisionModel, margin: f64, beside: f64) {
    let base = bodies.model().frame("base").unwrap();
    let lowest = bodies.objects_of(base).map(|own| {
        let bounds = own.shape.bounding_box().placed(&own.link_from_shape);
        bounds.min.z
    });
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    let at = Vector3::new(0.0, 0.0, lowest - margin - beside);
    world.add_plane("floor", at).unwrap();
}

fn arms(seed: u64, count: usize, turns: usize) -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(seed));
    // Where there are many, ways take their time.
    let doors = if count > 100 { 4 } else { 10 };
    for (name, tip, links) in [
        ("universal_ur5e", "flange", ["link2", "link3", "link6"]),
        ("franka_panda", "flange", ["base", "link5", "hand"]),
    ] {
        let robot = robot(name);
        let bodies = CollisionModel::of(&robot).unwrap();
        let rest = robot.model().neutral();
        let bodies = bodies.with_touching_ignored(&rest).unwrap();
        let covering = match count > 100 {
            true => spheres(&bodies, 1.0),
            false => SphereModel::of(&bodies, Resolution::PerLink(3)).unwrap(),
        };
        for turn in 0..turns {
            let mut own = checker(&bodies, &covering, &mut random);
            let mut world = world(&mut random, count, if count > 100 { 0.05 } else { 0.25 });
            let margin = [0.0, 0.02, 0.06][turn % 3];
            if turn % 2 == 0 {
                floor(&mut world, &bodies, margin, [0.0, 5e-5][turn / 2 % 2]);
            }
            own = own.with_world(&world).unwrap().with_margin(margin).unwrap();
            let plain = arm(&robot, tip, &mut random);
            let mut arm = plain.with_checker(&own, &rest).unwrap();
            for _ in 0..4 {
                ask(&mut digest, &arm, doors, &mut random);
                for _ in 0..[1, 1, 5][random.below(3)] {
                    change(&mut world, &mut random, &links);
                }
                let margin = [None, None, Some(0.0), Some(0.05)][random.below(4)];
                match arm.with_world(&world, margin) {
                    Ok(changed) => arm = changed,
                    Err(error) => digest.text(error.to_string()),
                }
                let mut drawn = Random::split_mix(random.bits());
                for _ in 0..5 {
                    let [start, there] = [(); 2].map(|()| drawn.configuration(&arm));
                    let target = arm.base_from_tool(&there).unwrap();
                    digest.solution(&arm.solve(target, &start).unwrap());
                }
            }
            ask(&mut digest, &arm, doors, &mut random);
        }
    }
    digest.value()
}

#[test]
fn of_mixed_arms_that_keep_clear() {
    check(&[(
        "arms of mixed options among changing obstacles",
        arms(921, 5, 3),
    )]);
}

#[test]
fn of_mixed_arms_among_many() {
    check(&[(
        "arms of mixed options among many obstacles",
        arms(922, 530, 5),
    )]);
}
