//! Promise: a character that is dragged by a hand keeps its feet in place, also beyond its reach. `--hold` selects
//! other held frames, and a dragged path has no jumps.

use crate::forked_rig::*;
use glam::{Affine3A, Vec3A};
use kinopt::animation::{Armature, ArmatureBone, LocalTransform};
use kinopt::io::gltf::{self, SceneMesh, ScenePosing, Skin};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MorphTargets, SkinWeights, SkinningMethod};
use serde_json::{Value, json};

/// Name, parent, and position in the model, in metres; y is up.
const BONES: [(&str, Option<usize>, [f32; 3]); 12] = [
    ("root", None, [0.0, 0.0, 0.0]),
    ("hips", Some(0), [0.0, 1.0, 0.0]),
    ("chest", Some(1), [0.0, 1.4, 0.0]),
    ("left arm", Some(2), [0.2, 1.4, 0.0]),
    ("left elbow", Some(3), [0.5, 1.4, 0.02]),
    ("left hand", Some(4), [0.8, 1.4, 0.0]),
    ("right arm", Some(2), [-0.2, 1.4, 0.0]),
    ("right hand", Some(6), [-0.8, 1.4, 0.0]),
    ("left leg", Some(1), [0.1, 0.9, 0.0]),
    ("left foot", Some(8), [0.1, 0.1, 0.02]),
    ("right leg", Some(1), [-0.1, 0.9, 0.0]),
    ("right foot", Some(10), [-0.1, 0.1, 0.02]),
];

fn character(folder: &Folder) -> String {
    let at = |bone: usize| Vec3A::from(BONES[bone].2);
    let bones = BONES
        .iter()
        .enumerate()
        .map(|(k, (name, parent, _))| ArmatureBone {
            name: (*name).into(),
            parent: *parent,
            rest: LocalTransform {
                translation: at(k) - parent.map_or(Vec3A::ZERO, at),
                ..LocalTransform::IDENTITY
            },
        });
    let armature = Armature::new(bones.collect(), Vec::new()).unwrap();
    let joints = BONES.map(|(name, ..)| armature.bone(name).unwrap());
    let inverses = (0..BONES.len()).map(|k| Affine3A::from_translation((-at(k)).into()));
    let mut weights = SkinWeights::builder(BONES.len(), BONES.len());
    (0..BONES.len()).for_each(|k| weights.add(k, k, 1.0).unwrap());
    let corners = (0..BONES.len()).map(|k| at(k).into()).collect();
    let mesh = SceneMesh {
        name: "body".into(),
        bone: joints[0],
        mesh: TriangleMesh::new(corners, Vec::new(), vec![[5, 7, 9], [7, 9, 11]]).unwrap(),
        tangents: Vec::new(),
        morph_targets: MorphTargets::new(BONES.len(), Vec::new()).unwrap(),
        first_morph_weight: 0,
        skin: Some(Skin {
            name: String::new(),
            joint_from_mesh: inverses.collect(),
            weights: weights.build().unwrap(),
            joints: joints.to_vec(),
        }),
    };
    folder.scene("character.glb", &scene(armature, vec![mesh], Vec::new()))
}

/// Displacement of a bone's vertex from rest.
fn moved(posed: &str, bone: &str) -> f32 {
    let scene = gltf::read(posed).unwrap();
    let index = BONES.iter().position(|(name, ..)| *name == bone).unwrap();
    let mut posing = ScenePosing::new(&scene, SkinningMethod::LinearBlend).unwrap();
    let mesh = posing.mesh(scene.armature.rest()).unwrap();
    let at = mesh.positions()[index];
    Vec3A::from(at).distance(Vec3A::from(BONES[index].2))
}

fn held(document: &Value) -> Vec<&str> {
    let tasks = list(&document["tasks"]).iter();
    let held = tasks.filter(|task| task["held"] == true);
    held.map(|task| word(&task["frame"])).collect()
}

#[test]
fn dragged_character_stays_on_its_feet() {
    let folder = Folder::new("holds");
    let (file, out) = (character(&folder), folder.file("posed.glb"));
    for target in ["0.3,1.9,0.5", "3,3,1"] {
        let document = answer!("solve {file} '--target=left hand={target}' --out {out}");
        assert_eq!(held(&document), ["right hand", "left foot", "right foot"]);
        for held_frame in ["hips", "left leg", "left foot", "right leg", "right foot"] {
            let moved = moved(&out, held_frame);
            assert!(moved < 1e-4, "{target}: {held_frame} moved by {moved}");
        }
        assert!(moved(&out, "left hand") > 0.3);
    }
    // The arm moves first. If it is too short the spine bends, but does not twist.
    let shoulder = |target: &str| {
        let hold = answer!("solve {file} '--target=left hand={target}' --out {out}");
        (hold["reached"] == true, moved(&out, "right arm"))
    };
    let (reached, distance) = shoulder("0.5,1.6,0.3");
    assert!(reached && distance < 0.02, "{distance}");
    for target in ["3,3,1", "-3,1.4,0.5", "0.5,1.4,-3", "0.2,-3,0.5"] {
        let (reached, distance) = shoulder(target);
        // 0.7 rad at an arm length of 0.2.
        assert!(!reached && distance < 0.15, "{target}: {distance}");
    }
}

#[test]
fn hold_option_selects_held_frames() {
    let folder = Folder::new("hold-names");
    let (file, out) = (character(&folder), folder.file("posed.glb"));
    let solve = |more| answer!("solve {file} '--target=left hand=3,3,1' --out {out} {more}");
    for nothing in ["--hold=none", "--hold none"] {
        assert!(held(&solve(nothing)).is_empty());
        // Without holds the figure topples.
        assert!(moved(&out, "left foot") > 0.1);
    }
    assert!(held(&solve("--hold=hips")).is_empty());
    assert!(moved(&out, "left foot") < 1e-6 && moved(&out, "right hand") > 0.1);
    let document = solve("'--hold=right hand' '--hold=right foot'");
    assert_eq!(held(&document), ["right hand", "right foot"]);

    let target = "'--target=left hand=3,3,1'";
    refused!("solve {file} {target} --hold=tail" => 1, "`tail`");
}

#[test]
fn path_is_dragged_out_of_reach_and_back() {
    let folder = Folder::new("dragged-path");
    let file = character(&folder);
    let target = |k: u32| {
        let turn = f64::from(k) * std::f64::consts::TAU / 40.0;
        let aside = 0.3 * (2.0 * turn).sin();
        [0.8 + 1.5 * turn.sin(), 1.4 + 0.3 * turn.sin(), aside]
    };
    let targets: Vec<[f64; 3]> = (0..40).map(target).collect();
    let path = folder.text("path.json", json!({ "targets": targets }));
    let answers = answer!("track {file} '--tip=left hand' --targets {path}");
    let summary = &answers["summary"];
    assert!(summary["jumps"].is_array(), "{summary}");
    let last = &list(&answers["solutions"])[39];
    assert_eq!(held(last), ["right hand", "left foot", "right foot"]);
    assert!(last["reached"] == true, "{last}");
}
