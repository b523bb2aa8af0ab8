//! Promise: meshes of a glTF file are read as it draws them: strips and fans, sparse morph targets, mirrored nodes, and
//! normalised weights.

use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3, Vec3, Vec4};
use kinopt::io::gltf::{Note, ScenePosing};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MorphTargets, PosedVertices, SkinningMethod};
use support::gltf_text::{Numbers, read};

#[test]
fn sparse_morph_targets_and_weights_are_read() {
    let mut numbers = Numbers::default();
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
    ];
    let positions = numbers.floats(&corners);
    let normals = numbers.floats(&[[0.0, 0.0, 1.0]; 4]);
    let tangents = numbers.floats(&[[1.0, 0.0, 0.0, -1.0]; 4]);
    let (places, deltas) = (numbers.view(&[1, 0, 3, 0]), {
        let bytes: Vec<u8> = [0.0f32, 0.0, 2.0, 0.5, 0.0, 0.0]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        numbers.view(&bytes)
    });
    let sparse = numbers.accessor(format!(
        r#"{{"componentType":5126,"type":"VEC3","count":4,"sparse":{{"count":2,"indices":{{"bufferView":{places},"componentType":5123}},"values":{{"bufferView":{deltas}}}}}}}"#
    ));
    // The complete accessor's values, with two of them replaced.
    let base = numbers.view(
        &[[0.0f32, 1.0, 0.0]; 4]
            .as_flattened()
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect::<Vec<u8>>(),
    );
    let mended = numbers.accessor(format!(
        r#"{{"bufferView":{base},"componentType":5126,"type":"VEC3","count":4,"sparse":{{"count":2,"indices":{{"bufferView":{places},"componentType":5123}},"values":{{"bufferView":{deltas}}}}}}}"#
    ));
    let turned = numbers.floats(&[[1.0, 0.0, -1.0], [0.0; 3], [0.0; 3], [0.0; 3]]);
    let strip = numbers.bytes(&[[0], [1], [2], [3]], "");
    let scene = numbers.read(&format!(
        r#""nodes":[{{"name":"face","mesh":0}},{{"name":"twin","mesh":0,"weights":[0,1],"translation":[10,0,0]}}],
        "meshes":[{{"name":"head","weights":[0.5,0],"extras":{{"targetNames":["smile","frown"]}},
        "primitives":[{{"mode":5,"indices":{strip},"attributes":{{"POSITION":{positions},"NORMAL":{normals},"TANGENT":{tangents}}},
        "targets":[{{"POSITION":{sparse},"NORMAL":{turned}}},{{"POSITION":{mended}}}]}}]}}]"#
    ));
    assert_eq!(
        scene.armature.morph_targets(),
        ["smile", "frown", "twin/smile", "twin/frown"]
    );
    assert_eq!(scene.armature.rest().morph_weights(), [0.5, 0.0, 0.0, 1.0]);
    assert_eq!(
        scene.meshes[0].tangents,
        [Vec4::new(1.0, 0.0, 0.0, -1.0); 4]
    );
    assert_eq!(
        scene.meshes[0].morph_targets.targets()[0].vertices(),
        [0, 1, 3]
    );
    let mut posing = ScenePosing::new(&scene, SkinningMethod::LinearBlend).unwrap();
    let meshes = posing.meshes(scene.armature.rest()).unwrap();
    assert_eq!(
        meshes[0].positions(),
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 0.0],
            [1.25, 1.0, 0.0]
        ]
        .map(Vec3::from)
    );
    let half = 0.5f32.sqrt();
    assert!(meshes[0].normals()[0].distance(Vec3::new(half, 0.0, half)) < 1e-6);
    assert_eq!(meshes[0].normals()[2], Vec3::Z);
    assert_eq!(
        meshes[1].positions(),
        [
            [10.0, 1.0, 0.0],
            [11.0, 0.0, 2.0],
            [10.0, 2.0, 0.0],
            [11.5, 1.0, 0.0]
        ]
        .map(Vec3::from)
    );
    assert_eq!(meshes[0].triangles(), [[0, 1, 2], [1, 3, 2]]);
    let joined = posing.mesh(scene.armature.rest()).unwrap();
    assert_eq!(joined.positions().len(), 8);
    assert_eq!(
        joined.triangles(),
        [[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6]]
    );

    assert_eq!(joined.normals().len(), 8);
    // If one mesh has no normals, the scene has none, and is otherwise equal.
    let mut plain = scene.clone();
    let bare = &plain.meshes[1].mesh;
    let bare = TriangleMesh::new(
        bare.positions().to_vec(),
        Vec::new(),
        bare.triangles().to_vec(),
    );
    plain.meshes[1].mesh = bare.unwrap();
    plain.meshes[1].morph_targets = MorphTargets::none(4);
    let mut posing = ScenePosing::new(&plain, SkinningMethod::LinearBlend).unwrap();
    let whole = posing.mesh(scene.armature.rest()).unwrap();
    assert!(whole.normals().is_empty());
    assert_eq!(whole.triangles(), joined.triangles());

    // Into the caller's memory, from an object that owns the scene.
    let mut owned = ScenePosing::new(Arc::new(scene.clone()), SkinningMethod::LinearBlend).unwrap();
    let all: Vec<Vec3> = meshes
        .iter()
        .flat_map(|mesh| mesh.normals().to_vec())
        .collect();
    let (mut positions, mut normals) = (vec![Vec3::ZERO; 8], vec![Vec3::ZERO; all.len()]);
    let buffers = PosedVertices {
        positions: &mut positions,
        normals: &mut normals,
        tangents: &mut [],
    };
    owned.deform(scene.armature.rest(), buffers).unwrap();
    assert_eq!(positions, joined.positions());
    assert_eq!(normals, all);
    let short = PosedVertices {
        positions: &mut positions[1..],
        ..PosedVertices::default()
    };
    assert!(owned.deform(scene.armature.rest(), short).is_err());
}

#[test]
fn triangles_without_indices_and_fans_are_read() {
    let mut numbers = Numbers::default();
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
    ];
    let five = numbers.floats(&corners);
    let three = numbers.floats(&corners[..3]);
    let fan = numbers.shorts(&[[4], [0], [1], [2]]);
    let scene = numbers.read(&format!(
        r#""nodes":[{{"mesh":0,"scale":[-1,1,1]}}],"meshes":[{{"primitives":[
        {{"attributes":{{"POSITION":{three}}}}},
        {{"attributes":{{"POSITION":{five}}},"mode":6}},
        {{"attributes":{{"POSITION":{five}}},"mode":6,"indices":{fan}}}]}}]"#
    ));
    let mesh = &scene.meshes[0].mesh;
    // Five vertices once, although two primitives share them.
    assert_eq!(mesh.positions().len(), 8);
    let fans = [[4, 5, 3], [5, 6, 3], [6, 7, 3], [3, 4, 7], [4, 5, 7]];
    assert_eq!(mesh.triangles()[0], [0, 1, 2]);
    assert_eq!(mesh.triangles()[1..], fans);
    // The node mirrors: the winding of triangles is reversed, so that the outside stays outside.
    let mut posing = ScenePosing::new(&scene, SkinningMethod::LinearBlend).unwrap();
    let posed = posing.mesh(scene.armature.rest()).unwrap();
    assert_eq!(posed.positions()[1], Vec3::NEG_X);
    assert_eq!(posed.triangles()[0], [0, 2, 1]);
}

/// A vertex that is repeated after one or two others gives no triangle, and reverses the winding of those that follow.
#[test]
fn degenerate_triangles_stitch_strips() {
    let mut numbers = Numbers::default();
    let corners = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|x: f32| [x, x * x, 0.0]);
    let corners = numbers.floats(&corners);
    let strip = [1, 0, 1, 2, 1, 3, 3, 4, 4, 5, 0];
    let strip = numbers.shorts(&strip.map(|corner| [corner]));
    let scene = numbers.read(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"mode":5,"indices":{strip},"attributes":{{"POSITION":{corners}}}}}]}}]"#
    ));
    let expected = [[0, 2, 1], [2, 3, 1], [4, 5, 0]];
    assert_eq!(scene.meshes[0].mesh.triangles(), expected);
}

/// A mesh without primitives leaves nothing behind.
#[test]
fn mesh_without_primitives_has_no_joints() {
    let scene = Numbers::default()
        .read(r#""nodes":[{"name":"nothing","mesh":0}],"meshes":[{"primitives":[]}]"#);
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    assert!(scene.meshes[0].mesh.positions().is_empty() && scene.meshes[0].skin.is_none());
}

#[test]
fn matrix_is_decomposed() {
    let [scale, turn, translation] = [
        DVec3::new(2.0, 3.0, 0.5),
        DVec3::new(0.6, -0.3, 0.2),
        DVec3::new(1.0, -2.0, 4.0),
    ];
    let turn = DQuat::from_scaled_axis(turn);
    for mirror in [1.0, -1.0] {
        let scale = scale * DVec3::new(mirror, 1.0, 1.0);
        let matrix = DMat4::from_scale_rotation_translation(scale, turn, translation);
        let text = matrix
            .as_mat4()
            .to_cols_array()
            .map(|v| v.to_string())
            .join(",");
        let scene = Numbers::default().read(&format!(r#""nodes":[{{"matrix":[{text}]}}]"#));
        let rest = scene
            .armature
            .rest()
            .local(scene.armature.bone_at(0).unwrap())
            .unwrap();
        let again = DMat4::from(rest.to_affine().as_daffine3());
        let apart = (again - matrix)
            .to_cols_array()
            .into_iter()
            .fold(0.0, |largest: f64, e| largest.max(e.abs()));
        assert!(apart < 2e-6, "{apart:e}");
    }
    let sheared = r#""nodes":[{"name":"slanted","matrix":[1,0,0,0,0.5,1,0,0,0,0,1,0,0,0,0,1]}]"#;
    let error = Numbers::default().refused(sheared);
    assert!(
        error.contains("nodes[0].matrix")
            && error.contains("`slanted`")
            && error.contains("shears"),
        "{error}"
    );
}

#[test]
fn rescaled_weights_are_noted() {
    let mut numbers = Numbers::default();
    let positions = numbers.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let joints = numbers.bytes(&[[0, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0]], "");
    let bytes = numbers.bytes(
        &[[255, 0, 0, 0], [51, 204, 0, 0], [100, 100, 0, 0]],
        r#","normalized":true"#,
    );
    let more_joints = numbers.bytes(&[[0, 0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0]], "");
    let more_weights = numbers.floats(&[[0.0; 4], [0.0; 4], [0.25, 0.0, 0.0, 0.0]]);
    let scene = numbers.read(&format!(
        r#""nodes":[{{"mesh":0,"skin":0}},{{"name":"a"}},{{"name":"b"}}],"skins":[{{"joints":[1,2]}}],
        "meshes":[{{"name":"skin","primitives":[{{"attributes":{{"POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{bytes},"JOINTS_1":{more_joints},"WEIGHTS_1":{more_weights}}}}}]}}]"#
    ));
    let weights = &scene.meshes[0].skin.as_ref().unwrap().weights;
    let pairs = |vertex| {
        weights
            .influences(vertex)
            .iter()
            .map(|i| (i.bone, i.weight))
            .collect::<Vec<_>>()
    };
    assert_eq!(pairs(0), [(0, 1.0)]);
    assert_eq!(pairs(1), [(0, 0.2), (1, 0.8)]);
    let sum = 200.0 / 255.0 + 0.25;
    assert_eq!(pairs(2), [(0, 0.25 / sum), (1, (200.0 / 255.0) / sum)]);
    let note = scene.notes.iter().find_map(|note| match note {
        Note::Weights {
            mesh,
            repair,
            merged,
            ..
        } => Some((mesh, repair, merged)),
        _ => None,
    });
    let (mesh, repair, merged) = note.unwrap();
    assert_eq!((mesh.as_str(), repair.rescaled, *merged), ("skin", 1, 1));
    assert_eq!(repair.worst.unwrap().0, 2);
}

#[test]
fn weights_with_half_the_sum_are_noted() {
    let mut numbers = Numbers::default();
    let positions = numbers.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let joints = numbers.bytes(&[[0; 4]; 3], "");
    let weights = numbers.floats(&[[0.5, 0.0, 0.0, 0.0]; 3]);
    let scene = numbers.read(&format!(
        r#""nodes":[{{"mesh":0,"skin":0}},{{"name":"a"}}],"skins":[{{"joints":[1]}}],
        "meshes":[{{"name":"skin","primitives":[{{"attributes":{{"POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}}}}]}}]"#
    ));
    let reported = scene.notes.iter().find_map(|note| match note {
        Note::Weights { repair, merged, .. } => Some((repair.rescaled, *merged)),
        _ => None,
    });
    assert_eq!(reported, Some((3, 0)));
}

/// Bytes as fractions: the lowest signed byte represents −1 as well (section 3.6.2.2). The last entry of an interleaved
/// view may end without the stride's padding.
#[test]
fn normalised_and_interleaved_accessors_are_read() {
    let mut numbers = Numbers::default();
    let bytes = [-128_i8, -127, 127, 0, 64, 1, 127, 0, 0].map(|v| v as u8);
    let fractions = numbers.raw(&bytes, 5120, "VEC3", 3, r#","normalized":true"#);
    let shorts: Vec<u8> = [-32768_i16, -32767, 32767, 0, 16384, 1, 32767, 0, 0]
        .into_iter()
        .flat_map(i16::to_le_bytes)
        .collect();
    let shorts = numbers.raw(&shorts, 5122, "VEC3", 3, r#","normalized":true"#);
    let third = [[1.0_f32, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]];
    let apart: Vec<u8> = third
        .iter()
        .flat_map(|entry| [entry[0], entry[1], entry[2], f32::NAN])
        .flat_map(f32::to_le_bytes)
        .collect();
    let apart = numbers.raw(&apart[..44], 5126, "VEC3", 3, "");
    let text = numbers.document(&format!(
        r#""nodes":[{{"mesh":0}},{{"mesh":1}},{{"mesh":2}}],"extensionsRequired":["KHR_mesh_quantization"],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{fractions}}}}}]}},
        {{"primitives":[{{"attributes":{{"POSITION":{apart}}}}}]}},
        {{"primitives":[{{"attributes":{{"POSITION":{shorts}}}}}]}}]"#
    ));
    let text = text.replacen(
        r#""byteLength":44"#,
        r#""byteLength":44,"byteStride":16"#,
        1,
    );
    let scene = read(text.as_bytes()).unwrap();
    for (mesh, middle, most) in [(0, 64.0, 127.0), (2, 16384.0, 32767.0)] {
        let expected = [
            Vec3::new(-1.0, -1.0, 1.0),
            Vec3::new(0.0, middle / most, 1.0 / most),
            Vec3::X,
        ];
        let found = scene.meshes[mesh].mesh.positions().iter().zip(expected);
        found.for_each(|(found, expected)| assert!(found.distance(expected) < 1e-7));
    }
    assert_eq!(scene.meshes[1].mesh.positions(), third.map(Vec3::from));
}

/// Values of a sparse accessor are read with the accessor's normalisation: integers represent fractions.
#[test]
fn sparse_normalised_values_are_read() {
    let mut numbers = Numbers::default();
    let positions = numbers.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let (places, values) = (numbers.view(&[1, 0]), numbers.view(&[51, 204, 0, 0]));
    let base = numbers.view(&[[255, 0, 0, 0]; 3].concat());
    let weights = numbers.accessor(format!(
        r#"{{"bufferView":{base},"componentType":5121,"normalized":true,"type":"VEC4","count":3,"sparse":{{"count":1,"indices":{{"bufferView":{places},"componentType":5123}},"values":{{"bufferView":{values}}}}}}}"#
    ));
    let joints = numbers.bytes(&[[0, 1, 0, 0]; 3], "");
    let scene = numbers.read(&format!(
        r#""nodes":[{{"name":"skin","mesh":0,"skin":0}},{{"name":"a"}},{{"name":"b"}}],"skins":[{{"joints":[1,2]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}}}}]}}]"#
    ));
    assert_eq!(scene.notes, []);
    let skin = scene.meshes[0].skin.as_ref().unwrap();
    let weights: Vec<f64> = skin
        .weights
        .influences(1)
        .iter()
        .map(|i| i.weight)
        .collect();
    assert!((weights[0] - 0.2).abs() < 1e-9 && (weights[1] - 0.8).abs() < 1e-9);
}

/// Morph targets of a mesh of several primitives move the vertices of their own primitive.
#[test]
fn morph_targets_move_their_primitive_only() {
    let mut numbers = Numbers::default();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let others = corners.map(|[x, y, z]: [f32; 3]| [x + 5.0, y, z]);
    let [first, second] = [&corners, &others].map(|places| numbers.floats(places));
    let up = numbers.floats(&[[0.0, 0.0, 1.0], [0.0; 3], [0.0, 0.0, 2.0]]);
    let aside = numbers.floats(&[[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
    let scene = numbers.read(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"weights":[1],"primitives":[
        {{"attributes":{{"POSITION":{first}}},"targets":[{{"POSITION":{up}}}]}},
        {{"attributes":{{"POSITION":{second}}},"targets":[{{"POSITION":{aside}}}]}}]}}]"#
    ));
    let mut posing = ScenePosing::new(&scene, SkinningMethod::LinearBlend).unwrap();
    let posed = posing.mesh(scene.armature.rest()).unwrap();
    let expected = [
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 2.0],
        [5.0, 0.0, 0.0],
        [9.0, 0.0, 0.0],
        [5.0, 5.0, 0.0],
    ];
    assert_eq!(posed.positions(), expected.map(Vec3::from));
}

/// Weights of a mesh of several primitives belong to the vertices of their own primitive.
#[test]
fn weights_belong_to_their_primitive() {
    let mut numbers = Numbers::default();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let others = corners.map(|[x, y, z]: [f32; 3]| [x + 5.0, y, z]);
    let [first, second] = [&corners, &others].map(|places| numbers.floats(places));
    let joints = numbers.bytes(&[[0, 1, 2, 0]; 3], "");
    let [to_first, to_others] = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.25, 0.75, 0.0]]
        .map(|weights: [f32; 4]| numbers.floats(&[weights; 3]));
    let scene = numbers.read(&format!(
        r#""nodes":[{{"name":"skin","mesh":0,"skin":0}},{{"name":"a"}},{{"name":"b"}},{{"name":"c"}}],"skins":[{{"joints":[1,2,3]}}],
        "meshes":[{{"primitives":[
        {{"attributes":{{"POSITION":{first},"JOINTS_0":{joints},"WEIGHTS_0":{to_first}}}}},
        {{"attributes":{{"POSITION":{second},"JOINTS_0":{joints},"WEIGHTS_0":{to_others}}}}}]}}]"#
    ));
    assert_eq!(scene.notes, []);
    let skin = scene.meshes[0].skin.as_ref().unwrap();
    for vertex in 0..6 {
        let influences = skin.weights.influences(vertex).iter();
        let weights: Vec<_> = influences.map(|i| (i.bone, i.weight)).collect();
        match vertex < 3 {
            true => assert_eq!(weights, [(0, 1.0)], "{vertex}"),
            false => assert_eq!(weights, [(1, 0.25), (2, 0.75)], "{vertex}"),
        }
    }
}
