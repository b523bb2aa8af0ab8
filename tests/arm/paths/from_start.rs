//! Promise: a path solved from a given start is no worse than the path that `Arm::track` follows from there.
//!
//! `KINOPT_CASES=1000 cargo test --release --test arm from_start` solves 1 000 lines with each shipped arm.
#![allow(clippy::print_stdout)]

use kinopt::arm::JointPath;
use kinopt::motion::path::{CartesianPath, PathSolver, Traversal};
use kinopt::spatial::{Placement, Vector3};
use kinopt::{Arm, Solution};
use support::arms::robot;
use support::path_steps::largest_difference;
use support::random::{Random, case_count};
use support::shipped_arms::{SHIPPED_ARMS, matrix_placement, numbers, recorded};

/// Points of a line, and the distance between consecutive ones in metres.
const POINTS: u32 = 100;
const STEP: f64 = 0.3 / 99.0;

fn line(first: Placement<f64>, direction: Vector3<f64>, step: f64, points: u32) -> CartesianPath {
    let along = |k: u32| first.translation + direction * (step * f64::from(k));
    let points = (0..points).map(|k| Placement::new(first.rotation, along(k)));
    CartesianPath::new(points.collect::<Vec<_>>()).unwrap()
}

/// A line of 30 cm from a random configuration in a random direction.
fn random_line(arm: &Arm, random: &mut Random) -> (CartesianPath, Vec<f64>) {
    let start = random.configuration(arm);
    let mut direction = || 2.0 * random.unit() - 1.0;
    let direction = Vector3::new(direction(), direction(), direction());
    let direction = direction * direction.norm().recip();
    let first = arm.base_from_tool(&start).unwrap();
    (line(first, direction, STEP, POINTS), start)
}

/// Number of targets that a track misses, and of its jumps.
fn rank(track: &JointPath<Vec<Solution>>) -> (usize, usize) {
    let missed = track.report.iter().filter(|solution| !solution.reached);
    (missed.count(), track.jumps.len())
}

#[test]
fn recorded_lines_need_no_reconfiguration() {
    for (number, case) in recorded("paths_from_starts.json")
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        let model = case["robot"].as_str().unwrap();
        let robot = robot(model.strip_suffix(".urdf").unwrap());
        let arm = Arm::new(&robot, "base", "flange").unwrap();
        let direction = numbers(&case["direction"]);
        let direction = Vector3::new(direction[0], direction[1], direction[2]);
        let (step, points) = (case["step"].as_f64().unwrap(), case["points"].as_u64());
        let first = matrix_placement(&case["first"]);
        let path = line(first, direction, step, points.unwrap() as u32);
        let start = numbers(&case["start"]);
        let track = arm.track(path.points(), &start).unwrap();
        assert_eq!(rank(&track), (0, 0), "{model} {number}");
        for max_step in [0.2, 0.5] {
            let solver = PathSolver::new(&arm).with_start(&start);
            let solved = solver.with_max_step(max_step).solve(&path).unwrap();
            assert!(solved.reached(), "{model} {number}");
            assert_eq!(&solved.q[..start.len()], start, "{model} {number}");
        }
    }
}

/// The path from a random start, the start, and the track from there.
fn tracked(arm: &Arm, random: &mut Random) -> (CartesianPath, Vec<f64>, JointPath<Vec<Solution>>) {
    let (path, start) = random_line(arm, random);
    let track = arm.track(path.points(), &start).unwrap();
    (path, start, track)
}

/// Calls `visit` for each shipped arm. The limbs of the NAO are left out: their five or six joints follow hardly any
/// line of 30 cm.
fn each_arm(mut visit: impl FnMut(&Arm, &str)) {
    let arms = SHIPPED_ARMS.into_iter();
    for [model, base, tip] in arms.filter(|[model, ..]| *model != "aldebaran_nao") {
        let robot = robot(model);
        let builder = Arm::builder(&robot, base, tip).with_atlas(false);
        visit(&builder.build().unwrap(), &format!("{model} {tip}"));
    }
}

#[test]
fn lines_that_track_follows_need_no_reconfiguration() {
    let case_count = case_count(100, 12);
    each_arm(|arm, name| {
        let (mut random, mut followed, mut made) = (Random::split_mix(56), 0, 0);
        while followed < case_count {
            made += 1;
            let (path, start, track) = tracked(arm, &mut random);
            if rank(&track) != (0, 0) {
                continue;
            }
            followed += 1;
            let solver = PathSolver::new(arm).with_start(&start);
            let solved = solver.solve(&path).unwrap();
            assert!(solved.reached(), "{name}: line {made} from {start:?}");
            assert_eq!(&solved.q[..start.len()], start, "{name}: line {made}");
        }
        println!("{name}: {followed} of {made} lines are followed, none is reconfigured");
    });
}

#[test]
fn lines_out_of_reach_are_no_worse_than_tracked() {
    let case_count = case_count(20, 3);
    each_arm(|arm, name| {
        let mut random = Random::split_mix(57);
        let (mut left, mut jumps, mut reconfigurations) = (0, 0, 0);
        while left < case_count {
            let (path, start, track) = tracked(arm, &mut random);
            let (missed, jumped) = rank(&track);
            if missed == 0 {
                continue;
            }
            left += 1;
            let solver = PathSolver::new(arm).with_start(&start);
            let solved = solver.solve(&path).unwrap();
            let found = (solved.report.missed.len(), solved.jumps.len());
            assert!(
                found <= (missed, jumped),
                "{name}: {found:?} from {start:?}"
            );
            jumps += jumped;
            reconfigurations += solved.jumps.len();
        }
        println!("{name}: {left} lines, {jumps} jumps, {reconfigurations} reconfigurations");
    });
}

/// Along a line and back: as a closed path, and as an open path with a given end.
#[test]
fn closed_paths_from_a_start_need_no_reconfiguration() {
    let case_count = case_count(30, 4);
    each_arm(|arm, name| {
        let (mut random, mut followed) = (Random::split_mix(58), 0);
        while followed < case_count {
            let (path, start, track) = tracked(arm, &mut random);
            if rank(&track) != (0, 0) {
                continue;
            }
            let mut points = path.points().to_vec();
            points.extend(path.points().iter().rev().skip(1).copied());
            let track = arm.track(&points, &start).unwrap();
            let end = track.report.last().map(|last| last.q.clone()).unwrap();
            if rank(&track) != (0, 0) || largest_difference(&end, &start) > 0.1 {
                continue;
            }
            followed += 1;
            let solver = PathSolver::new(arm).with_start(&start);
            points.pop();
            let ring = CartesianPath::new(points.clone()).unwrap();
            let ring = ring.with_traversal(Traversal::Cyclic);
            let solved = solver.solve(&ring).unwrap();
            assert!(solved.reached(), "{name}: ring from {start:?}");
            points.push(path.points()[0]);
            let solved = solver.with_end(&end);
            let solved = solved.solve(&CartesianPath::new(points).unwrap()).unwrap();
            assert!(solved.reached(), "{name}: from {start:?}");
            assert_eq!(solved.rows().last(), Some(&*end), "{name}");
        }
    });
}
