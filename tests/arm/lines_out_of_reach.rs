//! Straight lines of 0.3 mm steps out of the workspace and back: an arm settles at the nearest point of
//! its own branch, comes back on it, and never leaps to another. A debug build follows a few lines;
//! `KINOPT_CASES` asks for another number of each robot.
#![allow(clippy::unwrap_used)]

use kinopt::Solution;
use kinopt::arm::Arm;
use kinopt::spatial::Placement;
use support::arms::{Random, robot, within_limits};
use support::lines::{Line, ROBOTS, lines, robots};
use support::sample::{cases, few};

/// What one way of following made of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Seen {
    steps: usize,
    missed: usize,
    /// Steps, and those to a miss, in which a joint moves by more than 0.2 rad or m.
    jumps: usize,
    leaps: usize,
}

fn longest(a: &[f64], b: &[f64]) -> f64 {
    let moves = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    moves.fold(0.0, f64::max)
}

impl Seen {
    fn step(&mut self, arm: &Arm, from: &[f64], to: &Solution) {
        assert!(within_limits(arm, &to.q));
        self.steps += 1;
        self.missed += usize::from(!to.reached);
        let far = longest(from, &to.q) > 0.2;
        self.jumps += usize::from(far);
        self.leaps += usize::from(far && !to.reached);
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
    track.solutions
}

fn by_solve(arm: &Arm, targets: &[Placement<f64>], start: &[f64]) -> Vec<Solution> {
    let mut q = start.to_vec();
    // A miss is searched for as long as one alone: a debug build turns back soon behind the end.
    let most = targets.len() * if few() { 3 } else { 5 } / 10;
    let (out, back) = (&targets[..most], &targets[targets.len() - most..]);
    let step = |target: &Placement<f64>| {
        let solution = arm.solve(*target, &q).unwrap();
        q.clone_from(&solution.q);
        solution
    };
    out.iter().chain(back).map(step).collect()
}

fn follow(name: &str, follow: Follow, count: usize) -> Seen {
    let (_, base, tip) = ROBOTS.into_iter().find(|(n, ..)| *n == name).unwrap();
    let robot = robot(name);
    let arm = Arm::builder(&robot, base, tip);
    let arm = arm.with_atlas(false).build().unwrap();
    let mut seen = Seen::default();
    for Line { start, out } in lines(&arm, &mut Random(71), count) {
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
fn a_follower_never_leaps() {
    for name in robots() {
        let seen = follow(name, by_follower, cases(8, 1));
        assert!(seen.missed * 4 > seen.steps, "{name}: {seen:?}");
        assert_eq!(seen.jumps, 0, "{name}: {seen:?}");
    }
}

#[test]
fn a_track_never_leaps() {
    for name in robots().filter(|name| *name != "aldebaran_nao") {
        let seen = follow(name, by_track, cases(4, 1));
        assert!(seen.missed * 4 > seen.steps, "{name}: {seen:?}");
        assert_eq!(seen.jumps, 0, "{name}: {seen:?}");
    }
}

/// Each question from the answer before: a miss stays near its start.
#[test]
fn a_miss_stays_near_the_start() {
    for name in robots().filter(|name| *name != "aldebaran_nao") {
        let seen = follow(name, by_solve, cases(4, 1));
        assert_eq!(seen.leaps, 0, "{name}: {seen:?}");
    }
}

/// How many lines met no limit, and how many of them ended elsewhere than they began: out, at rest there, back,
/// at rest again.
fn comes_back(rest: usize) -> (usize, usize) {
    let (mut free, mut elsewhere) = (0, 0);
    for name in robots() {
        let (_, base, tip) = ROBOTS.into_iter().find(|(n, ..)| *n == name).unwrap();
        let robot = robot(name);
        let arm = Arm::builder(&robot, base, tip);
        let arm = arm.with_atlas(false).build().unwrap();
        for Line { start, out } in lines(&arm, &mut Random(7), cases(8, 2)) {
            let end = vec![*out.last().unwrap(); rest];
            let home = vec![out[0]; rest];
            let back = out.iter().rev().chain(&home);
            let targets: Vec<_> = out.iter().chain(&end).chain(back).copied().collect();
            let stands = by_follower(&arm, &targets, &start);
            let on_limit = |stand: &Solution| {
                let ends = arm.limits().zip(&stand.q);
                ends.into_iter()
                    .any(|(l, q)| *q <= l.lower || *q >= l.upper)
            };
            if stands[out.len()].reached || stands.iter().any(on_limit) {
                continue;
            }
            free += 1;
            let off = longest(&stands[stands.len() - 1].q, &stands[0].q);
            elsewhere += usize::from(off > 1e-3);
        }
    }
    (free, elsewhere)
}

/// An elbow bends back to the side that it was on, and a redundant arm's freedom leads home. Where a branch
/// ends without a nearest place on it the arm slides on to another, which is rare.
#[test]
fn a_follower_comes_back_to_where_it_was() {
    let (free, elsewhere) = comes_back(150);
    assert!(free >= 3 && elsewhere * 20 <= free, "{elsewhere} of {free}");
}
