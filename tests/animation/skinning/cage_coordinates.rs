//! Promise: mean value coordinates reproduce points and linear functions, inside, outside, and on vertices, edges and
//! faces. They are continuous across the surface.

use glam::{Affine3A, Mat3A, Quat, Vec3};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{CageBinding, SkinningError};
use support::random::Random;
use support::skins::vector;

fn cube() -> TriangleMesh {
    let corners = (0..8).map(|k| {
        let side = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
        Vec3::new(side(1), side(2), side(4))
    });
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    TriangleMesh::new(corners.collect(), vec![], triangles.collect()).unwrap()
}

/// The cube with its upper face pushed in: not convex.
fn pit() -> TriangleMesh {
    let mut positions = cube().positions().to_vec();
    positions.push(Vec3::new(0.1, -0.2, -0.4));
    let mut triangles: Vec<[u32; 3]> = cube().triangles()[..10].to_vec();
    for [a, b] in [[4, 5], [5, 7], [7, 6], [6, 4]] {
        triangles.push([a, b, 8]);
    }
    TriangleMesh::new(positions, vec![], triangles).unwrap()
}

/// Points inside and outside, and on every kind of surface feature.
fn points(cage: &TriangleMesh, random: &mut Random) -> Vec<Vec3> {
    let mut points: Vec<Vec3> = (0..400).map(|_| vector(random) * 1.4).collect();
    points.extend(cage.positions());
    for &triangle in cage.triangles() {
        let [a, b, c] = triangle.map(|corner| cage.positions()[corner as usize]);
        let onto = [0.5 * (a + b), 0.25 * a + 0.75 * c, (a + b + c) / 3.0];
        points.extend(onto);
        points.push(0.7 * a + 0.2 * b + 0.1 * c);
        // Just off the face, and in its plane outside it.
        points.push((a + b + c) / 3.0 + 1e-6 * (b - a).cross(c - a));
        points.push(a + 1.7 * (b - a) + 0.3 * (c - a));
    }
    points
}

#[test]
fn points_and_linear_functions_are_reproduced() {
    let mut random = Random::new(1);
    for cage in [cube(), pit()] {
        let points = points(&cage, &mut random);
        let binding = CageBinding::new(&cage, &points).unwrap();
        assert_eq!(binding.point_count(), points.len());
        let value = |p: Vec3| f64::from(2.0 * p.x - 0.5 * p.y + 3.0 * p.z + 0.25);
        for (k, point) in points.iter().enumerate() {
            let row = binding.coordinates(k).unwrap();
            let shares = || row.iter().map(|&share| f64::from(share));
            let sum: f64 = shares().sum();
            assert!(
                (sum - 1.0).abs() < 1e-6,
                "{point}: coordinates sum to {sum}"
            );
            let pairs = shares().zip(cage.positions());
            let actual: f64 = pairs.map(|(share, corner)| share * value(*corner)).sum();
            assert!((actual - value(*point)).abs() < 4e-6, "{point}: {actual}");
        }
        let mut posed = vec![Vec3::ZERO; points.len()];
        binding.positions(cage.positions(), &mut posed).unwrap();
        for (posed, rest) in posed.iter().zip(&points) {
            assert!((*posed - *rest).length() < 4e-6);
        }
        // And therefore every affine map of the cage.
        let motion = Affine3A {
            matrix3: Mat3A::from_quat(Quat::from_rotation_y(0.7))
                * Mat3A::from_diagonal(Vec3::new(2.0, 0.5, 1.0)),
            translation: Vec3::new(3.0, -1.0, 0.5).into(),
        };
        let moved: Vec<Vec3> = cage
            .positions()
            .iter()
            .map(|c| motion.transform_point3(*c))
            .collect();
        binding.positions(&moved, &mut posed).unwrap();
        for (posed, rest) in posed.iter().zip(&points) {
            assert!((*posed - motion.transform_point3(*rest)).length() < 1e-5);
        }
    }
}

/// In any unit of length.
#[test]
fn coordinates_are_unit_invariant() {
    let (cage, points) = (pit(), points(&pit(), &mut Random::new(3)));
    let binding = CageBinding::new(&cage, &points).unwrap();
    // Powers of two, so that positions are exact.
    for unit in [1e-9_f32, 1e9].map(|unit| unit.log2().round().exp2()) {
        let scaled = |places: &[Vec3]| places.iter().map(|position| *position * unit).collect();
        let scaled_cage: Vec<Vec3> = scaled(cage.positions());
        let scaled_cage =
            TriangleMesh::new(scaled_cage, vec![], cage.triangles().to_vec()).unwrap();
        let points: Vec<Vec3> = scaled(&points);
        let scaled = CageBinding::new(&scaled_cage, &points).unwrap();
        for point in 0..points.len() {
            let [a, b] = [&binding, &scaled].map(|binding| binding.coordinates(point).unwrap());
            let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            assert!(
                apart.fold(0.0, f32::max) < 1e-6,
                "point {point}, unit {unit}"
            );
        }
    }
}

#[test]
fn coordinates_in_a_convex_cage_are_nonnegative() {
    let mut random = Random::new(2);
    let points: Vec<Vec3> = (0..500).map(|_| vector(&mut random)).collect();
    let binding = CageBinding::new(&cube(), &points).unwrap();
    for (k, point) in points.iter().enumerate() {
        let row = binding.coordinates(k).unwrap();
        assert!(row.iter().all(|share| *share >= 0.0), "{point}");
    }
}

#[test]
fn surface_points_use_only_their_own_vertices() {
    let cage = cube();
    // Vertex 6, the middle of edge 0-1, and a point of the face x = −1, triangle (0, 4, 6).
    let points = [
        cage.positions()[6],
        Vec3::new(0.0, -1.0, -1.0),
        Vec3::new(-1.0, -0.5, 0.5),
    ];
    let binding = CageBinding::new(&cage, &points).unwrap();
    let support = |point: usize| -> Vec<(usize, f32)> {
        let row = binding
            .coordinates(point)
            .unwrap()
            .iter()
            .copied()
            .enumerate();
        row.filter(|(_, share)| share.abs() > 1e-7).collect()
    };
    assert_eq!(support(0), [(6, 1.0)]);
    assert_eq!(support(1), [(0, 0.5), (1, 0.5)]);
    // (−1, −½, ½) = ¼ c₀ + ½ c₄ + ¼ c₆.
    let on_face = support(2);
    assert_eq!(
        on_face
            .iter()
            .map(|(corner, _)| *corner)
            .collect::<Vec<_>>(),
        [0, 4, 6]
    );
    for ((_, share), expected) in on_face.iter().zip([0.25, 0.5, 0.25]) {
        assert!((share - expected).abs() < 1e-6);
    }
}

#[test]
fn coordinates_are_continuous_at_the_surface() {
    let cage = pit();
    for &triangle in cage.triangles() {
        let [a, b, c] = triangle.map(|corner| cage.positions()[corner as usize]);
        let normal = (b - a).cross(c - a).normalize();
        for on in [(a + b + c) / 3.0, 0.5 * (a + b), a] {
            let near = [on, on + 3e-5 * normal, on - 3e-5 * normal];
            let binding = CageBinding::new(&cage, &near).unwrap();
            for side in [1, 2] {
                let pairs = binding
                    .coordinates(0)
                    .unwrap()
                    .iter()
                    .zip(binding.coordinates(side).unwrap());
                let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(apart < 1e-3, "{on}: {apart}");
            }
        }
    }
}

#[test]
fn invalid_cages_and_points_are_rejected() {
    let cage = cube();
    let open = TriangleMesh::new(
        cage.positions().to_vec(),
        vec![],
        cage.triangles()[1..].to_vec(),
    );
    assert_eq!(
        CageBinding::new(&open.unwrap(), &[]).unwrap_err(),
        SkinningError::NotClosed
    );
    let flat = TriangleMesh::new(
        vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        vec![],
        vec![[0, 1, 2], [0, 2, 1]],
    );
    assert!(CageBinding::new(&flat.unwrap(), &[Vec3::ONE]).is_err());
    let mut squashed = cage.positions().to_vec();
    squashed[1] = squashed[0];
    let squashed = TriangleMesh::new(squashed, vec![], cage.triangles().to_vec()).unwrap();
    assert!(matches!(
        CageBinding::new(&squashed, &[]).unwrap_err(),
        SkinningError::FlatTriangle { .. }
    ));
    assert_eq!(
        CageBinding::new(&cage, &[Vec3::ZERO, Vec3::NAN]).unwrap_err(),
        SkinningError::NonFinitePoint { point: 1 }
    );
    let binding = CageBinding::new(&cage, &[Vec3::ZERO]).unwrap();
    assert_eq!(binding.coordinates(1), None);
    let few = binding
        .positions(&[Vec3::ZERO; 7], &mut [Vec3::ZERO])
        .unwrap_err();
    assert_eq!(few.to_string(), "7 cage corners given, expected 8");
    assert!(binding.positions(cage.positions(), &mut []).is_err());
}
