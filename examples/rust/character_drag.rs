//! A hand of a character follows a target while head, other hand and feet stay in place. The posed mesh is saved.
//!
//! `cargo run --features animation --example character_drag`
#![allow(clippy::print_stdout)]

use kinopt::Problem;
use kinopt::ik::Drag;
use kinopt::io::{obj, rig::Rig};
use kinopt::skinning::SkinningMethod;
use kinopt::spatial::Vector3;
use kinopt::task::Point;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rig = Rig::read("models/humanoid/humanoid.json")?;
    let (skeleton, rest) = (&rig.skeleton, rig.skeleton.model().neutral());
    let pose = skeleton.pose(&rest)?;
    let hand = skeleton.bone("left_hand")?;
    let start = pose.tip(skeleton, hand)?;

    let mut tasks = Problem::builder(skeleton.model());
    let dragged = tasks.add(Point::new(skeleton.tip(hand), start));
    for &bone in rig.constrained.iter().filter(|&&bone| bone != hand) {
        tasks.add(Point::new(skeleton.tip(bone), pose.tip(skeleton, bone)?));
    }
    let goal = Vector3::new(0.35, 0.45, 1.5); // metres
    let mut drag = Drag::new(tasks.build()?, &rest)?;
    for step in 1..=30 {
        let target = start + (goal - start) * (f64::from(step) / 30.0);
        drag.target_mut(dragged)?.set_target(target);
        drag.advance();
    }
    let solution = drag.settle(100);
    println!("{}", solution.explain());
    assert!(solution.reached);
    let posed = rig.posed_mesh(&solution.q, SkinningMethod::DualQuaternion)?;
    let out = std::env::temp_dir().join("reaching.obj");
    obj::write(&posed, &out)?;
    println!("saved: {}", out.display());
    Ok(())
}
