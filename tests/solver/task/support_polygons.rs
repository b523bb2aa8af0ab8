//! Promise: a support polygon does not depend on the order of its points, also if many are on one line. Points, margin
//! and vertical may be set in any order.

use kinopt::Problem;
use kinopt::problem::Evaluation;
use kinopt::solver::LeastSquares;
use kinopt::task::SupportPolygon;
use support::bodies::sledge;
use support::random::Random;

#[test]
fn square_does_not_depend_on_point_order() {
    let (model, _, masses) = sledge();
    // Corners, midpoints of the sides and the centre.
    let mut points: Vec<[f64; 3]> = (0..9)
        .map(|k| [f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0, 0.0])
        .collect();
    let mut random = Random::new(31);
    for _ in 0..40 {
        for k in (1..points.len()).rev() {
            points.swap(k, random.below(k + 1));
        }
        let mut tasks = Problem::builder(&model);
        tasks.add(SupportPolygon::new(&masses).with_points(points.clone()));
        let problem = tasks.build().unwrap();
        let mut scratch = problem.scratch();
        for _ in 0..20 {
            let q = [(); 2].map(|()| random.within(-2.0, 2.0));
            let mut residual = [f64::NAN; 2];
            Evaluation::new(&problem, &mut scratch).residual(&q, &mut residual);
            let [beyond_x, beyond_y] = q.map(|q| q - q.clamp(-1.0, 1.0));
            let deviation = residual[0].hypot(residual[1]) - beyond_x.hypot(beyond_y);
            assert!(deviation.abs() < 1e-12, "{q:?}: {residual:?} by {points:?}");
        }
    }
}

/// Feet on a line support a centre of mass on the line between them, and nothing beyond.
#[test]
fn two_points_support_the_line_between_them() {
    let (model, _, masses) = sledge();
    let mut tasks = Problem::builder(&model);
    let ends = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    tasks.add(SupportPolygon::new(&masses).with_points(ends));
    let problem = tasks.build().unwrap();
    let mut scratch = problem.scratch();
    for (q, expected) in [
        ([0.3, 0.0], 0.0),
        ([1.5, 0.0], 0.5),
        ([-1.25, 0.0], 0.25),
        ([0.3, 0.4], 0.4),
    ] {
        let mut residual = [f64::NAN; 2];
        Evaluation::new(&problem, &mut scratch).residual(&q, &mut residual);
        let deviation = residual[0].hypot(residual[1]) - expected;
        assert!(deviation.abs() < 1e-12, "{q:?}: {residual:?}");
    }
}

#[test]
fn polygon_does_not_depend_on_setter_order() {
    let (_, _, masses) = sledge();
    let points = [[0.0; 3], [1.0, 0.0, 0.3], [1.0, 0.2, 1.0], [0.0, 0.1, 1.0]];
    let (up, margin) = ([0.1, 1.0, 0.2], 0.07);
    let new = || SupportPolygon::new(&masses);
    let first = new().with_up(up).with_margin(margin).with_points(points);
    assert_ne!(first, new().with_margin(margin).with_points(points));
    assert_ne!(first, new().with_up(up).with_points(points));
    for other in [
        new().with_points(points).with_up(up).with_margin(margin),
        new().with_points(points).with_margin(margin).with_up(up),
        new().with_margin(margin).with_points(points).with_up(up),
        new().with_up(up).with_points(points).with_margin(margin),
        (points.into_iter()).fold(new().with_margin(margin).with_up(up), |polygon, point| {
            polygon.with_points([point])
        }),
    ] {
        assert_eq!(other, first);
    }
}
