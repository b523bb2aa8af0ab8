//! Promise: an unreachable target ends after bounded evaluations at a configuration that no free joint improves. The
//! report has its errors and exactly the active limits.

use std::f64::consts::PI;

use kinopt::Solution;
use kinopt::arm::{Arm, Search};
use kinopt::ik::{BoundKind, Side};
use kinopt::robot::Robot;
use kinopt::solver::Termination;
use kinopt::spatial::Placement;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use support::arms::{apart, base_from_tip, robot, within_limits};
use support::random::{Random, case_count, cases, few};

/// Metres that weigh as much as a radian.
const METRES_PER_RADIAN: f64 = 0.25;
/// Attempts of the SIMD solver, steps of the general solver, and final gradients.
const MAX_EVALUATIONS: usize = 4000;

struct Reach<'a> {
    robot: &'a Robot,
    arm: &'a Arm,
    ends: (&'a str, &'a str),
    target: Isometry3<f64>,
}

impl Reach<'_> {
    /// ½(metres² + (weight · radians)²) by nalgebra's kinematics.
    fn cost(&self, q: &[f64]) -> f64 {
        let at = base_from_tip(self.robot.model(), self.arm, q, self.ends.0, self.ends.1);
        let (metres, radians) = apart(&at, &self.target);
        0.5 * (metres * metres + METRES_PER_RADIAN * METRES_PER_RADIAN * radians * radians)
    }

    /// Central differences.
    fn slope(&self, q: &[f64], joint: usize) -> f64 {
        let step = 1e-5;
        let at = |angle: f64| {
            let mut q = q.to_vec();
            q[joint] += angle;
            self.cost(&q)
        };
        (at(step) - at(-step)) / (2.0 * step)
    }

    /// Checks that every free joint has a zero gradient and that every active limit is reported.
    fn check(&self, solution: &Solution) {
        assert!(!solution.reached && within_limits(self.arm, &solution.q));
        assert_eq!(
            solution.termination,
            Termination::Stationary,
            "{}",
            solution.explain()
        );
        assert!(
            solution.iterations <= MAX_EVALUATIONS,
            "{}",
            solution.iterations
        );
        let cost = self.cost(&solution.q);
        assert!(
            (solution.cost - cost).abs() <= 1e-9 * cost,
            "{} {cost}",
            solution.cost
        );
        let reported: Vec<(&str, Side)> = solution
            .active_limits()
            .map(|l| (l.joint, l.side))
            .collect();
        let named = self.arm.joints().zip(self.arm.limits()).enumerate();
        for (joint, (name, limits)) in named {
            let slope = self.slope(&solution.q, joint) / (2.0 * cost).sqrt();
            let value = solution.q[joint];
            let lower = value == limits.lower && reported.contains(&(name, Side::Lower));
            let upper = value == limits.upper && reported.contains(&(name, Side::Upper));
            // Reported limits have an outward force; the others have none.
            let fine = match (lower, upper) {
                (true, _) => slope > -1e-6,
                (_, true) => slope < 1e-6,
                // Beyond a limit the model clamps the joint: half of a one-sided difference.
                _ if value == limits.lower || value == limits.upper => slope.abs() < 1e-5,
                _ => slope.abs() < 1e-6,
            };
            assert!(fine, "{name}: {slope} {}", solution.explain());
        }
        let on_limit = |(name, side): &(&str, Side)| {
            let joint = self.arm.joints().position(|joint| joint == *name).unwrap();
            let limits = self.arm.limits().nth(joint).unwrap();
            solution.q[joint]
                == if *side == Side::Lower {
                    limits.lower
                } else {
                    limits.upper
                }
        };
        assert!(reported.iter().all(on_limit));
    }
}

fn stationary(name: &str, base: &str, tip: &str) {
    let robot = robot(name);
    let arm = Arm::builder(&robot, base, tip);
    let arm = arm
        .with_metres_per_radian(METRES_PER_RADIAN)
        .with_atlas(false);
    let arm = arm.build().unwrap();
    let mut random = Random::split_mix(17);
    let (mut missed, mut held) = (0, 0);
    let count = case_count(40, 12);
    for k in 0..count {
        let q = random.configuration(&arm);
        let at = base_from_tip(robot.model(), &arm, &q, base, tip);
        let mut unit = || 2.0 * random.unit() - 1.0;
        let axis = Vector3::new(unit(), unit(), unit());
        // Far away; slightly unreachable; rotated by a right angle at the edge.
        let (stretch, turn) = [(5.0, 0.0), (1.25, 0.0), (1.1, 0.5 * PI)][k % 3];
        let turn = UnitQuaternion::from_scaled_axis(axis.normalize() * turn);
        let moved = Translation3::from(at.translation.vector * stretch);
        let target = Isometry3::from_parts(moved, turn * at.rotation);
        let solution = arm.solve(target, &random.configuration(&arm)).unwrap();
        if !solution.reached {
            let ends = (base, tip);
            let (robot, arm) = (&robot, &arm);
            Reach {
                robot,
                arm,
                ends,
                target,
            }
            .check(&solution);
            missed += 1;
            held += usize::from(solution.active_limits().next().is_some());
        }
    }
    assert!(missed * 8 >= count * 3 && held >= 1, "{missed} {held}");
}

#[test]
fn seven_joint_misses_are_stationary() {
    stationary("franka_panda", "base", "flange");
    stationary("kuka_iiwa14", "base", "flange");
    stationary("rethink_baxter", "torso", "left_tool");
}

#[test]
fn scara_misses_are_stationary() {
    stationary("adept_cobra_s600", "base", "flange");
}

/// A position inside the workspace with an orientation beyond a limit: the Panda's last joint rotates by less than a
/// full turn.
#[test]
fn orientation_beyond_a_limit_names_the_limit() {
    let robot = robot("franka_panda");
    let free = Arm::builder(&robot, "base", "flange");
    let free = free.with_atlas(false).build().unwrap();
    let names: Vec<String> = free.joints().map(str::to_owned).collect();
    let q = [0.2, -0.3, 0.1, -1.9, 0.2, 1.7];
    let mut builder = Arm::builder(&robot, "base", "flange");
    for (name, value) in names.iter().zip(q) {
        builder = builder.with_locked(name, value);
    }
    let arm = builder
        .with_metres_per_radian(METRES_PER_RADIAN)
        .build()
        .unwrap();
    let upper = arm.limits().next().unwrap().upper;
    let target = arm.base_from_tool(&[upper + 0.1]).unwrap();
    let solution = arm.solve(target, &[0.0]).unwrap();
    assert!(!solution.reached && solution.q == [upper]);
    let reported: Vec<_> = solution
        .active_limits()
        .map(|l| (l.joint, l.side, l.kind))
        .collect();
    assert_eq!(
        reported,
        [(names[6].as_str(), Side::Upper, BoundKind::Limit)]
    );
    let missed = solution
        .tasks()
        .next()
        .unwrap()
        .orientation_error()
        .unwrap();
    assert!((missed - 0.1).abs() < 1e-9);
}

/// Move limits are distinguished from joint limits.
#[test]
fn move_limit_is_not_reported_as_joint_limit() {
    let robot = robot("franka_panda");
    let arm = Arm::builder(&robot, "base", "flange");
    let arm = arm.with_max_move(&[0.05; 7]).build().unwrap();
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let target = arm
        .base_from_tool(&[0.6, -0.2, 0.1, -1.8, 0.2, 1.7, 0.5])
        .unwrap();
    let solution = arm.solve(target, &start).unwrap();
    assert_eq!(solution.termination, Termination::CannotContinue);
    let kinds: Vec<_> = solution.active_limits().map(|limit| limit.kind).collect();
    assert!(!kinds.is_empty() && kinds.iter().all(|kind| *kind == BoundKind::Move));
    assert!(solution.explain().contains("end of the allowed move"));
    let is_far_away = solution
        .q
        .iter()
        .zip(start)
        .all(|(q, start)| (q - start).abs() <= 0.05);
    assert!(is_far_away, "{:?}", solution.q);
}

/// Out of reach is reported where it is certain, by all entry points, with the lengths that prove it. It is never
/// reported of a reachable position.
#[test]
fn proven_out_of_reach_is_reported() {
    let panda = robot("franka_panda");
    let arm = Arm::builder(&panda, "base", "flange");
    let arm = arm.with_atlas(false).build().unwrap();
    let start = [0.1, -0.3, 0.2, -2.0, 0.2, 1.7, 0.4];
    let mut random = Random::split_mix(5);
    for _ in cases(100, 10) {
        let mut target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let near = arm.solve(target, &start).unwrap();
        assert!(near.reached && !near.is_out_of_reach());
        // Usually an unreachable orientation at a reachable position.
        target.rotation = target.rotation.transpose();
        assert!(!arm.solve(target, &start).unwrap().is_out_of_reach());
        // The links of the file are 1.19 m long in total.
        target.translation = target.translation * (2.5 / target.translation.norm());
        let mut solutions = vec![arm.solve(target, &start).unwrap()];
        solutions.extend(arm.solve_batch(&[target], &start).unwrap());
        let mut followed = Solution::default();
        let mut follower = arm.follower(&start).unwrap();
        follower.advance(target, &mut followed).unwrap();
        solutions.push(followed);
        for solution in solutions {
            assert!(
                !solution.reached && solution.is_out_of_reach(),
                "{}",
                solution.explain()
            );
            let explanation = solution.explain().to_string();
            assert!(explanation.contains("Out of reach: "), "{explanation}");
        }
    }
}

/// Beyond the chain's length one attempt gives the result of all.
#[test]
fn target_beyond_reach_takes_one_attempt() {
    for (file, tip) in [("franka_panda", "flange"), ("universal_ur5e", "flange")] {
        let robot = robot(file);
        let builder = || Arm::builder(&robot, "base", tip);
        for search in [Search::Start, Search::Nearest] {
            let builder = || builder().with_search(search).with_atlas(!few());
            let arm = builder().build().unwrap();
            let many = builder().with_attempts(40).build().unwrap();
            let mut random = Random::split_mix(8);
            for _ in cases(20, 3) {
                let q = random.configuration(&arm);
                let start = random.configuration(&arm);
                let mut target = arm.base_from_tool(&q).unwrap();
                target.translation = target.translation * 6.0;
                let solution = arm.solve(target, &start).unwrap();
                if !solution.is_out_of_reach() {
                    continue;
                }
                assert_eq!(solution.attempts, 1, "{file} {search:?}");
                let all = many.solve(target, &start).unwrap();
                assert_eq!((&solution.q, all.attempts), (&all.q, 40));
                let batch = arm.solve_batch(&[target], &start).unwrap();
                assert_eq!(solution.q, batch[0].q);
            }
        }
    }
}

/// Also beyond all reach: the best of all attempts is no worse than the attempt from the start, and sometimes better.
#[test]
fn global_search_returns_the_best_miss() {
    let robot = robot("universal_ur5e");
    let builder = || Arm::builder(&robot, "base", "flange").with_atlas(false);
    let default_arm = builder().build().unwrap();
    let anywhere = builder().with_global_search_on_miss(true).build().unwrap();
    let (mut random, mut better) = (Random::split_mix(29), 0);
    for case in 0..6 {
        let target = default_arm
            .base_from_tool(&random.configuration(&default_arm))
            .unwrap();
        let position = target.translation;
        let unreachable = Placement::new(target.rotation, position * (1.5 / position.norm()));
        let start = random.configuration(&default_arm);
        let [near, best] =
            [&default_arm, &anywhere].map(|arm| arm.solve(unreachable, &start).unwrap());
        assert!(!near.reached && !best.reached);
        assert!(best.cost <= near.cost * (1.0 + 1e-6), "{case}");
        better += usize::from(best.cost < 0.99 * near.cost);
    }
    assert!(better > 0);
}
