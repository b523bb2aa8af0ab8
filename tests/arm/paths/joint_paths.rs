//! Promise: a Cartesian path that results from a continuous joint motion is solved without a reconfiguration, reported
//! or not, and without an unreached point. At most one in two hundred may fail.
//!
//! Debug builds solve a few cases of each arm; `KINOPT_CASES` sets another number.

use std::ops::Range;

use kinopt::Arm;
use kinopt::motion::path::{CartesianPath, PathSolver};
use kinopt::robot::Robot;
use kinopt::spatial::Placement;
use nalgebra::Isometry3;
use support::arms::{apart, base_from_tip, robot, within_limits};
use support::follower_chains::follower_chain;
use support::path_steps::{is_led, largest_difference};
use support::random::{Random, case_count, few};

/// A smooth joint motion through three random configurations, with `steps` points from one to the next.
fn joints(arm: &Arm, random: &mut Random, steps: usize) -> Vec<Vec<f64>> {
    let ends = [(); 3].map(|()| random.configuration(arm));
    through(&ends, steps)
}

fn through(ends: &[Vec<f64>; 3], steps: usize) -> Vec<Vec<f64>> {
    let mut rows = vec![ends[0].clone()];
    for pair in ends.windows(2) {
        for k in 1..=steps {
            let share = 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / steps as f64).cos();
            let between = |(a, b): (&f64, &f64)| a + share * (b - a);
            rows.push(pair[0].iter().zip(&pair[1]).map(between).collect());
        }
    }
    rows
}

/// Number of an arm's paths that are solved with a jump, or not for all points.
fn jumps([name, base, tip]: [&str; 3], cases: Range<usize>, atlas: bool) -> usize {
    let robot = robot(name);
    let arm = Arm::builder(&robot, base, tip)
        .with_atlas(atlas)
        .build()
        .unwrap();
    let mut random = Random::split_mix(11);
    let mut jumps = 0;
    for case in 0..cases.end {
        let joint_path = joints(&arm, &mut random, 150);
        if case < cases.start {
            continue;
        }
        let points: Vec<Placement<f64>> = joint_path
            .iter()
            .map(|q| arm.base_from_tool(q).unwrap())
            .collect();
        let path = CartesianPath::new(points.clone()).unwrap();
        let solution = PathSolver::new(&arm).solve(&path).unwrap();
        if !solution.report.missed.is_empty() {
            jumps += 1;
            continue;
        }
        let rows: Vec<&[f64]> = solution.rows().collect();
        assert_eq!(rows.len(), joint_path.len());
        for (q, expected) in rows.iter().zip(&joint_path) {
            assert!(within_limits(&arm, q));
            let [at, expected] =
                [q, expected.as_slice()].map(|q| base_from_tip(robot.model(), &arm, q, base, tip));
            let (metres, radians) = apart(&Isometry3::from(at), &Isometry3::from(expected));
            assert!(metres <= 1.1e-6 && radians <= 1.1e-6);
        }
        let reported: Vec<usize> = solution.jumps.iter().map(|r| r.index).collect();
        let untold = (1..rows.len()).find(|&row| {
            let (from, to) = (rows[row - 1], rows[row]);
            let is_jump = largest_difference(from, to) > 0.2 + 1e-9 && !reported.contains(&row);
            is_jump && !is_led(&arm, [points[row - 1], points[row]], [from, to])
        });
        assert_eq!(untold, None, "{name} {case}: {reported:?}");
        // A reported step exceeds the maximum step of a branch.
        let short = solution
            .jumps
            .iter()
            .find(|reported| reported.distance <= 0.2);
        assert_eq!(short, None, "{name} {case}");
        jumps += usize::from(!reported.is_empty());
    }
    jumps
}

#[test]
fn six_joint_motions_need_no_reconfiguration() {
    let count = case_count(20, 1);
    for name in ["universal_ur5e", "universal_ur10e"] {
        assert!(
            jumps([name, "base", "flange"], 0..count, !few()) * 200 <= count,
            "{name}"
        );
    }
}

#[test]
fn seven_joint_motions_need_no_reconfiguration() {
    let count = case_count(20, 1);
    for name in ["franka_panda", "kuka_iiwa14"] {
        assert!(
            jumps([name, "base", "flange"], 0..count, !few()) * 200 <= count,
            "{name}"
        );
    }
    assert!(jumps(["rethink_baxter", "torso", "left_tool"], 0..count, !few()) * 200 <= count);
}

/// The shortening must not move this step off the tool's path.
#[test]
fn subdivided_step_stays_on_the_tool_path() {
    let iiwa = ["kuka_iiwa14", "base", "flange"];
    assert_eq!(jumps(iiwa, 187..188, true), 0);
}

#[test]
fn scara_motions_need_no_reconfiguration() {
    let count = case_count(20, 1);
    assert!(jumps(["adept_cobra_s600", "base", "flange"], 0..count, !few()) * 200 <= count);
}

/// Paths on which joints wind so far that only one start needs no rewinding.
#[test]
fn two_turn_joints_start_where_they_need_no_rewind() {
    for (name, cases) in [
        ("universal_ur5e", &[29, 94, 214, 245, 899][..]),
        ("adept_cobra_s600", &[99, 243, 299, 321]),
    ] {
        let arm = Arm::new(&robot(name), "base", "flange").unwrap();
        let mut random = Random::split_mix(11);
        let all = (0..1000).map(|_| joints(&arm, &mut random, 150));
        for (case, joint_path) in all.enumerate().filter(|(case, _)| cases.contains(case)) {
            let points: Vec<Placement<f64>> = joint_path
                .iter()
                .map(|q| arm.base_from_tool(q).unwrap())
                .collect();
            let path = CartesianPath::new(points).unwrap();
            let solution = PathSolver::new(&arm).solve(&path).unwrap();
            assert!(solution.reached(), "{name} {case}");
            let left = solution.jumps;
            assert!(left.is_empty(), "{name} {case}: {left:?}");
        }
    }
}

/// Past stretched configurations, where the known branches of both sides belong to the same self-motion.
#[test]
fn jump_within_a_self_motion_is_distributed() {
    let robot = robot("kuka_iiwa14");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    for ends in [
        [
            [2.14, 1.03, 1.27, 1.34, 2.33, 1.83, 1.38],
            [2.55, -0.97, -0.13, -1.3, -2.34, -0.43, -0.98],
            [0.78, -0.39, -2.04, -0.02, -1.01, 1.12, 1.15],
        ],
        [
            [1.18, -1.07, -0.06, 1.57, -1.76, -0.97, 0.35],
            [-1.23, -0.43, -0.45, -1.55, 1.41, -2.07, 2.35],
            [-2.72, 0.35, -0.69, 2.03, -1.31, 1.62, -2.86],
        ],
    ] {
        let joint_path = through(&ends.map(|q| q.to_vec()), 150);
        let points: Vec<Placement<f64>> = joint_path
            .iter()
            .map(|q| arm.base_from_tool(q).unwrap())
            .collect();
        let path = CartesianPath::new(points).unwrap();
        let solution = PathSolver::new(&arm).solve(&path).unwrap();
        assert!(solution.report.missed.is_empty());
        let left: Vec<_> = (solution.jumps.iter())
            .map(|reported| (reported.index, reported.distance))
            .collect();
        assert_eq!(left, [], "{ends:?}");
        let rows: Vec<&[f64]> = solution.rows().collect();
        assert!(
            rows.windows(2)
                .all(|pair| largest_difference(pair[0], pair[1]) <= 0.2 + 1e-9)
        );
    }
}

/// Arms with mimic joints are solved as well, although the SIMD solver does not support them.
#[test]
fn chains_with_mimic_joints_are_solved() {
    let (mut random, mut whole, mut tried) = (Random::split_mix(91), 0, 0);
    for number in 0..12 {
        let (text, tip) = follower_chain(number);
        let Ok(robot) = Robot::parse(&text, "followers.urdf") else {
            continue;
        };
        let arm = Arm::builder(&robot, "l0", &tip).with_atlas(false);
        let arm = arm.build().unwrap();
        let ends = [(); 2].map(|()| random.configuration(&arm));
        let [from, to] = ends.map(|q| -> Vec<f64> { q.iter().map(|q| 0.5 * q).collect() });
        let between = |share: f64| -> Vec<f64> {
            let both = from.iter().zip(&to);
            both.map(|(a, b)| a + 0.2 * share * (b - a)).collect()
        };
        let points = (0..=12).map(|k| arm.base_from_tool(&between(f64::from(k) / 12.0)).unwrap());
        let points: Vec<_> = points.collect();
        let path = CartesianPath::new(points.clone()).unwrap();
        let reported = PathSolver::new(&arm)
            .with_start(&from)
            .solve(&path)
            .unwrap();
        tried += 1;
        whole += usize::from(reported.reached() && reported.report.missed.is_empty());
        for (row, (q, point)) in reported.rows().zip(&points).enumerate() {
            assert!(within_limits(&arm, q), "{number}");
            let missed = reported
                .report
                .missed
                .iter()
                .any(|missed| missed.index == row);
            let deviation = (arm.base_from_tool(q).unwrap().translation - point.translation).norm();
            assert!(
                missed || deviation < 1.1e-6,
                "chain {number}, row {row}: {deviation} m"
            );
        }
    }
    assert!(tried > 6 && whole == tried, "{whole} of {tried}");
}
