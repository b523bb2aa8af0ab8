//! Promise: so it is for skins whose weights, transforms and buffers are drawn at random, and for meshes whose bones have volumes.
#![allow(clippy::unwrap_used)]

use glam::{Affine3A, Mat3A, Vec3, Vec4};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{
    AutomaticWeights, CageBinding, Deformation, DualQuaternion, HeatWeights, MeshWeights,
    PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights, SkinWeights, SkinningMethod,
    bone_volumes,
};
use support::box_sides::box_triangles;
use support::random::Random;
use support::skins::{Vertices, weights};

use crate::animated::{check_single, mesh, number, rotation, vector};
use crate::digest::{Digest, Value};
use crate::drawn::{at_times, one_of};
use crate::skins::rigid;

/// A transform of any kind, seldom one that is none.
fn transform(random: &mut Random) -> Affine3A {
    let mut own = rigid(random);
    match random.below(12) {
        0 => own.matrix3 *= Mat3A::from_diagonal(Vec3::new(1.2, 0.7, 1.1)),
        1 => own.matrix3 *= 0.5,
        2 if at_times(random, 0.1) => own.matrix3.x_axis *= -1.0,
        3 if at_times(random, 0.1) => own.translation.z = f32::NAN,
        _ => {}
    }
    own
}

fn add(digest: &mut Digest, vertices: &Vertices) {
    let directions = vertices.positions.iter().chain(&vertices.normals);
    digest.singles(directions.flat_map(|v| v.to_array()));
    digest.singles(vertices.tangents.iter().flat_map(|v| v.to_array()));
}

/// Which buffers are asked for, of which one may be too short.
fn asked(random: &mut Random, rest: &Vertices) -> (Vertices, Vertices) {
    let mut own = rest.clone();
    if at_times(random, 0.3) {
        own.positions.clear();
    }
    if at_times(random, 0.4) {
        own.normals.clear();
    }
    if at_times(random, 0.5) {
        own.tangents.clear();
    }
    let mut room = own.clone();
    if at_times(random, 0.1) {
        room.normals.pop();
    }
    if at_times(random, 0.1) {
        own.tangents.push(Vec4::X);
    }
    (own, room)
}

fn skins() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2071));
    for case in 0..70 {
        let (vertices, bones) = (1 + 3 * (case % 9), 1 + case % 5);
        let rest = Vertices::random(&mut random, vertices);
        let most = one_of(&mut random, &[1, 3, 4, 5]);
        let own = weights(&mut random, vertices, bones, most);
        let packed = PackedWeights::new(&own);
        let pivots: Vec<Vec3> = (0..bones)
            .map(|_| vector(&mut random, 1.0).into())
            .collect();
        let mut both = MeshWeights::from(own.clone());
        if at_times(&mut random, 0.4) {
            both = MeshWeights::unpacked(own.clone());
        }
        if at_times(&mut random, 0.5) {
            both = both.with_pivots(pivots.clone());
        }
        let triangles = (0..vertices as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        let normals = if at_times(&mut random, 0.5) {
            rest.normals.clone()
        } else {
            Vec::new()
        };
        let bare = TriangleMesh::new(rest.positions.clone(), normals, triangles.collect()).unwrap();
        for method in SkinningMethod::ALL {
            let transforms: Vec<Affine3A> = (0..bones).map(|_| transform(&mut random)).collect();
            let (from, mut room) = asked(&mut random, &rest);
            digest.answer(both.deform(method, &transforms, from.rest(), room.posed()));
            add(&mut digest, &room);
            if let Some(posed) = digest.answer(both.mesh(method, &bare, &transforms)) {
                mesh(&mut digest, &posed);
            }
        }
        let Some(packed) = digest.answer(packed) else {
            continue;
        };
        // One memory for several poses, some of which are refused.
        let still = vec![Affine3A::IDENTITY; bones];
        let mut linear = PackedLinearBlend::new(&packed, &still).unwrap();
        let mut dual = PackedDualQuaternionBlend::new(&packed, &still).unwrap();
        if at_times(&mut random, 0.3) {
            (linear, dual) = (linear.portable(), dual.portable());
        }
        for _ in 0..3 {
            let transforms: Vec<Affine3A> = (0..bones).map(|_| transform(&mut random)).collect();
            digest.answer(linear.set_transforms(&transforms));
            let told = match at_times(&mut random, 0.5) {
                true => dual.set_stretched(&transforms, &pivots),
                false => dual.set_transforms(&transforms),
            };
            digest.answer(told);
            for blend in [&linear as &dyn Deformation, &dual] {
                let (from, mut room) = asked(&mut random, &rest);
                digest.answer(blend.deform(from.rest(), room.posed()));
                add(&mut digest, &room);
            }
        }
    }
    digest.value()
}

/// A closed box, warped or not.
fn closed(random: &mut Random) -> TriangleMesh {
    let warp = one_of(random, &[0.2, 0.2, 0.0]);
    let corners = (0..8_u32).map(|k| {
        let side = |bit: u32| if k & bit == 0 { -1.0 } else { 1.0 };
        Vec3::new(side(1), 0.7 * side(2), 1.6 * side(4)) + Vec3::from(vector(random, warp))
    });
    TriangleMesh::new(corners.collect(), Vec::new(), box_triangles()).unwrap()
}

fn closed_meshes() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2072));
    for case in 0..30 {
        let mut own = closed(&mut random);
        if case % 7 == 6 {
            let triangles = own.triangles()[1..].to_vec();
            own = TriangleMesh::new(own.positions().to_vec(), Vec::new(), triangles).unwrap();
        }
        let bones = 1 + random.below(3);
        let given = weights(&mut random, 8, bones, 3);
        if case < 4 || case == 6 {
            digest.debug(digest_of(bone_volumes(&own, &given)));
        }
        let segments: Vec<_> = (0..bones)
            .map(|_| match at_times(&mut random, 0.4) {
                true => {
                    [-1.0, 1.0].map(|x| glam::DVec3::new(x, 0.7, one_of(&mut random, &[0.0, 1.6])))
                }
                false => [(); 2].map(|()| vector(&mut random, 0.8).as_dvec3()),
            })
            .collect();
        let mut by = AutomaticWeights::default();
        (by.falloff, by.smoothing_steps, by.most) = (
            random.within(1.0, 6.0),
            random.below(3) as u32,
            1 + random.below(3),
        );
        let mut warm = HeatWeights::default();
        (warm.heat, warm.most) = (random.within(0.1, 5.0), 1 + random.below(3));
        for made in [
            by.for_segments(&own, &segments),
            warm.for_segments(&own, &segments),
        ] {
            if let Some(made) = digest.answer(made) {
                told(&mut digest, &made);
            }
        }
        let (a, b, share) = (
            own.positions()[0],
            own.positions()[2],
            number(&mut random, 0.5) + 0.5,
        );
        let third = own.positions()[3];
        let points = [
            a,
            a.lerp(b, share),
            (a + b + third) / 3.0,
            vector(&mut random, 0.5).into(),
            vector(&mut random, 3.0).into(),
            Vec3::new(0.1, f32::NAN, 0.0),
        ];
        let count = one_of(&mut random, &[5, 5, 5, 6]);
        let Some(binding) = digest.answer(CageBinding::new(&own, &points[..count])) else {
            continue;
        };
        for point in 0..=binding.point_count() {
            digest.debug(binding.coordinates(point));
        }
        let cage: Vec<Vec3> = (0..8).map(|_| vector(&mut random, 1.0).into()).collect();
        let mut posed = Vec::new();
        binding.positions(&cage, &mut posed).unwrap();
        digest.singles(posed.iter().flat_map(|v: &Vec3| v.to_array()));
        digest.answer(binding.positions(&cage[1..], &mut posed));
        digest.answer(binding.positions(&cage, &mut posed[1..]));
        let motion = DualQuaternion::from_rotation_translation(rotation(&mut random), a).unwrap();
        digest.vector(motion.transform_vector(b));
        digest.vector(motion.transform_point(b));
    }
    digest.value()
}

fn digest_of<T: std::fmt::Debug, E: std::fmt::Display>(answer: Result<T, E>) -> String {
    answer.map_or_else(|error| error.to_string(), |found| format!("{found:?}"))
}

fn told(digest: &mut Digest, weights: &SkinWeights) {
    for row in weights.iter() {
        digest.word(row.len() as u64);
        for influence in row {
            digest.word(influence.bone.into());
            digest.doubles([influence.weight]);
        }
    }
}

#[test]
fn of_drawn_skins() {
    check_single(&[
        ("drawn skins", skins()),
        ("drawn meshes that are closed", closed_meshes()),
    ]);
}
