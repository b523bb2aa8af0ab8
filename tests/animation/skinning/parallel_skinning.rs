//! Promise: skinning on a rayon pool equals single-threaded skinning bitwise.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use glam::Affine3A;
use kinopt::skinning::{
    Deformation, DualQuaternionBlend, LinearBlend, PackedDualQuaternionBlend, PackedLinearBlend,
    PackedWeights,
};
use support::random::Random;
use support::skins::{Vertices, rigid, weights};

fn assert_parallel_equals_serial(rest: &Vertices, deformation: &impl Deformation) {
    let serial = rest.deformed(deformation);
    let mut parallel = rest.clone();
    deformation
        .deform_parallel(rest.rest(), parallel.posed())
        .unwrap();
    // Not assert_eq, which would print all vertices.
    assert!(parallel == serial);
    // Positions only, with the other buffers missing.
    parallel.positions.fill(glam::Vec3::ZERO);
    let posed = kinopt::skinning::PosedVertices {
        positions: &mut parallel.positions,
        ..Default::default()
    };
    let rest = kinopt::skinning::RestVertices {
        positions: &rest.positions,
        ..Default::default()
    };
    deformation.deform_parallel(rest, posed).unwrap();
    assert!(parallel.positions == serial.positions);
}

#[test]
fn parallel_skinning_equals_serial() {
    let mut random = Random::new(7);
    let (count, bones) = (50_003, 20);
    let weights = weights(&mut random, count, bones, 4);
    let packed = PackedWeights::new(&weights).unwrap();
    let rest = Vertices::random(&mut random, count);
    let transforms: Vec<Affine3A> = (0..bones).map(|_| rigid(&mut random)).collect();
    assert_parallel_equals_serial(&rest, &LinearBlend::new(&weights, &transforms).unwrap());
    assert_parallel_equals_serial(
        &rest,
        &DualQuaternionBlend::new(&weights, &transforms).unwrap(),
    );
    let fast = PackedLinearBlend::new(&packed, &transforms).unwrap();
    assert_parallel_equals_serial(&rest, &fast);
    assert_parallel_equals_serial(&rest, &fast.portable());
    let fast = PackedDualQuaternionBlend::new(&packed, &transforms).unwrap();
    assert_parallel_equals_serial(&rest, &fast);
    assert_parallel_equals_serial(&rest, &fast.portable());
}

#[test]
fn wrong_sizes_are_errors_in_parallel() {
    let mut random = Random::new(8);
    let weights = weights(&mut random, 10, 3, 2);
    let blend = LinearBlend::new(&weights, &[Affine3A::IDENTITY; 3]).unwrap();
    let rest = Vertices::random(&mut random, 11);
    let mut posed = rest.clone();
    let error = blend.deform_parallel(rest.rest(), posed.posed());
    let error = error.unwrap_err().to_string();
    assert_eq!(error, "11 rest positions given, expected 10");
}
