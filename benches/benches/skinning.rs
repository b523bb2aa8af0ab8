//! Skinning of positions and normals with four influences, at a size that fits the caches and one that does not.
//! Throughput is in vertices.
#![allow(missing_docs, clippy::expect_used)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{Affine3A, Quat, Vec3};
use kinopt::skinning::{
    Deformation, DualQuaternionBlend, LinearBlend, PackedDualQuaternionBlend, PackedLinearBlend,
    PackedWeights, PosedVertices, RestVertices, SkinWeights,
};
use kinopt_benches::Sequence;

const BONES: usize = 64;

/// Numbers within [0, 1).
fn vector(sequence: &mut Sequence) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| sequence.unit() as f32))
}

/// Neighbouring vertices follow neighbouring bones, as in meshes.
fn weights(sequence: &mut Sequence, vertices: usize) -> SkinWeights {
    let mut builder = SkinWeights::builder(vertices, BONES);
    for vertex in 0..vertices {
        for influence in 0..4 {
            let bone = (vertex * BONES / vertices + influence) % BONES;
            let weight = 0.05 + sequence.unit();
            builder.add(vertex, bone, weight).expect("it is there");
        }
    }
    builder.build_repaired().expect("positive weights").0
}

fn skinning(criterion: &mut Criterion) {
    let mut sequence = Sequence::new(0.5);
    let transforms: Vec<Affine3A> = (0..BONES)
        .map(|_| {
            let axis = (vector(&mut sequence) - 0.5).normalize_or(Vec3::X);
            let turn = Quat::from_axis_angle(axis, 3.0 * sequence.unit() as f32);
            Affine3A::from_rotation_translation(turn, vector(&mut sequence))
        })
        .collect();
    let mut group = criterion.benchmark_group("skinning, positions and normals");
    for vertices in [1 << 15, 1 << 20] {
        let weights = weights(&mut sequence, vertices);
        let packed = PackedWeights::new(&weights).expect("four influences");
        let positions: Vec<Vec3> = (0..vertices).map(|_| vector(&mut sequence)).collect();
        let normals: Vec<Vec3> = (0..vertices)
            .map(|_| (vector(&mut sequence) - 0.5).normalize_or(Vec3::Z))
            .collect();
        let (mut posed, mut turned) = (positions.clone(), normals.clone());
        group.throughput(Throughput::Elements(vertices as u64));
        let mut measure = |name: &str, deformation: &dyn Deformation| {
            group.bench_function(BenchmarkId::new(name, vertices), |bencher| {
                bencher.iter(|| {
                    let rest = RestVertices {
                        positions: black_box(&positions),
                        normals: &normals,
                        tangents: &[],
                    };
                    let out = PosedVertices {
                        positions: &mut posed,
                        normals: &mut turned,
                        tangents: &mut [],
                    };
                    deformation.deform(rest, out).expect("equal sizes");
                });
            });
        };
        let lbs = PackedLinearBlend::new(&packed, &transforms).expect("valid");
        let dqs = PackedDualQuaternionBlend::new(&packed, &transforms).expect("rigid");
        measure("lbs, four influences", &lbs);
        measure("lbs, four influences, portable", &lbs.clone().portable());
        measure("dqs, four influences", &dqs);
        measure("dqs, four influences, portable", &dqs.clone().portable());
        let any = LinearBlend::new(&weights, &transforms).expect("valid");
        measure("lbs, any influences", &any);
        let any = DualQuaternionBlend::new(&weights, &transforms).expect("rigid");
        measure("dqs, any influences", &any);
    }
    group.finish();
}

criterion_group!(benches, skinning);
criterion_main!(benches);
