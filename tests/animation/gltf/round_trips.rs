//! Promise: a scene written as .glb is read back exactly in single precision if the format can represent it, and
//! sampled otherwise.

use glam::{Affine3A, EulerRot, Quat, Vec3, Vec3A, Vec4};
use kinopt::animation::curve::{KeyedCurve, TensionContinuityBias};
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Armature, ArmatureBone, Channel, Clip, LocalTransform};
use kinopt::io::gltf::{self, Note, Scene, SceneMesh, ScenePosing, Skin, WriteOptions};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MorphTarget, MorphTargets, SkinWeights, SkinningMethod};
use support::armatures::bone;
use support::fault_tables::ExpectedError;
use support::gltf_text::at;
use support::random::Random;

const BONES: usize = 9;
const VERTICES: usize = 40;

fn vector(random: &mut Random) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.within(-2.0, 2.0) as f32))
}

fn rotation(random: &mut Random) -> Quat {
    let [a, b, c] = vector(random).to_array();
    Quat::from_euler(EulerRot::XYZ, a, b, c)
}

fn armature(random: &mut Random) -> Armature {
    let bones = (0..BONES).map(|index| ArmatureBone {
        name: format!("bone {index}"),
        parent: index.checked_sub(1).map(|last| random.below(last + 1)),
        rest: LocalTransform {
            translation: vector(random).into(),
            rotation: rotation(random),
            scale: Vec3A::ONE + Vec3A::from(vector(random)) * 0.1,
        },
    });
    let bones: Vec<_> = bones.collect();
    let targets = ["wink", "smile", "shrug"].map(String::from).to_vec();
    let armature = Armature::new(bones, targets).unwrap();
    armature.with_rest_morph_weights(&[0.0, 0.3, -0.1]).unwrap()
}

fn mesh(random: &mut Random) -> TriangleMesh {
    let positions = (0..VERTICES).map(|_| vector(random)).collect();
    let normals = (0..VERTICES).map(|_| vector(random).normalize()).collect();
    let corner = |random: &mut Random| random.below(VERTICES) as u32;
    let triangles = (0..30).map(|_| std::array::from_fn(|_| corner(random)));
    TriangleMesh::new(positions, normals, triangles.collect()).unwrap()
}

fn targets(random: &mut Random) -> MorphTargets {
    let list = |vertices: &[u32], random: &mut Random| -> Vec<Vec3> {
        vertices.iter().map(|_| vector(random)).collect()
    };
    let few = vec![0, 3, 17];
    let all: Vec<u32> = (0..VERTICES as u32).collect();
    let few_deltas = [list(&few, random), list(&few, random)];
    let all_deltas = list(&all, random);
    let [positions, normals] = few_deltas;
    let made = [
        MorphTarget::new("wink", few, positions, normals, Vec::new()),
        MorphTarget::new("smile", all, all_deltas, Vec::new(), Vec::new()),
    ];
    MorphTargets::new(VERTICES, made.map(Result::unwrap).to_vec()).unwrap()
}

/// Weights whose sum is 1 in single precision as well: multiples of 2⁻¹⁰. Some vertices have six.
fn weights(joints: usize, random: &mut Random) -> SkinWeights {
    let mut builder = SkinWeights::builder(VERTICES, joints);
    for vertex in 0..VERTICES {
        let count = 1 + vertex % 6;
        let first = random.below(joints);
        let mut left = 1024;
        for slot in 0..count {
            let share = match slot + 1 == count {
                true => left,
                false => 1 + random.below(left / 3),
            };
            left -= share;
            let bone = (first + slot) % joints;
            builder.add(vertex, bone, share as f64 / 1024.0).unwrap();
        }
    }
    builder.build().unwrap()
}

fn skin(armature: &Armature, bones: &[usize], random: &mut Random) -> Skin {
    // Not the inverse of the rest pose.
    let bound = |random: &mut Random| {
        let scale = Vec3::ONE + vector(random) * 0.1;
        Affine3A::from_scale_rotation_translation(scale, rotation(random), vector(random))
    };
    Skin {
        name: "hide".into(),
        joints: bones
            .iter()
            .map(|&bone| armature.bone_at(bone).unwrap())
            .collect(),
        joint_from_mesh: bones.iter().map(|_| bound(random)).collect(),
        weights: weights(bones.len(), random),
    }
}

/// Scene that glTF can represent completely.
fn scene() -> Scene {
    let random = &mut Random::new(7);
    let armature = armature(random);
    let none = || MorphTargets::new(VERTICES, Vec::new()).unwrap();
    let body = SceneMesh {
        name: "body".into(),
        bone: armature.bone_at(2).unwrap(),
        mesh: mesh(random),
        tangents: (0..VERTICES)
            .map(|_| vector(random).normalize().extend(-1.0))
            .collect(),
        morph_targets: targets(random),
        first_morph_weight: 0,
        skin: Some(skin(&armature, &[7, 1, 3, 0, 4, 8, 6], random)),
    };
    let hat = SceneMesh {
        name: "hat".into(),
        bone: armature.bone_at(5).unwrap(),
        mesh: TriangleMesh::new(
            vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            vec![Vec3::Z; 3],
            vec![[0, 1, 2]],
        )
        .unwrap(),
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 3],
        morph_targets: MorphTargets::new(
            3,
            vec![
                MorphTarget::new("shrug", vec![1], vec![Vec3::Z], Vec::new(), vec![Vec3::Y])
                    .unwrap(),
            ],
        )
        .unwrap(),
        first_morph_weight: 2,
        skin: None,
    };
    let coat = SceneMesh {
        name: "coat".into(),
        bone: armature.bone_at(8).unwrap(),
        mesh: mesh(random),
        tangents: Vec::new(),
        morph_targets: none(),
        first_morph_weight: 3,
        skin: body.skin.clone().map(|skin| Skin {
            weights: weights(7, random),
            ..skin
        }),
    };
    let clips = vec![
        walk(&armature, random),
        constant_clip(&armature),
        Clip::builder("rest", &armature).build(),
    ];
    Scene {
        armature,
        meshes: vec![body, hat, coat],
        clips,
        notes: Vec::new(),
    }
}

fn times(count: usize, random: &mut Random) -> Vec<f32> {
    let mut time = 0.25;
    let mut next = || {
        time += random.within(0.01, 0.3) as f32;
        time
    };
    (0..count).map(|_| next()).collect()
}

/// Every kind of curve in glTF.
fn walk(armature: &Armature, random: &mut Random) -> Clip {
    let mut builder = Clip::builder("walk", armature);
    let bone = |index| armature.bone_at(index).unwrap();
    let vectors = |count: usize, random: &mut Random| -> Vec<Vec3A> {
        (0..count).map(|_| vector(random).into()).collect()
    };
    let turns = |count: usize, random: &mut Random| -> Vec<Quat> {
        (0..count).map(|_| rotation(random)).collect()
    };
    let shared = times(12, random);
    let other = times(5, random);
    let tangents = vectors(10, random);
    let pairs = |values: &[Vec3A]| {
        values
            .chunks(2)
            .map(|pair| [pair[0], pair[1]])
            .collect::<Vec<_>>()
    };
    let quads: Vec<[Vec4; 2]> = (0..5)
        .map(|_| [vector(random).extend(0.5), vector(random).extend(-0.5)])
        .collect();
    let channels = [
        (
            0,
            Channel::Translation(KeyedCurve::linear(shared.clone(), vectors(12, random)).unwrap()),
        ),
        (
            4,
            Channel::Translation(KeyedCurve::step(other.clone(), vectors(5, random)).unwrap()),
        ),
        (
            5,
            Channel::Translation(
                KeyedCurve::cubic(other.clone(), vectors(5, random), pairs(&tangents)).unwrap(),
            ),
        ),
        (
            6,
            Channel::Translation(
                KeyedCurve::catmull_rom(shared.clone(), vectors(12, random)).unwrap(),
            ),
        ),
        (
            0,
            Channel::Rotation(RotationCurve::slerp(shared.clone(), turns(12, random)).unwrap()),
        ),
        (
            1,
            Channel::Rotation(RotationCurve::slerp(other.clone(), turns(5, random)).unwrap()),
        ),
        (
            2,
            Channel::Rotation(RotationCurve::step(other.clone(), turns(5, random)).unwrap()),
        ),
        (
            3,
            Channel::Rotation(
                RotationCurve::cubic(other.clone(), turns(5, random), quads).unwrap(),
            ),
        ),
        (
            7,
            Channel::Rotation(RotationCurve::step(vec![0.5], turns(1, random)).unwrap()),
        ),
        (
            0,
            Channel::Scale(KeyedCurve::linear(other.clone(), vectors(5, random)).unwrap()),
        ),
        (
            8,
            Channel::Scale(
                KeyedCurve::kochanek_bartels(
                    other.clone(),
                    vectors(5, random),
                    &[TensionContinuityBias {
                        tension: 0.3,
                        continuity: -0.2,
                        bias: 0.5,
                    }; 5],
                )
                .unwrap(),
            ),
        ),
    ];
    for (index, channel) in channels {
        builder.channel(bone(index), channel).unwrap();
    }
    let numbers = |random: &mut Random| {
        (0..5)
            .map(|_| random.within(-1.0, 1.0) as f32)
            .collect::<Vec<_>>()
    };
    for target in 0..2 {
        let rates = numbers(random)
            .into_iter()
            .zip(numbers(random))
            .map(|(a, b)| [a, b])
            .collect();
        let curve = KeyedCurve::cubic(other.clone(), numbers(random), rates).unwrap();
        builder.morph_weight(target, curve).unwrap();
    }
    builder.build()
}

/// Constant clip that differs from the rest pose, over a span without keys.
fn constant_clip(armature: &Armature) -> Clip {
    let mut builder = Clip::builder("still", armature);
    let bone = armature.bone_at(3).unwrap();
    let turned = RotationCurve::step(vec![0.0], vec![Quat::from_rotation_z(1.0)]).unwrap();
    builder.channel(bone, Channel::Rotation(turned)).unwrap();
    builder
        .morph_weight(2, KeyedCurve::step(vec![0.0], vec![0.75]).unwrap())
        .unwrap();
    builder.build()
}

fn again(scene: &Scene, options: &WriteOptions) -> Scene {
    let bytes = gltf::to_bytes(scene, options).unwrap();
    let read = support::gltf_text::read(&bytes).unwrap();
    // The scales of its bones differ by axis.
    let scales = read.armature.scale_notes();
    for note in &read.notes {
        assert!(
            matches!(note, Note::Scaled(own) if scales.contains(own)),
            "{note}"
        );
    }
    read
}

#[test]
fn representable_content_survives_bitwise() {
    let scene = scene();
    let read = again(&scene, &WriteOptions::default());
    assert_eq!(read.armature, scene.armature);
    assert_eq!(read.meshes, scene.meshes);
    for (read, clip) in read.clips.iter().zip(&scene.clips) {
        assert_eq!((read.name(), read.span()), (clip.name(), clip.span()));
        assert_eq!(read, clip, "{}", clip.name());
    }
    assert_eq!(read.clips.len(), 3);
    // The bytes of a second write are equal as well.
    let bytes = |scene| gltf::to_bytes(scene, &WriteOptions::default()).unwrap();
    assert_eq!(bytes(&read), bytes(&scene));
    // Meshes that share a skin share it in the file.
    let text = String::from_utf8_lossy(&bytes(&scene)).into_owned();
    assert_eq!(text.matches("inverseBindMatrices").count(), 1);
}

#[test]
fn clip_returns_its_channels() {
    let scene = scene();
    for clip in &scene.clips {
        let mut builder = Clip::builder(clip.name(), &scene.armature);
        let [start, end] = clip.span();
        builder.span(start, end).unwrap();
        for (bone, channel) in clip.channels(&scene.armature).unwrap() {
            builder.channel(bone, channel).unwrap();
        }
        for (target, curve) in clip.morph_channels(&scene.armature).unwrap() {
            builder.morph_weight(target, curve).unwrap();
        }
        assert_eq!(&builder.build(), clip);
    }
    let other = Armature::new(Vec::new(), Vec::new()).unwrap();
    assert!(scene.clips[0].channels(&other).is_err());
}

#[test]
fn posed_mesh_survives_a_round_trip() {
    let scene = scene();
    let mut posing = ScenePosing::new(&scene, SkinningMethod::LinearBlend).unwrap();
    let posed = posing.mesh(&at(&scene, 0, 0.7)).unwrap();
    let read = support::gltf_text::read(&gltf::mesh_to_bytes(&posed).unwrap()).unwrap();
    assert_eq!(read.meshes[0].mesh, posed);
    let mut posing = ScenePosing::new(&read, SkinningMethod::LinearBlend).unwrap();
    assert_eq!(
        posing.mesh(read.armature.rest()).unwrap().positions(),
        posed.positions()
    );
}

/// For any names of its bones.
#[test]
fn scene_with_another_up_axis_gets_an_extra_bone() {
    let bones = vec![
        bone("up", None, Vec3A::ZERO),
        bone("up'", Some(0), Vec3A::new(0.25, 0.0, 2.0)),
    ];
    let bare = Scene {
        armature: Armature::new(bones, Vec::new()).unwrap(),
        meshes: Vec::new(),
        clips: Vec::new(),
        notes: Vec::new(),
    };
    let mut options = WriteOptions::default();
    options.up = Vec3::Z;
    let read = again(&bare, &options).armature;
    let [up, tip, stand] = ["up", "up'", "up''"].map(|name| read.bone(name).unwrap());
    assert_eq!(read.names().len(), 3);
    assert_eq!((read.parent(up), read.parent(tip)), (Some(stand), Some(up)));
    assert_eq!(read.parent(stand), None);
    let tip = read.rest_from_model()[tip.index()].inverse().translation;
    assert!(tip.distance(Vec3A::new(0.25, 2.0, 0.0)) < 1e-6, "{tip}");
}

#[test]
fn unwritable_and_unposable_scenes_are_errors() {
    let refused = |change: &dyn Fn(&mut Scene), words: &[&str]| {
        let mut broken = scene();
        change(&mut broken);
        let error = gltf::to_bytes(&broken, &WriteOptions::default())
            .unwrap_err()
            .to_string();
        for word in words {
            assert!(error.contains(word), "no {word} in {error}");
        }
    };
    refused(
        &|s| s.meshes[0].mesh = TriangleMesh::default(),
        &["`body`", "40"],
    );
    refused(
        &|s| s.meshes[1].bone = s.meshes[0].bone,
        &["`bone 2`", "two meshes"],
    );
    refused(
        &|s| {
            s.meshes[0].tangents.pop();
        },
        &["`body`", "39 tangents"],
    );
    refused(
        &|s| {
            s.meshes[0].skin.as_mut().unwrap().joints.pop();
        },
        &["`body`", "7", "6"],
    );
    refused(&|s| s.meshes[0].first_morph_weight = 2, &["`body`", "4"]);
    let other = Armature::new(Vec::new(), Vec::new()).unwrap();
    refused(
        &|s| s.clips.push(Clip::builder("alien", &other).build()),
        &["`alien`"],
    );
    refused(
        &|s| {
            s.meshes[1].mesh =
                TriangleMesh::new(vec![Vec3::ZERO; 3], Vec::new(), Vec::new()).unwrap()
        },
        &["`hat`", "no triangles"],
    );
    for keys_per_second in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(gltf::to_bytes(&scene(), &at_rate(keys_per_second)).is_err());
    }
    assert!(gltf::mesh_to_bytes(&TriangleMesh::default()).is_err());

    let mut mirrored = scene();
    let skin = mirrored.meshes[0].skin.as_mut().unwrap();
    skin.joint_from_mesh[2] = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let mut posing = ScenePosing::new(&mirrored, SkinningMethod::DualQuaternion).unwrap();
    posing
        .mesh(mirrored.armature.rest())
        .says("`body` | mirrors");
    assert!(posing.mesh(other.rest()).is_err());
}

#[test]
fn morph_targets_ignore_absent_mesh_attributes() {
    let mut bare = scene();
    bare.meshes[1].tangents.clear();
    let read = again(&bare, &WriteOptions::default());
    let [original, found] = [&bare, &read].map(|scene| &scene.meshes[1].morph_targets.targets()[0]);
    assert_eq!(found.position_deltas(), original.position_deltas());
    assert_eq!(original.tangent_deltas().len(), 1);
    assert_eq!(found.tangent_deltas(), []);
}

fn at_rate(keys_per_second: f32) -> WriteOptions {
    let mut options = WriteOptions::default();
    options.keys_per_second = keys_per_second;
    options
}

/// A glTF animation begins at 0 and ends with its last key. Keys before a clip's start shift all times. A translation
/// key at the clip's end keeps its duration if every bone rotates and all keys end earlier.
#[test]
fn clip_duration_is_kept_wherever_its_keys_are() {
    let mut scene = scene();
    let turning = |times: [f32; 2], span: [f32; 2]| {
        let mut builder = Clip::builder("turning", &scene.armature);
        for bone in 0..BONES {
            let ends = vec![Quat::IDENTITY, Quat::from_rotation_x(0.5)];
            let curve = RotationCurve::slerp(times.to_vec(), ends).unwrap();
            let bone = scene.armature.bone_at(bone).unwrap();
            builder.channel(bone, Channel::Rotation(curve)).unwrap();
        }
        builder.span(span[0], span[1]).unwrap();
        builder.build()
    };
    let (early, short, late) = (
        turning([-1.0, 1.5], [0.0, 1.0]),
        turning([0.0, 1.0], [0.0, 4.0]),
        turning([1.0, 2.0], [1.0, 2.0]),
    );
    scene.clips = vec![early, short, late];
    let read = again(&scene, &WriteOptions::default());
    let spans: Vec<_> = read.clips.iter().map(Clip::span).collect();
    assert_eq!(spans, [[0.0, 2.5], [0.0, 4.0], [1.0, 2.0]]);
    for (clip, keys) in read.clips.iter().zip([[0.0, 2.5], [0.0, 1.0], [1.0, 2.0]]) {
        let channels = clip.channels(&read.armature).unwrap();
        let turns = channels.iter().filter_map(|(_, channel)| match channel {
            Channel::Rotation(curve) => Some(curve.times()),
            _ => None,
        });
        let turns: Vec<_> = turns.collect();
        assert_eq!(turns, [&keys[..]; BONES]);
    }
}
