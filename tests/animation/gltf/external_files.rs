//! Promise: files written by other programs are read, posed and written again.
//!
//! They are not shipped: set `KINOPT_SHARED` to a folder that contains them in `assets/gltf/`.
#![allow(clippy::print_stderr)]

use std::path::PathBuf;

use glam::Vec3;
use kinopt::animation::{Cursor, Playback, Pose};
use kinopt::io::gltf::{self, Scene, ScenePosing, WriteOptions};
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

fn posed(scene: &Scene, pose: &Pose) -> Vec<Vec3> {
    let mut posing = ScenePosing::new(scene, SkinningMethod::LinearBlend).unwrap();
    posing.mesh(pose).unwrap().positions().to_vec()
}

/// Asserts that a written scene is read back with the same armature, meshes and clips.
fn assert_round_trip(scene: &Scene) {
    let options = WriteOptions::default();
    let bytes = gltf::to_bytes(scene, &options).unwrap();
    let again = gltf::from_bytes(&bytes, "again.glb", |_| unreachable!()).unwrap();
    assert_eq!(again.armature, scene.armature);
    assert_eq!(again.meshes, scene.meshes);
    assert_eq!(again.clips, scene.clips);
}

/// The reference numbers are from another program that reads the file and multiplies 4×4 matrices in double precision.
#[test]
fn fox_with_three_clips_equals_the_reference() {
    let Some(fox) = read("Fox.glb") else { return };
    assert_eq!(fox.armature.bones(), 26);
    let mesh = &fox.meshes[0].mesh;
    // Without indices.
    assert_eq!(
        (mesh.positions().len(), mesh.triangles().len()),
        (1728, 576)
    );
    let expected = [
        (
            "Run",
            0.4,
            [
                [2.9073, 31.3133, -23.8858],
                [9.6372, 29.8479, -44.7724],
                [7.5808, 37.0606, 41.5434],
                [-0.0, 45.9518, 72.4357],
            ],
            [-0.04131, 38.11772, 1.39721],
        ),
        (
            "Survey",
            2.0,
            [
                [2.0542, 34.1982, -20.7783],
                [7.7763, 19.9505, -28.9078],
                [7.0342, 28.2996, 24.1115],
                [0.5345, 55.0854, 68.8022],
            ],
            [0.11343, 33.08329, -1.6678],
        ),
        (
            "Walk",
            0.33,
            [
                [1.7303, 33.8703, -19.9725],
                [7.732, 24.3277, -31.2083],
                [6.9694, 26.9116, 18.2158],
                [-0.1684, 52.1123, 69.9932],
            ],
            [-0.14396, 34.03493, -1.84214],
        ),
    ];
    for (name, time, vertices, mean) in expected {
        let clip = fox
            .clips
            .iter()
            .position(|clip| clip.name() == name)
            .unwrap();
        let positions = posed(&fox, &at(&fox, clip, time));
        for (vertex, expected) in [0, 500, 1000, 1727].into_iter().zip(vertices) {
            let found = positions[vertex];
            assert!(
                found.distance(Vec3::from(expected)) < 2e-4,
                "{name}, {vertex}: {found}"
            );
        }
        let sum: Vec3 = positions.iter().sum();
        assert!((sum / 1728.0).distance(Vec3::from(mean)) < 1e-4, "{name}");
    }
    assert_round_trip(&fox);
}

#[test]
fn simple_skin_bends_as_specified() {
    let Some(scene) = read("SimpleSkin.gltf") else {
        return;
    };
    // Both joints are at (0, 1, 0) and were bound at (0.5, 1, 0). After a second the upper one has rotated by a quarter
    // turn about z.
    let positions = posed(&scene, &at(&scene, 0, 1.0));
    for (vertex, expected) in [
        (0, [-0.5, 0.0, 0.0]),
        (7, [-0.25, 1.5, 0.0]),
        (9, [-1.0, 1.5, 0.0]),
    ] {
        let found = positions[vertex];
        assert!(
            found.distance(Vec3::from(expected)) < 1e-6,
            "{vertex}: {found}"
        );
    }
    assert_round_trip(&scene);
}

#[test]
fn step_linear_and_cubic_clips_are_sampled() {
    let Some(scene) = read("interpolation_test.gltf") else {
        return;
    };
    let height = |clip: &str, node: &str, time: f64| {
        let clip = scene
            .clips
            .iter()
            .position(|candidate| candidate.name() == clip)
            .unwrap();
        let bone = scene.armature.bone(node).unwrap();
        at(&scene, clip, time).local(bone).unwrap().translation.y
    };
    let step = |time| height("Step Translation", "Cube.006", time);
    assert_eq!([step(0.8), step(0.85), step(1.3)], [10.0, 6.0, 10.0]);
    let line = height("Linear Translation", "Cube.009", 0.9375);
    assert!((line - 7.0).abs() < 1e-4, "{line}");
    // Tangents of zero: the interpolation factor is 3u² − 2u³.
    let spline = height("CubicSpline Translation", "Cube.008", 0.9375);
    let u: f32 = 0.25;
    assert!(
        (spline - (6.0 + 4.0 * u * u * (3.0 - 2.0 * u))).abs() < 1e-4,
        "{spline}"
    );
    assert_round_trip(&scene);
}

#[test]
fn cube_with_two_morph_targets_is_posed() {
    let Some(scene) = read("AnimatedMorphCube.gltf") else {
        return;
    };
    let mut pose = scene.armature.rest().clone();
    let rest = posed(&scene, &pose);
    // The largest deltas in the file's accessors, along y; the node rotates y to −z and scales by 100.
    for (target, most) in [0.018_932_53, 0.019_890_836].into_iter().enumerate() {
        pose.morph_weights_mut().copy_from_slice(&[0.0; 2]);
        pose.morph_weights_mut()[target] = 0.5;
        let moved = posed(&scene, &pose);
        let raised = moved.iter().zip(&rest).map(|(a, b)| b.z - a.z);
        let raised = raised.fold(f32::MIN, f32::max);
        assert!((raised - 50.0 * most).abs() < 1e-6, "{target}: {raised}");
    }
    assert_eq!(scene.meshes[0].tangents.len(), 24);
    assert_eq!(scene.clips[0].name(), "Square");
    assert_round_trip(&scene);
}
