//! Promise: files that other programs wrote are read, posed and written again.
//!
//! They are not shipped: set `KINOPT_SHARED` to a folder that has them under `assets/gltf/`.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used, clippy::print_stderr)]

use std::path::PathBuf;

use kinopt::animation::{Cursor, Playback, Pose};
use kinopt::io::gltf::{self, Scene, ScenePosing};
use kinopt::skinning::SkinningMethod;

fn shared(file: &str) -> Option<PathBuf> {
    let Some(shared) = std::env::var_os("KINOPT_SHARED") else {
        eprintln!("SKIPPED: KINOPT_SHARED is not set, so {file} was not read");
        return None;
    };
    Some(PathBuf::from(shared).join("assets/gltf").join(file))
}

fn read(file: &str) -> Option<Scene> {
    shared(file).map(|path| gltf::read(path).unwrap())
}

fn at(scene: &Scene, clip: usize, time: f64) -> Pose {
    let mut pose = scene.armature.rest().clone();
    let mut cursor = Cursor::new();
    scene.clips[clip]
        .sample(time, Playback::Hold, &mut cursor, &mut pose)
        .unwrap();
    pose
}

#[test]
fn a_fox_of_24_joints_and_three_clips() {
    let Some(fox) = read("Fox.glb") else { return };
    eprintln!("{:?}", fox.notes);
    assert_eq!(fox.armature.bones(), 26);
    let names: Vec<_> = fox.clips.iter().map(|clip| clip.name()).collect();
    assert_eq!(names, ["Survey", "Walk", "Run"]);
    let mesh = &fox.meshes[0];
    assert_eq!(
        (mesh.mesh.positions().len(), mesh.mesh.triangles().len()),
        (1728, 576)
    );
    let skin = mesh.skin.as_ref().unwrap();
    assert_eq!(skin.joints.len(), 24);
    let mut posing = ScenePosing::new(&fox, SkinningMethod::LinearBlend).unwrap();
    let posed = posing.mesh(&at(&fox, 2, 0.25)).unwrap();
    eprintln!(
        "{:?} -> {:?}",
        mesh.mesh.bounding_box(),
        posed.bounding_box()
    );
    // It runs, but does not run away.
    let moved = posed.positions().iter().zip(mesh.mesh.positions());
    let furthest = moved.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!((5.0..100.0).contains(&furthest), "{furthest}");
}
