//! Promise: shapes that exactly meet are apart, whatever rounding says: a robot whose neighbouring solids meet reaches and moves as
//! if there were nothing.

use kinopt::Arm;
use kinopt::collision::{Checker, World};
use kinopt::problem::{ClearanceCheck, CollisionAvoidance};
use kinopt::spatial::Vector3;
use support::arms::robot;
use support::random::Random;

use crate::arms_keep_clear::drawn;

/// Every solid of the shipped Baxter's arms ends where the next but one begins.
#[test]
fn a_robot_whose_solids_meet_reaches_what_its_plain_arm_reaches() {
    let robot = robot("rethink_baxter");
    let checker = Checker::of(&robot).unwrap();
    let rest = robot.model().neutral();
    for (side, seed) in [("left", 1), ("right", 2)] {
        let plain = Arm::new(&robot, "torso", format!("{side}_tool").as_str()).unwrap();
        let mut random = Random::new(seed);
        let arm = plain.clone().with_checker(&checker, &rest).unwrap();
        let mut asked = 0;
        while asked < 50 {
            let q = drawn(&arm, &mut random);
            // In itself by more than rounding: no promise.
            let touches = arm.collisions(&q).unwrap();
            if touches.iter().any(|pair| pair.depth() > 1e-6) {
                continue;
            }
            asked += 1;
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

/// The Panda's base stands exactly on the floor: that takes nothing from its ways, nor from the share of one that ends before a ball.
#[test]
fn a_base_on_its_floor_keeps_no_way_short() {
    let robot = robot("franka_panda");
    let alone = Checker::of(&robot).unwrap();
    let from = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8, 0.0, 0.0];
    let to = [1.5, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8, 0.0, 0.0];
    let mut ball = World::new();
    let place = Vector3::new(0.3, 0.35, 0.6);
    ball.add_sphere("ball", 0.1, place).unwrap();
    for (among, blocked) in [(World::new(), false), (ball, true)] {
        let shares = [false, true].map(|stands| {
            let mut world = among.clone();
            if stands {
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
