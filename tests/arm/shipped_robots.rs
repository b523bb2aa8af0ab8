//! Promise: every random pose of every shipped arm is solved to 1e-6 m and 1e-6 rad by independent kinematics, exactly
//! within the file's limits. `KINOPT_CASES` sets the number of poses for each chain (best with `--release`).

use kinopt::Solution;
use kinopt::arm::{Arm, Search};
use kinopt::robot::Robot;
use support::random::{Random, case_count, few};
use support::urdf_matrices::{Tree, apart, from_placement, placement};

fn all_solved(name: &str, base: &str, tip: &str, count: usize) {
    let count = case_count(count, count / 3);
    let file = format!("../models/{name}.urdf");
    let (robot, tree) = (Robot::read(&file).unwrap(), Tree::read(&file));
    for search in [Search::Start, Search::First] {
        let arm = Arm::builder(&robot, base, tip);
        let arm = arm.with_search(search);
        // A debug build makes seeds only for searches that start from them.
        let arm = arm.with_atlas(search == Search::First || !few());
        let arm = arm.build().unwrap();
        let joints: Vec<&str> = arm.joints().collect();
        let at = |q: &[f64]| {
            let values: Vec<_> = joints.iter().copied().zip(q.iter().copied()).collect();
            tree.base_from_tip(base, tip, &values)
        };
        let mut random = Random::split_mix(11);
        let mut solution = Solution::default();
        for _ in 0..count {
            let truth = random.configuration(&arm);
            let target = at(&truth);
            let start = random.configuration(&arm);
            arm.solve_into(placement(&target), &start, &mut solution)
                .unwrap();
            let found = at(&solution.q);
            let (metres, radians) = apart(&found, &target);
            assert!(
                solution.reached && metres <= 1e-6 && radians <= 1e-6,
                "{name} {tip}: {metres:e} {radians:e} {truth:?} {start:?} {}",
                solution.explain()
            );
            for (joint, value) in joints.iter().zip(&solution.q) {
                let (lower, upper) = tree.limits(joint);
                assert!(
                    lower <= *value && *value <= upper,
                    "{name}: {joint} {value}"
                );
            }
            // Errors are those of the result, and the arm's own kinematics agrees.
            let task = solution.tasks().next().unwrap();
            assert!((task.position_error().unwrap() - metres).abs() < 1e-13);
            assert!((task.orientation_error().unwrap() - radians).abs() < 1e-13);
            let actual = from_placement(&arm.base_from_tool(&solution.q).unwrap());
            let (metres, radians) = apart(&actual, &found);
            assert!(metres < 1e-13 && radians < 1e-13, "{metres:e} {radians:e}");
        }
    }
}

#[test]
fn seven_joints() {
    all_solved("franka_panda", "base", "flange", 120);
    all_solved("kuka_iiwa14", "base", "flange", 120);
}

#[test]
fn six_joints() {
    all_solved("universal_ur5e", "base", "flange", 120);
    all_solved("universal_ur10e", "base", "flange", 120);
}

#[test]
fn two_arms_on_a_torso() {
    all_solved("rethink_baxter", "torso", "left_tool", 80);
    all_solved("rethink_baxter", "torso", "right_tool", 80);
}

#[test]
fn scara_with_a_prismatic_joint() {
    all_solved("adept_cobra_s600", "base", "flange", 80);
}

#[test]
fn limbs_of_a_humanoid() {
    all_solved("aldebaran_nao", "torso", "left_hand", 40);
    all_solved("aldebaran_nao", "torso", "right_hand", 40);
    all_solved("aldebaran_nao", "torso", "left_sole", 40);
    all_solved("aldebaran_nao", "torso", "right_sole", 40);
    all_solved("aldebaran_nao", "torso", "head", 40);
}

/// The path from base to tip may first ascend: hand to hand, and sole to sole over the hips, whose yaw-pitch joints
/// share a motor.
#[test]
fn base_and_tip_in_different_branches() {
    all_solved("rethink_baxter", "left_tool", "right_tool", 15);
    all_solved("franka_panda", "flange", "base", 60);
    all_solved("aldebaran_nao", "left_sole", "right_sole", 10);
}
