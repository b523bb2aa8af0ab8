//! Promise: the points of a reach are at their times, or spread evenly over the span.

use kinopt::glam::DVec3;
use kinopt_bindings::clip_ik::reach_curve;

#[test]
fn reach_points_without_times_are_spread_evenly() {
    let points = || vec![DVec3::X, DVec3::Y, DVec3::Z];
    let even = reach_curve(points(), None, [1.0, 3.0]).unwrap();
    assert_eq!(even.times(), [1.0, 2.0, 3.0]);
    let given = reach_curve(points(), Some(vec![0.0, 0.5, 4.0]), [1.0, 3.0]).unwrap();
    assert_eq!(given.times(), [0.0, 0.5, 4.0]);
    assert!(reach_curve(points(), Some(vec![0.0, 0.5]), [1.0, 3.0]).is_err());
    assert!(reach_curve(points(), Some(vec![0.0, 0.5, 0.2]), [1.0, 3.0]).is_err());
}
