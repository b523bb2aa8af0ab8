//! A servo at 1 kHz: the tool follows a target that jumps, within velocity, acceleration and jerk limits.
//!
//! `cargo run --example servo`
#![allow(clippy::print_stdout)]

use kinopt::arm::Arm;
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = Robot::read("models/franka_panda.urdf")?;
    let arm = Arm::new(&robot, "base", "tool")?;
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let servo = arm.servo(&start, 0.001)?;
    let mut servo = servo
        .with_acceleration_limits(&[10.0; 7])? // rad/s²
        .with_jerk_limits(&[500.0; 7])?; // rad/s³
    let mut target = arm.base_from_tool(&start)?;
    let (mut cycles, mut acceleration) = (0, 0.0_f64);
    for offset in [Vector3::new(0.0, 0.2, 0.1), Vector3::new(0.0, -0.4, 0.0)] {
        target.translation += offset; // metres
        loop {
            let step = servo.step(target)?;
            cycles += 1;
            acceleration = step
                .acceleration
                .iter()
                .fold(acceleration, |a, b| a.max(b.abs()));
            if step.reached() {
                break;
            }
        }
    }
    println!("{cycles} cycles, at most {acceleration:.2} rad/s²");
    assert!(acceleration <= 10.0 * (1.0 + 1e-9));
    Ok(())
}
