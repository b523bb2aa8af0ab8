//! Promise: numbers of a glTF file with rounding errors, or missing ones that other readers supply, are read with a
//! note.

use kinopt::io::gltf::{Note, Scene};
use support::gltf_text::Numbers;

/// Triangle on two joints; `weights` of its vertices, and one number in the last row of the second inverse bind matrix.
fn skinned(weights: [[f32; 4]; 3], joints: [[u8; 4]; 3], last: f32) -> Scene {
    let mut numbers = Numbers::default();
    let positions = numbers.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let joints = numbers.bytes(&joints, "");
    let weights = numbers.floats(&weights);
    let mut inverse = [[0.0_f32; 16]; 2];
    for matrix in &mut inverse {
        for axis in 0..4 {
            matrix[5 * axis] = 1.0;
        }
    }
    inverse[1][15] = last;
    let bytes: Vec<u8> = inverse
        .as_flattened()
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let view = numbers.view(&bytes);
    let inverse = numbers.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5126,"type":"MAT4","count":2}}"#
    ));
    numbers.read(&format!(
        r#""nodes":[{{"mesh":0,"skin":0,"name":"m"}},{{"name":"a"}},{{"name":"b"}}],
        "skins":[{{"joints":[1,2],"inverseBindMatrices":{inverse}}}],
        "meshes":[{{"name":"skin","primitives":[{{"attributes":{{"POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}}}}]}}]"#
    ))
}

const HALVES: [f32; 4] = [0.5, 0.5, 0.0, 0.0];

#[test]
fn matrix_row_off_by_rounding_is_read_with_a_note() {
    let joints = [[0, 1, 0, 0]; 3];
    let exact = skinned([HALVES; 3], joints, 1.0);
    let near = skinned([HALVES; 3], joints, 0.999_999_94);
    let bound = |scene: &Scene| {
        scene.meshes[0]
            .skin
            .as_ref()
            .unwrap()
            .joint_from_mesh
            .clone()
    };
    assert_eq!(bound(&near), bound(&exact));
    let notes = |scene: &Scene| -> Vec<String> {
        let repaired = scene
            .notes
            .iter()
            .filter(|note| matches!(note, Note::Repaired { .. }));
        repaired.map(ToString::to_string).collect()
    };
    assert!(notes(&exact).is_empty());
    let [note] = &notes(&near)[..] else {
        panic!("{:?}", near.notes);
    };
    assert!(note.contains("skins[0].inverseBindMatrices[1]"), "{note}");
    assert!(note.contains("last row"), "{note}");
}

#[test]
fn vertex_without_weights_follows_its_first_joint() {
    // The joint of the last vertex does not exist.
    let joints = [[0, 1, 0, 0], [1, 0, 0, 0], [7, 0, 0, 0]];
    let scene = skinned([HALVES, [0.0; 4], [0.0; 4]], joints, 1.0);
    let weights = &scene.meshes[0].skin.as_ref().unwrap().weights;
    let influences_of = |vertex| {
        let influences = weights.influences(vertex).iter();
        influences.map(|i| (i.bone, i.weight)).collect::<Vec<_>>()
    };
    assert_eq!(influences_of(0), [(0, 0.5), (1, 0.5)]);
    assert_eq!(influences_of(1), [(1, 1.0)]);
    assert_eq!(influences_of(2), [(0, 1.0)]);
    let unweighted = scene.notes.iter().find_map(|note| match note {
        Note::Weights { unweighted, .. } => Some(*unweighted),
        _ => None,
    });
    assert_eq!(unweighted, Some(2));
    let is_noted = scene
        .notes
        .iter()
        .any(|note| note.to_string().contains("2 vertices without weights"));
    assert!(is_noted, "{:?}", scene.notes);
}

#[test]
fn repeated_key_times_are_removed() {
    let mut numbers = Numbers::default();
    let input = numbers.floats(&[[0.0], [0.5], [0.5], [1.0]]);
    let output = numbers.floats(&[[1.0_f32; 3], [2.0; 3], [3.0; 3], [4.0; 3]]);
    let scene = numbers.read(&format!(
        r#""nodes":[{{"name":"hip"}}],"animations":[{{"samplers":[{{"input":{input},"output":{output}}}],"channels":[{{"sampler":0,"target":{{"node":0,"path":"scale"}}}}]}}]"#
    ));
    let note = scene.notes[0].to_string();
    assert!(note.contains("1 keys removed"), "{note}");
    let mut pose = scene.armature.rest().clone();
    let hold = kinopt::animation::Playback::Hold;
    let mut cursor = kinopt::animation::Cursor::new();
    for (time, scale) in [(0.0, 1.0), (0.5, 3.0), (1.0, 4.0)] {
        scene.clips[0]
            .sample(time, hold, &mut cursor, &mut pose)
            .unwrap();
        let bone = scene.armature.bone("hip").unwrap();
        assert_eq!(pose.local_of(bone).scale.x, scale);
    }
}
