//! Promise: so it is for scenes: written and posed.
#![allow(clippy::unwrap_used)]

use glam::{Affine3A, Vec3, Vec3A, Vec4};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{Armature, Clip, Easing};
use kinopt::io::gltf::{self, Scene, SceneMesh, ScenePosing, Skin, WriteOptions};
use kinopt::io::rig::Rig;
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MorphTarget, MorphTargets, PosedVertices, SkinningMethod};
use support::random::Random;
use support::skins::weights;
use support::small_rig::{JSON, SmallRig};

use crate::animated::{armature, bone, check_single, local, mesh, pose, vector};
use crate::clips::varied;
use crate::digest::{Digest, Value};
use crate::gltf::add;

/// A GLB file but for the library's version, and whether its lengths are right.
pub(crate) fn file(digest: &mut Digest, bytes: &[u8]) {
    let Some(_) = bytes.strip_prefix(b"glTF") else {
        return digest.bytes(bytes);
    };
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(word(8), bytes.len());
    let json = std::str::from_utf8(&bytes[20..20 + word(12)]).unwrap();
    let own = concat!("kinopt ", env!("CARGO_PKG_VERSION"));
    digest.bytes(json.trim_end().replace(own, "kinopt"));
    digest.bytes(&bytes[20 + word(12)..]);
    assert_eq!(bytes.len() % 4, 0);
}

fn points(random: &mut Random, count: usize) -> Vec<Vec3> {
    (0..count).map(|_| vector(random, 1.0).into()).collect()
}

/// A skin with morph targets, another mesh in the same skin, one on a bone, and clips.
fn scene(random: &mut Random) -> Scene {
    let names = ["wink", "smile", "shrug"].map(String::from).to_vec();
    let body = armature(16, random).with_morph_targets(names).unwrap();
    let body = body.with_rest_morph_weights(&[0.0, 0.5, -0.25]).unwrap();
    let solid = |random: &mut Random, count: usize, normals: bool| {
        let triangles = (0..count as u32 - 2).map(|k| [k, k + 1, k + 2]).collect();
        let normals = if normals {
            points(random, count)
        } else {
            Vec::new()
        };
        TriangleMesh::new(points(random, count), normals, triangles).unwrap()
    };
    let mut targets = |list: Vec<u32>, name: &str, both: bool| {
        let count = if both { list.len() } else { 0 };
        let (p, n, t) = (
            points(random, list.len()),
            points(random, count),
            points(random, count),
        );
        MorphTarget::new(name, list, p, n, t).unwrap()
    };
    let wink = targets(vec![1, 5], "a", true);
    let smile = targets((0..9).collect(), "b", true);
    let shrug = targets(vec![], "c", false);
    let bones = [7, 1, 3, 0, 12, 8].map(|index| bone(&body, index));
    let bound = bones.map(|_| local(random).to_affine());
    let skin = |random: &mut Random, count| Skin {
        name: "hide".into(),
        joints: bones.to_vec(),
        joint_from_mesh: bound.to_vec(),
        weights: weights(random, count, 6, 6),
    };
    let part = |name: &str, index: usize, mesh: TriangleMesh| SceneMesh {
        name: name.into(),
        bone: bone(&body, index),
        morph_targets: MorphTargets::none(mesh.positions().len()),
        mesh,
        tangents: Vec::new(),
        first_morph_weight: 0,
        skin: None,
    };
    let mut whole = part("body", 2, solid(random, 9, true));
    whole.tangents = points(random, 9)
        .into_iter()
        .map(|v| v.extend(-1.0))
        .collect();
    whole.morph_targets = MorphTargets::new(9, vec![wink, smile]).unwrap();
    whole.skin = Some(skin(random, 9));
    let mut coat = part("coat", 4, solid(random, 7, false));
    coat.skin = Some(skin(random, 7));
    let mut hat = part("hat", 5, solid(random, 4, true));
    (hat.morph_targets, hat.first_morph_weight) = (MorphTargets::new(4, vec![shrug]).unwrap(), 2);
    let mut clips = vec![varied(&body, random).renamed("first")];
    clips.extend(more_clips(&body, random));
    Scene {
        armature: body,
        meshes: vec![whole, coat, hat],
        clips,
        notes: Vec::new(),
    }
}

/// Weights that are keyed together or not, spans that are longer than the keys, and nothing.
fn more_clips(body: &Armature, random: &mut Random) -> Vec<Clip> {
    let mut values = |count: usize| (0..count).map(|_| random.unit() as f32).collect::<Vec<_>>();
    let times = || vec![0.5, 1.0, 2.0];
    let linear = KeyedCurve::linear(times(), values(3)).unwrap();
    let other = KeyedCurve::linear(vec![0.0, 1.0], values(2)).unwrap();
    let cubic = KeyedCurve::catmull_rom(times(), values(3)).unwrap();
    // A sample all but falls on a key.
    let near = vec![0.5, 1.00001, 2.0];
    let eased = KeyedCurve::eased(near, values(3), vec![Easing::CubicIn; 3]).unwrap();
    let one = KeyedCurve::step(vec![0.75], values(1)).unwrap();
    let curves = [
        [Some(linear.clone()), Some(linear.clone())],
        [Some(linear.clone()), Some(other)],
        [Some(cubic.clone()), Some(one)],
        [None, Some(cubic)],
        [Some(eased.clone()), Some(linear.clone())],
        [Some(eased), None],
        [None, None],
    ];
    let clips = curves.into_iter().enumerate().map(|(number, curves)| {
        let mut builder = Clip::builder(format!("clip {number}"), body);
        for (target, curve) in curves.into_iter().enumerate() {
            if let Some(curve) = curve {
                builder.morph_weight(target, curve).unwrap();
            }
        }
        if number != 1 {
            builder.span(-0.25, 2.5).unwrap();
        }
        builder.build()
    });
    clips.collect()
}

fn written() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(201));
    let scene = scene(&mut random);
    let mut options = WriteOptions::default();
    for (rate, up) in [
        (30.0, Vec3::Y),
        (4.0, Vec3::Z),
        (0.5, Vec3::new(1.0, 2.0, -3.0)),
    ] {
        (options.keys_per_second, options.up) = (rate, up);
        let bytes = gltf::to_bytes(&scene, &options).unwrap();
        file(&mut digest, &bytes);
        add(&mut digest, &read(&bytes));
    }
    // A delta of every vertex, one of which is nothing, and of every one.
    for zero in [Vec3::ZERO, Vec3::X] {
        let mut deltas = points(&mut random, 4);
        deltas[2] = zero;
        let shrug = MorphTarget::new("c", vec![0, 1, 2, 3], deltas, vec![], vec![]).unwrap();
        let mut own = scene.clone();
        own.meshes[2].morph_targets = MorphTargets::new(4, vec![shrug]).unwrap();
        own.meshes.drain(..2);
        own.clips.clear();
        file(&mut digest, &gltf::to_bytes(&own, &options).unwrap());
    }
    let triangle = &scene.meshes[2].mesh;
    file(&mut digest, &gltf::mesh_to_bytes(triangle).unwrap());
    let rig = SmallRig::with_json(JSON).parse().unwrap();
    let skin = rig.mesh.as_ref().zip(rig.weights.as_ref());
    for skin in [skin, None] {
        let own = Scene::of_skeleton(&rig.skeleton, skin).unwrap();
        let bytes = gltf::to_bytes(&own, &WriteOptions::default()).unwrap();
        file(&mut digest, &bytes);
        add(&mut digest, &read(&bytes));
    }
    let other = weights(&mut random, 5, 3, 2);
    digest.refused(Scene::of_skeleton(&rig.skeleton, Some((triangle, &other))).map(|_| ()));
    digest.value()
}

fn read(bytes: &[u8]) -> Scene {
    support::gltf_text::read(bytes).unwrap()
}

fn posed() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(202));
    let mut scene = scene(&mut random);
    for method in SkinningMethod::ALL {
        let mut posing = ScenePosing::new(&scene, method).unwrap();
        for mirrored in [false, true] {
            let mut own = pose(&scene.armature, &mut random);
            if mirrored {
                own.set_scale(bone(&scene.armature, 5), Vec3A::new(-1.0, 0.5, 2.0))
                    .unwrap();
                own.morph_weights_mut().fill(0.0);
            }
            let parts = match posing.meshes(&own) {
                Ok(parts) => parts,
                Err(error) => {
                    digest.text(error.to_string());
                    continue;
                }
            };
            for part in parts {
                mesh(&mut digest, &part);
            }
            mesh(&mut digest, &posing.mesh(&own).unwrap());
            let (mut positions, mut normals) = (vec![Vec3::ONE; 20], vec![Vec3::ONE; 13]);
            let buffers = PosedVertices {
                positions: &mut positions,
                normals: &mut normals,
                tangents: &mut [],
            };
            posing.deform(&own, buffers).unwrap();
            digest.singles(positions.iter().chain(&normals).flat_map(|v| v.to_array()));
            let short = PosedVertices {
                positions: &mut positions[1..],
                ..PosedVertices::default()
            };
            digest.refused(posing.deform(&own, short));
            let short = PosedVertices {
                normals: &mut normals[1..],
                ..PosedVertices::default()
            };
            digest.refused(posing.deform(&own, short));
        }
        let mut flat = scene.armature.rest().clone();
        flat.set_scale(bone(&scene.armature, 0), Vec3A::new(-1.0, 1.0, 1.0))
            .unwrap();
        let found = posing.meshes(&flat).map(|meshes| meshes.len());
        digest.text(found.map_or_else(|error| error.to_string(), |count| count.to_string()));
        flat.morph_weights_mut()[0] = f32::NAN;
        digest.refused(posing.meshes(&flat));
        digest.refused(posing.meshes(armature(2, &mut random).rest()));
    }
    digest.debug(scene.turning_bones());
    scene.meshes.truncate(0);
    digest.debug(scene.turning_bones());
    digest.value()
}

fn refused() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(203));
    let good = scene(&mut random);
    let mut options = WriteOptions::default();
    let changes: [fn(&mut Scene); 16] = [
        |scene| scene.meshes[0].tangents.truncate(3),
        |scene| {
            scene.meshes[0].morph_targets =
                MorphTargets::new(5, scene.meshes[2].morph_targets.targets().to_vec()).unwrap()
        },
        |scene| scene.meshes[2].first_morph_weight = 3,
        |scene| scene.meshes[1].bone = scene.armature.bone_at(2).unwrap(),
        |scene| {
            scene.meshes[1]
                .skin
                .as_mut()
                .unwrap()
                .joint_from_mesh
                .truncate(2)
        },
        |scene| scene.meshes[1].skin.as_mut().unwrap().joint_from_mesh[2] = Affine3A::NAN,
        |scene| {
            scene.meshes[1].skin.as_mut().unwrap().weights = weights(&mut Random::new(1), 7, 5, 2)
        },
        |scene| {
            scene.meshes[1].skin.as_mut().unwrap().weights = weights(&mut Random::new(1), 8, 6, 2)
        },
        |scene| scene.meshes[2].mesh = TriangleMesh::default(),
        |scene| {
            scene.meshes[1].mesh =
                TriangleMesh::new(scene.meshes[1].mesh.positions().to_vec(), vec![], vec![])
                    .unwrap()
        },
        |scene| scene.armature = armature(3, &mut Random::new(2)),
        |scene| {
            scene
                .clips
                .push(Clip::builder("odd", &armature(3, &mut Random::new(2))).build())
        },
        |scene| scene.meshes[2].bone = armature(30, &mut Random::new(2)).bone_at(29).unwrap(),
        |scene| {
            scene.meshes[1].skin.as_mut().unwrap().joints[1] =
                armature(30, &mut Random::new(2)).bone_at(28).unwrap()
        },
        |scene| scene.meshes[1].skin.as_mut().unwrap().name = "other".into(),
        |scene| scene.meshes[0].tangents = vec![Vec4::X; 9],
    ];
    for change in changes {
        let mut odd = good.clone();
        change(&mut odd);
        match gltf::to_bytes(&odd, &options) {
            Ok(bytes) => file(&mut digest, &bytes),
            Err(error) => digest.text(error.to_string()),
        }
        let posing = ScenePosing::new(&odd, SkinningMethod::LinearBlend).map(|_| ());
        digest.text(posing.map_or_else(|error| error.to_string(), |()| String::new()));
    }
    for rate in [0.0, -1.0, f32::NAN, 1e9] {
        options.keys_per_second = rate;
        digest.refused(gltf::to_bytes(&good, &options));
    }
    options = WriteOptions::default();
    for up in [Vec3::ZERO, Vec3::NAN] {
        options.up = up;
        digest.refused(gltf::to_bytes(&good, &options));
    }
    digest.refused(gltf::mesh_to_bytes(&TriangleMesh::default()));
    let wrong = gltf::write_mesh(&TriangleMesh::default(), "a.glb").unwrap_err();
    digest.text(wrong.to_string());
    digest.value()
}

#[test]
fn of_scenes() {
    let rig = Rig::read("../models/robot-arm/robot-arm.json").unwrap();
    let scene = Scene::of_skeleton(&rig.skeleton, None).unwrap();
    let mut arm = Digest::new();
    file(
        &mut arm,
        &gltf::to_bytes(&scene, &WriteOptions::default()).unwrap(),
    );
    check_single(&[
        ("scenes, written", written()),
        ("scenes, posed", posed()),
        ("scenes: what is refused", refused()),
        ("scenes of skeletons", arm.value()),
    ]);
}
