//! Promise: distances are independent of the world's origin, the unit of length and the order of shapes. Normals are
//! their derivatives, distance bounds are exact, and equivalent shapes have equal distances.

use kinopt::collision::{Separation, Shape, ShapeKind, separation, separation_within};
use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;
use support::convex_shapes::Solid;
use support::random::Random;

fn placed(random: &mut Random, size: f64) -> Placement<f64> {
    let rotation = na::Matrix3::from(random.rotation());
    Placement::new(rotation.into(), random.vector(size).into())
}

/// Random shape: convex, a closed mesh, a point cloud or a height field.
fn any_shape(random: &mut Random) -> Shape {
    let points = |random: &mut Random| -> Vec<Vector3<f64>> {
        (0..12).map(|_| random.vector(0.5).into()).collect()
    };
    match random.below(8) {
        0 => Shape::points(points(random), 0.05).unwrap(),
        1 => hull_as_mesh(&Shape::convex(&points(random)).unwrap()),
        2 => {
            let heights = (0..20).map(|_| random.within(-0.2, 0.2)).collect();
            Shape::height_field(heights, 4, [0.3, 0.25]).unwrap()
        }
        _ => Solid::random(random).shape(),
    }
}

/// The triangles of a hull as a mesh.
fn hull_as_mesh(hull: &Shape) -> Shape {
    let ShapeKind::Convex(hull) = hull.kind() else {
        panic!("{hull:?}")
    };
    Shape::mesh(hull.vertices().to_vec(), hull.triangles().to_vec()).unwrap()
}

fn close(a: &Separation, b: &Separation, what: &str) {
    assert!(
        (a.distance - b.distance).abs() < 1e-12,
        "{what}: {a:?} {b:?}"
    );
}

#[test]
fn origin_and_order_do_not_matter() {
    let mut random = Random::new(21);
    for _ in 0..600 {
        let shapes = [any_shape(&mut random), any_shape(&mut random)];
        let [a, b] = [placed(&mut random, 0.8), placed(&mut random, 0.8)];
        let found = separation(&shapes[0], &a, &shapes[1], &b);
        let back = separation(&shapes[1], &b, &shapes[0], &a);
        close(&found, &back, "the order");
        let moved = placed(&mut random, 1.0);
        let moved_result = separation(&shapes[0], &(moved * a), &shapes[1], &(moved * b));
        close(&found, &moved_result, "the origin");
    }
}

/// In another unit lengths scale and directions are equal.
#[test]
fn distances_are_unit_invariant() {
    let times = |solid: &Solid, factor: f64| match solid {
        Solid::Sphere(radius) => Solid::Sphere(radius * factor),
        Solid::Capsule(radius, length) => Solid::Capsule(radius * factor, length * factor),
        Solid::Cylinder(radius, length) => Solid::Cylinder(radius * factor, length * factor),
        Solid::Cuboid(size) => Solid::Cuboid(size.map(|side| side * factor)),
        Solid::Convex(points) => Solid::Convex(points.iter().map(|point| point * factor).collect()),
    };
    let mut random = Random::new(27);
    for case in 0..300 {
        let kind = case % 5;
        let solids = [kind, if case % 2 == 0 { 1 } else { kind }];
        let solids = solids.map(|kind| Solid::of_kind(kind, &mut random));
        let mut at = [placed(&mut random, 0.3), placed(&mut random, 0.3)];
        // Crossing axes without a common volume.
        if case % 3 == 0 {
            at[1].translation = at[0].translation;
        }
        let reported = |unit: f64| {
            let [a, b] = [0, 1].map(|k| {
                let at = Placement::new(at[k].rotation, at[k].translation * unit);
                (times(&solids[k], unit).shape(), at)
            });
            let found = separation(&a.0, &a.1, &b.0, &b.1);
            (found.distance / unit, found.normal)
        };
        let (distance, normal) = reported(1.0);
        for unit in [1.0 / 1024.0, 1024.0, 1_048_576.0] {
            let (other, along) = reported(unit);
            assert!(
                (other - distance).abs() < 1e-13,
                "{solids:?}: {other} {distance}"
            );
            assert!(
                (along - normal).norm() < 1e-6,
                "{solids:?}: {along:?} {normal:?}"
            );
        }
    }
}

#[test]
fn normals_are_derivatives() {
    let mut random = Random::new(22);
    let (step, mut checked) = (1e-6, 0);
    for _ in 0..1500 {
        let shapes = [
            Solid::random(&mut random).shape(),
            Solid::random(&mut random).shape(),
        ];
        let [a, b] = [placed(&mut random, 1.0), placed(&mut random, 1.0)];
        let at = |offset: Vector3<f64>| {
            let moved = Placement::new(b.rotation, b.translation + offset);
            separation(&shapes[0], &a, &shapes[1], &moved)
        };
        let found = at(Vector3::zero());
        let along: Vector3<f64> = random.direction().into_inner().into();
        let [ahead, behind] = [at(along * step), at(along * -step)];
        let turned = (ahead.normal - behind.normal).norm();
        // There is no derivative across a kink.
        if turned > 1e-2 {
            continue;
        }
        let slope = (ahead.distance - behind.distance) / (2.0 * step);
        let expected = found.normal.dot(along);
        assert!(
            (slope - expected).abs() < 1e-6 + turned * turned,
            "{slope} {expected} {found:?}"
        );
        checked += 1;
    }
    assert!(checked > 1300, "only {checked} are smooth");
}

#[test]
fn distance_bounds_are_exact() {
    let mut random = Random::new(23);
    for _ in 0..600 {
        let shapes = [any_shape(&mut random), any_shape(&mut random)];
        let [a, b] = [placed(&mut random, 1.0), placed(&mut random, 1.0)];
        let found = separation(&shapes[0], &a, &shapes[1], &b);
        for slack in [-0.1, -1e-9, 1e-9, 0.1] {
            let within = found.distance + slack;
            match separation_within(&shapes[0], &a, &shapes[1], &b, within) {
                Some(near) => {
                    assert!(slack > 0.0, "{found:?} within {within}: {near:?}");
                    close(&near, &found, "the bound");
                }
                None => assert!(slack < 0.0, "{found:?} is not within {within}"),
            }
        }
    }
}

#[test]
fn sphere_distance_is_that_of_its_centre() {
    let mut random = Random::new(24);
    for _ in 0..1500 {
        let shape = any_shape(&mut random);
        let radius = random.within(0.01, 0.3);
        let position = random.vector(0.8).into();
        let at = Placement::translation(position);
        let ball = Shape::sphere(radius).unwrap();
        let found = separation(&shape, &Placement::identity(), &ball, &at).distance;
        let expected = shape.signed_distance(position) - radius;
        // A sphere that cuts a surface is as deep as that triangle alone, which may be less than the distance of its
        // centre.
        let surface = matches!(shape.kind(), ShapeKind::Mesh(_) | ShapeKind::HeightField(_));
        let exact = !surface || expected > 0.0 || expected < -2.0 * radius;
        match exact {
            true => assert!(
                (found - expected).abs() < 1e-12,
                "{found} {expected} {shape:?}"
            ),
            false => assert!(
                found >= expected - 1e-12 && found < 0.0,
                "{found} {expected}"
            ),
        }
    }
}

#[test]
fn mesh_equals_hull_and_cloud_equals_points() {
    let mut random = Random::new(25);
    for _ in 0..400 {
        let points: Vec<Vector3<f64>> = (0..30).map(|_| random.vector(0.5).into()).collect();
        let hull = Shape::convex(&points).unwrap();
        let mesh = hull_as_mesh(&hull);
        let other = Solid::random(&mut random).shape();
        let [a, b] = [placed(&mut random, 1.2), placed(&mut random, 1.2)];
        let [one, two] = [&hull, &mesh].map(|shape| separation(shape, &a, &other, &b));
        if one.distance > 0.0 {
            close(&one, &two, "hull and mesh");
        } else {
            assert!(two.distance <= 1e-12 && two.distance >= one.distance - 1e-12);
        }
        for point in (0..5).map(|_| Vector3::from(random.vector(0.6))) {
            let deviation = hull.signed_distance(point) - mesh.signed_distance(point);
            assert!(deviation.abs() < 1e-12, "{deviation}");
        }
        let cloud = Shape::points(points.clone(), 0.02).unwrap();
        let cloud_distance = separation(&cloud, &a, &other, &b).distance;
        let in_other = b.inverse() * a;
        let each = points
            .iter()
            .map(|&p| other.signed_distance(in_other.apply(p)));
        let nearest = each.fold(f64::INFINITY, f64::min) - 0.02;
        assert!(
            (cloud_distance - nearest).abs() < 1e-12,
            "{cloud_distance} {nearest}"
        );
    }
}

#[test]
fn plane_distance_is_that_of_the_lowest_point() {
    let mut random = Random::new(26);
    for _ in 0..300 {
        let solid = Solid::random(&mut random);
        let [a, b] = [placed(&mut random, 1.0), placed(&mut random, 1.0)];
        let floor = Shape::half_space();
        let found = separation(&floor, &a, &solid.shape(), &b);
        let up = na::Vector3::from(a.rotation.z);
        let lowest = -solid.reach_at(&b, -up) - a.translation.dot(a.rotation.z);
        assert!(
            (found.distance - lowest).abs() < 1e-12,
            "{found:?} {lowest}"
        );
        close(
            &found,
            &separation(&solid.shape(), &b, &floor, &a),
            "the order",
        );
        // A large flat height field gives the same result.
        let level = Shape::height_field(vec![0.0; 4], 2, [100.0, 100.0]).unwrap();
        let ground = separation(&level, &a, &solid.shape(), &b).distance;
        if lowest > 0.0 {
            assert!((ground - lowest).abs() < 1e-12, "{ground} {lowest}");
        } else {
            assert!(
                ground < 0.0 && ground >= lowest - 1e-12,
                "{ground} {lowest}"
            );
        }
    }
}

/// A cloud's distance from a floor is that of its lowest point less the radius, for any rotations.
#[test]
fn cloud_above_floor_includes_its_radius() {
    let mut random = Random::new(77);
    for radius in [0.01, 0.2] {
        let points: Vec<Vector3<f64>> = (0..20).map(|_| random.vector(0.5).into()).collect();
        let cloud = Shape::points(points.clone(), radius).unwrap();
        let [world_from_cloud, world_from_floor] =
            [0.3, 2.0].map(|size: f64| placed(&mut random, size));
        let floor_from_cloud = world_from_floor.inverse() * world_from_cloud;
        let heights = points.iter().map(|&point| floor_from_cloud.apply(point).z);
        let expected = heights.fold(f64::INFINITY, f64::min) - radius;
        let floor = Shape::half_space();
        let reported = separation(&floor, &world_from_floor, &cloud, &world_from_cloud);
        assert!(
            (reported.distance - expected).abs() < 1e-12,
            "{reported:?} {expected}"
        );
        let reported = separation(&cloud, &world_from_cloud, &floor, &world_from_floor);
        assert!(
            (reported.distance - expected).abs() < 1e-12,
            "{reported:?} {expected}"
        );
    }
}

/// A centre exactly in the surface gives no direction to leave by.
#[test]
fn sphere_centred_in_a_face_leaves_along_normal() {
    let ball = Shape::sphere(0.05).unwrap();
    let cuboid = Shape::cuboid([0.6, 0.4, 0.8]).unwrap();
    let cylinder = Shape::cylinder(0.3, 0.8).unwrap();
    for (solid, halves) in [(cuboid, [0.3, 0.2, 0.4]), (cylinder, [0.3, 0.3, 0.4])] {
        for (axis, half) in Vector3::UNITS.into_iter().zip(halves) {
            // In the middle of a face and off it; a round side has no second position.
            let aside = (Vector3::new(1.0, 1.0, 1.0) - axis) * 0.05;
            let asides = [Vector3::zero(), aside].into_iter();
            let flat = halves[0] != halves[1] || axis == Vector3::UNITS[2];
            let places = asides.take(1 + usize::from(flat));
            for (out, aside) in places.flat_map(|aside| [(axis, aside), (-axis, aside)]) {
                let at = Placement::translation(out * half + aside);
                let found = separation(&solid, &Placement::identity(), &ball, &at);
                assert!((found.distance + 0.05).abs() < 1e-12, "{solid:?} {out:?}");
                assert!((found.normal - out).norm() < 1e-12, "{solid:?} {found:?}");
            }
        }
    }
}

/// Lengths of a box may differ by a factor of up to 1e12.
#[test]
fn slender_boxes_are_measured_or_rejected() {
    let ball = Shape::sphere(0.1).unwrap();
    for long in [1e3, 1e6, 1e9] {
        for thin in [1e-12 * long, 1e-9 * long, 1e-6 * long] {
            let plate = Shape::cuboid([0.05_f64.max(thin), long, thin]).unwrap();
            for gap in [-0.02, 0.0, 1e-3, 0.5] {
                // Above the plate's middle, and off it.
                for along in [0.0, 0.3 * long] {
                    let at = Vector3::new(0.01, along, 0.5 * thin + 0.1 + gap);
                    let found = separation(&plate, &Placement::identity(), &ball, &at.into());
                    let resolved = 1e-9 + 4.0 * f64::EPSILON * long;
                    let deviation = found.distance - gap;
                    assert!(
                        deviation.abs() < resolved,
                        "{long:e} {thin:e} {gap} {along}: {deviation:e}"
                    );
                }
            }
        }
    }
    let error = Shape::cuboid([0.05, 1e9, 1e-9]).unwrap_err();
    let reported = "the length of the box along y is 1e9 and the length of the box along z 1e-9: more than 1e12 times";
    assert_eq!(error.to_string(), reported);
}
