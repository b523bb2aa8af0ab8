//! Promise: morph targets blend shapes by the documented formula, sparsely and before skinning, and reject invalid
//! input.

use glam::{Affine3A, Quat, Vec3, Vec4};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{Armature, Clip, Cursor, Easing, Playback};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{
    Deformation, LinearBlend, MorphTarget, MorphTargets, SkinWeights, SkinningError,
};
use support::random::Random;

fn triangle(corners: [[f32; 3]; 3]) -> TriangleMesh {
    let corners = corners.map(Vec3::from_array).to_vec();
    TriangleMesh::new(corners, vec![], vec![[0, 1, 2]]).unwrap()
}

/// A mouth's corners and upper lip, its smile and its frown: the example of the lecture notes on skeletal animation.
fn mouth() -> (TriangleMesh, MorphTargets) {
    let rest = triangle([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.5, 0.0]]);
    let smile = triangle([[-0.1, 0.2, 0.0], [1.1, 0.2, 0.0], [0.5, 0.6, 0.0]]);
    let frown = triangle([[0.1, -0.2, 0.0], [0.9, -0.2, 0.0], [0.5, 0.3, 0.0]]);
    let targets = vec![
        MorphTarget::between("smile", &rest, &smile, 0.0).unwrap(),
        MorphTarget::between("frown", &rest, &frown, 0.0).unwrap(),
    ];
    (rest, MorphTargets::new(3, targets).unwrap())
}

#[test]
fn half_a_smile_and_some_frown_blend() {
    let (rest, targets) = mouth();
    let mut posed = rest.positions().to_vec();
    targets
        .apply(&[0.5, 0.2], &mut posed, &mut [], &mut [])
        .unwrap();
    let smirk = [[-0.03, 0.06, 0.0], [1.03, 0.06, 0.0], [0.5, 0.51, 0.0]];
    for (posed, expected) in posed.iter().zip(smirk) {
        assert!(
            (*posed - Vec3::from_array(expected)).length() < 1e-6,
            "{posed}"
        );
    }
    // A full weight gives the shape, a zero weight the rest.
    let mut posed = rest.positions().to_vec();
    targets
        .apply(&[0.0, 0.0], &mut posed, &mut [], &mut [])
        .unwrap();
    assert_eq!(posed, rest.positions());
    targets
        .apply(&[0.0, 1.0], &mut posed, &mut [], &mut [])
        .unwrap();
    assert!((posed[2] - Vec3::new(0.5, 0.3, 0.0)).length() < 1e-7);
}

/// Fourteen vertices and four expressions with animated weights: at all times the face is rest + Σ αₖ (shapeₖ − rest)
/// with the weights of that time.
#[test]
fn clip_of_weights_animates_a_face() {
    let mut random = Random::new(23);
    let mut vertex = || Vec3::from_array(random.vector(1.0).map(|x| x as f32).into());
    let mut face = || -> Vec<Vec3> { (0..14).map(|_| vertex()).collect() };
    let rest = face();
    let names = ["smile", "frown", "surprise", "blink"];
    let shapes = names.map(|_| face());
    let mesh = |face: &[Vec3]| TriangleMesh::new(face.to_vec(), vec![], vec![]).unwrap();
    let targets = names.iter().zip(&shapes);
    let targets = targets
        .map(|(name, shape)| MorphTarget::between(*name, &mesh(&rest), &mesh(shape), 0.0).unwrap());
    let targets = MorphTargets::new(14, targets.collect()).unwrap();

    let armature = Armature::new(vec![], names.map(String::from).to_vec()).unwrap();
    let mut builder = Clip::builder("expressions", &armature);
    let eased = |times: [f32; 3]| {
        let there_and_back = vec![0.0, 1.0, 0.0];
        KeyedCurve::eased(times.to_vec(), there_and_back, vec![Easing::CubicInOut; 3]).unwrap()
    };
    // Overlapping in sequence; the frown has no channel and stays at rest.
    for (name, times) in [("smile", [0.0, 1.0, 2.0]), ("surprise", [1.0, 2.0, 3.0])] {
        let target = armature.morph_target(name).unwrap();
        builder.morph_weight(target, eased(times)).unwrap();
    }
    let blink = KeyedCurve::linear(vec![0.4, 0.5, 0.6], vec![0.0, 1.0, 0.0]).unwrap();
    let target = armature.morph_target("blink").unwrap();
    builder.morph_weight(target, blink).unwrap();
    let clip = builder.build();

    let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
    for (time, weights) in [
        (0.0, [0.0, 0.0, 0.0, 0.0]),
        (0.25, [0.0625, 0.0, 0.0, 0.0]),
        (0.5, [0.5, 0.0, 0.0, 1.0]),
        (0.55, [1.0 - 4.0 * 0.45_f32.powi(3), 0.0, 0.0, 0.5]),
        (1.0, [1.0, 0.0, 0.0, 0.0]),
        (1.25, [0.9375, 0.0, 0.0625, 0.0]),
        (2.5, [0.0, 0.0, 0.5, 0.0]),
        (9.0, [0.0, 0.0, 0.0, 0.0]),
    ] {
        clip.sample(time, Playback::Hold, &mut cursor, &mut pose)
            .unwrap();
        let mut posed = rest.clone();
        targets
            .apply(pose.morph_weights(), &mut posed, &mut [], &mut [])
            .unwrap();
        for (vertex, posed) in posed.iter().enumerate() {
            let moves = shapes.iter().zip(weights);
            let moves = moves.map(|(shape, weight)| (shape[vertex] - rest[vertex]) * weight);
            let expected = rest[vertex] + moves.sum::<Vec3>();
            assert!((*posed - expected).length() < 2e-6, "{time} s");
        }
    }
}

#[test]
fn only_moving_vertices_are_stored() {
    let rest = triangle([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.5, 0.0]]);
    let shape = triangle([[0.0, 0.0, 0.0], [1.0, 0.25, 0.0], [0.5, 0.5, 0.001]]);
    let all = MorphTarget::between("s", &rest, &shape, 0.0).unwrap();
    assert_eq!((all.name(), all.vertices()), ("s", &[1, 2][..]));
    let coarse = MorphTarget::between("s", &rest, &shape, 0.01).unwrap();
    assert_eq!(coarse.vertices(), [1]);
}

#[test]
fn normals_and_tangents_are_blended_and_normalised() {
    let target = MorphTarget::new(
        "tilt",
        vec![1],
        vec![Vec3::ZERO],
        vec![Vec3::new(1.0, 0.0, 0.0)],
        vec![Vec3::new(0.0, 0.0, -1.0)],
    );
    let targets = MorphTargets::new(2, vec![target.unwrap()]).unwrap();
    let mut normals = [Vec3::new(0.0, 0.0, 5.0), Vec3::Z];
    let mut tangents = [
        Vec4::new(1.0, 0.0, 0.0, 1.0),
        Vec4::new(1.0, 0.0, 0.0, -1.0),
    ];
    targets
        .apply(&[1.0], &mut [], &mut normals, &mut tangents)
        .unwrap();
    let s = 0.5_f32.sqrt();
    // A vertex without a target is unchanged.
    assert_eq!(normals[0], Vec3::new(0.0, 0.0, 5.0));
    assert!((normals[1] - Vec3::new(s, 0.0, s)).length() < 1e-6);
    assert!((tangents[1] - Vec4::new(s, 0.0, -s, -1.0)).length() < 1e-6);
    // Meshes with normals give deltas of normals.
    let flat = triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).with_computed_normals();
    let tipped = triangle([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]).with_computed_normals();
    let tip = MorphTarget::between("tip", &flat, &tipped, 0.0).unwrap();
    let targets = MorphTargets::new(3, vec![tip]).unwrap();
    let (mut positions, mut normals) = (flat.positions().to_vec(), flat.normals().to_vec());
    targets
        .apply(&[1.0], &mut positions, &mut normals, &mut [])
        .unwrap();
    assert_eq!(positions, tipped.positions());
    assert_eq!(normals, tipped.normals());
}

#[test]
fn morphs_are_applied_before_skinning() {
    let (rest, targets) = mouth();
    let mut shaped = rest.positions().to_vec();
    targets
        .apply(&[1.0, 0.0], &mut shaped, &mut [], &mut [])
        .unwrap();
    let mut builder = SkinWeights::builder(3, 1);
    for vertex in 0..3 {
        builder.add(vertex, 0, 1.0).unwrap();
    }
    let weights = builder.build().unwrap();
    let turn = [Affine3A::from_quat(Quat::from_rotation_z(1.0))];
    let mut posed = [Vec3::ZERO; 3];
    let blend = LinearBlend::new(&weights, &turn).unwrap();
    blend.positions(&shaped, &mut posed).unwrap();
    let corner = turn[0].transform_point3(Vec3::new(1.1, 0.2, 0.0));
    assert!((posed[1] - corner).length() < 1e-6);
}

#[test]
fn invalid_targets_are_rejected_by_name() {
    let one = |vertices: &[u32], positions: &[Vec3], normals: &[Vec3]| {
        MorphTarget::new(
            "t",
            vertices.to_vec(),
            positions.to_vec(),
            normals.to_vec(),
            vec![],
        )
    };
    let text = |error: SkinningError| error.to_string();
    let error = text(one(&[0, 1], &[Vec3::X], &[]).unwrap_err());
    assert_eq!(error, "target `t`: 1 position deltas for 2 vertices");
    let error = text(one(&[0, 1], &[], &[]).unwrap_err());
    assert_eq!(error, "target `t`: 0 position deltas for 2 vertices");
    let error = text(one(&[0], &[Vec3::X], &[Vec3::X; 2]).unwrap_err());
    assert_eq!(error, "target `t`: 2 normal deltas for 1 vertices");
    for vertices in [[1, 1], [1, 0]] {
        let error = one(&vertices, &[Vec3::X; 2], &[]).unwrap_err();
        assert!(
            matches!(error, SkinningError::TargetOrder { vertex, .. } if vertex == vertices[1])
        );
    }
    let error = one(&[4], &[Vec3::NAN], &[]).unwrap_err();
    assert!(matches!(
        error,
        SkinningError::NonFiniteDelta { vertex: 4, .. }
    ));
    let target = one(&[4], &[Vec3::X], &[]).unwrap();
    let error = MorphTargets::new(4, vec![target.clone()]).unwrap_err();
    assert!(matches!(
        error,
        SkinningError::TargetVertexOutOfRange {
            vertex: 4,
            vertices: 4,
            ..
        }
    ));
    let small = triangle([[0.0; 3]; 3]);
    let large = TriangleMesh::new(vec![Vec3::ZERO; 4], vec![], vec![]).unwrap();
    let error = MorphTarget::between("t", &small, &large, 0.0).unwrap_err();
    assert!(matches!(
        error,
        SkinningError::TargetShapeCount {
            given: 4,
            vertices: 3,
            ..
        }
    ));

    let targets = MorphTargets::new(5, vec![target]).unwrap();
    let mut positions = [Vec3::ONE; 5];
    let error = targets
        .apply(&[], &mut positions, &mut [], &mut [])
        .unwrap_err();
    assert_eq!(text(error), "0 weights for 1 morph targets: t");
    let error = targets
        .apply(&[f32::NAN], &mut positions, &mut [], &mut [])
        .unwrap_err();
    assert!(matches!(error, SkinningError::NonFiniteTargetWeight { .. }));
    let error = targets
        .apply(&[1.0], &mut positions, &mut [Vec3::X; 4], &mut [])
        .unwrap_err();
    assert_eq!(text(error), "4 normals given, expected 5");
    assert_eq!(positions, [Vec3::ONE; 5]);
}
