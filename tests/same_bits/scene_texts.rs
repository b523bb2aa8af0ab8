//! Promise: so it is for scenes with several things of their files changed: what is read, noted, posed, amended and written in
//! every mixture of options.
#![allow(clippy::unwrap_used)]

use glam::Vec3;
use kinopt::animation::{Clip, Pose};
use kinopt::io::gltf::{self, SceneFile, ScenePosing, WriteOptions};
use kinopt::skinning::SkinningMethod;
use support::changed_json;
use support::gltf_text::{Numbers, read, small};
use support::random::Random;

use crate::animated::{check_single, mesh, pose};
use crate::digest::{Digest, Value};
use crate::gltf::add;
use crate::robot_texts::{add_error, add_text};
use crate::scenes::file;

/// Two meshes of several parts, of which one repeats its weights in a second set; sparse targets over a view and without; two
/// skins, two scenes, two clips with a channel that names no node, a curve of every kind.
fn large() -> (Numbers, String) {
    let mut n = Numbers::default();
    let square = n.floats(&[
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.5],
    ]);
    let normals = n.floats(&[[0.0, 0.6, 0.8]; 4]);
    let tangents = n.floats(&[[1.0, 0.0, 0.0, -1.0]; 4]);
    let joints = n.shorts(&[[0, 1, 1, 0], [1, 0, 0, 0], [0, 0, 1, 2], [2, 1, 0, 0]]);
    let weights = n.floats(&[
        [0.5, 0.25, 0.25, 0.0],
        [1.0, 0.0, 0.0, 0.0],
        [0.5, 0.5, 0.5, 0.5],
        [0.25; 4],
    ]);
    let strip = n.bytes(&[[0], [1], [2], [3]], "");
    // Its view's number too, as each has had one of its own so far.
    let base = n.floats(&[
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0],
        [0.5, 0.0, 0.0],
    ]);
    let places = n.view(&[1, 3]);
    let deltas: Vec<u8> = [1.0f32, 0.0, 0.0, 0.0, 2.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let deltas = n.view(&deltas);
    let sparse = |view: String| {
        format!(
            r#"{{{view}"componentType":5126,"type":"VEC3","count":4,"sparse":{{"count":2,"indices":{{"bufferView":{places},"componentType":5121}},"values":{{"bufferView":{deltas}}}}}}}"#
        )
    };
    let (bare, over) = (
        n.accessor(sparse(String::new())),
        n.accessor(sparse(format!(r#""bufferView":{base},"#))),
    );
    let mut bound = [[0.0f32; 16]; 3];
    for (k, matrix) in bound.iter_mut().enumerate() {
        (matrix[0], matrix[5], matrix[10], matrix[15]) = (1.0, 1.0, 2.0, 1.0);
        matrix[12 + k] = 0.5;
    }
    let bound = n.floats(&bound);
    let times = n.floats(&[[0.25], [0.5], [1.5]]);
    let late = n.floats(&[[1.0], [2.0], [2.5]]);
    let turns = n.floats(&[
        [0.0, 0.0, 0.6, 0.8],
        [0.0, 0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0, 0.0],
    ]);
    let small_turns = n.raw(
        &[0, 127, 0, 0, 0, 0, 0, 127, 127, 0, 0, 0],
        5120,
        "VEC4",
        3,
        r#","normalized":true"#,
    );
    let moves = n.floats(&[[0.0, 1.0, 0.0], [0.5, 1.0, 0.0], [0.5, 2.0, 0.0]]);
    let cubic = n.floats(&[[0.25, 0.5, 1.0]; 9]);
    let morphs = n.floats(&[[0.0], [1.0], [0.5], [0.25], [1.0], [0.0]]);
    let rest = format!(
        r#""nodes":[{{"name":"a","children":[1,2,5]}},{{"name":"b","translation":[0,1,0],"children":[3]}},{{"name":"b","rotation":[0,0.6,0,0.8],"scale":[1,2,1]}},
        {{"translation":[1,0,0]}},{{"name":"skin","mesh":0,"skin":0}},{{"name":"hat","mesh":1,"weights":[0.5,0.25],"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,1,2,3,1]}},
        {{"name":"other","children":[7]}},{{"name":"lamp","mesh":1}},{{"name":"second","mesh":0,"skin":1}}],
        "scene":1,"scenes":[{{"nodes":[6]}},{{"nodes":[0,4,8,6]}},{{}}],
        "meshes":[{{"name":"body","primitives":[{{"attributes":{{"POSITION":{square},"NORMAL":{normals},"TANGENT":{tangents},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},"indices":{strip},"mode":5}},
          {{"attributes":{{"POSITION":{square},"NORMAL":{normals},"TANGENT":{tangents},"JOINTS_0":{joints},"WEIGHTS_0":{weights},"JOINTS_1":{joints},"WEIGHTS_1":{weights}}},"indices":{strip},"mode":6}},{{"attributes":{{"POSITION":{square}}},"mode":0}}]}},
          {{"name":"hat","weights":[0.125,1],"extras":{{"targetNames":["wink","smile"]}},"primitives":[{{"attributes":{{"POSITION":{square},"NORMAL":{normals},"TANGENT":{tangents}}},"indices":{strip},"mode":5,
          "targets":[{{"POSITION":{bare},"NORMAL":{over}}},{{"POSITION":{over},"TANGENT":{bare}}}]}},{{"attributes":{{"POSITION":{square},"NORMAL":{normals},"TANGENT":{tangents}}},"targets":[{{"POSITION":{over}}},{{"POSITION":{bare}}}],"mode":6}}]}}],
        "skins":[{{"name":"hide","joints":[1,0,2],"inverseBindMatrices":{bound}}},{{"joints":[0,3,1]}}],
        "animations":[{{"name":"go","samplers":[{{"input":{times},"output":{turns}}},{{"input":{times},"output":{moves},"interpolation":"STEP"}},{{"input":{late},"output":{morphs}}}],
        "channels":[{{"sampler":0,"target":{{"node":1,"path":"rotation"}}}},{{"sampler":1,"target":{{"path":"translation"}}}},{{"sampler":2,"target":{{"node":5,"path":"weights"}}}}]}},
        {{"samplers":[{{"input":{late},"output":{small_turns}}},{{"input":{late},"output":{cubic},"interpolation":"CUBICSPLINE"}},{{"input":{times},"output":{moves}}}],
        "channels":[{{"sampler":1,"target":{{"path":"scale"}}}},{{"sampler":0,"target":{{"node":3,"path":"rotation"}}}},{{"sampler":1,"target":{{"node":2,"path":"scale"}}}},{{"sampler":2,"target":{{"node":8,"path":"translation"}}}},{{"sampler":2,"target":{{"path":"translation"}}}}]}},
        {{"name":"go","samplers":[],"channels":[]}}]"#
    );
    (n, rest)
}

fn options(random: &mut Random) -> WriteOptions {
    let mut own = WriteOptions::default();
    own.keys_per_second = [30.0, 4.0, 1000.0, 0.5][random.below(4)];
    own.up = [
        Vec3::Y,
        Vec3::Z,
        Vec3::X,
        -Vec3::Y,
        Vec3::new(0.0, 0.6, 0.8),
    ][random.below(5)];
    own
}

/// The file amended: clips that move all bones, and another pose at rest, in turns.
fn amend(digest: &mut Digest, mut own: SceneFile, random: &mut Random) {
    let body = own.scene().armature.clone();
    for name in ["x", "y"] {
        if random.below(2) == 0 {
            let posed = own.set_rest(&pose(&body, random));
            digest.word(posed.is_ok().into());
        }
        let poses: Vec<Pose> = (0..3)
            .map(|_| pose(&own.scene().armature, random))
            .collect();
        let clip = Clip::through_poses(name, &body, &[0.25, 0.5, 1.5], &poses).unwrap();
        // Of some the span is wider than the keys.
        let wider = [(0.25, 1.5), (0.0, 1.5), (-0.5, 1.0), (0.25, 2.0)][random.below(4)];
        let mut longer = Clip::builder(name, &body);
        for (bone, channel) in clip.channels(&body).unwrap().into_iter().step_by(2) {
            longer.channel(bone, channel).unwrap();
        }
        longer.span(wider.0, wider.1).unwrap();
        match own.add_clip(&longer.build(), &options(random)) {
            Ok(()) => {}
            Err(error) => add_error(digest, &error),
        }
    }
    let bytes = own.to_bytes().unwrap();
    add_text(digest, &String::from_utf8_lossy(&bytes[bytes.len() / 2..]));
    match read(&bytes) {
        Ok(scene) => add_text(
            digest,
            &format!("{:?} {:?}", scene.armature.names(), scene.clips.len()),
        ),
        Err(error) => add_error(digest, &error),
    }
}

fn scenes() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(941));
    for ((numbers, rest), count) in [(large(), 150), (small(), 40)] {
        let whole: serde_json::Value = serde_json::from_str(&numbers.document(&rest)).unwrap();
        let (mut whole, buffers) = (whole.clone(), whole["buffers"].clone());
        whole.as_object_mut().unwrap().remove("buffers");
        let glb = numbers.glb(&rest);
        let mut texts = changed_json::changed(&whole.to_string(), count, &mut random);
        texts.insert(0, whole.to_string());
        for (round, text) in texts.iter().enumerate() {
            let mut own: serde_json::Value = serde_json::from_str(text).unwrap();
            if let Some(own) = own.as_object_mut() {
                own.entry("buffers").or_insert(buffers.clone());
            }
            let text = own.to_string();
            let scene = match read(text.as_bytes()) {
                Ok(scene) => scene,
                Err(error) => {
                    add_error(&mut digest, &error);
                    continue;
                }
            };
            add(&mut digest, &scene);
            if round % 4 == 0 {
                let missing = |_: &str| Err(gltf::read("no/such.glb").unwrap_err());
                let own = SceneFile::from_bytes(text.as_bytes(), "own", missing).unwrap();
                amend(&mut digest, own, &mut random);
                match gltf::to_bytes(&scene, &options(&mut random)) {
                    Ok(bytes) => file(&mut digest, &bytes),
                    Err(error) => add_error(&mut digest, &error),
                }
            }
            if round % 3 == 0 {
                let method = SkinningMethod::ALL[random.below(SkinningMethod::ALL.len())];
                match ScenePosing::new(&scene, method) {
                    Ok(mut posing) => {
                        for _ in 0..2 {
                            match posing.mesh(&pose(&scene.armature, &mut random)) {
                                Ok(posed) => mesh(&mut digest, &posed),
                                Err(error) => add_error(&mut digest, &error),
                            }
                        }
                    }
                    Err(error) => add_error(&mut digest, &error),
                }
            }
        }
        amend(
            &mut digest,
            SceneFile::from_bytes(&glb, "own", |_| unreachable!()).unwrap(),
            &mut random,
        );
        for _ in 0..40 {
            let mut bytes = glb.clone();
            let among = [bytes.len(), 24][random.below(2)];
            let at = random.below(among);
            bytes[at] ^= 1 << random.below(8);
            match read(&bytes) {
                Ok(scene) => add_text(&mut digest, &format!("{:?}", scene.notes)),
                Err(error) => add_error(&mut digest, &error),
            }
        }
    }
    digest.value()
}

#[test]
fn of_texts_of_scenes() {
    check_single(&[("texts of scenes, changed", scenes())]);
}
