//! Promise: a rig written as a scene is one animated file. Read again, its skin has the rig's positions.

use kinopt::animation::{Clip, Cursor, Playback};
use kinopt::io::gltf::{self, Scene, ScenePosing, WriteOptions};
use kinopt::skinning::{MeshWeights, SkinningMethod, single_precision_transform};
use support::bones::humanoid;

#[test]
fn skin_of_the_scene_moves_as_that_of_the_rig() {
    let rig = humanoid();
    let (mesh, weights) = (rig.mesh.as_ref().unwrap(), rig.weights.as_ref().unwrap());
    let mut scene = Scene::of_skeleton(&rig.skeleton, Some((mesh, weights))).unwrap();
    // Morph targets that are added later use the armature's first weights.
    assert_eq!(scene.meshes[0].first_morph_weight, 0);
    // The mesh has its own bone, which is at rest like every other bone.
    let bones = scene.armature.bones();
    assert_eq!(bones, rig.skeleton.bones().len() + 1);
    assert_eq!(scene.armature.rest_from_model().len(), bones);
    let mut builder = Clip::builder("keys", &scene.armature);
    builder.euler_clip(&rig.clip).unwrap();
    let clip = builder.build();
    scene.clips.push(clip);
    let options = WriteOptions::default();
    let bytes = gltf::to_bytes(&scene, &options).unwrap();
    let scene = gltf::from_bytes(&bytes, "rig.glb", |_| unreachable!()).unwrap();
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    let (clip, [start, end]) = (&scene.clips[0], rig.clip.time_span().unwrap());
    let weights = MeshWeights::from(weights.clone());
    let mut posing = ScenePosing::new(&scene, SkinningMethod::LinearBlend).unwrap();
    let mut pose = scene.armature.rest().clone();
    let mut q = vec![0.0; rig.skeleton.angles()];
    // At 30 samples per second, where the curves equal the rig's own.
    for frame in [0, 7, 22, 40] {
        let time = (start + f64::from(frame) / 30.0).min(end);
        rig.clip.sample(time, Playback::Hold, &mut q).unwrap();
        let posed_skeleton = rig.skeleton.pose(&q).unwrap();
        let transforms: Vec<_> = posed_skeleton
            .skinning_transforms(&rig.skeleton)
            .map(|transform| single_precision_transform(&transform))
            .collect();
        let expected = weights
            .mesh(SkinningMethod::LinearBlend, mesh, &transforms)
            .unwrap();
        clip.sample(
            time - f64::from(clip.span()[0]),
            Playback::Hold,
            &mut Cursor::new(),
            &mut pose,
        )
        .unwrap();
        let posed = posing.mesh(&pose).unwrap();
        for (actual, other) in posed.positions().iter().zip(expected.positions()) {
            assert!(
                actual.distance(*other) < 1e-4,
                "{actual} for {other} at {time} s"
            );
        }
    }
}

#[test]
fn skeleton_without_mesh_is_a_scene() {
    let rig = humanoid();
    let scene = Scene::of_skeleton(&rig.skeleton, None).unwrap();
    let bytes = gltf::to_bytes(&scene, &WriteOptions::default()).unwrap();
    let again = gltf::from_bytes(&bytes, "bones.glb", |_| unreachable!()).unwrap();
    assert_eq!(again.armature.names(), scene.armature.names());
    assert!(again.meshes.is_empty());
}
