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

const QUERIES: u32 = 2_000;
const ROUNDS: usize = 15;

/// Shortest time of a query in several rounds, microseconds.
fn fastest(mut round: impl FnMut()) -> f64 {
    let rounds = (0..ROUNDS).map(|_| {
        let start = Instant::now();
        round();
        start.elapsed().as_secs_f64() * 1e6 / f64::from(QUERIES)
    });
    rounds.fold(f64::INFINITY, f64::min)
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

    let mut solution = kinopt::Solution::default();
    let of_rust = fastest(|| {
        for target in &targets {
            arm.solve_into(*target, &start, &mut solution).unwrap();
        }
    });

    let text = |text: &str| CString::new(text).unwrap();
    let (path, base, tip) = (
        text("models/franka_panda.urdf"),
        text("base"),
        text("flange"),
    );
    // SAFETY: the pointers are those of live objects, arrays and texts of the stated lengths.
    let of_c = unsafe {
        let (mut robot, mut arm, mut solution) = (null_mut(), null_mut(), null_mut());
        kinopt_robot_read(path.as_ptr(), null(), &raw mut robot);
        kinopt_arm_new(robot, base.as_ptr(), tip.as_ptr(), null(), &raw mut arm);
        kinopt_solution_new(&raw mut solution);
        let time = fastest(|| {
            for target in &columns {
                kinopt_arm_solve(arm, target.as_ptr(), start.as_ptr(), start.len(), solution);
            }
        });
        kinopt_solution_free(solution);
        kinopt_arm_free(arm);
        kinopt_robot_free(robot);
        time
    };
    println!(
        "Rust {of_rust:.3} µs, C {of_c:.3} µs, difference {:.3} µs",
        of_c - of_rust
    );
}
