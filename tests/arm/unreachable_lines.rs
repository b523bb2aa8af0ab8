//! Promise: along straight lines of 0.3 mm steps out of the workspace and back, an arm never jumps. It settles at the
//! closest pose of its branch.
//!
//! A debug build follows a few lines; `KINOPT_CASES` sets their number for each robot.

use kinopt::Solution;
use kinopt::arm::Arm;
use kinopt::spatial::Placement;
use support::arms::{robot, within_limits};
use support::lines::{Line, ROBOTS, lines, robots};
use support::path_steps::largest_difference;
use support::random::{Random, case_count, few};

/// Counts of one way to follow a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Counts {
    steps: usize,
    missed: usize,
    /// Steps in which a joint moves by more than 0.2 rad or m, and those of them that end in a miss.
    jumps: usize,
    unreached_jumps: usize,
}

impl Counts {
    fn step(&mut self, arm: &Arm, from: &[f64], to: &Solution) {
        assert!(within_limits(arm, &to.q));
        self.steps += 1;
        self.missed += usize::from(!to.reached);
        let is_jump = largest_difference(from, &to.q) > 0.2;
        self.jumps += usize::from(is_jump);
        self.unreached_jumps += usize::from(is_jump && !to.reached);
    }
}

type Follow = fn(&Arm, &[Placement<f64>], &[f64]) -> Vec<Solution>;

fn by_follower(arm: &Arm, targets: &[Placement<f64>], start: &[f64]) -> Vec<Solution> {
    let mut follower = arm.follower(start).unwrap();
    let step = |target: &Placement<f64>| {
        let mut solution = Solution::default();
        let jump = follower.advance(*target, &mut solution).unwrap();
        assert_eq!(jump, None);
        solution
    };
    targets.iter().map(step).collect()
}

fn by_track(arm: &Arm, targets: &[Placement<f64>], start: &[f64]) -> Vec<Solution> {
    let track = arm.track(targets, start).unwrap();
    assert_eq!(track.jumps, []);
    track.report
}

fn by_solve(arm: &Arm, targets: &[Placement<f64>], start: &[f64]) -> Vec<Solution> {
    let mut q = start.to_vec();
    // Misses are slow to solve, so a debug build returns soon after the edge.
    let count = targets.len() * if few() { 3 } else { 5 } / 10;
    let (out, back) = (&targets[..count], &targets[targets.len() - count..]);
    let step = |target: &Placement<f64>| {
        let solution = arm.solve(*target, &q).unwrap();
        q.clone_from(&solution.q);
        solution
    };
    out.iter().chain(back).map(step).collect()
}

fn follow(name: &str, follow: Follow, count: usize) -> Counts {
    let (_, base, tip) = ROBOTS.into_iter().find(|(n, ..)| *n == name).unwrap();
    let robot = robot(name);
    let arm = Arm::builder(&robot, base, tip);
    let arm = arm.with_atlas(false).build().unwrap();
    let mut seen = Counts::default();
    for Line { start, out } in lines(&arm, &mut Random::split_mix(71), count) {
        let back = out.iter().rev();
        let targets: Vec<_> = out.iter().chain(back).copied().collect();
        let solutions = follow(&arm, &targets, &start);
        let mut from = &start;
        for solution in &solutions {
            seen.step(&arm, from, solution);
            from = &solution.q;
        }
    }
    seen
}

#[test]
fn path_follower_never_jumps() {
    for name in robots() {
        let seen = follow(name, by_follower, case_count(8, 1));
        assert!(seen.missed * 4 > seen.steps, "{name}: {seen:?}");
        assert_eq!(seen.jumps, 0, "{name}: {seen:?}");
    }
}

#[test]
fn track_never_jumps() {
    for name in robots().filter(|name| *name != "aldebaran_nao") {
        let seen = follow(name, by_track, case_count(4, 1));
        assert!(seen.missed * 4 > seen.steps, "{name}: {seen:?}");
        assert_eq!(seen.jumps, 0, "{name}: {seen:?}");
    }
}

/// Each solve starts from the previous result.
#[test]
fn miss_stays_near_the_start() {
    for name in robots().filter(|name| *name != "aldebaran_nao") {
        let seen = follow(name, by_solve, case_count(4, 1));
        assert_eq!(seen.unreached_jumps, 0, "{name}: {seen:?}");
    }
}

/// Lines that met no limit, and those of them that ended at another configuration: out, rest, back, rest.
fn count_returns(rest: usize) -> (usize, usize) {
    let (mut free, mut on_other_branch) = (0, 0);
    for name in robots() {
        let (_, base, tip) = ROBOTS.into_iter().find(|(n, ..)| *n == name).unwrap();
        let robot = robot(name);
        let arm = Arm::builder(&robot, base, tip);
        let arm = arm.with_atlas(false).build().unwrap();
        for Line { start, out } in lines(&arm, &mut Random::split_mix(7), case_count(8, 2)) {
            let end = vec![*out.last().unwrap(); rest];
            let home = vec![out[0]; rest];
            let back = out.iter().rev().chain(&home);
            let targets: Vec<_> = out.iter().chain(&end).chain(back).copied().collect();
            let track = by_follower(&arm, &targets, &start);
            let on_limit = |stand: &Solution| {
                let ends = arm.limits().zip(&stand.q);
                ends.into_iter()
                    .any(|(l, q)| *q <= l.lower || *q >= l.upper)
            };
            if track[out.len()].reached || track.iter().any(on_limit) {
                continue;
            }
            free += 1;
            let distance = largest_difference(&track[track.len() - 1].q, &track[0].q);
            on_other_branch += usize::from(distance > 1e-3);
        }
    }
    (free, on_other_branch)
}

/// The elbow keeps its branch, and null-space motion returns to the start. If a branch ends without a local minimum,
/// the arm slides to another, which is rare.
#[test]
fn path_follower_returns_to_its_start() {
    let (free, on_other_branch) = count_returns(150);
    assert!(
        free >= 3 && on_other_branch * 20 <= free,
        "{on_other_branch} of {free}"
    );
}
