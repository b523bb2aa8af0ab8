//! Promise: a mesh's measures equal those of its solid, and an invalid mesh is rejected.

use glam::Vec3;
use kinopt::mesh::{MeshError, TriangleMesh};
use support::box_sides::box_triangles;

/// A box from `low` to `low + edges`, counter-clockwise from outside.
fn cuboid(low: Vec3, edges: Vec3) -> TriangleMesh {
    let corner =
        |i: u32| low + edges * Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
    TriangleMesh::new((0..8).map(corner).collect(), vec![], box_triangles()).unwrap()
}

#[test]
fn box_is_closed_with_its_volume_and_size() {
    let mesh = cuboid(Vec3::new(100.0, -50.0, 7.0), Vec3::new(1.0, 2.0, 2.0));
    assert!((mesh.signed_volume() - 4.0).abs() < 1e-12);
    assert!((mesh.size() - 3.0).abs() < 1e-12);
    assert!(mesh.is_closed());
    let [low, high] = mesh.bounding_box().unwrap();
    assert_eq!(
        (low, high),
        (Vec3::new(100.0, -50.0, 7.0), Vec3::new(101.0, -48.0, 9.0))
    );

    let mut inside_out = mesh.triangles().to_vec();
    inside_out.iter_mut().for_each(|t| t.reverse());
    let positions = mesh.positions().to_vec();
    let inside_out = TriangleMesh::new(positions.clone(), vec![], inside_out).unwrap();
    assert!((inside_out.signed_volume() + 4.0).abs() < 1e-12);
    assert!(inside_out.is_closed());

    let open =
        TriangleMesh::new(positions.clone(), vec![], mesh.triangles()[1..].to_vec()).unwrap();
    assert!(!open.is_closed());
    let mut one_flipped = mesh.triangles().to_vec();
    one_flipped[3].reverse();
    assert!(
        !TriangleMesh::new(positions, vec![], one_flipped)
            .unwrap()
            .is_closed()
    );
    assert!(!TriangleMesh::default().is_closed());
}

#[test]
fn vertex_normals_are_weighted_by_area() {
    // A large floor and a small wall share an edge, whose normals are weighted by area.
    let positions = vec![
        Vec3::ZERO,
        Vec3::new(0.0, 1.0, 0.0),
        Vec3::new(-3.0, 0.0, 0.0),
        Vec3::new(0.0, 0.0, 1.0),
    ];
    let mesh = TriangleMesh::new(positions, vec![], vec![[0, 1, 2], [0, 1, 3]]).unwrap();
    let normals = mesh.vertex_normals();
    // Twice the areas are 3 (along +z) and 1 (along +x).
    let expected = Vec3::new(1.0, 0.0, 3.0) / 10.0_f32.sqrt();
    assert!((normals[0] - expected).length() < 1e-6, "{}", normals[0]);
    assert_eq!(normals[2], Vec3::Z);
    assert_eq!(normals[3], Vec3::X);
    assert_eq!(mesh.clone().with_computed_normals().normals(), normals);
}

#[test]
fn vertex_normals_are_never_nan() {
    let huge = f32::MAX;
    let positions = vec![
        Vec3::ZERO,
        Vec3::X,
        Vec3::X * 2.0,
        Vec3::new(9.0, 9.0, 9.0), // used by nothing
        Vec3::new(huge, 0.0, 0.0),
        Vec3::new(0.0, huge, 0.0),
        Vec3::new(0.0, 0.0, -huge),
        Vec3::new(1e-40, 0.0, 0.0),
        Vec3::new(0.0, 1e-40, 0.0),
    ];
    let triangles = vec![[0, 1, 2], [1, 1, 1], [4, 5, 6], [7, 8, 0]];
    let normals = TriangleMesh::new(positions, vec![], triangles)
        .unwrap()
        .vertex_normals();
    assert_eq!(normals[1], Vec3::ZERO);
    assert_eq!(normals[3], Vec3::ZERO);
    for vertex in [4, 5, 6, 7, 8] {
        assert!(
            (normals[vertex].length() - 1.0).abs() < 1e-6,
            "{vertex}: {}",
            normals[vertex]
        );
    }
}

#[test]
fn invalid_parts_are_rejected_by_name() {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let invalid = |p: Vec<Vec3>, n, t| TriangleMesh::new(p, n, t).unwrap_err();
    assert_eq!(
        invalid(positions.clone(), vec![], vec![[0, 1, 2], [0, 3, 1]]),
        MeshError::IndexOutOfRange {
            triangle: 1,
            index: 3,
            vertices: 3
        }
    );
    let few = invalid(positions.clone(), vec![Vec3::X], vec![]).to_string();
    assert_eq!(few, "1 normals given, expected 3");
    // The first of several is named.
    let nan = Vec3::new(0.0, f32::NAN, 0.0);
    let nans = vec![Vec3::X, nan, nan];
    assert_eq!(
        invalid(positions.clone(), nans.clone(), vec![]),
        MeshError::NonFiniteNormal { vertex: 1 }
    );
    assert_eq!(
        invalid(nans, vec![], vec![]),
        MeshError::NonFinitePosition { vertex: 1 }
    );
    let mesh = TriangleMesh::new(positions, vec![], vec![[0, 1, 2]]).unwrap();
    let few = mesh.with_vertices(vec![Vec3::ZERO], vec![]).unwrap_err();
    assert_eq!(few.to_string(), "1 positions given, expected 3");
}
