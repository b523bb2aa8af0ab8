//! Promise: so it is for glTF files: what each holds, what reading notes, and what is refused.
#![allow(clippy::unwrap_used)]

use kinopt::io::gltf::{self, Scene};
use support::gltf_text::{Numbers, read, small};

use crate::animated::{changed, check_single, mesh};
use crate::digest::Digest;

/// All of a scene.
pub(crate) fn add(digest: &mut Digest, scene: &Scene) {
    digest.json(&scene.armature);
    for own in &scene.meshes {
        digest.debug((&own.name, own.bone, own.first_morph_weight));
        mesh(digest, &own.mesh);
        digest.singles(own.tangents.iter().flat_map(|t| t.to_array()));
        digest.debug(&own.morph_targets);
        digest.debug(&own.skin);
    }
    scene
        .clips
        .iter()
        .for_each(|clip| digest.clip(&scene.armature, clip));
    for note in &scene.notes {
        digest.debug(note);
        digest.bytes(note.to_string());
    }
    digest.debug(scene.turning_bones());
}

fn changes() -> u64 {
    let mut digest = Digest::new();
    let (numbers, rest) = small();
    let text = numbers.document(&rest);
    let start = text.find("data:").unwrap();
    let uri = text[start..start + text[start..].find('"').unwrap()].to_owned();
    let encoded = uri.split_once(',').unwrap().1;
    let [whole, cut] = [format!("data:,{encoded}"), uri[..uri.len() - 8].to_owned()];
    let unpadded = uri.trim_end_matches('=').to_owned();
    let mut all: Vec<(&str, &str)> = vec![
        (&uri, &whole),
        (&uri, &cut),
        (&uri, &unpadded),
        (&uri, "data:;base64"),
        (&uri, "data:;base64,a*b"),
        (&uri, "https://example.org/a.bin"),
        (&uri, "%ff.bin"),
    ];
    all.extend([
        (r#""version":"2.0""#, r#""version":"1.0""#),
        (r#""version":"2.0""#, r#""version":"2.1","minVersion":"2.1""#),
        (r#""version":"2.0""#, r#""version":"2.1","minVersion":"2.0""#),
        (r#""version":"2.0""#, r#""version":2"#),
        (r#""asset":{"version":"2.0"}"#, r#""asset":{"version":"2.0"},"extensionsRequired":["KHR_materials_x","ACME"]"#),
        (r#""asset":{"version":"2.0"}"#, r#""asset":{"version":"2.0"},"extensionsRequired":["KHR_texture_x"],"extensionsUsed":["KHR_texture_x","KHR_mesh_quantization","ACME"],"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],"materials":[{},{}],"images":[{"uri":"a.png"}],"textures":[{"source":0}]"#),
        (r#""name":"upper""#, r#""name":"lower""#),
        (r#""name":"upper""#, r#""name":"body""#),
        (r#""name":"upper","#, ""),
        (r#""name":"upper","#, r#""name":"node/3","#),
        (r#""name":"upper","#, r#""name":"upper","children":[9],"#),
        (r#""name":"upper","#, r#""name":"upper","children":[1],"#),
        (r#""name":"upper","#, r#""name":"upper","children":[3],"#),
        (r#""rotation":[0,0,0,1]"#, r#""rotation":[0,0,0,0]"#),
        (r#""rotation":[0,0,0,1]"#, r#""rotation":[0,3,0,4]"#),
        (r#""rotation":[0,0,0,1]"#, r#""scale":[1,-2,1e39]"#),
        (r#""rotation":[0,0,0,1]"#, r#""scale":[1,-2,0.5]"#),
        (r#""translation":[0,1,0]"#, r#""translation":[0,1e39,0]"#),
        ("[2,0,0,0,0,2,", "[2,0,0,1,0,2,"),
        ("[2,0,0,0,0,2,", "[2,0,0,0,1,2,"),
        ("[2,0,0,0,0,2,", "[-2,0,0,0,0,3,"),
        (r#""scene":0,"#, r#""scene":5,"#),
        (r#""scene":0,"#, ""),
        (r#""scene":0,"scenes":[{"nodes":[3]}],"#, ""),
        (r#""nodes":[3]"#, r#""nodes":[4]"#),
        (r#""nodes":[3]"#, r#""nodes":[1]"#),
        (r#"{"nodes":[3]}"#, "{}"),
        (r#""skin":0"#, r#""skin":1"#),
        (r#","skin":0"#, ""),
        (r#""mesh":0"#, r#""mesh":1"#),
        (r#""weights":[0.5]"#, r#""weights":[0.5,1]"#),
        (r#","weights":[0.5]"#, ""),
        (r#""name":"tube""#, r#""name":"""#),
        (r#""name":"tube""#, r#""name":"tube","weights":[0.25]"#),
        (r#"["bulge"]"#, "[]"),
        (r#"["bulge"]"#, "[\"\", \"more\"]"),
        (r#"["bulge"]"#, "7"),
        (r#""joints":[1,0]"#, r#""joints":[1,7]"#),
        (r#""joints":[1,0]"#, r#""joints":[]"#),
        (r#""joints":[1,0]"#, r#""joints":[1]"#),
        (r#""joints":[1,0]"#, r#""joints":[1,0,2]"#),
        (r#""joints":[1,0]"#, r#""name":"hide","joints":[0,1]"#),
        (r#""skins":[{"#, r#""skins":[{"joints":[0,1,2],"inverseBindMatrices":4},{"#),
        (r#""POSITION":0,"#, ""),
        (r#""POSITION":0,"#, r#""POSITION":77,"#),
        (r#""POSITION":0,"#, r#""POSITION":3,"#),
        (r#""POSITION":0,"#, r#""POSITION":0,"TANGENT":3,"TEXCOORD_0":0,"_HEAT":1,"#),
        (r#""NORMAL":1,"#, r#""NORMAL":9,"#),
        (r#""NORMAL":1,"#, ""),
        (r#""JOINTS_0":2,"#, ""),
        (r#""JOINTS_0":2,"#, r#""JOINTS_0":3,"#),
        (r#""JOINTS_0":2,"#, r#""JOINTS_0":2,"JOINTS_1":2,"WEIGHTS_1":3,"#),
        (r#","JOINTS_0":2,"WEIGHTS_0":3"#, ""),
        (r#""mode":4"#, r#""mode":9"#),
        (r#""mode":4"#, r#""mode":1"#),
        (r#""mode":4"#, r#""mode":5"#),
        (r#""mode":4"#, r#""mode":6"#),
        (r#""indices":5,"#, ""),
        (r#""indices":5"#, r#""indices":7"#),
        (r#""componentType":5123,"type":"SCALAR""#, r#""componentType":5125,"type":"SCALAR""#),
        (r#""target":{"node":0,"#, r#""target":{"node":8,"#),
        (r#""target":{"node":0,"#, r#""target":{"#),
        (r#""target":{"node":2,"path":"weights"}"#, r#""target":{"node":1,"path":"weights"}"#),
        (r#""path":"translation""#, r#""path":"scale""#),
        (r#""path":"translation""#, r#""path":"pointer""#),
        (r#""node":1,"path":"translation""#, r#""node":0,"path":"rotation""#),
        (r#""path":"rotation""#, r#""path":"scale""#),
        (r#"{"sampler":0,"#, r#"{"sampler":6,"#),
        (r#"{"sampler":0,"#, r#"{"sampler":1,"#),
        (r#""CUBICSPLINE""#, r#""LINEAR""#),
        (r#""CUBICSPLINE""#, r#""SPLINE""#),
        (r#""interpolation":"STEP""#, r#""interpolation":"CUBICSPLINE""#),
        (r#","interpolation":"STEP""#, ""),
        (r#""name":"bend""#, r#""name":"""#),
        (r#""byteLength":48"#, r#""byteLength":47"#),
        (r#""bufferView":0"#, r#""bufferView":70"#),
        (r#""bufferView":0"#, r#""byteOffset":4,"bufferView":0"#),
        (r#""buffer":0"#, r#""buffer":3"#),
        (r#""byteOffset":0"#, r#""byteStride":8,"byteOffset":0"#),
        (r#""componentType":5126,"type":"VEC3","count":4"#, r#""componentType":5124,"type":"VEC3","count":4"#),
        (r#""componentType":5126,"type":"VEC3","count":4"#, r#""componentType":5126,"type":"VEC3","count":0"#),
        (r#""componentType":5126,"type":"VEC3","count":4"#, r#""componentType":5126,"type":"MAT2","count":4"#),
        (r#""sparse":{"count":2"#, r#""sparse":{"count":0"#),
        (r#""sparse":{"count":2"#, r#""sparse":{"count":3"#),
        (r#""count":4,"sparse""#, r#""count":3,"sparse""#),
        (r#""count":4,"sparse""#, r#""count":5,"sparse""#),
        (r#""componentType":5123}"#, r#""componentType":5122}"#),
        (r#""componentType":5123}"#, r#""componentType":5121}"#),
        (r#""animations":["#, r#""animations":[7,"#),
    ]);
    changed(&mut digest, &text, &all, |text| read(text.as_bytes()), add);
    for rubbish in [
        &b""[..],
        b"rubbish",
        b"[1]",
        b"{}",
        b"{",
        br#"{"asset": {"version": "2.0"}"#,
    ] {
        digest.refused(read(rubbish));
    }
    add(
        &mut digest,
        &read(br#" {"asset": {"version": "2.0"}}"#).unwrap(),
    );
    let missing = text.replacen(&uri, "a%20b%zz.bin", 1);
    let opened = |file: &str| {
        assert_eq!(file, "a b%zz.bin");
        Ok(vec![0; 10_000])
    };
    digest.refused(gltf::from_bytes(missing.as_bytes(), "own.gltf", opened));
    digest.refused(gltf::read("no/such.glb").map_err(|error| error.file));
    digest.value()
}

fn containers() -> u64 {
    let mut digest = Digest::new();
    let (numbers, rest) = small();
    let good = numbers.glb(&rest);
    add(&mut digest, &read(&good).unwrap());
    for (at, word) in [
        (4, 1_u32),
        (8, 4),
        (8, 13),
        (8, 19),
        (8, u32::MAX),
        (12, u32::MAX),
        (16, 7),
        (12, 20),
    ] {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        let found = read(&bytes).map(|scene| scene.clips.len());
        digest.bytes(found.map_or_else(|error| error.to_string(), |clips| clips.to_string()));
    }
    digest.refused(read(&good[..10]));
    digest.refused(read(&good[..good.len() - 1]));
    let scene = read(&good).unwrap();
    digest.bytes(scene.clip("bend").unwrap().name());
    digest.refused(scene.clip("bent"));
    digest.value()
}

/// Primitives of every mode, numbers of every size, weights that are put right, and names that are shared.
fn varied() -> u64 {
    let mut digest = Digest::new();
    let mut numbers = Numbers::default();
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.25],
        [0.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
    ];
    let five = numbers.floats(&corners);
    let three = numbers.floats(&corners[..3]);
    let normals = numbers.floats(&[
        [0.0, 0.0, 1.0],
        [0.0, 0.6, 0.8],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.6, 0.0, 0.8],
    ]);
    let tangents = numbers.floats(&[[1.0, 0.0, 0.0, -1.0]; 5]);
    let odd = numbers.floats(&[[1.0, 0.0, f32::INFINITY, -1.0]; 5]);
    let fan = numbers.bytes(&[[4], [0], [1], [2]], "");
    let strip = numbers.shorts(&[[0], [1], [2], [2], [3], [4], [0]]);
    let fractions = [-128_i8, -127, 127, 0, 64, 1, 127, 0, 3].map(|v| v as u8);
    let fractions = numbers.raw(&fractions, 5120, "VEC3", 3, r#","normalized":true"#);
    let shorts: Vec<u8> = [-32768_i16, -32767, 32767, 0, 16384, 1, 32767, 0, 5]
        .into_iter()
        .flat_map(i16::to_le_bytes)
        .collect();
    let plain = numbers.raw(&shorts, 5122, "VEC3", 3, "");
    let shorts = numbers.raw(&shorts, 5122, "VEC3", 3, r#","normalized":true"#);
    let words: Vec<u8> = [2_u32, 1, 0]
        .into_iter()
        .flat_map(u32::to_le_bytes)
        .collect();
    let words = numbers.raw(&words, 5125, "SCALAR", 3, "");
    let woven: Vec<u8> = (0..28).map(|k| 7 * k).collect();
    let view = numbers.view(&woven);
    let woven = numbers.accessor(format!(
        r#"{{"bufferView":{view},"byteOffset":2,"componentType":5123,"normalized":true,"type":"VEC3","count":3}}"#
    ));
    let zeros = numbers.accessor(r#"{"componentType":5126,"type":"VEC3","count":3}"#.into());
    let (places, deltas) = (
        numbers.view(&[1, 2]),
        numbers.view(&[
            0, 0, 128, 63, 0, 0, 0, 0, 0, 0, 0, 64, 0, 0, 64, 64, 0, 0, 0, 0, 0, 0, 0, 0,
        ]),
    );
    let sparse = format!(
        r#""sparse":{{"count":2,"indices":{{"bufferView":{places},"componentType":5121}},"values":{{"bufferView":{deltas}}}}}"#
    );
    let mended = numbers.accessor(format!(r#"{{"bufferView":{view},"byteOffset":4,"componentType":5121,"type":"VEC3","count":3,"normalized":true}}"#));
    let lifted = numbers.accessor(format!(
        r#"{{"componentType":5126,"type":"VEC3","count":3,{sparse}}}"#
    ));
    let joints = numbers.bytes(&[[0, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 9]], "");
    let bytes = numbers.bytes(
        &[[255, 0, 0, 0], [51, 204, 0, 0], [100, 100, 0, 0]],
        r#","normalized":true"#,
    );
    let more_joints = numbers.shorts(&[[0, 0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0]]);
    let more_weights = numbers.floats(&[[0.0; 4], [-0.25, 0.0, 0.0, 0.0], [0.25, 0.0, 0.0, 0.0]]);
    let times = numbers.floats(&[[-0.5], [0.25], [2.0]]);
    let pairs = numbers.floats(&[[0.0], [1.0], [0.5], [0.25], [-1.0], [2.0]]);
    let cubic: Vec<[f32; 1]> = (0..18).map(|k| [0.125 * k as f32]).collect();
    let cubic = numbers.floats(&cubic);
    let rest = |primitives: &str, more: &str| {
        format!(
            r#""nodes":[{{"name":"a","mesh":0}},{{"name":"a","children":[0,3]}},{{"mesh":1,"skin":0,"weights":[0.5,2]}},{{"name":"b","mesh":0,"scale":[-1,1,1]}},
         {{"name":"","mesh":1,"skin":0}},{{"name":"out","mesh":0}}],
        "scenes":[{{"nodes":[]}},{{"nodes":[1,2,4]}}],"scene":1,"skins":[{{"joints":[1,3]}}],
        "meshes":[{{"name":"m","primitives":[{primitives}]}},
         {{"name":"m","extras":{{"targetNames":["up","up"]}},"weights":[1,0],"primitives":[{{"attributes":{{"POSITION":{three},"JOINTS_0":{joints},"WEIGHTS_0":{bytes},"JOINTS_1":{more_joints},"WEIGHTS_1":{more_weights}}},"targets":[{{"POSITION":{lifted}}},{{"POSITION":{mended},"NORMAL":{zeros}}}]}}]}}],
        "animations":[{{"samplers":[{{"input":{times},"output":{pairs}}},{{"input":{times},"output":{cubic},"interpolation":"CUBICSPLINE"}}],
         "channels":[{{"sampler":0,"target":{{"node":2,"path":"weights"}}}},{{"sampler":1,"target":{{"node":4,"path":"weights"}}}},{{"sampler":0,"target":{{"node":5,"path":"weights"}}}}]}}]{more}"#
        )
    };
    let solid = |attributes: &str, more: &str| {
        format!(r#"{{"attributes":{{"POSITION":{five}{attributes}}}{more}}}"#)
    };
    let (normal, both) = (
        format!(r#","NORMAL":{normals}"#),
        format!(r#","NORMAL":{normals},"TANGENT":{tangents}"#),
    );
    let (by_fan, by_strip) = (
        format!(r#","mode":6,"indices":{fan}"#),
        format!(r#","mode":5,"indices":{strip}"#),
    );
    let points = solid(&both, r#","mode":0"#);
    for primitives in [
        [
            solid(&both, &by_fan),
            solid(&both, &by_strip),
            solid(&both, r#","mode":6"#),
        ]
        .join(","),
        [solid(&normal, &by_fan), solid(&both, &by_strip)].join(","),
        [
            solid(&normal, &by_strip),
            solid("", &by_fan),
            points.clone(),
        ]
        .join(","),
        [
            points.clone(),
            format!(r#"{{"attributes":{{"POSITION":{fractions}}},"indices":{words}}}"#),
        ]
        .join(","),
        [shorts, plain, woven, zeros]
            .map(|at| format!(r#"{{"attributes":{{"POSITION":{at}}}}}"#))
            .join(","),
        points,
        [
            solid(&both, &by_fan),
            format!(
                r#"{{"attributes":{{"POSITION":{three}}},"targets":[{{"POSITION":{lifted}}}]}}"#
            ),
        ]
        .join(","),
        solid("", ""),
        solid(&format!(r#","TANGENT":{odd}"#), &by_fan),
    ] {
        let found = read(numbers.document(&rest(&primitives, "")).as_bytes());
        match found {
            Ok(scene) => add(&mut digest, &scene),
            Err(error) => digest.bytes(error.to_string()),
        }
    }
    // Memory out of proportion, more than can be counted, and a curve that is none.
    let (mut last, mut beyond) = ([0; 64], [0; 64]);
    last[..2].copy_from_slice(&[1, 2]);
    beyond[..2].copy_from_slice(&[1, 3]);
    for accessor in [
        r#"{"componentType":5126,"type":"VEC3","count":4000000000}"#,
        r#"{"componentType":5126,"type":"VEC3","count":18446744073709551615}"#,
        r#"{"bufferView":0,"byteOffset":18446744073709551615,"componentType":5126,"type":"VEC3","count":1}"#,
        r#"{"componentType":5126,"type":"VEC3","count":3,"sparse":{"count":2,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}}"#,
    ] {
        for places in [[0; 64], last, beyond] {
            let mut own = Numbers::default();
            own.view(&places);
            let at = own.accessor(accessor.to_owned());
            let text = own.document(&format!(r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{at}}}}}]}}]"#));
            match read(text.as_bytes()) {
                Ok(scene) => add(&mut digest, &scene),
                Err(error) => digest.bytes(error.to_string()),
            }
        }
    }
    digest.value()
}

#[test]
fn of_gltf() {
    check_single(&[
        ("glTF, one thing changed", changes()),
        ("glTF, containers", containers()),
        ("glTF, varied", varied()),
    ]);
}
