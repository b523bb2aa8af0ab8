//! Promise: the error for an invalid glTF file names the file, the place and the fault.

use kinopt::io::gltf;
use support::fault_tables::faults;
use support::gltf_text::{Numbers, read, small};

/// Replaces a text that occurs once in the small file, and returns the error.
fn changed(from: &str, to: &str) -> String {
    let (numbers, rest) = small();
    let text = numbers.document(&rest);
    assert_eq!(text.matches(from).count(), 1, "{from} in {text}");
    match read(text.replacen(from, to, 1).as_bytes()) {
        Ok(_) => String::new(),
        Err(error) => error.to_string(),
    }
}

#[track_caller]
fn says(error: &str, words: &str) {
    assert!(error.contains("own.gltf"), "{error}");
    for word in words.split(" | ") {
        assert!(error.contains(word), "no {word} in {error}");
    }
}

#[test]
fn valid_small_file_is_read() {
    let (numbers, rest) = small();
    assert!(read(numbers.document(&rest).as_bytes()).is_ok());
    assert!(read(&numbers.glb(&rest)).is_ok());
}

/// Faults that replace one passage of the small file.
const FAULTS: &str = r#"
"mode":4 => "mode":9 | mode | unknown
"rotation":[0,0,0,1] => "rotation":[0,0,0,0] | nodes[1].rotation | `lower` | zero
"translation":[0,1,0] => "translation":[0,1e39,0] | nodes[0].translation[1] | out of range
[2,0,0,0,0,2, => [2,0,0,1,0,2, | nodes[3].matrix | last row
[2,0,0,0,0,2, => [2,0,0,0,1,2, | nodes[3].matrix | node 3 | shears
"scene":0 => "scene":5 | scene 5
"nodes":[3] => "nodes":[4] | scenes[0].nodes[0] | node 4
"skin":0 => "skin":1 | skins[1] | does not exist
"mesh":0 => "mesh":1 | meshes[1] | does not exist
"weights":[0.5] => "weights":[0.5,1] | nodes[2].weights | `tube` | 2 weights for 1
"joints":[1,0] => "joints":[1,7] | skins[0].joints[1] | node 7
"joints":[1,0] => "joints":[] | skins[0].joints | no joints
"joints":[1,0] => "joints":[1] | `tube` | bone 1 | 1 bones
"joints":[1,0] => "joints":[1,0,2] | skins[0].inverseBindMatrices | 2 for 3
"POSITION":0, =>  | meshes[0].primitives[0].attributes | `tube` | POSITION
"POSITION":0, => "POSITION":77, | accessors[77] | `tube` | POSITION | does not exist
"POSITION":0, => "POSITION":3, | accessors[3].type | 3 numbers
"NORMAL":1, => "NORMAL":9, | attributes.NORMAL | 2 entries for 4
"JOINTS_0":2, =>  | JOINTS_n
,"JOINTS_0":2,"WEIGHTS_0":3 =>  | `tube` | JOINTS_0
"JOINTS_0":2, => "JOINTS_0":3, | accessors[3] | unsigned integers
"indices":5 => "indices":7 | indices | unsigned integers
"target":{"node":0, => "target":{"node":8, | animations[0].channels[0].target.node | node 8
{"sampler":0, => {"sampler":6, | channels[0].sampler | `bend` | sampler 6
"interpolation":"STEP" => "interpolation":"SPLINE" | samplers[2].interpolation | CUBICSPLINE
"interpolation":"CUBICSPLINE" => "interpolation":"LINEAR" | samplers[0] | `bend` | rotation of node `upper` | 6 values for 2 keys
{"node":1,"path":"translation"} => {"node":0,"path":"rotation"} | accessors[9].type | `bend` | rotation of node `upper`
{"sampler":1,"target":{"node":1,"path":"translation"}} => {"sampler":0,"target":{"node":0,"path":"rotation"}} | channels[1] | `upper` | already
"#;

#[test]
fn faults_are_named() {
    let (numbers, rest) = small();
    let text = numbers.document(&rest);
    for mut fault in faults(FAULTS) {
        fault.parts.push("own.gltf");
        fault.check(read(fault.applied(&text).as_bytes()));
    }
}

#[test]
fn document_errors_are_named() {
    let versions = |to: &str| changed(r#""version":"2.0""#, to);
    says(&versions(r#""version":"1.0""#), "asset | 1.0 | 2.0");
    says(&versions(r#""version":"2.1","minVersion":"2.1""#), "2.1");
    assert_eq!(versions(r#""version":"2.1","minVersion":"2.0""#), "");
    says(&versions(r#""version":2"#), "asset.version");
    let extension = |name: &str| {
        versions(&format!(
            r#""version":"2.0"}},"extensionsRequired":["{name}"],"x":{{"#
        ))
    };
    says(
        &extension("KHR_gaussian_splatting_compression_spz"),
        "extensionsRequired[0] | `KHR_gaussian_splatting_compression_spz` | KHR_draco_mesh_compression",
    );
    assert_eq!(extension("KHR_texture_transform"), "");
    for rubbish in [&b""[..], b"rubbish", b"[1]"] {
        says(
            &read(rubbish).unwrap_err().to_string(),
            "not a glTF file | no JSON object",
        );
    }
    says(&read(b"{}").unwrap_err().to_string(), "asset");
}

#[test]
fn container_errors_are_named() {
    let (numbers, rest) = small();
    let good = numbers.glb(&rest);
    let with = |at: usize, word: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        read(&bytes).unwrap_err().to_string()
    };
    says(&with(4, 1), "byte 4 | version 1");
    // Shorter than its own header.
    says(&with(8, 4), "JSON");
    says(&with(8, u32::MAX), "byte 8 | 4294967295");
    says(&with(12, u32::MAX), "byte 12 | 4294967295");
    says(&with(16, 7), "no JSON chunk");
    // A chunk of another kind is skipped, at any position.
    let mut longer = good.clone();
    longer.extend([4, 0, 0, 0, b'A', b'B', b'C', b'D', 1, 2, 3, 4]);
    let length = longer.len() as u32;
    longer[8..12].copy_from_slice(&length.to_le_bytes());
    assert!(read(&longer).is_ok());
    // Of two binary chunks the first is the buffer's.
    let mut twice = good.clone();
    twice.extend([4, 0, 0, 0, b'B', b'I', b'N', 0, 1, 2, 3, 4]);
    twice[8..12].copy_from_slice(&length.to_le_bytes());
    assert_eq!(read(&twice).unwrap().meshes, read(&good).unwrap().meshes);
}

#[test]
fn buffer_errors_are_named() {
    let (numbers, rest) = small();
    let text = numbers.document(&rest);
    let start = text.find("data:").unwrap();
    let end = start + text[start..].find('"').unwrap();
    let with = |uri: &str| {
        let text = format!("{}{uri}{}", &text[..start], &text[end..]);
        read(text.as_bytes()).unwrap_err().to_string()
    };
    says(&with("data:,abc"), "buffers[0].uri | base64");
    says(&with("data:;base64,a*b"), "buffers[0].uri | base64");
    says(
        &with("data:;base64,AAAA"),
        "buffers[0].byteLength | 3 are left",
    );
    says(&with("https://example.org/a.bin"), "is not a relative URI");
    says(
        &with("legs%20and%20arms.bin"),
        "buffers[0].uri | legs and arms.bin",
    );
    let opened = |file: &str| {
        assert_eq!(file, "a b.bin");
        Ok(vec![0; 10_000])
    };
    let text = format!("{}a%20b.bin{}", &text[..start], &text[end..]);
    // All zeros.
    let error = gltf::from_bytes(text.as_bytes(), "own.gltf", opened).unwrap_err();
    says(
        &error.to_string(),
        "accessors[6].sparse.indices | `tube` | increase",
    );
}

#[test]
fn node_errors_are_named() {
    let child = r#""name":"upper","#;
    says(
        &changed(child, r#""name":"upper","children":[9],"#),
        "nodes[0].children[0] | node 9 | 0 to 3",
    );
    says(
        &changed(child, r#""name":"upper","children":[1],"#),
        "node `lower` | `upper`",
    );
    says(
        &changed(child, r#""name":"upper","children":[3],"#),
        "below itself",
    );
}

#[test]
fn skin_and_mesh_errors_are_named() {
    let mut numbers = Numbers::default();
    let corners = numbers.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    let indices = numbers.shorts(&[[0], [1], [2]]);
    let five = numbers.shorts(&[[0], [1], [1], [0], [1]]);
    let over = |indices: usize| {
        numbers.refused(&format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"name":"m","primitives":[{{"attributes":{{"POSITION":{corners}}},"indices":{indices}}}]}}]"#
        ))
    };
    says(
        &over(indices),
        "primitives[0].indices | `m` | index 2 is out of range | 2 vertices",
    );
    says(&over(five), "primitives[0].indices | 5 corners");
}

#[test]
fn accessor_errors_are_named() {
    let mut numbers = Numbers::default();
    let view = numbers.view(&[0; 64]);
    let mesh = |accessor: &str| {
        let mut numbers = Numbers::default();
        numbers.view(&[0; 64]);
        let at = numbers.accessor(accessor.to_owned());
        numbers.refused(&format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"name":"m","primitives":[{{"attributes":{{"POSITION":{at}}}}}]}}]"#
        ))
    };
    assert_eq!(view, 0);
    let vec3 = |more: &str| mesh(&format!(r#"{{"componentType":5126,"type":"VEC3",{more}}}"#));
    says(
        &vec3(r#""bufferView":0,"count":6"#),
        "accessors[0].bufferView | `m` | 72 | 64 are left",
    );
    says(
        &vec3(r#""bufferView":0,"count":5,"byteOffset":5"#),
        "byte 5",
    );
    says(
        &vec3(r#""bufferView":0,"count":1,"byteOffset":18446744073709551615"#),
        "18446744073709551615",
    );
    says(
        &vec3(r#""bufferView":0,"count":0"#),
        "accessors[0].count | 0",
    );
    says(&vec3(r#""bufferView":4,"count":1"#), "view 4 of 1");
    // More zeros without a buffer than the file's size justifies.
    says(
        &vec3(r#""count":4000000000"#),
        "accessors[0] | out of proportion",
    );
    says(
        &vec3(r#""count":18446744073709551615"#),
        "meshes[0].primitives[0] | more vertices than can be counted",
    );
    says(
        &mesh(r#"{"componentType":5124,"type":"VEC3","count":1,"bufferView":0}"#),
        "componentType | 5126",
    );
    let sparse = |indices: &str| {
        vec3(&format!(
            r#""count":3,"sparse":{{"count":2,"indices":{{"bufferView":0,"componentType":5121{indices}}},"values":{{"bufferView":0}}}}"#
        ))
    };
    says(&sparse(""), "accessors[0].sparse.indices | increase");
    // Entries 1 and 2 exist; 3 does not.
    for (last, is_valid) in [(2, true), (3, false)] {
        let mut numbers = Numbers::default();
        let places = numbers.view(&[1, last]);
        let values = numbers.view(&[0; 24]);
        let at = numbers.accessor(format!(
            r#"{{"componentType":5126,"type":"VEC3","count":3,"sparse":{{"count":2,"indices":{{"bufferView":{places},"componentType":5121}},"values":{{"bufferView":{values}}}}}}}"#
        ));
        let text = numbers.document(&format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{at}}}}}]}}]"#
        ));
        match read(text.as_bytes()) {
            Ok(_) => assert!(is_valid),
            Err(error) => {
                assert!(!is_valid, "{error}");
                says(&error.to_string(), "sparse.indices | the 3 entries");
            }
        }
    }
    says(
        &sparse(r#","byteOffset":64"#),
        "sparse.indices.bufferView | byte 64",
    );
}

#[test]
fn animation_errors_are_named() {
    let keys = |times: &[[f32; 1]], values: &[[f32; 3]]| {
        let mut numbers = Numbers::default();
        let (input, output) = (numbers.floats(times), numbers.floats(values));
        numbers.refused(&format!(
            r#""nodes":[{{"name":"hip"}}],"animations":[{{"name":"hop","samplers":[{{"input":{input},"output":{output}}}],"channels":[{{"sampler":0,"target":{{"node":0,"path":"scale"}}}}]}}]"#
        ))
    };
    let zero = [0.0; 3];
    let location = ["animations[0].samplers[0]", "`hop`", "scale of node `hip`"];
    for (times, values, words) in [
        ([[1.0], [0.5]], [zero, zero], ["key 1", "not after"]),
        ([[0.0], [f32::NAN]], [zero, zero], ["key 1", "not finite"]),
        (
            [[0.0], [1.0]],
            [zero, [0.0, f32::INFINITY, 0.0]],
            ["key 1", "not finite"],
        ),
    ] {
        let error = keys(&times, &values);
        says(&error, &location.join(" | "));
        says(&error, &words.join(" | "));
    }
    says(&keys(&[[0.0], [1.0]], &[zero]), "1 values for 2 keys");
}

/// Weights for a mesh without morph targets are an error.
#[test]
fn weights_without_morph_targets_are_rejected() {
    let mut numbers = Numbers::default();
    let corners = numbers.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let ends = numbers.floats(&[[0.0], [1.0]]);
    let error = numbers.refused(&format!(
        r#""nodes":[{{"name":"hip","mesh":0}}],"meshes":[{{"name":"tube","primitives":[{{"attributes":{{"POSITION":{corners}}}}}]}}],
        "animations":[{{"name":"hop","samplers":[{{"input":{ends},"output":{ends}}}],"channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}]}}]"#
    ));
    says(
        &error,
        "animations[0].samplers[0] | `hop` | node `hip` | mesh `tube` has no morph targets",
    );
}

#[test]
fn numbers_not_finite_are_rejected() {
    let refused = |positions: [[f32; 3]; 3], weights: [[f32; 4]; 3]| {
        let mut numbers = Numbers::default();
        let positions = numbers.floats(&positions);
        let weights = numbers.floats(&weights);
        let joints = numbers.bytes(&[[0, 1, 0, 0]; 3], "");
        numbers.refused(&format!(
            r#""nodes":[{{"mesh":0,"skin":0}}],"skins":[{{"joints":[0,0]}}],"meshes":[{{"name":"m","primitives":[{{"attributes":{{"POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}}}}]}}]"#
        ))
    };
    let (flat, one) = ([[0.0; 3]; 3], [[1.0, 0.0, 0.0, 0.0]; 3]);
    let nan = f32::NAN;
    says(
        &refused([[0.0; 3], [0.0, nan, 0.0], [0.0; 3]], one),
        "`m` | vertex 1 | position",
    );
    says(
        &refused(flat, [one[0], one[0], [0.5, nan, 0.0, 0.0]]),
        "`m` | vertex 2 | bone 1",
    );
    says(
        &refused(flat, [one[0], [0.0, -1.0, 0.0, 0.0], one[0]]),
        "meshes[0] | `m` | vertex 1 | sum to 0",
    );
}
