//! Face of fourteen vertices and four morph targets (smile, frown, surprise, blink), animated by a clip of their
//! weights.
//!
//! `cargo run --example face`: the mouth's corners rise, the mouth opens, the corners fall, and the eyes close only
//! at 0.6 s and 3.6 s.
#![allow(clippy::print_stdout)]

use std::error::Error;

use glam::Vec3;
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{Armature, Clip, Cursor, Easing, Playback};
use kinopt::skinning::{MorphTarget, MorphTargets};

/// Brows, lids, nose, mouth and chin, from left to right and top to bottom.
const FACE: [[f32; 2]; 14] = [
    [-0.8, 0.8],
    [-0.3, 0.8],
    [0.3, 0.8],
    [0.8, 0.8],
    [-0.5, 0.6],
    [0.5, 0.6],
    [-0.5, 0.4],
    [0.5, 0.4],
    [0.0, 0.0],
    [-0.4, -0.5],
    [0.0, -0.45],
    [0.4, -0.5],
    [0.0, -0.55],
    [0.0, -1.0],
];
const INNER_BROW: usize = 1;
const LIDS: [usize; 2] = [4, 6];
const CORNER: usize = 9;
const LIPS: [usize; 2] = [10, 12];

/// Morph target from the moved vertices in ascending order, with their offsets in x and y.
fn target(name: &str, moves: &[(u32, [f32; 2])]) -> Result<MorphTarget, Box<dyn Error>> {
    let vertices = moves.iter().map(|(vertex, _)| *vertex).collect();
    let deltas = moves.iter().map(|(_, [x, y])| Vec3::new(*x, *y, 0.0));
    Ok(MorphTarget::new(
        name,
        vertices,
        deltas.collect(),
        vec![],
        vec![],
    )?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let targets = vec![
        target(
            "smile",
            &[(9, [-0.1, 0.15]), (11, [0.1, 0.15]), (12, [0.0, -0.05])],
        )?,
        target(
            "frown",
            &[
                (1, [0.05, -0.1]),
                (2, [-0.05, -0.1]),
                (9, [0.0, -0.15]),
                (11, [0.0, -0.15]),
            ],
        )?,
        target(
            "surprise",
            &[
                (0, [0.0, 0.15]),
                (1, [0.0, 0.2]),
                (2, [0.0, 0.2]),
                (3, [0.0, 0.15]),
                (4, [0.0, 0.05]),
                (5, [0.0, 0.05]),
                (9, [0.1, 0.0]),
                (11, [-0.1, 0.0]),
                (12, [0.0, -0.3]),
                (13, [0.0, -0.25]),
            ],
        )?,
        target("blink", &[(4, [0.0, -0.2]), (5, [0.0, -0.2])])?,
    ];
    let names = targets.iter().map(|target| target.name().to_owned());
    // The face has no bones, only morph targets.
    let armature = Armature::new(Vec::new(), names.collect())?;
    let targets = MorphTargets::new(FACE.len(), targets)?;

    // Expressions are smooth; the lids open and close linearly.
    let mut builder = Clip::builder("expressions", &armature);
    for (name, times) in [
        ("smile", [0.0, 1.0, 2.0]),
        ("surprise", [1.0, 2.0, 3.0]),
        ("frown", [2.0, 3.0, 4.0]),
    ] {
        let smooth = vec![Easing::CubicInOut; 3];
        let weights = KeyedCurve::eased(times.to_vec(), vec![0.0, 1.0, 0.0], smooth)?;
        builder.morph_weight(armature.morph_target(name)?, weights)?;
    }
    let times = vec![0.5, 0.6, 0.7, 3.5, 3.6, 3.7];
    let blink = KeyedCurve::linear(times, vec![0.0, 1.0, 0.0, 0.0, 1.0, 0.0])?;
    builder.morph_weight(armature.morph_target("blink")?, blink)?;
    let clip = builder.build();

    let rest = FACE.map(|[x, y]| Vec3::new(x, y, 0.0));
    let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
    println!("time   smile frown surpr blink   corner  mouth    eye   brow");
    for frame in 0..=20 {
        let time = 0.2 * f64::from(frame);
        clip.sample(time, Playback::Hold, &mut cursor, &mut pose)?;
        let mut face = rest;
        targets.apply(pose.morph_weights(), &mut face, &mut [], &mut [])?;
        let [open_mouth, open_eye] = [LIPS, LIDS].map(|[up, low]| face[up].y - face[low].y);
        let weights: Vec<String> = pose
            .morph_weights()
            .iter()
            .map(|w| format!("{w:.3}"))
            .collect();
        println!(
            "{time:.1} s  {}  {:6.3} {open_mouth:6.3} {open_eye:6.3} {:6.3}",
            weights.join(" "),
            face[CORNER].y,
            face[INNER_BROW].y
        );
    }
    Ok(())
}
