//! Promise: each mesh of a written scene is read back with its own skin, in order, although equal skins are written
//! once. Content that the format cannot represent is an error or omitted.

use glam::{Affine3A, Vec3, Vec3A};
use kinopt::animation::Armature;
use kinopt::io::gltf::{self, Scene, SceneMesh, Skin, UnwritableScene, WriteOptions};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MorphTargets, SkinWeights};
use support::armatures::bone;
use support::gltf_text::Numbers;

fn armature() -> Armature {
    let bones = vec![
        bone("hips", None, Vec3A::ZERO),
        bone("left", Some(0), Vec3A::X),
        bone("right", Some(0), -Vec3A::X),
    ];
    Armature::new(bones, Vec::new()).unwrap()
}

/// Skin of a triangle on the first of these joints.
fn skin(armature: &Armature, joints: &[usize]) -> Skin {
    let mut weights = SkinWeights::builder(3, joints.len());
    for vertex in 0..3 {
        weights.add(vertex, 0, 1.0).unwrap();
    }
    let joints = joints.iter().map(|&joint| armature.bone_at(joint).unwrap());
    let joints: Vec<_> = joints.collect();
    Skin {
        name: "hide".into(),
        joint_from_mesh: vec![Affine3A::IDENTITY; joints.len()],
        joints,
        weights: weights.build().unwrap(),
    }
}

fn mesh(name: &str, bone: usize, armature: &Armature, skin: Skin) -> SceneMesh {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    SceneMesh {
        name: name.into(),
        bone: armature.bone_at(bone).unwrap(),
        mesh: TriangleMesh::new(corners, vec![Vec3::Z; 3], vec![[0, 1, 2]]).unwrap(),
        tangents: Vec::new(),
        morph_targets: MorphTargets::new(3, Vec::new()).unwrap(),
        first_morph_weight: 0,
        skin: Some(skin),
    }
}

fn scene(armature: Armature, meshes: Vec<SceneMesh>) -> Scene {
    Scene {
        armature,
        meshes,
        clips: Vec::new(),
        notes: Vec::new(),
    }
}

#[test]
fn skins_with_any_difference_are_written_apart() {
    let armature = armature();
    let two_bone_skin = || skin(&armature, &[1, 2]);
    let mut named = two_bone_skin();
    named.name = "coat".into();
    let mut bound = two_bone_skin();
    bound.joint_from_mesh[1] = Affine3A::from_translation(Vec3::Z);
    for (other, count) in [
        (two_bone_skin(), 1),
        (skin(&armature, &[2, 1]), 2),
        (named, 2),
        (bound, 2),
    ] {
        let meshes = vec![
            mesh("one", 1, &armature, two_bone_skin()),
            mesh("other", 2, &armature, other),
        ];
        let whole = scene(armature.clone(), meshes);
        let bytes = gltf::to_bytes(&whole, &WriteOptions::default()).unwrap();
        let read = support::gltf_text::read(&bytes).unwrap();
        assert_eq!(read.meshes, whole.meshes);
        let text = String::from_utf8_lossy(&bytes);
        assert_eq!(text.matches(r#""joints":["#).count(), count, "{text}");
    }
}

/// An empty mesh of morph targets may have any number of vertices.
#[test]
fn empty_morph_targets_may_have_any_size() {
    let armature = armature();
    let original = mesh("one", 1, &armature, skin(&armature, &[1, 2]));
    let bare = SceneMesh {
        morph_targets: MorphTargets::none(0),
        ..original.clone()
    };
    let whole = scene(armature, vec![bare]);
    let bytes = gltf::to_bytes(&whole, &WriteOptions::default()).unwrap();
    assert_eq!(support::gltf_text::read(&bytes).unwrap().meshes, [original]);
}

/// Joint indices have sixteen bits.
#[test]
fn more_joints_than_sixteen_bits_are_rejected() {
    let armature = armature();
    let joints = 65_537;
    let many = skin(&armature, &vec![1; joints]);
    let whole = scene(armature.clone(), vec![mesh("crowd", 0, &armature, many)]);
    let error = gltf::to_bytes(&whole, &WriteOptions::default()).unwrap_err();
    let mesh = "crowd".to_owned();
    assert_eq!(error, UnwritableScene::TooManyJoints { mesh, joints });
}

/// Also if a file lists a child before its parent: the written file is read in the armature's order.
#[test]
fn meshes_are_ordered_by_their_bones() {
    let mut numbers = Numbers::default();
    let corners = numbers.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let mesh = |name: &str| {
        format!(r#"{{"name":"{name}","primitives":[{{"attributes":{{"POSITION":{corners}}}}}]}}"#)
    };
    let (hat, head) = (mesh("hat"), mesh("head"));
    let scene = numbers.read(&format!(
        r#""nodes":[{{"name":"top","mesh":0}},{{"name":"neck","mesh":1,"children":[0]}}],"meshes":[{hat},{head}]"#
    ));
    let bytes = gltf::to_bytes(&scene, &WriteOptions::default()).unwrap();
    let again = support::gltf_text::read(&bytes).unwrap();
    for scene in [&scene, &again] {
        let names: Vec<_> = scene.meshes.iter().map(|mesh| mesh.name.as_str()).collect();
        assert_eq!(names, ["head", "hat"]);
    }
}
