//! Promise: skinning on a rayon pool, by buffer and by range of vertices equals skinning as a whole bitwise.

use glam::Affine3A;
use kinopt::skinning::{
    Deformation, DualQuaternionBlend, LinearBlend, PackedDualQuaternionBlend, PackedLinearBlend,
    PackedWeights,
};
use support::random::Random;
use support::skins::{Vertices, rigid, weights};

/// Skinning by buffer, and of 21 vertices from the twelfth on, equals that of the whole.
fn assert_parts_equal_the_whole(rest: &Vertices, whole: &Vertices, deformation: &impl Deformation) {
    let mut parts = Vertices {
        positions: Vec::new(),
        normals: Vec::new(),
        tangents: Vec::new(),
    };
    deformation
        .positions_into(&rest.positions, &mut parts.positions)
        .unwrap();
    deformation
        .normals_into(&rest.normals, &mut parts.normals)
        .unwrap();
    deformation
        .tangents_into(&rest.tangents, &mut parts.tangents)
        .unwrap();
    assert!(parts == *whole);
    let range = |all: &Vertices| Vertices {
        positions: all.positions[11..32].to_vec(),
        normals: all.normals[11..32].to_vec(),
        tangents: all.tangents[11..32].to_vec(),
    };
    let (rest, mut posed) = (range(rest), range(rest));
    deformation.deform_range(11, rest.rest(), posed.posed());
    assert!(posed == range(whole));
}

fn assert_parallel_equals_serial(rest: &Vertices, deformation: &impl Deformation) {
    let serial = rest.deformed(deformation);
    assert_parts_equal_the_whole(rest, &serial, deformation);
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
