//! Promise: shapes are validated on construction, and errors name the fault.

use kinopt::collision::{Checker, Shape, ShapeError, World};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::box_sides::box_triangles;
use support::fault_tables::ExpectedError;
use support::random::Random;

#[test]
fn lengths_are_positive_and_finite() {
    for invalid in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
        Shape::sphere(invalid).says("radius of the sphere");
        assert!(Shape::capsule(1.0, invalid).is_err() && Shape::capsule(invalid, 1.0).is_err());
        assert!(Shape::cylinder(1.0, invalid).is_err() && Shape::cylinder(invalid, 1.0).is_err());
        assert!(Shape::cuboid([1.0, invalid, 1.0]).is_err());
        assert!(Shape::ellipsoid([1.0, invalid, 1.0]).is_err());
        assert!(Shape::points(vec![Vector3::zero()], invalid).is_err());
        assert!(Shape::height_field(vec![0.0; 4], 2, [1.0, invalid]).is_err());
    }
}

#[test]
fn points_in_a_plane_have_no_hull() {
    let flat: Vec<_> = (0..20)
        .map(|i| Vector3::new(f64::from(i), f64::from(i * i), 2.0))
        .collect();
    let error = Shape::convex(&flat).unwrap_err();
    assert!(
        matches!(error, ShapeError::Flat { points: 20, .. }),
        "{error}"
    );
}

#[test]
fn ellipsoid_hull_is_tight() {
    let radii = [0.3, 0.05, 1.2];
    let hull = Shape::ellipsoid(radii).unwrap();
    let mut farthest = f64::NEG_INFINITY;
    let mut random = Random::new(3);
    for _ in 0..5000 {
        let [x, y, z] = [(); 3].map(|()| random.within(-1.0, 1.0));
        let length = (x * x + y * y + z * z).sqrt();
        let [x, y, z] = [x, y, z].map(|part| part / length);
        let at = |scale: f64| {
            Vector3::new(
                scale * x * radii[0],
                scale * y * radii[1],
                scale * z * radii[2],
            )
        };
        // A point of the ellipsoid is inside, one 2 % farther out is not.
        let inside = hull.signed_distance(at(1.0));
        assert!(inside <= 1e-12, "{inside}");
        farthest = farthest.max(inside);
        assert!(hull.signed_distance(at(1.02)) > 0.0);
    }
    assert!(farthest > -1e-3, "{farthest}");
}

#[test]
fn mjcf_ellipsoids_collide() {
    let text = r#"<mujoco><worldbody><body name="arm"><joint name="hinge" axis="0 0 1"/>
        <geom type="ellipsoid" size="0.5 0.1 0.1" pos="0.5 0 0"/></body></worldbody></mujoco>"#;
    let robot = Robot::parse_mjcf(text, "arm.xml").unwrap();
    let mut world = World::new();
    world
        .add_sphere("ball", 0.05, Vector3::new(0.9, 0.3, 0.0))
        .unwrap();
    let checker = Checker::of(&robot).unwrap().with_world(&world).unwrap();
    assert!(checker.collisions(&[0.0]).unwrap().is_empty());
    let touching = checker.collisions(&[0.32]).unwrap();
    assert_eq!(touching[0].second, "ball");
}

/// Below its lowest point a height field is solid to the depth of its longer side.
#[test]
fn height_field_depth_is_its_longer_side() {
    for (columns, rows, spacing) in [
        (2, 9, [1.0, 0.5]),
        (9, 2, [0.5, 1.0]),
        (3, 3, [0.25, 2.0]),
        (3, 3, [2.0, 0.25]),
    ] {
        let heights: Vec<f64> = (0..columns * rows)
            .map(|k| 1.0 + f64::from(k % 2))
            .collect();
        let deep = (spacing[0] * f64::from(columns - 1)).max(spacing[1] * f64::from(rows - 1));
        let field = Shape::height_field(heights, columns as usize, spacing).unwrap();
        let at = |share: f64| field.signed_distance(Vector3::new(0.0, 0.0, 1.0 - share * deep));
        assert!(at(0.9) < 0.0, "{columns} × {rows}: {}", at(0.9));
        assert!(
            (at(1.1) - 0.1 * deep).abs() < 1e-12,
            "{columns} × {rows}: {}",
            at(1.1)
        );
    }
}

/// Points of a shape are in its bounding box and sphere, which are nearly tight.
#[test]
fn bounding_box_and_sphere_are_tight() {
    let corner = |k: u32| {
        let side = |bit| if k & bit == 0 { -0.4 } else { 0.2 };
        Vector3::new(0.5 * side(1), side(2), 2.0 * side(4))
    };
    let corners: Vec<_> = (0..8).map(corner).collect();
    let triangles = box_triangles();
    let shapes = [
        Shape::sphere(0.3),
        Shape::capsule(0.1, 0.7),
        Shape::cylinder(0.4, 0.2),
        Shape::cylinder(0.1, 0.9),
        Shape::cuboid([0.2, 0.5, 0.9]),
        Shape::convex(&corners),
        Shape::mesh(corners.clone(), triangles),
        Shape::height_field(vec![0.1, 0.3, 0.2, 0.5, -0.1, 0.4], 3, [0.8, 0.6]),
        Shape::points(corners[..5].to_vec(), 0.15),
    ];
    let mut random = Random::new(5);
    for shape in shapes {
        let shape = shape.unwrap();
        let (bounds, ball) = (shape.bounding_box(), shape.bounding_sphere());
        let middle = (bounds.min + bounds.max) * 0.5;
        let half = (bounds.max - bounds.min).to_array();
        let (mut farthest, mut reach) = (0.0_f64, [0.0_f64; 3]);
        for _ in 0..3000 {
            let offset = half.map(|half| half * random.within(-0.8, 0.8));
            let at = middle + Vector3::from(offset);
            if shape.signed_distance(at) > 0.0 {
                continue;
            }
            for k in 0..3 {
                assert!(offset[k].abs() <= 0.5 * half[k] + 1e-9, "{shape:?} {at:?}");
                reach[k] = reach[k].max(offset[k].abs() / (0.5 * half[k]));
            }
            let away = (at - ball.centre).norm();
            assert!(away <= ball.radius + 1e-9, "{shape:?} {at:?}: {away}");
            farthest = farthest.max(away);
        }
        // A rotated bounding box contains all its corners and is tight on six sides.
        for _ in 0..20 {
            let [turn, by] = [3.0, 1.0].map(|size| {
                let v = random.vector(size);
                Vector3::new(v.x, v.y, v.z)
            });
            let world_from_shape = Placement::new(rotation_exp(turn), by);
            let placed = bounds.placed(&world_from_shape);
            let mut reached = [[f64::INFINITY; 3]; 2];
            for k in 0..8 {
                let pick = |bit: u32, ends: [f64; 2]| ends[usize::from(k & bit != 0)];
                let corner = Vector3::new(
                    pick(1, [bounds.min.x, bounds.max.x]),
                    pick(2, [bounds.min.y, bounds.max.y]),
                    pick(4, [bounds.min.z, bounds.max.z]),
                );
                let at = world_from_shape.apply(corner);
                let [low, high] = [at - placed.min, placed.max - at].map(Vector3::to_array);
                for axis in 0..3 {
                    reached[0][axis] = reached[0][axis].min(low[axis]);
                    reached[1][axis] = reached[1][axis].min(high[axis]);
                }
            }
            let differences = reached.as_flattened().iter();
            assert!(
                differences
                    .into_iter()
                    .all(|difference| difference.abs() < 1e-12),
                "{reached:?}"
            );
        }
        assert!(
            reach.iter().all(|reach| *reach > 0.85),
            "{shape:?} {reach:?}"
        );
        assert!(farthest > 0.7 * ball.radius, "{shape:?}: {farthest}");
    }
}

/// The number of triangles at a vertex does not decide which side of it a point is on.
#[test]
fn vertex_of_many_triangles_has_the_right_side() {
    let corners = [
        [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    let [a, b, c, d] = corners.map(Vector3::from);
    for parts in [1_u32, 12] {
        // The side from b to c is split, and with it the two faces at it: from a, and from d.
        let cut = (0..=parts).map(|k| b + (c - b) * (f64::from(k) / f64::from(parts)));
        let vertices: Vec<Vector3<f64>> = [a, d].into_iter().chain(cut).collect();
        let (first, last) = (2, 2 + parts);
        let mut triangles = vec![[0, 1, first], [0, last, 1]];
        for k in first..last {
            triangles.extend([[0, k, k + 1], [1, k + 1, k]]);
        }
        let mesh = Shape::mesh(vertices, triangles).unwrap();
        for (corner, others) in [(a, [b, c, d]), (d, [a, b, c])] {
            let [p, q, r] = others;
            // Outward normals of the three faces at the corner; points in their cone are nearest to it.
            let normals = [[p, q, r], [q, r, p], [r, p, q]].map(|[x, y, z]| {
                let normal = (x - corner).cross(y - corner);
                let out = normal * -(z - corner).dot(normal).signum();
                out * (1.0 / out.norm())
            });
            for k in 0..3 {
                let direction = normals[k] + (normals[(k + 1) % 3] + normals[(k + 2) % 3]) * 0.1;
                let distance = 0.01 / direction.norm();
                let reported = mesh.signed_distance(corner + direction * distance);
                assert!((reported - 0.01).abs() < 1e-12, "{parts} {k}: {reported}");
                assert!(mesh.signed_distance(corner - corner * 0.01) < 0.0);
            }
        }
    }
}

/// A box whose triangles have separate vertices, displaced by up to half the merge tolerance, is closed and has the
/// box's distances. With larger displacements it is open.
#[test]
fn vertices_within_rounding_close_a_mesh() {
    let half = [0.3, 0.5, 0.2];
    let corner = |k: u32| {
        [0, 1, 2].map(|axis| half[axis] * f64::from(u8::from(k >> axis & 1 == 1) * 2) - half[axis])
    };
    let size = 2.0 * (half[0] * half[0] + half[1] * half[1] + half[2] * half[2]).sqrt();
    let mut random = Random::new(8);
    for _ in 0..20 {
        for (share, closed) in [(0.45e-6, true), (0.01, false)] {
            let mut vertices = Vec::new();
            for &k in box_triangles().as_flattened() {
                let [x, y, z] = corner(k);
                let offset = random.direction().into_inner() * (share * size);
                vertices.push(Vector3::new(x + offset.x, y + offset.y, z + offset.z));
            }
            let triangles = (0..12).map(|k| [0, 1, 2].map(|at| 3 * k + at)).collect();
            let mesh = Shape::mesh(vertices, triangles).unwrap();
            let inside = mesh.signed_distance(Vector3::new(0.05, 0.1, 0.0));
            let expected = if closed { -half[2] } else { half[2] };
            assert!(
                (inside - expected).abs() < 2.0 * share * size,
                "{inside} {closed}"
            );
        }
    }
}

/// The enclosed volume decides which side is outside, also for cubes of 1 mm at kilometres from the origin.
#[test]
fn small_mesh_far_from_the_origin_has_an_inside() {
    let mut random = Random::new(9);
    for _ in 0..20 {
        let middle = Vector3::from(random.vector(10_000.0));
        let corner = |k: u32| {
            let along = |axis: u32| (f64::from(k >> axis & 1) - 0.5) * 1e-3;
            middle + Vector3::new(along(0), along(1), along(2))
        };
        let mesh = Shape::mesh((0..8).map(corner).collect(), box_triangles()).unwrap();
        let inside = mesh.signed_distance(middle);
        assert!((inside + 0.5e-3).abs() < 1e-9, "{middle:?}: {inside}");
    }
}
