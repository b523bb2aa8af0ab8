//! Promise: so it is for the meshes in glTF files: primitives of every mode, numbers of every size, weights that are put right.
#![allow(clippy::unwrap_used)]

use support::gltf_text::{Numbers, read};

use crate::animated::check_single;
use crate::digest::{Digest, Value};
use crate::gltf::add;

/// Primitives of every mode, numbers of every size, weights that are put right, and names that are shared.
fn varied() -> Value {
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
            Err(error) => digest.text(error.to_string()),
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
                Err(error) => digest.text(error.to_string()),
            }
        }
    }
    digest.value()
}

#[test]
fn of_primitives() {
    check_single(&[("glTF, varied", varied())]);
}
