//! Time of a pose query by the C interface, compared with that of Rust: `cargo run --release -p kinopt-c --example call_overhead`.
#![allow(
    unsafe_code,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a measurement that calls the C interface"
)]

use std::ffi::CString;
use std::ptr::{null, null_mut};
use std::time::Instant;

use kinopt_bindings::placement::to_columns;
use kinopt_c::arm::{kinopt_arm_free, kinopt_arm_new, kinopt_arm_solve};
use kinopt_c::robot::{kinopt_robot_free, kinopt_robot_read};
use kinopt_c::solution::{kinopt_solution_free, kinopt_solution_new};

/// Queries of a round: few, so that some rounds end without an interruption on a busy machine.
const QUERIES: u32 = 100;
const ROUNDS: usize = 3_000;

/// Time of a query of one round, microseconds.
fn time(round: impl FnOnce()) -> f64 {
    let start = Instant::now();
    round();
    start.elapsed().as_secs_f64() * 1e6 / f64::from(QUERIES)
}

fn main() {
    let robot = kinopt::robot::Robot::read("models/franka_panda.urdf").unwrap();
    let arm = kinopt::Arm::new(&robot, "base", "flange").unwrap();
    let start = arm.default_start().to_vec();
    let limits: Vec<_> = arm.limits().collect();
    let targets = (0..QUERIES).map(|query| {
        let share = |joint: usize| 0.5 + 0.45 * (f64::from(query) * 1.7 + joint as f64).sin();
        let q = limits.iter().enumerate();
        let q = q.map(|(joint, range)| range.lower + share(joint) * (range.upper - range.lower));
        arm.base_from_tool(&q.collect::<Vec<_>>()).unwrap()
    });
    let targets: Vec<_> = targets.collect();
    let columns: Vec<_> = targets.iter().map(to_columns).collect();

    let text = |text: &str| CString::new(text).unwrap();
    let (path, base, tip) = (
        text("models/franka_panda.urdf"),
        text("base"),
        text("flange"),
    );
    let mut solution = kinopt::Solution::default();
    let (mut fastest_rust, mut fastest_c) = (f64::INFINITY, f64::INFINITY);
    // SAFETY: the pointers are those of live objects, arrays and texts of the stated lengths.
    unsafe {
        let (mut c_robot, mut c_arm, mut c_solution) = (null_mut(), null_mut(), null_mut());
        kinopt_robot_read(path.as_ptr(), null(), &raw mut c_robot);
        kinopt_arm_new(c_robot, base.as_ptr(), tip.as_ptr(), null(), &raw mut c_arm);
        kinopt_solution_new(&raw mut c_solution);
        // In turns, so that both have the same clock and load.
        for _ in 0..ROUNDS {
            fastest_rust = fastest_rust.min(time(|| {
                for target in &targets {
                    arm.solve_into(*target, &start, &mut solution).unwrap();
                }
            }));
            fastest_c = fastest_c.min(time(|| {
                for target in &columns {
                    kinopt_arm_solve(
                        c_arm,
                        target.as_ptr(),
                        start.as_ptr(),
                        start.len(),
                        c_solution,
                    );
                }
            }));
        }
        kinopt_solution_free(c_solution);
        kinopt_arm_free(c_arm);
        kinopt_robot_free(c_robot);
    }
    println!(
        "Rust {fastest_rust:.3} µs, C {fastest_c:.3} µs, difference {:.3} µs",
        fastest_c - fastest_rust
    );
}
