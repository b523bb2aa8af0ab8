//! Promise: in a scaled world all distances scale by the factor, for all kinds of obstacles.

use kinopt::collision::{Shape, World, WorldError, separation};
use kinopt::spatial::{Placement, Vector3};
use support::fault_tables::ExpectedError;

const SCALES: [f64; 3] = [0.7, 1.0, 3.25];

fn at(x: f64, y: f64) -> Placement<f64> {
    let turn = kinopt::spatial::rotation_exp(Vector3::new(0.3 * x, 0.2, -0.4 * y));
    Placement::new(turn, Vector3::new(x, y, 0.5))
}

/// One obstacle of each kind, at least 3 m apart.
fn one_of_each() -> World {
    let corners =
        |x: f64| [[0.0; 3], [x, 0.0, 0.0], [0.0, x, 0.0], [0.0, 0.0, x]].map(Vector3::from);
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let heights = (0..12).map(|k| 0.1 * f64::from(k % 5)).collect();
    let mut world = World::new();
    let floor = Placement::translation(Vector3::new(0.0, 0.0, -9.0));
    world.add("floor", Shape::half_space(), floor).unwrap();
    let shapes = [
        Shape::sphere(0.4),
        Shape::capsule(0.2, 0.7),
        Shape::cylinder(0.3, 0.5),
        Shape::cuboid([0.3, 0.5, 0.8]),
        Shape::convex(&corners(0.6)),
        Shape::mesh(corners(0.9).to_vec(), faces),
        Shape::height_field(heights, 4, [0.2, 0.3]),
        Shape::points(corners(0.5).to_vec(), 0.05),
    ];
    for (k, shape) in shapes.into_iter().enumerate() {
        let placement = at(3.0 * (k % 3) as f64, 3.0 * (k / 3) as f64);
        world
            .add(&format!("{k}"), shape.unwrap(), placement)
            .unwrap();
    }
    world
}

#[test]
fn distances_scale_with_the_world() {
    let world = one_of_each();
    for times in SCALES {
        let scaled = world.scaled(times).unwrap();
        let pairs: Vec<_> = world.obstacles().zip(scaled.obstacles()).collect();
        for (k, (a, scaled_a)) in pairs.iter().enumerate() {
            for (b, scaled_b) in &pairs[k + 1..] {
                let before = separation(&a.shape, &a.placement, &b.shape, &b.placement);
                let after = separation(
                    &scaled_a.shape,
                    &scaled_a.placement,
                    &scaled_b.shape,
                    &scaled_b.placement,
                );
                let deviation = after.distance - times * before.distance;
                assert!(
                    before.distance > 0.1 && deviation.abs() < 1e-9,
                    "{} {}: {deviation:e}",
                    a.name,
                    b.name
                );
            }
        }
    }
}

#[test]
fn attachment_is_kept_and_bad_scales_rejected() {
    let mut world = World::new();
    world
        .add_box("board", [0.1, 0.2, 0.3], at(0.0, 0.0))
        .unwrap();
    world.attach("board", "hand", at(0.2, 0.0)).unwrap();
    let scaled = world.scaled(2.0).unwrap();
    let board = scaled.obstacle("board").unwrap();
    assert_eq!(board.attached.as_deref(), Some("hand"));
    let offset = board.placement.translation - at(0.2, 0.0).translation * 2.0;
    assert!(offset.norm() < 1e-15);
    for invalid in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        world.scaled(invalid).says("times | positive");
    }
    let error = world.scaled(1e-320).unwrap_err();
    assert!(matches!(error, WorldError::Shape { .. }), "{error}");
}
