//! An arm among boxes: poses at least 2 cm away from all obstacles, and a world that changes.
//!
//! `cargo run --features collision --example collision_world`
#![allow(clippy::print_stdout)]

use kinopt::Arm;
use kinopt::collision::{Checker, World};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use nalgebra::{Isometry3, vector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = Robot::read("models/franka_panda.urdf")?;
    let mut world = World::new();
    world.add_box("table", [0.8, 1.2, 0.04], Vector3::new(0.65, 0.0, 0.1))?;
    world.add_box("shelf", [0.2, 0.6, 0.02], Vector3::new(0.75, 0.0, 0.5))?;
    world.add_cylinder("pillar", 0.05, 0.8, Vector3::new(0.4, 0.35, 0.5))?;
    let checker = Checker::of(&robot)?.with_world(&world)?.with_margin(0.02)?; // metres
    let fingers = robot.model().neutral(); // values of the joints outside the arm
    let arm = Arm::new(&robot, "base", "tool")?.with_checker(&checker, &fingers)?;

    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let down = vector![std::f64::consts::PI, 0.0, 0.0]; // axis times angle
    let target = Isometry3::new(vector![0.5, 0.1, 0.2], down);
    let solution = arm.solve(target, &start)?;
    println!("{}", solution.explain());
    assert!(solution.reached && arm.collisions(&solution.q)?.is_empty());

    world.add_sphere("ball", 0.1, Vector3::new(0.5, 0.1, 0.2))?;
    let blocked = arm.with_world(&world, None)?;
    let blocked = blocked.solve(target, &start)?;
    println!("{}", blocked.explain());
    assert!(!blocked.reached);
    Ok(())
}
