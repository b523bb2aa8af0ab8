//! Every random pose of every shipped arm is solved, within limits bit for bit.
#![cfg(feature = "urdf")]
#![allow(clippy::unwrap_used)]

mod arm_support;

use arm_support::{Random, apart, base_from_tip, placement, robot, within_limits};
use kinopt::Solution;
use kinopt::arm::{Arm, Search};

fn all_solved(name: &str, base: &str, tip: &str, count: usize) {
    let robot = robot(name);
    let model = robot.model();
    for search in [Search::Start, Search::First] {
        let arm = Arm::builder(&robot, base, tip).unwrap();
        let arm = arm.with_search(search).build().unwrap();
        let mut random = Random(11);
        let mut solution = Solution::default();
        for _ in 0..count {
            let truth = random.configuration(&arm);
            let wanted = base_from_tip(model, &arm, &truth, base, tip);
            let start = random.configuration(&arm);
            arm.solve_into(wanted, &start, &mut solution).unwrap();
            let at = base_from_tip(model, &arm, &solution.q, base, tip);
            let (metres, radians) = apart(&at, &wanted);
            assert!(
                solution.reached && metres <= 1e-6 && radians <= 1.05e-6,
                "{name} {tip}: {metres} {radians} {truth:?} {}",
                solution.explain()
            );
            assert!(within_limits(&arm, &solution.q));
            // The door's own kinematics agrees.
            let own =
                placement(&at).translation - arm.base_from_tool(&solution.q).unwrap().translation;
            assert!(own.norm() < 1e-12);
        }
    }
}

#[test]
fn seven_joints() {
    all_solved("franka_panda", "base", "flange", 150);
    all_solved("kuka_iiwa14", "base", "flange", 150);
}

#[test]
fn six_joints() {
    all_solved("universal_ur5e", "base", "flange", 150);
    all_solved("universal_ur10e", "base", "flange", 150);
}

#[test]
fn both_arms_of_a_torso() {
    all_solved("rethink_baxter", "torso", "left_tool", 80);
    all_solved("rethink_baxter", "torso", "right_tool", 80);
}

#[test]
fn a_scara_with_a_sliding_joint() {
    all_solved("adept_cobra_s600", "base", "flange", 80);
}

#[test]
fn limbs_of_a_humanoid() {
    all_solved("aldebaran_nao", "torso", "left_hand", 40);
    all_solved("aldebaran_nao", "torso", "right_hand", 40);
    all_solved("aldebaran_nao", "torso", "left_sole", 40);
    all_solved("aldebaran_nao", "torso", "head", 40);
}

/// The way may climb before it descends: hand to hand, and sole to sole over the hips.
#[test]
fn the_base_need_not_carry_the_tip() {
    all_solved("rethink_baxter", "left_tool", "right_tool", 15);
    all_solved("franka_panda", "flange", "base", 60);
    all_solved("aldebaran_nao", "left_sole", "right_sole", 10);
}
