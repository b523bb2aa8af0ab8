//! A motion capture on a humanoid robot: retargeted within its limits and saved as a table.
//!
//! `cargo run --features motion --example retargeting`
#![allow(clippy::print_stdout)]

use kinopt::io::bvh;
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting};
use kinopt::robot::{BaseJoint, Robot};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = Robot::read("models/aldebaran_nao.urdf")?.with_base_joint(BaseJoint::FREE)?;
    let file = bvh::read("models/captures/steps.bvh")?;
    let capture = Capture::of_clip(&file.armature, &file.clip, 30.0)?;
    let guess = BodyMap::guess(&capture, robot.model())?;
    let retargeting = Retargeting::new(&robot, &guess.map, &capture, RetargetOptions::default())?;
    let motion = retargeting.per_frame()?;
    println!(
        "{} frames, foot sliding {:.5} m",
        motion.rows().count(),
        motion.report.slip
    );
    assert!(motion.rows().all(|q| robot.model().is_within_limits(q)));

    let out = std::env::temp_dir().join("steps.csv");
    let mut table = String::new();
    for q in motion.rows() {
        let numbers: Vec<String> = q.iter().map(f64::to_string).collect();
        table += &(numbers.join(",") + "\n");
    }
    std::fs::write(&out, table)?;
    println!("saved: {}", out.display());
    Ok(())
}
