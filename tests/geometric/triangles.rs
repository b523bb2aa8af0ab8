//! Promise: a triangle of two bones has their lengths, and says by how much its target is too far or too near;
//! as many attempts that agree as are asked for end a search.
#![allow(clippy::unwrap_used)]

use kinopt::Problem;
use kinopt::geometric::{Ccd, Fabrik, Geometric, Span, triangle};
use kinopt::ik::Restarts;
use kinopt::spatial::Vector3;
use kinopt::task::Point;
use support::planar_arm;
use support::random::Random;

#[test]
fn sides_angles_and_what_is_missed_are_those_of_plane_geometry() {
    let mut random = Random::new(3);
    let mut seen = [0; 3];
    for _ in 0..300 {
        let mut vector = || Vector3::from(random.vector(1.0));
        let (root, target, towards) = (vector(), vector(), vector());
        let lengths = [random.within(0.1, 1.5), random.within(0.1, 1.5)];
        let [upper, lower] = lengths;
        let found = triangle(root, lengths, target, towards);
        let distance = (target - root).norm();
        let missed = (target - found.tip).norm();
        let expected = match distance {
            d if d > upper + lower => d - (upper + lower),
            d if d < (upper - lower).abs() => (upper - lower).abs() - d,
            _ => 0.0,
        };
        assert!((missed - expected).abs() < 1e-12);
        let told = match found.span {
            Span::TooFar(by) => (0, by),
            Span::TooNear(by) => (1, by),
            Span::Within => (2, 0.0),
        };
        seen[told.0] += 1;
        assert!((told.1 - expected).abs() < 1e-12, "{told:?} {expected}");
        let (first, second) = (found.mid - root, found.tip - found.mid);
        assert!((first.norm() - upper).abs() < 1e-9 && (second.norm() - lower).abs() < 1e-9);
        let angle = |a: Vector3<f64>, b: Vector3<f64>| a.cross(b).norm().atan2(a.dot(b));
        assert!((angle(target - root, first) - found.swing).abs() < 1e-7);
        assert!((angle(first, second) - found.turn).abs() < 1e-7);
        // Out towards the pole, in its plane.
        let along = (target - root) * distance.recip();
        let aside = towards - along * along.dot(towards);
        let out = first - along * along.dot(first);
        assert!(out.dot(aside) > -1e-9 && out.cross(aside).norm() < 1e-7);
    }
    assert!(seen.iter().all(|count| *count > 10), "{seen:?}");
}

#[test]
fn attempts_that_agree_are_counted_from_the_first() {
    let model = planar_arm(&[0.5, 0.4], None);
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [2.0, 0.3, 0.0]));
    let problem = builder.build().unwrap();
    for agreeing in 1..5 {
        let restarts = Restarts::default().with_agreeing(agreeing);
        let (ccd, fabrik) = (Ccd::default(), Fabrik::default());
        let ccd = ccd.with_restarts(restarts).solve(&problem, &[0.3, 0.2]);
        let fabrik = fabrik.with_restarts(restarts).solve(&problem, &[0.3, 0.2]);
        assert_eq!([ccd, fabrik].map(|s| s.unwrap().attempts), [agreeing; 2]);
    }
}
