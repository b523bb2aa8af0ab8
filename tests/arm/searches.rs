//! Promise: the nearest search returns the nearest solution, and all solutions of a redundant arm differ.
//! `KINOPT_CASES` sets the number of cases for each robot (best with `--release`).
#![allow(clippy::print_stdout)]

use kinopt::arm::{Argument, Arm, PoseBounds, PoseSolution, Search};
use kinopt::model::{Limits, Model};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::arms::{distance, robot, within_limits};
use support::random::{Random, case_count, cases, few};
use support::urdf_matrices::{apart, from_placement};

/// Two solutions of one pose to 1e-6 are equally near to the start within this distance, radians.
const DISTANCE_TOLERANCE: f64 = 1e-4;

/// Redundant arms, and one of six joints.
const ROBOTS: [(&str, &str, &str); 4] = [
    ("franka_panda", "base", "flange"),
    ("kuka_iiwa14", "base", "flange"),
    ("rethink_baxter", "torso", "left_tool"),
    ("universal_ur5e", "base", "flange"),
];

fn assert_solves(arm: &Arm, q: &[f64], target: &Placement<f64>) {
    let found = from_placement(&arm.base_from_tool(q).unwrap());
    let (metres, radians) = apart(&found, &from_placement(target));
    assert!(metres <= 1e-6 && radians <= 1e-6, "{metres:e} {radians:e}");
    assert!(within_limits(arm, q));
}

#[test]
fn nearest_search_beats_a_hundred_restarts() {
    let (mut all, mut lost) = (0, 0);
    for (name, base, tip) in ROBOTS {
        let robot = robot(name);
        let build = |search| {
            let builder = Arm::builder(&robot, base, tip).with_atlas(!few());
            builder.with_search(search).build().unwrap()
        };
        let (nearest, restarts) = (build(Search::Nearest), build(Search::Start));
        let mut random = Random::split_mix(3);
        let (cases, mut nearest_count) = (case_count(20, 2), 0);
        for _ in 0..cases {
            let truth = random.configuration(&nearest);
            let target = nearest.base_from_tool(&truth).unwrap();
            let start = random.configuration(&nearest);
            let ours = nearest.solve(target, &start).unwrap();
            assert!(ours.reached);
            assert_solves(&nearest, &ours.q, &target);
            let mut best = f64::INFINITY;
            for _ in 0..100 {
                let from = random.configuration(&restarts);
                let other = restarts.solve(target, &from).unwrap();
                best = best.min(distance(&other.q, &start));
            }
            nearest_count += usize::from(distance(&ours.q, &start) <= best + DISTANCE_TOLERANCE);
        }
        println!("{name}: {nearest_count} of {cases}");
        all += cases;
        lost += cases - nearest_count;
    }
    // Of few cases one may fail.
    assert!(lost <= (all / 20).max(1), "{lost} of {all}");
}

/// The solutions of attempts of a redundant arm are sorted by their weighted distance from the start.
#[test]
fn all_solutions_of_a_redundant_arm_differ() {
    let robot = robot("franka_panda");
    for weights in [[1.0; 7], [2.0, 2.0, 1.0, 1.0, 0.5, 0.5, 0.1]] {
        let builder = Arm::builder(&robot, "base", "flange").with_joint_weights(&weights);
        let arm = builder.with_atlas(!few()).build().unwrap();
        let weighted_distance = |a: &[f64], b: &[f64]| {
            let scaled =
                |q: &[f64]| -> Vec<f64> { q.iter().zip(&weights).map(|(v, w)| v * w).collect() };
            distance(&scaled(a), &scaled(b))
        };
        let mut random = Random::split_mix(4);
        for _ in cases(5, 3) {
            let target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
            let start = random.configuration(&arm);
            let all = arm.solve_all_from(target, &start).unwrap();
            assert!(!all.complete && all.argument == Argument::None && all.has_family);
            assert!(all.solutions.len() > 1);
            for (i, a) in all.solutions.iter().enumerate() {
                assert_solves(&arm, &a.q, &target);
                let is_apart = |b: &PoseSolution| weighted_distance(&a.q, &b.q) > 0.5;
                assert!(all.solutions[i + 1..].iter().all(is_apart));
            }
            let near_first = |pair: &[PoseSolution]| {
                weighted_distance(&pair[0].q, &start) <= weighted_distance(&pair[1].q, &start)
            };
            assert!(all.solutions.windows(2).all(near_first));
        }
    }
}

/// Goal bounds are freedom for the nearest search. Of two prismatic joints on one line the heavier moves less, by the
/// squares of the weights.
#[test]
fn nearest_search_uses_the_goal_bounds() {
    let mut builder = Model::builder("rail");
    let (at, x) = (Placement::identity(), Vector3::new(1.0, 0.0, 0.0));
    let limits = Limits::new(-2.0, 2.0);
    let first = builder.prismatic("first", None, at, x, limits);
    let second = builder.prismatic("second", Some(first), at, x, limits);
    builder.frame("base", None, at);
    builder.frame("tip", Some(second), at);
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let arm = Arm::builder(&robot, "base", "tip");
    let arm = arm.with_goal(PoseBounds::within([0.1, 0.0, 0.0, 0.0, 0.0, 0.0]));
    let arm = arm.with_joint_weights(&[1.0, 2.0]);
    let arm = arm.with_search(Search::Nearest).build().unwrap();
    let target = Placement::translation(Vector3::new(0.9, 0.0, 0.0));
    // From 0.3 to 0.8, split four to one.
    let solution = arm.solve(target, &[0.1, 0.2]).unwrap();
    let moved = [solution.q[0] - 0.1, solution.q[1] - 0.2];
    let distance = (moved[0] - 0.4).abs().max((moved[1] - 0.1).abs());
    assert!(solution.reached && distance < 1e-4, "{moved:?}");
}
