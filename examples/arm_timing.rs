//! Times common queries of an arm on the shipped robots, and checks the results.
//!
//! `cargo run --release --features urdf --example arm_timing` times single queries one by one; the fastest of five
//! rounds counts.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::time::Instant;

use kinopt::Solution;
use kinopt::arm::{Arm, PoseOutcome, Search};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};

const POSES: usize = 2000;

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * 0.5f64.powi(53)
    }

    fn configuration(&mut self, arm: &Arm) -> Vec<f64> {
        let limits: Vec<_> = arm.limits().collect();
        let pi = std::f64::consts::PI;
        limits
            .iter()
            .map(|l| {
                let (lower, upper) = (l.lower.max(-2.0 * pi), l.upper.min(2.0 * pi));
                lower + self.unit() * (upper - lower)
            })
            .collect()
    }
}

fn micros(started: Instant) -> f64 {
    started.elapsed().as_nanos() as f64 / 1e3
}

fn singles(name: &str, arm: &Arm, goals: &[Placement<f64>], starts: &[f64], rounds: usize) {
    let n = arm.joint_count();
    let mut best = vec![f64::INFINITY; goals.len()];
    let mut solution = Solution::default();
    let (mut solved, mut attempts) = (0, 0);
    for round in 0..rounds {
        for (k, goal) in goals.iter().enumerate() {
            let started = Instant::now();
            arm.solve_into(goal, &starts[k * n..(k + 1) * n], &mut solution)
                .unwrap();
            best[k] = best[k].min(micros(started));
            if round == 0 {
                solved += usize::from(solution.reached);
                attempts += solution.attempts;
            }
        }
    }
    let count = goals.len();
    let mean = best.iter().sum::<f64>() / count as f64;
    best.sort_by(f64::total_cmp);
    println!(
        "  {name}: median {:.2} p99 {:.2} worst {:.1} mean {mean:.2} us, reached {solved} of {count}, {:.1} attempts",
        best[count / 2],
        best[count * 99 / 100],
        best[count - 1],
        attempts as f64 / count as f64,
    );
}

fn robot(file: &str, base: &str, tip: &str) {
    println!("{file}: {base} to {tip}");
    let robot = Robot::read(format!("models/{file}.urdf")).unwrap();
    let build = |search| {
        Arm::builder(&robot, base, tip)
            .with_search(search)
            .build()
            .unwrap()
    };
    let arm = build(Search::First);
    let n = arm.joint_count();
    let mut random = Random(1);
    let goals: Vec<Placement<f64>> = (0..POSES)
        .map(|_| arm.base_from_tool(&random.configuration(&arm)).unwrap())
        .collect();
    let starts: Vec<f64> = (0..POSES)
        .flat_map(|_| random.configuration(&arm))
        .collect();
    singles("first", &arm, &goals, &starts, 5);
    singles("start", &build(Search::Start), &goals, &starts, 5);
    singles(
        "nearest",
        &build(Search::Nearest),
        &goals[..200],
        &starts,
        2,
    );
    let distinct = Search::Distinct {
        k: 8,
        distance: 0.5,
    };
    singles("distinct 8", &build(distinct), &goals[..200], &starts, 2);

    let mut fastest = f64::INFINITY;
    for _ in 0..7 {
        let started = Instant::now();
        let solutions = arm.solve_batch(&goals, &starts).unwrap();
        fastest = fastest.min(micros(started) / POSES as f64);
        drop(solutions);
    }
    println!("  first, batch of solutions: {fastest:.3} us a pose");
    let (mut q, mut outcomes) = (vec![0.0; n * POSES], vec![PoseOutcome::default(); POSES]);
    let mut fastest = f64::INFINITY;
    for _ in 0..7 {
        let started = Instant::now();
        arm.solve_batch_into(&goals, &starts, &mut q, &mut outcomes)
            .unwrap();
        fastest = fastest.min(micros(started) / POSES as f64);
    }
    println!("  first, batch into slices: {fastest:.3} us a pose");

    let wave = |k: usize| -> Vec<f64> {
        arm.limits()
            .enumerate()
            .map(|(i, l)| {
                let (lower, upper) = (l.lower.max(-3.0), l.upper.min(3.0));
                let phase = (0.002 * k as f64 * (1.0 + 0.3 * i as f64)).sin();
                0.5 * (lower + upper) + 0.3 * (upper - lower) * phase
            })
            .collect()
    };
    let path: Vec<Placement<f64>> = (0..POSES)
        .map(|k| arm.base_from_tool(&wave(k)).unwrap())
        .collect();
    let mut fastest = f64::INFINITY;
    let (mut worst, mut jumps) = (0.0_f64, 0);
    for _ in 0..7 {
        let started = Instant::now();
        let track = arm.track(&path, &wave(0)).unwrap();
        fastest = fastest.min(micros(started) / POSES as f64);
        jumps = track.jumps.len();
        worst = track
            .report
            .windows(2)
            .flat_map(|pair| {
                pair[0]
                    .q
                    .iter()
                    .zip(&pair[1].q)
                    .map(|(a, b)| (a - b).abs())
                    .collect::<Vec<_>>()
            })
            .fold(0.0, f64::max);
    }
    println!("  track: {fastest:.3} us a step, longest joint step {worst:.3}, {jumps} jumps");

    let start = vec![0.3; n];
    let unreachable: Vec<Placement<f64>> = goals[..200]
        .iter()
        .map(|goal| {
            Placement::new(
                goal.rotation,
                goal.translation * 5.0 + Vector3::new(3.0, 0.0, 0.0),
            )
        })
        .collect();
    let starts: Vec<f64> = start.iter().copied().cycle().take(200 * n).collect();
    singles("out of the workspace", &arm, &unreachable, &starts, 2);
    let turned: Vec<Placement<f64>> = goals[..200]
        .iter()
        .map(|goal| {
            let outward = goal.translation * (1.0 / goal.translation.norm());
            let rotation = Matrix3::rotation(
                outward.cross(goal.rotation.z) * (1.0 / outward.cross(goal.rotation.z).norm()),
                (1.0, 0.0),
            );
            Placement::new(rotation * goal.rotation, goal.translation * 1.15)
        })
        .collect();
    singles("at the edge, any orientation", &arm, &turned, &starts, 2);
    let solution = arm.solve(unreachable[0], &start).unwrap();
    println!("{}", solution.explain());
}

fn main() {
    robot("franka_panda", "base", "flange");
    robot("universal_ur5e", "base", "flange");
    robot("kuka_iiwa14", "base", "flange");
}
