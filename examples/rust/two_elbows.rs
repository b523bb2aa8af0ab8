//! Two solutions of an arm of two bones by the law of cosines: elbow up and elbow down.
//!
//! `cargo run --example two_elbows` prints one hand and two elbows, mirrored at the line from the shoulder to the
//! target.
#![allow(clippy::print_stdout)]

use std::error::Error;

use kinopt::Problem;
use kinopt::geometric::{Elbow, Geometric, TwoBone, triangle};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::Model;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;

const UPPER: f64 = 2.0;
const LOWER: f64 = 1.5;

fn main() -> Result<(), Box<dyn Error>> {
    let [x, _, z] = Vector3::UNITS;
    let mut builder = Model::builder("arm");
    let shoulder = builder.continuous("shoulder", None, Placement::identity(), z);
    let elbow = builder.continuous(
        "elbow",
        Some(shoulder),
        Placement::translation(x * UPPER),
        z,
    );
    let hand = builder.frame("hand", Some(elbow), Placement::translation(x * LOWER));
    let bend = builder.frame("bend", Some(elbow), Placement::identity());
    let model = builder.build()?;
    let mut kinematics = ForwardKinematics::of_frames(&model, &[bend, hand])?;

    let target = Vector3::new(1.0, 2.0, 0.0);
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(hand, target));
    let problem = tasks.build()?;

    println!("target ({:.2}, {:.2})", target.x, target.y);
    println!("            shoulder     elbow   elbow at           hand at");
    for (name, side) in [
        ("elbow down", Elbow::Positive),
        ("elbow up", Elbow::Negative),
    ] {
        let solution = TwoBone::new(side).solve(&problem, &[0.0, 0.0])?;
        let placed = kinematics.place(&solution.q)?;
        let [bend, hand] = [placed[0], placed[1]].map(|frame| frame.translation);
        let [first, second] = [0, 1].map(|joint| solution.q[joint].to_degrees());
        println!(
            "{name:10} {first:8.3}° {second:8.3}°   ({:6.3}, {:6.3})   ({:.3}, {:.3})",
            bend.x, bend.y, hand.x, hand.y
        );
    }

    // The formula: cos θ₂ = (d² − L₁² − L₂²) / (2 L₁ L₂).
    let cosine = (target.norm_squared() - UPPER * UPPER - LOWER * LOWER) / (2.0 * UPPER * LOWER);
    println!(
        "by the law of cosines the elbow turns by ±{:.3}°",
        cosine.acos().to_degrees()
    );

    // In space the elbows form a circle, and a direction selects one. No model is needed.
    let solved = triangle(Vector3::zero(), [UPPER, LOWER], target, z);
    println!(
        "bent towards z it is at ({:.3}, {:.3}, {:.3})",
        solved.mid.x, solved.mid.y, solved.mid.z
    );
    Ok(())
}
