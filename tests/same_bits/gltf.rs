//! Promise: so it is for glTF files: what each holds, what reading notes, and what is refused.
#![allow(clippy::unwrap_used)]

use kinopt::io::gltf::{self, Scene};
use support::gltf_text::{read, small};

use crate::animated::{changed, check_single, mesh};
use crate::digest::{Digest, Value};

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
        digest.text(note.to_string());
    }
    digest.debug(scene.turning_bones());
}

fn changes() -> Value {
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
        (r#""byteOffset":48,"byteLength":48"#, r#""byteOffset":48,"byteLength":4800"#),
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

fn containers() -> Value {
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
        digest.text(found.map_or_else(|error| error.to_string(), |clips| clips.to_string()));
    }
    digest.refused(read(&good[..10]));
    digest.refused(read(&good[..good.len() - 1]));
    let scene = read(&good).unwrap();
    digest.text(scene.clip("bend").unwrap().name());
    digest.refused(scene.clip("bent"));
    digest.value()
}

#[test]
fn of_gltf() {
    check_single(&[
        ("glTF, one thing changed", changes()),
        ("glTF, containers", containers()),
    ]);
}
