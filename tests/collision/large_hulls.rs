//! Promise: distances and depths of hulls with hundreds of vertices equal the result over all vertices. This includes
//! faces that are flat to rounding, and needles.

use kinopt::collision::{separation, separation_within};
use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;
use support::convex_shapes::{Solid, gap_along};
use support::random::Random;

/// Points on an ellipsoid; on a box with sides that bulge by less than rounding; on two rings that nearly meet.
fn hull(kind: usize, random: &mut Random) -> Solid {
    let bulge = [1e-3, 1e-9, 1e-13, 1e-15][random.below(4)];
    let thin = [1.0, 1e-2, 1e-4][random.below(3)];
    let point = |random: &mut Random| {
        let direction = random.direction().into_inner();
        match kind {
            0 => direction.component_mul(&na::Vector3::new(0.5, 0.5 * thin, 0.3)),
            1 => {
                let largest = direction.amax();
                let on_box = direction / largest;
                on_box * 0.4 * (1.0 + bulge * (3.0 - on_box.norm_squared()))
            }
            _ => {
                let ring = na::Vector3::new(direction.x, direction.y, 0.0).normalize();
                let side = if direction.z > 0.0 { 1.0 } else { -1.0 };
                ring * 0.5 + na::Vector3::z() * (side * thin * 0.2)
            }
        }
    };
    Solid::Convex((0..300).map(|_| point(random)).collect())
}

#[test]
fn hull_distance_equals_that_of_all_vertices() {
    let mut random = Random::new(11);
    for i in 0..240 {
        let [a, b] = [i % 3, i / 3 % 4].map(|kind| match kind {
            3 => Solid::random(&mut random),
            kind => hull(kind, &mut random),
        });
        let mut random_pose = |size: f64| {
            let turn = na::Matrix3::from(random.rotation());
            Placement::new(turn.into(), random.vector(size).into())
        };
        let at_a = random_pose(1.0);
        let at_b = match i % 5 {
            0 => at_a,
            // Face against face.
            1 => at_a * Placement::translation(Vector3::new(0.9, 0.0, 0.0)),
            2 => at_a * Placement::translation(Vector3::new(0.0, 0.0, 0.8)),
            _ => random_pose(1.4),
        };
        let (shape_a, shape_b) = (a.shape(), b.shape());
        let found = separation(&shape_a, &at_a, &shape_b, &at_b);
        let along = |u: na::Vector3<f64>| gap_along((&a, &at_a), (&b, &at_b), u);
        let normal = na::Vector3::from(found.normal);
        let actual = along(normal);
        assert!(
            (actual - found.distance).abs() < 1e-12,
            "pair {i}: {actual} along its normal, {found:?}"
        );
        let offset = found.on_second - found.on_first - found.normal * found.distance;
        assert!(offset.norm() < 1e-12, "pair {i}: {offset:?}");
        for (shape, at, point) in [
            (&shape_a, &at_a, found.on_first),
            (&shape_b, &at_b, found.on_second),
        ] {
            let deviation = shape.signed_distance(at.inverse().apply(point));
            assert!(
                deviation.abs() < 1e-9,
                "pair {i}: a point {deviation} off its shape"
            );
        }
        // No other direction separates farther.
        for step in 0..60 {
            let size = [1.0, 1e-3, 1e-6][step % 3];
            let other = (normal + size * random.direction().into_inner()).normalize();
            assert!(along(other) < found.distance + 1e-12, "pair {i}");
        }
        // A bound just above the distance finds it, one just below does not.
        for (by, is_found) in [(1e-12, true), (-1e-12, false), (0.1, true), (-0.1, false)] {
            let within = found.distance + by;
            let near = separation_within(&shape_a, &at_a, &shape_b, &at_b, within);
            assert_eq!(near.is_some(), is_found, "pair {i}: {found:?}, {by}");
        }
    }
}
