//! Pick and place: straight lines through key positions, timed within limits.
//!
//! `cargo run --example pick_and_place`
#![allow(clippy::print_stdout)]

use kinopt::Arm;
use kinopt::motion::path::{CartesianPath, PathSolver, TimingLimits};
use kinopt::robot::Robot;
use nalgebra::{Isometry3, vector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = Robot::read("models/franka_panda.urdf")?;
    let arm = Arm::new(&robot, "base", "tool")?;
    let down = vector![std::f64::consts::PI, 0.0, 0.0]; // axis times angle
    let home = vector![0.4, 0.0, 0.5]; // metres
    let (over_pick, pick) = (vector![0.5, -0.3, 0.3], vector![0.5, -0.3, 0.1]);
    let (over_place, place) = (vector![0.5, 0.3, 0.3], vector![0.5, 0.3, 0.1]);
    let mut keys = vec![home, over_pick, pick, over_pick];
    keys.extend([over_place, place, over_place, home]);
    let mut points = Vec::new();
    for ends in keys.windows(2) {
        for step in 0..50 {
            let at = ends[0].lerp(&ends[1], f64::from(step) / 50.0);
            points.push(Isometry3::new(at, down).into());
        }
    }
    let path = CartesianPath::new(points)?;
    let joints = PathSolver::new(&arm).solve(&path)?;
    println!("{} reconfigurations", joints.jumps.len());
    assert!(joints.reached() && joints.jumps.is_empty());
    let limits = TimingLimits::of(&arm)
        .with_acceleration_limits(&[5.0; 7]) // rad/s²
        .with_jerk_limits(&[100.0; 7]); // rad/s³
    let motion = joints.trajectory(&limits)?;
    println!("{:.2} s", motion.duration());
    Ok(())
}
