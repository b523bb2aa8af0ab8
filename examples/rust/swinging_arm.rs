//! Forward kinematics over time: the four joints of an arm swing like pendulums at different frequencies, and the
//! hand draws a curve.
//!
//! `cargo run --example swinging_arm` prints one period of three seconds that ends at its start. The hand is never
//! farther from the shoulder than the length of the bones. To see the curve: `cargo run -q --example swinging_arm |
//! gnuplot -p -e "plot '-' using 2:3 with lines"`
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec3A};
use kinopt::animation::{Armature, ArmatureBone, LocalTransform};

const LENGTHS: [f32; 4] = [2.0, 1.5, 1.0, 0.5];
/// Swings per period, and amplitude in radians.
const SWINGS: [(f32, f32); 4] = [(1.0, 0.8), (2.0, 0.9), (3.0, 0.7), (5.0, 0.5)];
const PERIOD: f32 = 3.0;
const FRAMES: u32 = 90;

fn main() -> Result<(), Box<dyn Error>> {
    // Each bone begins at the end of its parent.
    let bones = (0..LENGTHS.len()).map(|k| ArmatureBone {
        name: format!("bone {k}"),
        parent: k.checked_sub(1),
        rest: LocalTransform {
            translation: Vec3A::X * k.checked_sub(1).map_or(0.0, |parent| LENGTHS[parent]),
            ..LocalTransform::IDENTITY
        },
    });
    let armature = Armature::new(bones.collect(), Vec::new())?;
    let hand = Vec3A::X * LENGTHS[3];

    let mut pose = armature.rest().clone();
    let mut model_from_bone = vec![Affine3A::IDENTITY; armature.bones()];
    println!("# seconds       x       y   from the shoulder");
    for frame in 0..=FRAMES {
        let time = PERIOD * frame as f32 / FRAMES as f32;
        for (index, (frequency, swing)) in SWINGS.into_iter().enumerate() {
            let angle = swing * (TAU * frequency * time / PERIOD).sin();
            if let Some(bone) = armature.bone_at(index) {
                let mut local = pose.local(bone)?;
                local.rotation = Quat::from_rotation_z(angle);
                pose.set_local(bone, local)?;
            }
        }
        // W_j = W_parent(j) L_j; the hand is the end of the last bone.
        armature.local_to_model(&pose, &mut model_from_bone)?;
        let at = model_from_bone[3].transform_point3a(hand);
        println!("{time:9.3} {:7.3} {:7.3} {:11.3}", at.x, at.y, at.length());
    }
    Ok(())
}
