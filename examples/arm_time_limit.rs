//! Overrun of a wall-clock limit by an arm, over difficult queries of several kinds. The limits are 1 ms, and 50 µs,
//! which stops many more queries.
//!
//! `cargo run --release --features urdf --example arm_time_limit`. On Linux, queries with an involuntary context
//! switch are left out.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::time::{Duration, Instant};

use kinopt::Solution;
use kinopt::arm::{Arm, ArmBuilder, Axis, PoseBounds, Search};
use kinopt::robot::Robot;
use kinopt::solver::Termination;

const QUERIES: usize = 300;

/// SplitMix64 generator.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * 0.5f64.powi(53)
    }

    fn configuration(&mut self, arm: &Arm) -> Vec<f64> {
        let ends: Vec<_> = arm.limits().map(|l| (l.lower, l.upper)).collect();
        let value = |(lower, upper): &(f64, f64)| lower + self.unit() * (upper - lower);
        ends.iter().map(value).collect()
    }
}

/// Number of involuntary context switches of this thread; 0 on systems without the count.
fn interruptions() -> u64 {
    let status = std::fs::read_to_string("/proc/thread-self/status").unwrap_or_default();
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("nonvoluntary_ctxt_switches:"));
    line.and_then(|count| count.trim().parse().ok())
        .unwrap_or(0)
}

/// Times queries, two thirds of which are out of reach: some barely, some by far.
fn overruns(kind: &str, builder: &ArmBuilder<'_>, limit: Duration) {
    // More attempts than the time limit allows.
    let arm = builder
        .clone()
        .with_time_limit(limit)
        .with_attempts(100_000);
    let arm = arm.build().unwrap();
    let mut random = Random(1);
    let mut solution = Solution::default();
    let mut overruns = Vec::new();
    let mut stopped = 0;
    for k in 0..QUERIES {
        let mut goal = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        goal.translation = goal.translation * [1.0, 1.3, 5.0][k % 3];
        let start = random.configuration(&arm);
        let interruptions_before = interruptions();
        let started = Instant::now();
        let solutions = arm.solve_all(goal, &start).unwrap();
        solution = solutions.into_iter().next().unwrap_or(solution);
        let elapsed = started.elapsed();
        stopped += usize::from(solution.termination == Termination::TimeLimit);
        if interruptions() == interruptions_before {
            overruns.push(elapsed.saturating_sub(limit).as_secs_f64() * 1e6);
        }
    }
    overruns.sort_by(f64::total_cmp);
    let counted = overruns.len();
    let quantile = |share: f64| {
        let index = (counted.saturating_sub(1) as f64 * share) as usize;
        overruns.get(index).copied().unwrap_or(f64::NAN)
    };
    println!(
        "{kind:<16} {stopped:>4} of {QUERIES} stopped by the clock; {counted} undisturbed, over by, µs: \
         median {:>6.1}  p99 {:>6.1}  max {:>6.1}",
        quantile(0.5),
        quantile(0.99),
        quantile(1.0)
    );
}

fn main() {
    let panda = Robot::read("models/franka_panda.urdf").unwrap();
    let humanoid = Robot::read("models/aldebaran_nao.urdf").unwrap();
    let arm = || Arm::builder(&panda, "base", "flange");
    let distinct = Search::Distinct {
        k: 8,
        distance: 0.5,
    };
    let hips = Arm::builder(&humanoid, "left_sole", "right_sole");
    let kinds = [
        ("start", arm()),
        ("first", arm().with_search(Search::First)),
        ("nearest", arm().with_search(Search::Nearest)),
        ("distinct", arm().with_search(distinct)),
        ("bounded moves", arm().with_max_move(&[0.3; 7])),
        ("posture", arm().with_posture(&[0.3; 7])),
        (
            "free axis",
            arm().with_goal(PoseBounds::free_about(Axis::Z)),
        ),
        ("follower", hips.clone()),
        ("follower nearest", hips.with_search(Search::Nearest)),
    ];
    for limit in [Duration::from_millis(1), Duration::from_micros(50)] {
        println!("limit {limit:?}");
        for (kind, builder) in &kinds {
            overruns(kind, builder, limit);
        }
    }
}
