//! From keyframes to a posed skin: sampling and blending.

use std::error::Error;
use std::hint::black_box;

use glam::Vec3;
use kinopt::animation::{EulerClip, EulerKey, EulerTrack, Playback};
use kinopt::skinning::{Deformation, LinearBlend, SkinWeights, single_precision_transform};

use super::{Run, Stage, single};
use crate::{Sequence, at_ease, figure};

const VERTICES: usize = 1000;
const INFLUENCES: usize = 4;
const KEYS: usize = 40;

pub(super) fn stages() -> Vec<Stage> {
    vec![
        single("clip of 22 bones and 40 keys, one sample", sample),
        single("linear blend, positions of 1000 vertices", || blend(false)),
        single("linear blend, normals of 1000 vertices", || blend(true)),
    ]
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

fn blend(normals: bool) -> Result<Run, Box<dyn Error>> {
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
    let pose = skeleton.pose(&at_ease(&skeleton));
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
        let blend = LinearBlend::new(&weights, &transforms)?;
        let moved = match normals {
            true => blend.normals(&rest, &mut posed),
            false => blend.positions(&rest, &mut posed),
        };
        black_box(&posed);
        moved
    };
    run()?;
    Ok(Box::new(move || {
        let _checked_once = run();
    }))
}
