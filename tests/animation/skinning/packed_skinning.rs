//! Promise: packed skinning of four influences equals the general path to rounding, with and without AVX2, for any
//! number of vertices.

use glam::{Affine3A, Vec3, Vec4};
use kinopt::skinning::{
    Deformation, DualQuaternionBlend, LinearBlend, MeshWeights, PackedDualQuaternionBlend,
    PackedLinearBlend, PackedWeights, SkinWeights, SkinningError, SkinningMethod,
};
use support::random::Random;
use support::skins::{Vertices, rigid, stretching, weights};

const BONES: usize = 13;

/// Nearly singular blends make normals inaccurate, so normals are compared only if the blend is well conditioned, by
/// the area scale of its cofactors.
fn close(a: &Vertices, b: &Vertices) {
    for (vertex, (a, b)) in a.positions.iter().zip(&b.positions).enumerate() {
        assert!((*a - *b).length() < 3e-6, "position {vertex}: {a} {b}");
    }
    for (vertex, (a, b)) in a.normals.iter().zip(&b.normals).enumerate() {
        assert!((*a - *b).length() < 1e-3, "normal {vertex}: {a} {b}");
        assert!((a.length() - 1.0).abs() < 1e-5);
    }
    for (vertex, (a, b)) in a.tangents.iter().zip(&b.tangents).enumerate() {
        assert!((*a - *b).length() < 1e-3, "tangent {vertex}: {a} {b}");
    }
    // Nearly all of them agree to rounding.
    let near =
        |pairs: &mut dyn Iterator<Item = f32>| pairs.filter(|deviation| *deviation < 3e-6).count();
    let normals = &mut a
        .normals
        .iter()
        .zip(&b.normals)
        .map(|(a, b)| (*a - *b).length());
    assert!(near(normals) * 10 >= a.normals.len() * 9);
    let tangents = &mut a
        .tangents
        .iter()
        .zip(&b.tangents)
        .map(|(a, b)| (*a - *b).length());
    assert!(near(tangents) * 10 >= a.tangents.len() * 9);
}

#[test]
fn packed_linear_blend_equals_the_general_path() {
    let mut random = Random::new(1);
    for count in [1, 7, 8, 9, 64, 1003] {
        let weights = weights(&mut random, count, BONES, 4);
        let packed = PackedWeights::new(&weights).unwrap();
        let rest = Vertices::random(&mut random, count);
        for transform in [rigid, stretching] {
            let transforms: Vec<Affine3A> = (0..BONES).map(|_| transform(&mut random)).collect();
            let any = rest.deformed(&LinearBlend::new(&weights, &transforms).unwrap());
            let fast = PackedLinearBlend::new(&packed, &transforms).unwrap();
            close(&rest.deformed(&fast), &any);
            close(&rest.deformed(&fast.portable()), &any);
        }
    }
}

#[test]
fn packed_dual_quaternions_equal_the_general_path() {
    let mut random = Random::new(2);
    for count in [1, 7, 8, 9, 64, 1003] {
        let weights = weights(&mut random, count, BONES, 4);
        let packed = PackedWeights::new(&weights).unwrap();
        let rest = Vertices::random(&mut random, count);
        let transforms: Vec<Affine3A> = (0..BONES).map(|_| rigid(&mut random)).collect();
        let any = rest.deformed(&DualQuaternionBlend::new(&weights, &transforms).unwrap());
        let fast = PackedDualQuaternionBlend::new(&packed, &transforms).unwrap();
        close(&rest.deformed(&fast), &any);
        close(&rest.deformed(&fast.portable()), &any);
    }
}

#[test]
fn packed_stretch_equals_the_general_path() {
    let mut random = Random::new(7);
    for count in [1, 9, 1003] {
        let weights = weights(&mut random, count, BONES, 4);
        let packed = PackedWeights::new(&weights).unwrap();
        let rest = Vertices::random(&mut random, count);
        let transforms = [(); BONES].map(|()| {
            let size = [(); 3].map(|()| random.within(0.5, 1.6) as f32);
            rigid(&mut random) * Affine3A::from_scale(Vec3::from(size))
        });
        let pivots =
            [(); BONES].map(|()| Vec3::from([(); 3].map(|()| random.within(-0.5, 0.5) as f32)));
        let any = DualQuaternionBlend::stretched(&weights, &transforms, &pivots).unwrap();
        let any = rest.deformed(&any);
        let mut fast = PackedDualQuaternionBlend::stretched(&packed, &transforms, &pivots).unwrap();
        close(&rest.deformed(&fast), &any);
        close(&rest.deformed(&fast.clone().portable()), &any);

        // A rejected pose changes nothing; a rigid one removes all earlier stretch.
        let mut mirror = transforms;
        mirror[3] = Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0));
        let refused = fast.set_stretched(&mirror, &pivots).unwrap_err();
        assert_eq!(refused, SkinningError::Mirrored { bone: 3 });
        close(&rest.deformed(&fast), &any);
        let turned = [(); BONES].map(|()| rigid(&mut random));
        fast.set_transforms(&turned).unwrap();
        let rigid = rest.deformed(&PackedDualQuaternionBlend::new(&packed, &turned).unwrap());
        assert_eq!(rest.deformed(&fast).positions, rigid.positions);
        // A rejected pose leaves no stretch behind either.
        fast.set_stretched(&mirror, &pivots).unwrap_err();
        let rigid = PackedDualQuaternionBlend::new(&packed, &turned).unwrap();
        let rigid = rest.deformed(&rigid.portable()).positions;
        assert_eq!(rest.deformed(&fast.portable()).positions, rigid);
    }
}

#[test]
fn missing_buffers_are_skipped() {
    let mut random = Random::new(3);
    let weights = weights(&mut random, 21, BONES, 4);
    let packed = PackedWeights::new(&weights).unwrap();
    let rest = Vertices::random(&mut random, 21);
    let transforms: Vec<Affine3A> = (0..BONES).map(|_| rigid(&mut random)).collect();
    let fast = PackedLinearBlend::new(&packed, &transforms).unwrap();
    let all = rest.deformed(&fast);
    let mut alone = rest.clone();
    fast.positions(&rest.positions, &mut alone.positions)
        .unwrap();
    fast.normals(&rest.normals, &mut alone.normals).unwrap();
    fast.tangents(&rest.tangents, &mut alone.tangents).unwrap();
    assert_eq!(alone, all);
}

#[test]
fn normals_without_direction_become_zero() {
    let mut builder = SkinWeights::builder(9, 1);
    for vertex in 0..9 {
        builder.add(vertex, 0, 1.0).unwrap();
    }
    let packed = PackedWeights::new(&builder.build().unwrap()).unwrap();
    let flat = [Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.0))];
    let fast = PackedLinearBlend::new(&packed, &flat).unwrap();
    for blend in [fast.clone(), fast.portable()] {
        let mut posed = [Vec3::ONE; 9];
        let mut rest = [Vec3::X; 9];
        rest[8] = Vec3::ZERO;
        blend.normals(&rest, &mut posed).unwrap();
        assert_eq!(posed, [Vec3::ZERO; 9]);
        let mut posed = [Vec4::ONE; 9];
        blend
            .tangents(&[Vec4::new(0.0, 0.0, 2.0, 1.0); 9], &mut posed)
            .unwrap();
        assert_eq!(posed, [Vec4::new(0.0, 0.0, 0.0, 1.0); 9]);
    }
}

#[test]
fn excess_influences_and_bad_poses_are_rejected() {
    let mut random = Random::new(4);
    let six = weights(&mut random, 12, BONES, 6);
    assert_eq!(
        PackedWeights::new(&six).unwrap_err(),
        SkinningError::TooManyInfluences {
            vertex: 4,
            influences: 5
        }
    );
    let packed = PackedWeights::new(&six.pruned(4).unwrap().0).unwrap();
    assert_eq!((packed.vertex_count(), packed.bone_count()), (12, BONES));

    // The largest bone index of 16 bits, and the next one.
    let mut builder = SkinWeights::builder(1, 65_536);
    builder.add(0, 65_535, 1.0).unwrap();
    let most = PackedWeights::new(&builder.build().unwrap()).unwrap();
    assert_eq!((most.vertex_count(), most.bone_count()), (1, 65_536));
    let mut builder = SkinWeights::builder(1, 65_537);
    builder.add(0, 65_536, 1.0).unwrap();
    assert_eq!(
        PackedWeights::new(&builder.build().unwrap()).unwrap_err(),
        SkinningError::TooManyBones { bones: 65_537 }
    );

    let still = vec![Affine3A::IDENTITY; BONES];
    let mut blend = PackedLinearBlend::new(&packed, &still).unwrap();
    let expected = format!("2 bone transforms given, expected {BONES}");
    let error = blend.set_transforms(&still[..2]).unwrap_err();
    assert_eq!(error.to_string(), expected);
    let mut broken = still.clone();
    broken[3].translation.y = f32::INFINITY;
    broken[BONES - 1].translation.x = f32::NAN;
    assert_eq!(
        blend.set_transforms(&broken).unwrap_err(),
        SkinningError::NonFiniteTransform { bone: 3 }
    );
    // The previous pose is kept.
    let rest = Vertices::random(&mut random, 12);
    let posed = rest.deformed(&blend);
    for (posed, rest) in posed.positions.iter().zip(&rest.positions) {
        assert!((*posed - *rest).length() < 1e-6);
    }
    let mut scaled = still.clone();
    scaled[5] = Affine3A::from_scale(Vec3::splat(1.1));
    let refused = SkinningError::NotRigid { bone: 5 };
    let mut blend = PackedDualQuaternionBlend::new(&packed, &still).unwrap();
    assert_eq!(blend.set_transforms(&scaled).unwrap_err(), refused);
    let deformed = rest.deformed(&blend);
    for (posed, rest) in deformed.positions.iter().zip(&rest.positions) {
        assert!((*posed - *rest).length() < 1e-6);
    }
    assert_eq!(
        PackedDualQuaternionBlend::new(&packed, &scaled).unwrap_err(),
        refused
    );
}

#[test]
fn changed_pose_equals_a_new_blend() {
    let mut random = Random::new(5);
    let weights = weights(&mut random, 50, BONES, 4);
    let packed = PackedWeights::new(&weights).unwrap();
    let rest = Vertices::random(&mut random, 50);
    let [before, after] =
        [(), ()].map(|()| -> Vec<Affine3A> { (0..BONES).map(|_| rigid(&mut random)).collect() });
    let mut lbs = PackedLinearBlend::new(&packed, &before).unwrap();
    lbs.set_transforms(&after).unwrap();
    let rebuilt = PackedLinearBlend::new(&packed, &after).unwrap();
    assert!(rest.deformed(&lbs) == rest.deformed(&rebuilt));
    assert!(rest.deformed(&lbs.portable()) == rest.deformed(&rebuilt.portable()));
    let mut dqs = PackedDualQuaternionBlend::new(&packed, &before).unwrap();
    dqs.set_transforms(&after).unwrap();
    let rebuilt = PackedDualQuaternionBlend::new(&packed, &after).unwrap();
    assert!(rest.deformed(&dqs) == rest.deformed(&rebuilt));
    assert!(rest.deformed(&dqs.portable()) == rest.deformed(&rebuilt.portable()));
    // From one stretch to another, to none, and to one again.
    let stretched = [0.6, 1.7].map(|by| -> Vec<Affine3A> {
        let stretch = Affine3A::from_scale(Vec3::new(by, 1.0, 1.0 / by));
        after.iter().map(|turn| *turn * stretch).collect()
    });
    let pivots = [vec![Vec3::X; BONES], vec![Vec3::new(0.3, -0.2, 0.1); BONES]];
    let mut dqs = PackedDualQuaternionBlend::stretched(&packed, &stretched[0], &pivots[0]).unwrap();
    dqs.set_stretched(&stretched[1], &pivots[1]).unwrap();
    let rebuilt = PackedDualQuaternionBlend::stretched(&packed, &stretched[1], &pivots[1]).unwrap();
    assert!(rest.deformed(&dqs) == rest.deformed(&rebuilt));
    let portable = dqs.clone().portable();
    assert!(rest.deformed(&portable) == rest.deformed(&rebuilt.portable()));
    dqs.set_transforms(&before).unwrap();
    let rebuilt = PackedDualQuaternionBlend::new(&packed, &before).unwrap();
    assert!(rest.deformed(&dqs) == rest.deformed(&rebuilt));
    dqs.set_stretched(&stretched[0], &pivots[0]).unwrap();
    let rebuilt = PackedDualQuaternionBlend::stretched(&packed, &stretched[0], &pivots[0]).unwrap();
    assert!(rest.deformed(&dqs) == rest.deformed(&rebuilt));
}

#[test]
fn mesh_pose_does_not_depend_on_the_path() {
    let mut random = Random::new(41);
    let positions = Vertices::random(&mut random, 1001).positions;
    let mesh = kinopt::mesh::TriangleMesh::new(positions, vec![], vec![]).unwrap();
    let transforms: Vec<Affine3A> = (0..BONES).map(|_| rigid(&mut random)).collect();
    for (most, packed) in [(4, true), (7, false)] {
        let weights = weights(&mut random, 1001, BONES, most);
        let ready = MeshWeights::from(weights.clone());
        assert_eq!(ready.is_packed(), packed, "{most} influences");
        for method in SkinningMethod::ALL {
            let posed = ready.mesh(method, &mesh, &transforms).unwrap();
            let expected = method.mesh(&mesh, &weights, &transforms).unwrap();
            for (a, b) in posed.positions().iter().zip(expected.positions()) {
                assert!((*a - *b).length() < 3e-6, "{method}: {a} {b}");
            }
            let plain = MeshWeights::unpacked(weights.clone());
            assert!(!plain.is_packed());
            assert_eq!(plain.mesh(method, &mesh, &transforms).unwrap(), expected);
        }
        // Stretched bones need pivots.
        let stretched: Vec<Affine3A> = transforms
            .iter()
            .map(|turn| *turn * Affine3A::from_scale(Vec3::new(1.0, 1.2, 0.9)))
            .collect();
        let dual = SkinningMethod::DualQuaternion;
        let refused = ready.mesh(dual, &mesh, &stretched).unwrap_err();
        assert_eq!(refused, SkinningError::NotRigid { bone: 0 });
        let pivots = vec![Vec3::new(0.1, 0.2, -0.3); BONES];
        let posed = ready.with_pivots(pivots.clone());
        let posed = posed.mesh(dual, &mesh, &stretched).unwrap();
        let expected = DualQuaternionBlend::stretched(&weights, &stretched, &pivots).unwrap();
        let expected = expected.mesh(&mesh).unwrap();
        for (a, b) in posed.positions().iter().zip(expected.positions()) {
            assert!((*a - *b).length() < 3e-6, "{a} {b}");
        }
    }
}
