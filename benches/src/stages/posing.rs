//! Sampling, blending and skinning: from keyframes to a posed skin.

use std::error::Error;
use std::hint::black_box;

use glam::{Affine3A, Vec3};
use kinopt::animation::{Cursor, EulerClip, EulerKey, EulerTrack, Playback};
use kinopt::skinning::{
    Deformation, LinearBlend, PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights,
    PosedVertices, RestVertices, SkinWeights, SkinningError, single_precision_transform,
};

use super::{Run, Stage, single};
use crate::{Keying, Sequence, armature, at_ease, clip, figure};

const VERTICES: usize = 1000;
const INFLUENCES: usize = 4;
const KEYS: usize = 40;
/// Number of bones of a game character.
const CHARACTER_BONES: usize = 67;

pub(super) fn stages() -> Vec<Stage> {
    vec![
        single("clip of 22 bones and 40 keys, one sample", sample),
        single("clip of a body of 67 bones, at 60 Hz", || {
            character(Keying::Body)
        }),
        single("clip of 67 bones, all channels, at 60 Hz", || {
            character(Keying::Everything)
        }),
        single(
            "clip of 67 bones, all channels keyed apart, at 60 Hz",
            || character(Keying::ReducedEverything),
        ),
        single("linear blend, positions of 1000 vertices", || {
            skin(|weights, transforms, rest, posed| {
                LinearBlend::new(weights.any, transforms)?.positions(rest, posed)
            })
        }),
        single("linear blend, normals of 1000 vertices", || {
            skin(|weights, transforms, rest, posed| {
                LinearBlend::new(weights.any, transforms)?.normals(rest, posed)
            })
        }),
        single("packed linear blend, 1000 vertices", || {
            skin(|weights, transforms, rest, posed| {
                let blend = PackedLinearBlend::new(weights.four, transforms)?;
                blend.deform(positions(rest), into(posed))
            })
        }),
        single("packed dual quaternions, 1000 vertices", || {
            skin(|weights, transforms, rest, posed| {
                let blend = PackedDualQuaternionBlend::new(weights.four, transforms)?;
                blend.deform(positions(rest), into(posed))
            })
        }),
    ]
}

fn positions(rest: &[Vec3]) -> RestVertices<'_> {
    RestVertices {
        positions: rest,
        normals: &[],
        tangents: &[],
    }
}

fn into(posed: &mut [Vec3]) -> PosedVertices<'_> {
    PosedVertices {
        positions: posed,
        normals: &mut [],
        tangents: &mut [],
    }
}

fn sample() -> Result<Run, Box<dyn Error>> {
    let (skeleton, _) = figure(2, 4);
    let mut random = Sequence::new(0.5);
    let mut key = |k: usize| EulerKey {
        time: 0.1 * k as f64 + 0.05 * random.unit(),
        angles: [random.unit(), random.unit(), random.unit()],
    };
    let tracks = skeleton.bone_ids().map(|bone| EulerTrack {
        bone,
        keys: (0..KEYS).map(&mut key).collect(),
    });
    let clip = EulerClip::new(tracks.collect())?;
    let mut q = vec![0.0; skeleton.angles()];
    clip.sample(1.0, Playback::Loop, &mut q)?;
    let mut time = 0.0;
    Ok(Box::new(move || {
        time = (time + 0.0731) % 4.0;
        let _checked_once = clip.sample(time, Playback::Loop, &mut q);
        black_box(&q);
    }))
}

/// One frame of clip playback.
fn character(keying: Keying) -> Result<Run, Box<dyn Error>> {
    let armature = armature(CHARACTER_BONES);
    let clip = clip(&armature, keying, &mut Sequence::new(0.5));
    let mut pose = armature.rest().clone();
    let (mut cursor, mut frame) = (Cursor::new(), 0_u32);
    let mut run = move || {
        frame += 1;
        let sampled = clip.sample(
            f64::from(frame) / 60.0,
            Playback::Loop,
            &mut cursor,
            &mut pose,
        );
        black_box(&pose);
        sampled
    };
    run()?;
    Ok(Box::new(move || {
        let _checked_once = run();
    }))
}

/// The weights in each form.
struct Weights<'a> {
    any: &'a SkinWeights,
    four: &'a PackedWeights,
}

/// Skins one frame with the transforms of the bones.
type Blend = fn(Weights<'_>, &[Affine3A], &[Vec3], &mut [Vec3]) -> Result<(), SkinningError>;

fn skin(blend: Blend) -> Result<Run, Box<dyn Error>> {
    let (skeleton, _) = figure(2, 4);
    let bones = skeleton.bones().len();
    let mut random = Sequence::new(0.5);
    let mut weights = SkinWeights::builder(VERTICES, bones);
    for vertex in 0..VERTICES {
        for k in 0..INFLUENCES {
            weights.add(vertex, (vertex + 5 * k) % bones, 1.0 / INFLUENCES as f64)?;
        }
    }
    let weights = weights.build()?;
    let packed = PackedWeights::new(&weights)?;
    let pose = skeleton.pose(&at_ease(&skeleton))?;
    let transforms: Vec<_> = pose
        .skinning_transforms(&skeleton)
        .map(|transform| single_precision_transform(&transform))
        .collect();
    let mut coordinate = || random.unit() as f32;
    let rest: Vec<Vec3> = (0..VERTICES)
        .map(|_| Vec3::new(coordinate(), coordinate(), coordinate()).normalize())
        .collect();
    let mut posed = rest.clone();
    let mut run = move || {
        let weights = Weights {
            any: &weights,
            four: &packed,
        };
        let moved = blend(weights, &transforms, &rest, &mut posed);
        black_box(&posed);
        moved
    };
    run()?;
    Ok(Box::new(move || {
        let _checked_once = run();
    }))
}
