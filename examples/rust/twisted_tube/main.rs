//! From keys to skin: a clip twists one bone of a tube by half a turn, and the mesh follows by linear blend skinning
//! and by dual quaternions.
//!
//! `cargo run --example twisted_tube`: at 180° linear blend skinning loses two thirds of the blended half and
//! collapses the waist (the candy wrapper). Dual quaternions keep both.
#![allow(clippy::print_stdout)]

#[allow(dead_code, unreachable_pub, reason = "tests share it")]
mod tube;

use std::error::Error;
use std::f32::consts::PI;

use glam::{Affine3A, Quat, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::EulerOrder;
use kinopt::animation::{
    Armature, ArmatureBone, Channel, Clip, Cursor, EulerCurve, LocalTransform, Playback,
};
use kinopt::skinning::{MeshWeights, SkinningMethod};

use tube::TwistedTube;

fn main() -> Result<(), Box<dyn Error>> {
    let tube = TwistedTube::default();
    let (rest, weights) = (tube.mesh()?, MeshWeights::from(tube.weights()?));
    let bone = |name: &str, parent, x: f64| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform {
            translation: Vec3A::X * x as f32,
            ..LocalTransform::IDENTITY
        },
    };
    let bones = vec![
        bone("still", None, 0.0),
        bone("turns", Some(0), tube.length / 2.0),
    ];
    let armature = Armature::new(bones, Vec::new())?;

    // Angles instead of quaternions, as half a turn is equally short in both directions.
    let twist = EulerCurve {
        order: EulerOrder::Xyz,
        before: Quat::IDENTITY,
        angles: KeyedCurve::linear(vec![0.0, 4.0], vec![Vec3A::ZERO, Vec3A::X * PI])?,
    };
    let mut builder = Clip::builder("twist", &armature);
    builder.channel(armature.bone("turns")?, Channel::Euler(twist))?;
    let clip = builder.build();

    let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
    let mut model_from_bone = vec![Affine3A::IDENTITY; armature.bones()];
    let mut posed_from_rest = model_from_bone.clone();
    println!(
        "        volume kept, %          waist, %\ntwist   theory    lbs    dqs    lbs    dqs"
    );
    for step in 0..=4 {
        // Keys to local pose, local pose to bone placements, placements to skinning matrices, matrices to vertices.
        clip.sample(f64::from(step), Playback::Hold, &mut cursor, &mut pose)?;
        armature.local_to_model(&pose, &mut model_from_bone)?;
        armature.skinning_transforms(&model_from_bone, &mut posed_from_rest)?;
        let mut volumes = Vec::new();
        let mut waists = Vec::new();
        for method in SkinningMethod::ALL {
            let posed = weights.mesh(method, &rest, &posed_from_rest)?;
            volumes.push(100.0 * posed.signed_volume() / rest.signed_volume());
            let radii = tube
                .ring_radii(&posed)
                .into_iter()
                .map(|(_, radius)| radius);
            waists.push(100.0 * radii.fold(f64::INFINITY, f64::min) / tube.radius);
        }
        let degrees = 45.0 * f64::from(step);
        let lost = tube.blended_share * (1.0 - degrees.to_radians().cos()) / 3.0;
        println!(
            "{degrees:4}°  {:7.2} {:6.2} {:6.2} {:6.2} {:6.2}",
            100.0 * (1.0 - lost),
            volumes[0],
            volumes[1],
            waists[0],
            waists[1]
        );
    }
    Ok(())
}
