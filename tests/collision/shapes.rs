//! Promise: a shape is checked when it is made, and what is wrong is named.

use kinopt::collision::{Shape, ShapeError};
use kinopt::spatial::Vector3;

#[test]
fn lengths_are_positive_and_finite() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
        let told = Shape::sphere(bad).unwrap_err().to_string();
        assert!(told.contains("radius of the sphere"), "{told}");
        assert!(Shape::capsule(1.0, bad).is_err() && Shape::capsule(bad, 1.0).is_err());
        assert!(Shape::cylinder(1.0, bad).is_err() && Shape::cylinder(bad, 1.0).is_err());
        assert!(Shape::cuboid([1.0, bad, 1.0]).is_err());
        assert!(Shape::points(vec![Vector3::zero()], bad).is_err());
        assert!(Shape::height_field(vec![0.0; 4], 2, [1.0, bad]).is_err());
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
