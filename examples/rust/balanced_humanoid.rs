//! A humanoid robot crouches and reaches down, its feet in place and its centre of mass over them.
//!
//! `cargo run --example balanced_humanoid`
#![allow(clippy::print_stdout)]

use kinopt::Problem;
use kinopt::ik::{Drag, crouched_configuration};
use kinopt::kinematics::{ForwardKinematics, centre_of_mass};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::Vector3;
use kinopt::task::{FramePose, Point, Posture, SupportPolygon, Task};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = Robot::read("models/aldebaran_nao.urdf")?.with_base_joint(BaseJoint::FREE)?;
    let (model, map, up) = (robot.model(), robot.map(), Vector3::UNITS[2]);
    let feet = [model.frame("left_sole")?, model.frame("right_sole")?];
    let stance = crouched_configuration(model, map, &feet, &model.neutral(), up)?;
    let at = ForwardKinematics::new(model).place(&stance)?.to_vec();
    let hand = model.frame("left_hand")?;
    let start = at[hand.index()].translation;
    let mut tasks = Problem::builder(model);
    tasks.parameters(map.clone());
    let dragged = tasks.add(Point::new(hand, start));
    let mut balance = SupportPolygon::new(&robot.masses()?).with_margin(0.02);
    for foot in feet {
        tasks.add(Task::new(FramePose::new(foot, at[foot.index()])).scale(10.0));
        balance = balance.with_points_on(foot, robot.sole(foot));
    }
    tasks.add(Task::new(balance).scale(10.0));
    tasks.add(Posture::new(model, &stance).upright(model));
    let mut drag = Drag::new(tasks.build()?, &stance)?;
    for step in 1..=30 {
        let offset = Vector3::new(0.1, 0.0, -0.2) * (f64::from(step) / 30.0); // metres
        drag.target_mut(dragged)?.set_target(start + offset);
        drag.advance();
    }
    println!("{}", drag.settle(100).explain());
    println!("{:?}", centre_of_mass(model, &robot.masses()?, drag.q())?);
    Ok(())
}
