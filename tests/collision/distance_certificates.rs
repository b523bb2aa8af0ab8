//! Promise: distances are certified by their parts. The two points are on the shapes at that distance, and the planes
//! through them normal to the direction separate the shapes. A penetration depth is the smallest over all directions.

use kinopt::collision::separation;
use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;
use support::convex_shapes::{Solid, gap_along};
use support::random::Random;

/// Random pairs near each other, some at one position, with aligned axes, or in contact.
fn pairs(seed: u64, count: usize) -> impl Iterator<Item = [(Solid, Placement<f64>); 2]> {
    let mut random = Random::new(seed);
    (0..count).map(move |i| {
        let solids = [Solid::random(&mut random), Solid::random(&mut random)];
        let random_pose = |size: f64, random: &mut Random| {
            Placement::new(
                na::Matrix3::from(random.rotation()).into(),
                random.vector(size).into(),
            )
        };
        let first = random_pose(1.0, &mut random);
        let second = match i % 8 {
            0 => first,
            1 => first * Placement::translation(Vector3::new(0.3, 0.0, 0.0)),
            2 => first * Placement::translation(Vector3::new(0.0, 0.0, 1.2)),
            3 => Placement::translation(first.translation),
            _ => random_pose(1.5, &mut random),
        };
        let [a, b] = solids;
        [(a, first), (b, second)]
    })
}

/// Shapes that are moved into contact are no deeper than along that motion.
#[test]
fn contact_is_no_deeper_than_its_motion() {
    for (i, [(a, at_a), (b, at_b)]) in pairs(2, 3000).enumerate() {
        let before = separation(&a.shape(), &at_a, &b.shape(), &at_b);
        if before.distance < 0.0 {
            continue;
        }
        for depth in [0.0, 1e-13, 1e-9, 1e-6, 1e-4] {
            let offset = before.normal * -(before.distance + depth);
            let at_b = Placement::new(at_b.rotation, at_b.translation + offset);
            let found = separation(&a.shape(), &at_a, &b.shape(), &at_b);
            let smallest = gap_along((&a, &at_a), (&b, &at_b), before.normal.into());
            let what =
                || format!("pair {i}: {a:?} at {at_a:?}, {b:?} at {at_b:?}: {found:?}, {smallest}");
            assert!(found.distance >= smallest - 1e-12, "{}", what());
            // Along its own normal the found distance is exact.
            let certified = gap_along((&a, &at_a), (&b, &at_b), found.normal.into());
            assert!((found.distance - certified).abs() < 1e-12, "{}", what());
        }
    }
}

#[test]
fn distances_and_depths_are_certified() {
    let mut random = Random::new(7);
    for (i, [(a, at_a), (b, at_b)]) in pairs(1, 4000).enumerate() {
        let found = separation(&a.shape(), &at_a, &b.shape(), &at_b);
        let what = || format!("pair {i}: {a:?} at {at_a:?}, {b:?} at {at_b:?}: {found:?}");
        let normal = na::Vector3::from(found.normal);
        assert!((normal.norm() - 1.0).abs() < 1e-12, "{}", what());
        let along = gap_along((&a, &at_a), (&b, &at_b), normal);
        assert!(
            (along - found.distance).abs() < 1e-12,
            "{along} along; {}",
            what()
        );
        let offset = found.on_second - found.on_first - found.normal * found.distance;
        assert!(
            offset.norm() < 1e-12,
            "points off by {}; {}",
            offset.norm(),
            what()
        );
        for (solid, at, point) in [(&a, &at_a, found.on_first), (&b, &at_b, found.on_second)] {
            let deviation = solid.shape().signed_distance(at.inverse().apply(point));
            assert!(
                deviation.abs() < 1e-9,
                "a point {deviation} off its shape; {}",
                what()
            );
        }
        if found.distance < 0.0 {
            for _ in 0..60 {
                let any = random.direction().into_inner();
                let near = (normal + 1e-3 * any).normalize();
                for u in [any, near] {
                    let other = gap_along((&a, &at_a), (&b, &at_b), u);
                    assert!(
                        other < found.distance + 1e-12,
                        "{other} along {u}; {}",
                        what()
                    );
                }
            }
        }
    }
}
