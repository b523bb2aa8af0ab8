//! URDF in, joint angles out: `cargo run --example arm`.
#![allow(clippy::print_stdout)]

use kinopt::arm::Arm;
use kinopt::robot::Robot;
use nalgebra::{Isometry3, Vector3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = Robot::read("models/franka_panda.urdf")?;
    let arm = Arm::new(&robot, "base", "flange")?;
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    // 0.5 m ahead, 0.5 m up, pointing down.
    let down = Vector3::x() * std::f64::consts::PI;
    let target = Isometry3::new(Vector3::new(0.5, 0.0, 0.5), down);
    let solution = arm.solve(target, &start)?;
    println!("{}\nq = {:.4?}", solution.explain(), solution.q);
    assert!(solution.reached);
    Ok(())
}
