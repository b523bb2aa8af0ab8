//! Promise: linear blend skinning in single precision equals the formula in double precision to 1e-6 of the model's
//! size.

use glam::{Affine3A, Vec3};
use kinopt::mesh::TriangleMesh;
use kinopt::model::Limits;
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::skinning::{
    Deformation, LinearBlend, SkinWeights, SkinningError, single_precision_transform,
};
use kinopt::spatial::{Placement, Vector3};
use nalgebra::{Matrix4, Rotation3, Translation3, Vector3 as N3, Vector4};
use support::random::Random;

/// Random rotation and translation.
fn random_placement(random: &mut Random, size: f64) -> Matrix4<f64> {
    let turn = Rotation3::new(random.vector(std::f64::consts::PI));
    Translation3::from(random.vector(size)).to_homogeneous() * turn.to_homogeneous()
}

fn placement_of(m: &Matrix4<f64>) -> Placement<f64> {
    let rotation: nalgebra::Matrix3<f64> = m.fixed_view::<3, 3>(0, 0).into();
    Placement::new(
        rotation.into(),
        Vector3::new(m[(0, 3)], m[(1, 3)], m[(2, 3)]),
    )
}

/// Weights of up to `most` influences that sum to 1, some slightly negative as in real files.
fn weights(random: &mut Random, vertices: usize, bones: usize, most: usize) -> SkinWeights {
    let mut builder = SkinWeights::builder(vertices, bones);
    for vertex in 0..vertices {
        let count = 1 + vertex % most.min(bones);
        let raw: Vec<f64> = (0..count)
            .map(|k| {
                let positive = 0.05 + random.unit();
                if k == 3 { -7.5e-5 } else { positive }
            })
            .collect();
        let sum: f64 = raw.iter().sum();
        for (k, weight) in raw.iter().enumerate() {
            builder
                .add(vertex, (vertex + k) % bones, weight / sum)
                .unwrap();
        }
    }
    builder.build().unwrap()
}

fn mesh(random: &mut Random, vertices: usize, size: f64) -> TriangleMesh {
    let single = |v: N3<f64>| Vec3::new(v.x as f32, v.y as f32, v.z as f32);
    let positions = (0..vertices).map(|_| single(random.vector(0.5 * size)));
    let positions = positions.collect();
    // Not normalised, as in mesh files; one is zero.
    let mut normals: Vec<Vec3> = (0..vertices)
        .map(|k| single(random.vector(1.0)) * 10_f32.powi(k as i32 % 40 - 20))
        .collect();
    normals[7] = Vec3::ZERO;
    TriangleMesh::new(positions, normals, vec![[0, 1, 2]]).unwrap()
}

/// Σ w_j T_j in double precision.
fn blended(transforms: &[Matrix4<f64>], weights: &SkinWeights, vertex: usize) -> Matrix4<f64> {
    weights
        .influences(vertex)
        .iter()
        .map(|i| transforms[i.bone as usize] * i.weight)
        .sum()
}

fn double(v: Vec3) -> N3<f64> {
    N3::new(v.x.into(), v.y.into(), v.z.into())
}

#[test]
fn positions_and_normals_agree_with_double_precision() {
    for (seed, size, most) in [
        (1, 1.0, 1),
        (2, 1.8, 4),
        (3, 250.0, 13),
        (4, 1e-6, 13),
        (5, 3e9, 6),
    ] {
        let mut random = Random::new(seed);
        let (vertices, bones) = (400, 19);
        let weights = weights(&mut random, vertices, bones, most);
        let rest = mesh(&mut random, vertices, size);
        let transforms: Vec<_> = (0..bones)
            .map(|_| random_placement(&mut random, size))
            .collect();

        let single: Vec<Affine3A> = transforms
            .iter()
            .map(|t| single_precision_transform(&placement_of(t)))
            .collect();
        let blend = LinearBlend::new(&weights, &single).unwrap();
        let posed = blend.mesh(&rest).unwrap();
        assert_eq!(posed.triangles(), rest.triangles());

        for vertex in 0..vertices {
            let m = blended(&transforms, &weights, vertex);
            let v = double(rest.positions()[vertex]);
            let expected = (m * Vector4::new(v.x, v.y, v.z, 1.0)).xyz();
            let miss = (double(posed.positions()[vertex]) - expected).norm();
            assert!(
                miss <= 1e-6 * size,
                "vertex {vertex}: off by {miss} of {size}"
            );

            let n = double(rest.normals()[vertex]);
            let normal = double(posed.normals()[vertex]);
            if n.norm() == 0.0 {
                assert_eq!(normal, N3::zeros());
                continue;
            }
            let linear: nalgebra::Matrix3<f64> = m.fixed_view::<3, 3>(0, 0).into();
            let expected = (linear.try_inverse().unwrap().transpose() * n).normalize();
            assert!((normal.norm() - 1.0).abs() < 1e-6);
            // A nearly singular blend makes its inverse, and so the normal, inaccurate.
            let condition = linear.norm() * linear.try_inverse().unwrap().norm();
            let miss = (normal - expected).norm();
            assert!(
                miss < 1e-6 * condition,
                "vertex {vertex}: normal off by {miss}"
            );
        }
    }
}

/// The documented recursion T_i = T_parent T̂_i R_x(θ₃) R_z(θ₂) R_x(θ₁) T̂_i⁻¹, written out.
#[test]
fn skin_follows_a_posed_chain() {
    let mut random = Random::new(11);
    let count = 6;
    let mut bones: Vec<Bone> = Vec::new();
    let rests: Vec<_> = (0..count)
        .map(|_| random_placement(&mut random, 1.0))
        .collect();
    for (index, rest) in rests.iter().enumerate() {
        let chain = Skeleton::new("chain", bones.clone()).unwrap();
        bones.push(Bone {
            name: format!("bone/{index}"),
            parent: index.checked_sub(1).and_then(|i| chain.bone_at(i)),
            length: 0.4,
            model_from_rest: placement_of(rest),
            limits: [Limits::UNBOUNDED; 3],
        });
    }
    let skeleton = Skeleton::new("chain", bones).unwrap();
    let q: Vec<f64> = (0..3 * count)
        .map(|_| 3.0 * random.within(-1.0, 1.0))
        .collect();

    let turn = |axis: N3<f64>, angle: f64| Rotation3::new(axis * angle).to_homogeneous();
    let mut transforms: Vec<Matrix4<f64>> = Vec::new();
    for (index, rest) in rests.iter().enumerate() {
        let parent = match index {
            0 => Matrix4::identity(),
            _ => transforms[index - 1],
        };
        let turned = turn(N3::x(), q[3 * index + 2])
            * turn(N3::z(), q[3 * index + 1])
            * turn(N3::x(), q[3 * index]);
        transforms.push(parent * rest * turned * rest.try_inverse().unwrap());
    }

    let weights = weights(&mut random, 200, count, 4);
    let rest = mesh(&mut random, 200, 1.0);
    let single: Vec<Affine3A> = skeleton
        .pose(&q)
        .unwrap()
        .skinning_transforms(&skeleton)
        .map(|t| single_precision_transform(&t))
        .collect();
    let posed = LinearBlend::new(&weights, &single).unwrap().mesh(&rest);
    for (vertex, posed) in posed.unwrap().positions().iter().enumerate() {
        let v = double(rest.positions()[vertex]).push(1.0);
        let expected = (blended(&transforms, &weights, vertex) * v).xyz();
        let reach = expected.amax().max(1.0);
        assert!((double(*posed) - expected).norm() <= 1e-6 * reach);
    }
}

#[test]
fn at_rest_nothing_moves() {
    let mut random = Random::new(21);
    let weights = weights(&mut random, 50, 5, 5);
    let rest = mesh(&mut random, 50, 1.0);
    let still = [Affine3A::IDENTITY; 5];
    let blend = LinearBlend::new(&weights, &still).unwrap();
    let posed = blend.mesh(&rest).unwrap();
    for (a, b) in posed.positions().iter().zip(rest.positions()) {
        assert!((*a - *b).length() < 3e-7);
    }
    // Without normals there are none afterwards.
    let bare = TriangleMesh::new(rest.positions().to_vec(), Vec::new(), Vec::new()).unwrap();
    assert!(blend.mesh(&bare).unwrap().normals().is_empty());
}

#[test]
fn reflection_flips_normals_correctly() {
    // diag(1, 1, −1) has the inverse transpose diag(1, 1, −1): (0, 0, 1) becomes (0, 0, −1).
    let mirror = [Affine3A::from_scale(Vec3::new(1.0, 1.0, -1.0))];
    let mut builder = SkinWeights::builder(1, 1);
    builder.add(0, 0, 1.0).unwrap();
    let weights = builder.build().unwrap();
    let mut posed = [Vec3::ONE];
    let blend = LinearBlend::new(&weights, &mirror).unwrap();
    blend.normals(&[Vec3::Z], &mut posed).unwrap();
    assert_eq!(posed, [Vec3::NEG_Z]);
    // Flattened to the xy plane, its normal remains and others become parallel to it.
    let flat = [Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.0))];
    let blend = LinearBlend::new(&weights, &flat).unwrap();
    blend
        .normals(&[Vec3::new(3.0, 0.0, 4.0)], &mut posed)
        .unwrap();
    assert_eq!(posed, [Vec3::Z]);
    blend.normals(&[Vec3::X], &mut posed).unwrap();
    assert_eq!(posed, [Vec3::ZERO]);
}

#[test]
fn size_errors_name_the_buffer() {
    let mut random = Random::new(31);
    let weights = weights(&mut random, 9, 3, 2);
    let three = [Affine3A::IDENTITY; 3];
    let few = LinearBlend::new(&weights, &three[..2]).unwrap_err();
    assert_eq!(few.to_string(), "2 bone transforms given, expected 3");
    let blend = LinearBlend::new(&weights, &three).unwrap();
    let (nine, eight) = ([Vec3::ONE; 9], [Vec3::ONE; 8]);
    let refused = |result: Result<(), SkinningError>, what: &str| {
        let error = result.unwrap_err().to_string();
        assert_eq!(error, format!("8 {what} given, expected 9"));
    };
    refused(blend.positions(&eight, &mut nine.clone()), "rest positions");
    refused(
        blend.positions(&nine, &mut eight.clone()),
        "posed positions",
    );
    refused(blend.normals(&eight, &mut nine.clone()), "rest normals");
    refused(blend.normals(&nine, &mut eight.clone()), "posed normals");
    let small = TriangleMesh::new(eight.to_vec(), Vec::new(), Vec::new()).unwrap();
    refused(blend.mesh(&small).map(|_| ()), "rest positions");
}
