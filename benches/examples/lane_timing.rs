//! Times the SIMD solver on random reachable poses of two arms, and along a smooth path.
//!
//! `cargo run --release -p kinopt-benches --example lane_timing` times single queries one by one; the fastest of five rounds counts.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::time::Instant;

use kinopt::simd_ik::{Chain, LaneOptions, PoseOutcome, PoseSolver, Prefer};
use kinopt::spatial::Placement;
use support::random::Random;
use support::simd_chains::{panda, target, ur5};

const POSES: usize = 2000;

fn micros(started: Instant) -> f64 {
    started.elapsed().as_nanos() as f64 / 1e3
}

fn mean(values: impl Iterator<Item = u32>) -> f64 {
    values.map(f64::from).sum::<f64>() / POSES as f64
}

fn poses(name: &str, chain: &Chain) {
    let started = Instant::now();
    let solver = PoseSolver::new(chain, LaneOptions::default()).unwrap();
    println!(
        "{name}: built in {:.0} ms, atlas {} kB",
        micros(started) / 1e3,
        solver.atlas_memory() / 1024
    );
    let n = solver.joints();
    let mut random = Random::split_mix(1);
    let sample = |random: &mut Random| -> Vec<f64> {
        chain
            .joints()
            .iter()
            .map(|j| random.within(j.lower, j.upper))
            .collect()
    };
    let goals: Vec<Placement<f64>> = (0..POSES)
        .map(|_| target(chain, &sample(&mut random)))
        .collect();
    let starts: Vec<f64> = (0..POSES).flat_map(|_| sample(&mut random)).collect();
    let mut q = vec![0.0; n * POSES];
    let mut outcomes = vec![PoseOutcome::default(); POSES];
    for search in [Prefer::First, Prefer::Start] {
        let mut best = vec![f64::INFINITY; POSES];
        for _ in 0..5 {
            for (k, goal) in goals.iter().enumerate() {
                let (start, q) = (&starts[k * n..(k + 1) * n], &mut q[k * n..(k + 1) * n]);
                let started = Instant::now();
                outcomes[k] = solver.solve(goal, start, search, None, q).unwrap();
                best[k] = best[k].min(micros(started));
            }
        }
        let average = best.iter().sum::<f64>() / POSES as f64;
        best.sort_by(f64::total_cmp);
        println!(
            "  {search:?} single: median {:.2} p99 {:.2} mean {average:.2} us, solved {}, \
             {:.2} iterations, {:.2} attempts",
            best[POSES / 2],
            best[POSES * 99 / 100],
            outcomes.iter().filter(|o| o.reached).count(),
            mean(outcomes.iter().map(|o| o.iterations)),
            mean(outcomes.iter().map(|o| o.attempts)),
        );
        let mut fastest = f64::INFINITY;
        for _ in 0..7 {
            let started = Instant::now();
            solver
                .solve_batch(&goals, &starts, search, &mut q, &mut outcomes)
                .unwrap();
            fastest = fastest.min(micros(started) / POSES as f64);
        }
        println!(
            "  {search:?} batch: {fastest:.3} us a pose, solved {}, {:.2} iterations, at most {}",
            outcomes.iter().filter(|o| o.reached).count(),
            mean(outcomes.iter().map(|o| o.iterations)),
            outcomes.iter().map(|o| o.iterations).max().unwrap(),
        );
    }
}

fn path(chain: &Chain) {
    let solver = PoseSolver::new(chain, LaneOptions::default()).unwrap();
    let n = solver.joints();
    let at = |k: usize| -> Vec<f64> {
        let wave = |i: usize| (0.002 * k as f64 * (1.0 + 0.3 * i as f64)).sin();
        let joints = chain.joints().iter().enumerate();
        joints
            .map(|(i, j)| 0.5 * (j.lower + j.upper) + 0.3 * (j.upper - j.lower) * wave(i))
            .collect()
    };
    let goals: Vec<Placement<f64>> = (0..POSES).map(|k| target(chain, &at(k))).collect();
    let mut q = vec![0.0; n * POSES];
    let mut outcomes = vec![PoseOutcome::default(); POSES];
    let mut fastest = f64::INFINITY;
    for _ in 0..15 {
        let started = Instant::now();
        solver.track(&goals, &at(0), &mut q, &mut outcomes).unwrap();
        fastest = fastest.min(micros(started) / POSES as f64);
    }
    println!(
        "  track: {fastest:.3} us a step, solved {}, {:.2} iterations",
        outcomes.iter().filter(|o| o.reached).count(),
        mean(outcomes.iter().map(|o| o.iterations)),
    );
}

fn main() {
    poses("panda", &panda());
    path(&panda());
    poses("ur5", &ur5());
}
