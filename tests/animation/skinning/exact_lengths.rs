//! Promise: packed skinning normalises normals and tangents with exact roots and divisions, so results are bitwise
//! equal on all processors.

use glam::{Affine3A, Vec3};
use kinopt::skinning::{
    Deformation, PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights, SkinWeights,
};
use support::random::Random;

const COUNT: usize = 4000;

/// All vertices on one bone.
fn on_one_bone(vertices: usize) -> PackedWeights {
    let mut builder = SkinWeights::builder(vertices, 1);
    for vertex in 0..vertices {
        builder.add(vertex, 0, 1.0).unwrap();
    }
    PackedWeights::new(&builder.build().unwrap()).unwrap()
}

fn normals(blend: &impl Deformation, rest: &[Vec3]) -> Vec<Vec3> {
    let mut posed = vec![Vec3::ZERO; rest.len()];
    blend.normals(rest, &mut posed).unwrap();
    posed
}

#[test]
fn axes_of_any_length_become_unit_axes() {
    let mut random = Random::new(1);
    let rest: Vec<Vec3> = (0..COUNT)
        .map(|k| Vec3::AXES[k % 3] * random.within(1e-3, 1e3) as f32)
        .collect();
    let expected: Vec<Vec3> = (0..COUNT).map(|k| Vec3::AXES[k % 3]).collect();
    let packed = on_one_bone(COUNT);
    let shift = [Affine3A::from_translation(Vec3::new(0.3, -2.0, 1.0))];
    let lbs = PackedLinearBlend::new(&packed, &shift).unwrap();
    let dqs = PackedDualQuaternionBlend::new(&packed, &shift).unwrap();
    assert_eq!(normals(&lbs, &rest), expected);
    assert_eq!(normals(&dqs, &rest), expected);
    assert_eq!(normals(&lbs.portable(), &rest), expected);
    assert_eq!(normals(&dqs.portable(), &rest), expected);
}

/// x² + y² + z² in the two rounding orders of the code paths, with an exact root.
#[test]
fn directions_are_divided_by_the_exact_root() {
    let mut random = Random::new(2);
    let mut rest = Vec::new();
    for _ in 0..COUNT {
        rest.push(Vec3::from(
            [(); 3].map(|()| random.within(-1.0, 1.0) as f32),
        ));
    }
    let packed = on_one_bone(COUNT);
    let still = [Affine3A::IDENTITY];
    let blend = PackedLinearBlend::new(&packed, &still).unwrap();
    let fused = |n: &Vec3| *n / n.x.mul_add(n.x, n.y.mul_add(n.y, n.z * n.z)).sqrt();
    let apart = |n: &Vec3| {
        let n = *n / n.abs().max_element();
        n * (1.0 / (n.x * n.x + n.y * n.y + n.z * n.z).sqrt())
    };
    let [fused, apart] = [
        rest.iter().map(fused).collect::<Vec<_>>(),
        rest.iter().map(apart).collect(),
    ];
    assert_eq!(normals(&blend.clone().portable(), &rest), apart);
    // Without fused multiply-add, the portable path is the only one.
    let posed = normals(&blend, &rest);
    assert!(posed == fused || posed == apart);
}

/// Squares of shorter normals underflow.
#[test]
fn tiny_normals_become_unit_or_zero() {
    let mut rest = Vec::new();
    for exponent in -26..-10 {
        for k in 1..10 {
            let size = k as f32 * 10f32.powi(exponent);
            rest.push(Vec3::new(0.6, -0.48, 0.64) * size);
        }
    }
    let packed = on_one_bone(rest.len());
    let still = [Affine3A::IDENTITY];
    let blend = PackedLinearBlend::new(&packed, &still).unwrap();
    for blend in [blend.clone(), blend.portable()] {
        for (normal, rest) in normals(&blend, &rest).iter().zip(&rest) {
            let deviation = normal.length() - 1.0;
            assert!(
                *normal == Vec3::ZERO || deviation.abs() < 1e-6,
                "{rest} {normal}"
            );
        }
    }
}
