//! Promise: the ground height of a world at a position is the first intersection of a vertical line from above.

use kinopt::collision::{Shape, World};
use kinopt::spatial::{Matrix3, Placement, Vector3};

const HEIGHT_TOLERANCE: f64 = 1e-7;

#[test]
fn heights_of_steps_sphere_and_slope_are_exact() {
    let mut world = World::new();
    let at = |x: f64, y: f64, z: f64| Placement::translation(Vector3::new(x, y, z));
    // Up is y: steps of 0.2 along x, each 0.5 long.
    for step in 0..4 {
        let (name, x) = (format!("step {step}"), 0.25 + 0.5 * f64::from(step));
        let height = 0.2 * f64::from(step + 1);
        let shape = Shape::cuboid([0.5, height, 2.0]).unwrap();
        world.add(&name, shape, at(x, 0.5 * height, 0.0)).unwrap();
    }
    world
        .add("ball", Shape::sphere(0.3).unwrap(), at(-2.0, 1.0, 0.0))
        .unwrap();
    let up = Vector3::UNITS[1];
    let top = |x: f64, z: f64| world.height_at(Vector3::new(x, -7.0, z), up);
    for (x, height) in [
        (0.1, 0.2),
        (0.4999, 0.2),
        (0.5001, 0.4),
        (1.2, 0.6),
        (1.99, 0.8),
    ] {
        assert!(
            (top(x, 0.3).unwrap() - height).abs() < HEIGHT_TOLERANCE,
            "{x}"
        );
    }
    assert_eq!(top(2.1, 0.0), None);
    assert_eq!(top(0.25, 1.5), None);
    // x² + z² + (y − 1)² = 0.3².
    let ball = 1.0 + (0.09_f64 - 0.01 - 0.04).sqrt();
    assert!((top(-2.1, 0.2).unwrap() - ball).abs() < HEIGHT_TOLERANCE);
    // A slope of one third, with z′ along (−1, 3, 0).
    let length = 10_f64.sqrt();
    let normal = Vector3::new(-1.0 / length, 3.0 / length, 0.0);
    let along = Vector3::new(3.0 / length, 1.0 / length, 0.0);
    let turned = Matrix3::from_columns(along, normal.cross(along), normal);
    let slope = Placement::new(turned, Vector3::new(0.0, -0.5, 0.0));
    world.add("slope", Shape::half_space(), slope).unwrap();
    let top = |x: f64| world.height_at(Vector3::new(x, 0.0, 0.0), up).unwrap();
    assert!((top(30.0) - 9.5).abs() < 1e-6 && (top(0.1) - 0.2).abs() < HEIGHT_TOLERANCE);
    assert!((top(-30.0) + 10.5).abs() < 1e-6);
    assert_eq!(World::new().height_at(Vector3::zero(), up), None);
}

/// Attached objects are no ground, at any placement in their files; detached ones are.
#[test]
fn attached_objects_are_no_ground() {
    let mut world = World::new();
    let up = Vector3::UNITS[2];
    world
        .add_box("floor", [4.0, 4.0, 0.2], Vector3::new(0.0, 0.0, -0.1))
        .unwrap();
    let placement = Placement::translation(Vector3::new(0.5, 0.0, 0.7));
    world
        .add("crate", Shape::cuboid([0.4; 3]).unwrap(), placement)
        .unwrap();
    let off_the_ground = Vector3::new(-1.0, 0.0, 5.0);
    let over = Vector3::new(0.5, 0.1, 5.0);
    let top = |world: &World, at| world.height_at(at, up).unwrap();
    assert!((top(&world, over) - 0.9).abs() < HEIGHT_TOLERANCE);
    world.attach("crate", "hand", placement).unwrap();
    for at in [over, off_the_ground] {
        assert!(top(&world, at).abs() < HEIGHT_TOLERANCE, "{at:?}");
    }
    world.detach("crate", placement).unwrap();
    assert!((top(&world, over) - 0.9).abs() < HEIGHT_TOLERANCE);
    // Also if it is the only obstacle.
    let mut held = World::new();
    held.add("crate", Shape::cuboid([0.4; 3]).unwrap(), placement)
        .unwrap();
    held.attach("crate", "hand", placement).unwrap();
    assert_eq!(held.height_at(over, up), None);
}

/// Nearly six times as high as it is far.
#[test]
fn height_of_a_steep_slope_is_exact() {
    let (sin, cos) = 80_f64.to_radians().sin_cos();
    let (x, normal) = (Vector3::new(cos, 0.0, sin), Vector3::new(-sin, 0.0, cos));
    let slope = Matrix3::from_columns(x, normal.cross(x), normal);
    let mut world = World::new();
    let placement = Placement::new(slope, Vector3::zero());
    world.add("slope", Shape::half_space(), placement).unwrap();
    for at in [0.5, 3.0] {
        let top = world.height_at(Vector3::new(at, 0.2, 0.0), Vector3::UNITS[2]);
        assert!(
            (top.unwrap() - at * sin / cos).abs() < 1e-6 * at,
            "{at}: {top:?}"
        );
    }
}
