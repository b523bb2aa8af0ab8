//! Promise: a two-bone triangle has the bones' lengths and reports by how much its target is too far or too near. The
//! requested number of agreeing attempts ends a search.

use kinopt::Problem;
use kinopt::geometric::{Ccd, Fabrik, Geometric, Span, triangle};
use kinopt::ik::Restarts;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use support::planar_arm;
use support::random::Random;

#[test]
fn triangle_matches_plane_geometry() {
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
        let reported = match found.span {
            Span::TooFar(by) => (0, by),
            Span::TooNear(by) => (1, by),
            Span::Within => (2, 0.0),
        };
        seen[reported.0] += 1;
        assert!(
            (reported.1 - expected).abs() < 1e-12,
            "{reported:?} {expected}"
        );
        let (first, second) = (found.mid - root, found.tip - found.mid);
        assert!((first.norm() - upper).abs() < 1e-9 && (second.norm() - lower).abs() < 1e-9);
        let angle = |a: Vector3<f64>, b: Vector3<f64>| a.cross(b).norm().atan2(a.dot(b));
        assert!((angle(target - root, first) - found.swing).abs() < 1e-7);
        assert!((angle(first, second) - found.turn).abs() < 1e-7);
        // The bend is towards the pole, in its plane.
        let along = (target - root) * distance.recip();
        let aside = towards - along * along.dot(towards);
        let out = first - along * along.dot(first);
        assert!(out.dot(aside) > -1e-9 && out.cross(aside).norm() < 1e-7);
    }
    assert!(seen.iter().all(|count| *count > 10), "{seen:?}");
}

#[test]
fn agreeing_attempts_are_counted_from_the_first() {
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

/// A frame with its own target reaches it, whatever frames beyond it require.
#[test]
fn pinned_frame_inside_a_chain_stays() {
    let mut builder = Model::builder("four links");
    let (z, limits) = (Vector3::new(0.0, 0.0, 1.0), Limits::new(-2.5, 2.5));
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    let mut joint = builder.revolute("0", None, Placement::identity(), z, limits);
    let mut frames = Vec::new();
    for name in ["1", "2", "3"] {
        joint = builder.revolute(name, Some(joint), link, z, limits);
        frames.push(builder.frame(format!("at {name}"), Some(joint), Placement::identity()));
    }
    let tip = builder.frame("tip", Some(joint), link);
    let model = builder.build().unwrap();
    let goal = [0.4, 0.7, -0.5, 0.9];
    let places = ForwardKinematics::new(&model)
        .place(&goal)
        .unwrap()
        .to_vec();
    let mut builder = Problem::builder(&model);
    for frame in [frames[1], tip] {
        builder.add(Point::new(frame, places[frame.index()].translation));
    }
    let problem = builder.build().unwrap();
    let fabrik = Fabrik::default().with_restarts(Restarts::none());
    let solution = fabrik.solve(&problem, &[0.3, 0.3, -0.3, 0.3]).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    assert!(solution.iterations < 40, "{}", solution.iterations);
}

/// The bend direction has no size: it is equal in any unit of length.
#[test]
fn bend_direction_is_scale_invariant() {
    for unit in [1e-14, 1.0, 1e14] {
        for towards in [1e-3, 1.0, 1e3] {
            let target = Vector3::new(unit, 0.0, 0.0);
            let side = Vector3::new(0.3, -0.6, 0.8) * (towards * unit);
            let found = triangle(Vector3::zero(), [unit, unit], target, side);
            // An equilateral triangle in the plane of the bend direction.
            let height = 0.75_f64.sqrt();
            let expected = Vector3::new(0.5, -0.6 * height, 0.8 * height) * unit;
            assert!(
                (found.mid - expected).norm() < 1e-12 * unit,
                "{unit} {towards}"
            );
        }
    }
}
