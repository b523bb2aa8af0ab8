//! Promise: invalid shapes and damaged files give an error that names the fault, or a note; never a panic.

use kinopt::collision::{Shape, ShapeNote, World, separation};
use kinopt::spatial::{Placement, Vector3};
use support::fault_tables::ExpectedError;
use support::random::{Random, few};

const WORLD: &str = r#"{"boxes": [{"name": "a", "size": [1, 2, 3], "position": [0.5, -1e-3, 2]}],
 "cylinders": [{"name": "b", "radius": 0.5, "length": 1, "quaternion": [0.6, 0.8, 0, 0]}],
 "meshes": [{"name": "c", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "triangles": [[0,2,1],[0,1,3],[1,2,3],[0,3,2]]}],
 "height_fields": [{"name": "d", "heights": [0,1,2,3], "columns": 2, "spacing": [1, 1]}],
 "points": [{"name": "e", "radius": 0.1, "positions": [[0,0,0],[1,1,1]], "attached": "hand"}], "order": ["e","a","b","c","d"]}"#;

const SCENE: &str = "world:
  collision_objects:
    - id: Can1
      primitive_poses: [{position: [0.5, 0.25, -0.375], orientation: [0, 0, 0.6, 0.8]}]
      primitives:
        - {type: cylinder, dimensions: [0.14, 0.03]}
    - id: \"x y\"
      primitive_poses:
      - position: {x: 1, y: 2, z: 3}
      primitives: [{type: box, dimensions: [1, 2, 3]}]
";

/// Text with some bytes removed, doubled or replaced.
fn damaged(text: &str, random: &mut Random) -> Vec<u8> {
    const PIECES: [&str; 16] = [
        "[", "]", "{", "}", "\"", ":", "-", "1e999", "NaN", "null", "&a", "*a", "\n", "\t",
        "\u{fe}", ",",
    ];
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        let end = (at + random.below(12)).min(bytes.len());
        match random.below(4) {
            0 => drop(bytes.drain(at..end)),
            1 => {
                let again = bytes[at..end].to_vec();
                bytes.splice(at..at, again);
            }
            2 => {
                let piece = PIECES[random.below(PIECES.len())];
                bytes.splice(at..end, piece.bytes());
            }
            _ => bytes[at] = random.below(256) as u8,
        }
        if bytes.is_empty() {
            bytes.push(b' ');
        }
    }
    bytes
}

#[test]
fn damaged_worlds_are_rejected_or_read() {
    World::from_json(WORLD.as_bytes(), "whole").unwrap();
    World::from_moveit(SCENE.as_bytes(), "whole").unwrap();
    let mut random = Random::new(3);
    let mut refused = 0;
    for _ in 0..4000 {
        let json = World::from_json(&damaged(WORLD, &mut random), "damaged");
        let scene = World::from_moveit(&damaged(SCENE, &mut random), "damaged");
        for error in [json.err(), scene.err()].into_iter().flatten() {
            assert!(error.to_string().starts_with("damaged: "), "{error}");
            refused += 1;
        }
    }
    assert!(refused > 3000, "only {refused} of 8000 were damaged");
}

#[test]
fn deep_nesting_is_rejected() {
    for open in ["[", "{\"a\":", "- ", "a:\n "] {
        let deep = open.repeat(100_000);
        assert!(World::from_json(deep.as_bytes(), "deep").is_err());
        assert!(World::from_moveit(deep.as_bytes(), "deep").is_err());
    }
}

#[test]
fn mesh_defects_are_noted() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::from);
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let inside = Vector3::new(0.1, 0.1, 0.1);
    let whole = Shape::mesh(corners.to_vec(), faces.to_vec()).unwrap();
    assert!(whole.notes().is_empty());
    assert!((whole.signed_distance(inside) + 0.1).abs() < 1e-15);

    let open = Shape::mesh(corners.to_vec(), faces[..3].to_vec()).unwrap();
    assert_eq!(open.notes(), [ShapeNote::Open { edges: 3 }]);
    assert!(open.signed_distance(inside) > 0.0);

    let turned = faces.map(|[a, b, c]| [a, c, b]).to_vec();
    let turned = Shape::mesh(corners.to_vec(), turned).unwrap();
    assert_eq!(turned.notes(), [ShapeNote::InsideOut]);
    assert!((turned.signed_distance(inside) + 0.1).abs() < 1e-15);

    let mut mixed = faces.to_vec();
    mixed[0].swap(0, 1);
    let mixed = Shape::mesh(corners.to_vec(), mixed).unwrap();
    assert_eq!(mixed.notes(), [ShapeNote::Winding { edges: 3 }]);

    // Separate vertices for every triangle, and two degenerate triangles.
    let loose: Vec<_> = faces
        .iter()
        .flatten()
        .map(|&i| corners[i as usize])
        .collect();
    let mut triangles: Vec<[u32; 3]> = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    triangles.extend([[0, 0, 1], [2, 1, 2]]);
    let loose = Shape::mesh(loose, triangles).unwrap();
    assert_eq!(loose.notes(), [ShapeNote::WithoutArea { triangles: 2 }]);
    assert!((loose.signed_distance(inside) + 0.1).abs() < 1e-15);
}

/// Vertices within rounding are merged if that closes the mesh, and only then: a closed mesh stays exactly as it is.
#[test]
fn mesh_open_by_rounding_is_closed_with_a_note() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::from);
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let inside = Vector3::new(0.1, 0.1, 0.1);
    // Separate vertices for every triangle, each displaced by up to `by`.
    let shaken = |size: f64, by: f64, keep: usize| {
        let mut random = Random::new(7);
        let mut offset = || {
            let offset = random.vector(1.0);
            Vector3::new(offset.x, offset.y, offset.z) * by
        };
        let indices = faces[..keep].iter().flatten();
        let loose: Vec<_> = indices
            .map(|&i| corners[i as usize] * size + offset())
            .collect();
        let triangles = (0..keep as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect();
        Shape::mesh(loose, triangles).unwrap()
    };
    for size in [1e-3, 1.0, 1e3] {
        let closed = shaken(size, 1e-9 * size, 4);
        assert!(
            matches!(closed.notes(), [ShapeNote::Closed { vertices: 8, .. }]),
            "{:?}",
            closed.notes()
        );
        let depth = closed.signed_distance(inside * size);
        assert!((depth + 0.1 * size).abs() < 1e-8 * size, "{depth}");
        // With larger displacements, or a missing triangle, the mesh stays open.
        let open = shaken(size, 1e-3 * size, 4);
        assert_eq!(open.notes(), [ShapeNote::Open { edges: 12 }]);
        let missing = shaken(size, 1e-9 * size, 3);
        assert_eq!(missing.notes(), [ShapeNote::Open { edges: 9 }]);
    }
    let mut world = kinopt::collision::World::new();
    let shape = shaken(1.0, 1e-9, 4);
    world.add("part", shape, Vector3::zero()).unwrap();
    let notes = world.notes();
    assert!(
        notes.len() == 1 && notes[0].contains("part") && notes[0].contains("closes"),
        "{notes:?}"
    );
    assert!(world.scaled(2.0).unwrap().notes().is_empty());
}

/// Squares of such coordinates overflow and would give NaN.
#[test]
fn placements_beyond_1e9_are_rejected() {
    let mut world = World::new();
    for coordinate in [1e300, -2e9, 1.1e9] {
        world
            .add_sphere("moon", 0.1, Vector3::new(coordinate, 0.0, 0.0))
            .says("moon | 1e9");
    }
    world
        .add_sphere("moon", 0.1, Vector3::new(1e9, 0.0, 0.0))
        .unwrap();
    assert!(
        world
            .move_to("moon", Vector3::new(0.0, 1e300, 0.0))
            .is_err()
    );
    assert!(
        world
            .attach("moon", "hand", Vector3::new(0.0, 1e300, 0.0))
            .is_err()
    );
    let text = r#"{"boxes": [{"name": "far", "size": [1, 1, 1], "position": [1e300, 0, 0]}]}"#;
    World::from_json(text.as_bytes(), "w.json").says("boxes[0] | far");
}

#[test]
fn invalid_coordinates_are_named() {
    let nan = Vector3::new(0.0, f64::NAN, 0.0);
    let far_point = Vector3::new(0.0, 1e300, 0.0);
    for invalid in [nan, far_point] {
        let points = vec![Vector3::zero(), invalid, Vector3::zero(), Vector3::zero()];
        for reported in [
            Shape::convex(&points).unwrap_err(),
            Shape::mesh(points.clone(), vec![[0, 1, 2]]).unwrap_err(),
            Shape::points(points.clone(), 0.1).unwrap_err(),
        ] {
            assert!(
                reported.to_string().contains(" 1 has a coordinate"),
                "{reported}"
            );
        }
    }
    assert!(Shape::height_field(vec![0.0, 1.0, f64::INFINITY, 0.0], 2, [1.0, 1.0]).is_err());
    assert!(Shape::height_field(vec![0.0; 5], 2, [1.0, 1.0]).is_err());
    assert!(Shape::height_field(vec![0.0; 4], 0, [1.0, 1.0]).is_err());
    assert!(Shape::mesh(vec![Vector3::zero(); 9], vec![[0, 1, 2], [3, 4, 5]]).is_err());
    assert!(Shape::points(Vec::new(), 0.1).is_err());
}

#[test]
fn million_triangles_are_accepted() {
    // A tenth of them in a debug build.
    let n = if few() { 224_u32 } else { 708 };
    let vertex = |i: u32, j: u32| {
        let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
        let (a, b) = (u * std::f64::consts::TAU, v * std::f64::consts::TAU);
        let r = 1.0 + 0.3 * b.cos();
        Vector3::new(r * a.cos(), r * a.sin(), 0.3 * b.sin())
    };
    let vertices: Vec<_> = (0..n * n).map(|k| vertex(k / n, k % n)).collect();
    let index = |i: u32, j: u32| i % n * n + j % n;
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [
            index(i, j),
            index(i + 1, j),
            index(i + 1, j + 1),
            index(i, j + 1),
        ];
        [[a, b, c], [a, c, d]]
    });
    let torus = Shape::mesh(vertices, triangles.collect()).unwrap();
    assert!(torus.notes().is_empty(), "{:?}", torus.notes());
    let distance = |x: f64, z: f64| torus.signed_distance(Vector3::new(x, 0.0, z));
    assert!((distance(1.0, 0.0) + 0.3).abs() < 1e-3);
    assert!((distance(0.0, 0.0) - 0.7).abs() < 1e-3);
    let ball = Shape::sphere(0.1).unwrap();
    let at = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
    let deep = separation(&torus, &Placement::identity(), &ball, &at).distance;
    assert!((deep + 0.4).abs() < 1e-3, "{deep}");
}
