//! Promise: all 2 000 poses of two external reference workloads are solved to 1e-6 m and 1e-6 rad, alone and in a
//! batch. A dense path is followed without a flip.
//!
//! The workloads have no licence and are not shipped: `KINOPT_SHARED` names the folder with `workloads/` and `robots/`.
//! Best run with `--release`; a debug build takes every tenth pose.
#![allow(clippy::print_stderr)]

use std::path::{Path, PathBuf};

use kinopt::arm::{Arm, Search};
use kinopt::robot::Robot;
use kinopt::{Solution, spatial::Placement};
use serde::Deserialize;
use support::urdf_matrices::{Matrix, Tree, apart, from_quaternion, placement};

/// Largest joint displacement of a step beyond that of the path's own joint, radians.
const MAX_EXTRA_STEP: f64 = 0.2;

#[derive(Deserialize)]
struct Workload {
    urdf: String,
    base_link: String,
    tip_link: String,
    joint_names: Vec<String>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    targets: Vec<[f64; 7]>,
    starts: Vec<Vec<f64>>,
    truth: Vec<Vec<f64>>,
}

struct Bench {
    work: Workload,
    robot: Robot,
    tree: Tree,
    targets: Vec<Matrix>,
    goals: Vec<Placement<f64>>,
}

fn shared() -> Option<PathBuf> {
    let shared = std::env::var_os("KINOPT_SHARED").map(PathBuf::from);
    if shared.is_none() {
        eprintln!("SKIPPED: KINOPT_SHARED is not set, so no reference workload was solved");
    }
    shared
}

impl Bench {
    fn read(shared: &Path, name: &str, every: usize) -> Self {
        let text = std::fs::read_to_string(shared.join(format!("workloads/{name}.json"))).unwrap();
        let mut work: Workload = serde_json::from_str(&text).unwrap();
        let urdf = shared.join("robots").join(&work.urdf);
        let thinned = |all: &[Vec<f64>]| all.iter().step_by(every).cloned().collect();
        work.targets = work.targets.iter().step_by(every).copied().collect();
        work.starts = thinned(&work.starts);
        work.truth = thinned(&work.truth);
        let target: Vec<Matrix> = work.targets.iter().copied().map(from_quaternion).collect();
        Self {
            goals: target.iter().map(placement).collect(),
            robot: Robot::read(&urdf).unwrap(),
            tree: Tree::read(&urdf),
            targets: target,
            work,
        }
    }

    fn arm(&self, search: Search) -> Arm {
        let Workload {
            base_link,
            tip_link,
            joint_names,
            ..
        } = &self.work;
        let builder = Arm::builder(&self.robot, base_link, tip_link);
        let arm = builder.with_search(search).build().unwrap();
        assert!(arm.joints().eq(joint_names.iter().map(String::as_str)));
        arm
    }

    fn assert_solved(&self, index: usize, solution: &Solution) {
        let names = self.work.joint_names.iter().map(String::as_str);
        let values: Vec<_> = names.zip(solution.q.iter().copied()).collect();
        let found = (self.tree).base_from_tip(&self.work.base_link, &self.work.tip_link, &values);
        let (metres, radians) = apart(&found, &self.targets[index]);
        assert!(
            solution.reached && metres <= 1e-6 && radians <= 1e-6,
            "pose {index}: {metres:e} m, {radians:e} rad: {}",
            solution.explain()
        );
        let limits = self.work.lower.iter().zip(&self.work.upper);
        for ((lower, upper), value) in limits.zip(&solution.q) {
            assert!(lower <= value && value <= upper, "pose {index}: {value}");
        }
    }
}

/// Checks that the workload's numbers match the matrices.
fn assert_truth(bench: &Bench) {
    for (truth, target) in bench.work.truth.iter().zip(&bench.targets).take(50) {
        let names = bench.work.joint_names.iter().map(String::as_str);
        let values: Vec<_> = names.zip(truth.iter().copied()).collect();
        let Workload {
            base_link,
            tip_link,
            ..
        } = &bench.work;
        let found = bench.tree.base_from_tip(base_link, tip_link, &values);
        let (metres, radians) = apart(&found, target);
        assert!(metres < 1e-12 && radians < 1e-12, "{metres:e} {radians:e}");
    }
}

#[test]
fn reference_poses_are_solved() {
    let Some(shared) = shared() else { return };
    let every = if cfg!(debug_assertions) { 10 } else { 1 };
    for name in ["panda", "ur5"] {
        let bench = Bench::read(&shared, name, every);
        assert_truth(&bench);
        let starts: Vec<f64> = bench.work.starts.iter().flatten().copied().collect();
        for search in [Search::Start, Search::First] {
            let arm = bench.arm(search);
            let mut solution = Solution::default();
            for (index, start) in bench.work.starts.iter().enumerate() {
                arm.solve_into(bench.goals[index], start, &mut solution)
                    .unwrap();
                bench.assert_solved(index, &solution);
            }
            let together = arm.solve_batch(&bench.goals, &starts).unwrap();
            for (index, solution) in together.iter().enumerate() {
                bench.assert_solved(index, solution);
            }
        }
        eprintln!("{name}: {} poses solved", bench.goals.len());
    }
}

#[test]
fn reference_path_is_followed_without_a_flip() {
    let Some(shared) = shared() else { return };
    let bench = Bench::read(&shared, "panda_track", 1);
    assert_truth(&bench);
    let arm = bench.arm(Search::Start);
    for start in [&bench.work.truth[0], &bench.work.starts[0]] {
        let path = arm.track(&bench.goals, start).unwrap().report;
        let mut largest_excess: f64 = 0.0;
        for (index, solution) in path.iter().enumerate() {
            bench.assert_solved(index, solution);
            let Some(last) = index.checked_sub(1) else {
                continue;
            };
            let truth = bench.work.truth[index].iter().zip(&bench.work.truth[last]);
            let ours = solution.q.iter().zip(&path[last].q);
            for ((a, b), (c, d)) in ours.zip(truth) {
                largest_excess = largest_excess.max((a - b).abs() - (c - d).abs());
            }
        }
        assert!(
            largest_excess <= MAX_EXTRA_STEP,
            "a joint moved {largest_excess} rad beyond the path's own"
        );
        eprintln!(
            "panda_track: no joint moved more than {largest_excess:.1e} rad beyond the path's own"
        );
    }
}
