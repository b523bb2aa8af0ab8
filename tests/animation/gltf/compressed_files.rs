//! Promise: files in Draco and meshopt compression have the nodes, skins, clips and meshes of the original, up to
//! quantisation.

use kinopt::animation::{Cursor, Playback};
use kinopt::io::gltf::{Scene, ScenePosing};
use kinopt::skinning::SkinningMethod;
use support::gltf_text::read;

const ORIGINAL: &[u8] = include_bytes!("compressed/tube.glb");
const DRACO: &[u8] = include_bytes!("compressed/tube-draco.glb");
const MESHOPT: &[u8] = include_bytes!("compressed/tube-meshopt.glb");

/// Largest quantisation error of positions of a tube of 1.5 m in 12 bits, metres.
const QUANTUM: f32 = 1.5 / 4096.0;

/// Corners of all triangles of the first mesh in a pose of the first clip, in an order that compression keeps: sorted.
fn corners(scene: &Scene, time: f64) -> Vec<[f32; 3]> {
    let mut pose = scene.armature.rest().clone();
    let clip = &scene.clips[0];
    clip.sample(time, Playback::Hold, &mut Cursor::new(), &mut pose)
        .unwrap();
    pose.morph_weights_mut()[0] = 0.5;
    let mut posing = ScenePosing::new(scene, SkinningMethod::LinearBlend).unwrap();
    let mesh = posing.mesh(&pose).unwrap();
    let positions = mesh.positions();
    let triangles = mesh.triangles().iter().flatten();
    triangles
        .map(|&vertex| positions[vertex as usize].to_array())
        .collect()
}

/// Largest distance of a point of `a` from the nearest of `b`.
fn distance(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    let nearest = |p: &[f32; 3]| {
        let to = |q: &[f32; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f32>().sqrt();
        b.iter().map(to).fold(f32::INFINITY, f32::min)
    };
    a.iter().map(nearest).fold(0.0, f32::max)
}

/// Bones by name; compression may change their order.
fn bones(scene: &Scene) -> Vec<String> {
    let mut names = scene.armature.names().to_vec();
    names.sort();
    names
}

fn check(compressed: &[u8]) {
    let [original, decoded] = [ORIGINAL, compressed].map(|bytes| read(bytes).unwrap());
    assert_eq!(bones(&original), bones(&decoded));
    assert_eq!(decoded.meshes[0].mesh.triangles().len(), 72);
    assert_eq!(decoded.turning_bones().len(), 2);
    for time in [0.0, 0.25, 0.7] {
        let [expected, found] = [&original, &decoded].map(|scene| corners(scene, time));
        let error = distance(&expected, &found).max(distance(&found, &expected));
        assert!(error < 4.0 * QUANTUM, "{error} m at {time} s");
    }
}

#[test]
fn draco_meshes_are_decoded() {
    check(DRACO);
}

#[test]
fn meshopt_views_are_decoded() {
    check(MESHOPT);
}

#[test]
fn khr_meshopt_views_are_decoded() {
    // Both extensions have the same members, and names of equal length.
    let ext = b"EXT_meshopt_compression";
    let mut bytes = MESHOPT.to_vec();
    while let Some(at) = bytes.windows(ext.len()).position(|window| window == ext) {
        bytes[at..at + 3].copy_from_slice(b"KHR");
    }
    check(&bytes);
}

/// A file with 16 bytes from `offset` in its binary chunk replaced.
fn damaged(file: &[u8], offset: usize) -> Vec<u8> {
    let json = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let first = 20 + json + 8 + offset;
    let mut bytes = file.to_vec();
    bytes[first..first + 16].fill(0x5A);
    bytes
}

#[test]
fn damaged_compression_is_an_error() {
    let document = |file: &[u8]| -> serde_json::Value {
        let json = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
        serde_json::from_slice(&file[20..20 + json]).unwrap()
    };
    let number = |value: &serde_json::Value| value.as_u64().unwrap_or(0) as usize;
    let draco = document(DRACO);
    let view = &draco["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
    let view = &draco["bufferViews"][number(&view["bufferView"])];
    let meshopt = document(MESHOPT);
    let extension = &meshopt["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
    for (file, view, name) in [
        (DRACO, view, "KHR_draco_mesh_compression"),
        (MESHOPT, extension, "meshopt_compression"),
    ] {
        let error = read(&damaged(file, number(&view["byteOffset"]))).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
}

#[test]
fn damaged_bytes_never_panic() {
    let mut random = support::random::Random::new(55);
    for file in [DRACO, MESHOPT] {
        let json = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
        for _ in support::random::cases(300, 100) {
            let mut bytes = file.to_vec();
            let first = 20 + json + 8;
            for _ in 0..3 {
                let at = first + random.below(bytes.len() - first);
                bytes[at] = random.below(256) as u8;
            }
            let _ = read(&bytes);
        }
    }
}
