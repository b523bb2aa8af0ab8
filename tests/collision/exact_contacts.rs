//! Promise: shapes in exact contact count as separate despite rounding. A robot whose neighbouring solids meet reaches
//! and moves without contacts.

use kinopt::Arm;
use kinopt::collision::{Checker, World};
use kinopt::problem::{ClearanceCheck, CollisionAvoidance};
use kinopt::spatial::Vector3;
use support::arms::robot;
use support::random::Random;

/// Each solid of the shipped Baxter's arms ends where the next but one starts.
#[test]
fn meeting_solids_do_not_block_targets() {
    let robot = robot("rethink_baxter");
    let checker = Checker::of(&robot).unwrap();
    let rest = robot.model().neutral();
    for (side, seed) in [("left", 1), ("right", 2)] {
        let plain = Arm::new(&robot, "torso", format!("{side}_tool").as_str()).unwrap();
        let mut random = Random::new(seed);
        let arm = plain.clone().with_checker(&checker, &rest).unwrap();
        let mut count = 0;
        while count < 50 {
            let q = random.configuration(&arm);
            // Skips self-collisions beyond rounding.
            let touches = arm.collisions(&q).unwrap();
            if touches.iter().any(|pair| pair.depth() > 1e-6) {
                continue;
            }
            count += 1;
            assert!(touches.is_empty(), "{touches:?}");
            let target = arm.base_from_tool(&q).unwrap();
            let solution = arm.solve(target, &rest_of(&arm)).unwrap();
            assert!(solution.reached, "{}", solution.explain());
            assert!(
                solution.collisions().is_empty(),
                "{:?}",
                solution.collisions()
            );
        }
    }
}

fn rest_of(arm: &Arm) -> Vec<f64> {
    arm.limits().map(|l| l.clamp(0.0)).collect()
}

/// The Panda's base is exactly on the floor. This blocks no motion, and does not change the free fraction of one that
/// ends at a sphere.
#[test]
fn base_on_its_floor_blocks_no_motion() {
    let robot = robot("franka_panda");
    let alone = Checker::of(&robot).unwrap();
    let from = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8, 0.0, 0.0];
    let to = [1.5, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8, 0.0, 0.0];
    let mut ball = World::new();
    let position = Vector3::new(0.3, 0.35, 0.6);
    ball.add_sphere("ball", 0.1, position).unwrap();
    for (among, blocked) in [(World::new(), false), (ball, true)] {
        let shares = [false, true].map(|with_floor| {
            let mut world = among.clone();
            if with_floor {
                world.add_plane("floor", Vector3::zero()).unwrap();
            }
            let checker = alone.clone().with_world(&world).unwrap();
            let mut check = checker.check();
            let (from, to) = (from.as_slice(), to.as_slice());
            assert!(check.is_free(from), "{:?}", check.collisions(from));
            assert_eq!(check.blocked(from, to).is_some(), blocked);
            check.free_share(from, to)
        });
        assert_eq!(shares[0], shares[1]);
        assert!(if blocked {
            (0.05..0.95).contains(&shares[0])
        } else {
            shares[0] == 1.0
        });
    }
}
