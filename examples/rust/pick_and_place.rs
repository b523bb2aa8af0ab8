//! Pick and place: straight lines through key positions, timed within limits.
//!
//! `cargo run --example pick_and_place`
#![allow(clippy::print_stdout)]

use kinopt::Arm;
use kinopt::motion::path::{CartesianPath, PathSolver, TimingLimits};
use kinopt::robot::Robot;
use kinopt::spatial::Placement;
use nalgebra::{Isometry3, vector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = Robot::read("models/franka_panda.urdf")?;
    let arm = Arm::new(&robot, "base", "tool")?;
    let down = vector![std::f64::consts::PI, 0.0, 0.0]; // axis times angle
    let at = |x, y, z| Placement::from(Isometry3::new(vector![x, y, z], down)); // metres
    let home = at(0.4, 0.0, 0.5);
    let (over_pick, pick) = (at(0.5, -0.3, 0.3), at(0.5, -0.3, 0.1));
    let (over_place, place) = (at(0.5, 0.3, 0.3), at(0.5, 0.3, 0.1));
    let keys = [
        over_pick, pick, over_pick, over_place, place, over_place, home,
    ];

    let path = CartesianPath::new([home])?.through(&keys, 0.01)?;
    let joints = PathSolver::new(&arm).solve(&path)?;
    println!(
        "{} points, {} reconfigurations",
        path.points().len(),
        joints.jumps.len()
    );
    assert!(joints.reached() && joints.jumps.is_empty());
    let limits = TimingLimits::of(&arm)
        .with_acceleration_limits(&[5.0; 7]) // rad/s²
        .with_jerk_limits(&[100.0; 7]); // rad/s³
    let motion = joints.trajectory(&limits)?;
    println!("{:.2} s", motion.duration());
    Ok(())
}
