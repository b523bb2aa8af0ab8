//! Promise: options of methods have their documented effect. More damping shortens the first step. The rank tolerance
//! decides whether similar columns count as one.

use kinopt::ik::Restarts;
use kinopt::model::{Limits, Model};
use kinopt::problem::Problem;
use kinopt::solver::{Damping, GaussNewton, LevenbergMarquardt, Method, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Solution, Solver};
use support::planar_arm;

/// Result of a single iteration.
fn one_step(method: impl Method, problem: &Problem, start: &[f64]) -> Solution {
    let solver = Solver::new(method)
        .with_stopping(Stopping::default().with_max_iterations(1))
        .with_restarts(Restarts::none());
    solver.solve_once(problem, start).unwrap()
}

fn moved(solution: &Solution, start: &[f64]) -> f64 {
    let moves = solution.q.iter().zip(start).map(|(a, b)| (a - b) * (a - b));
    moves.sum::<f64>().sqrt()
}

#[test]
fn initial_damping_shortens_the_first_step() {
    let model = planar_arm(&[1.0, 0.8, 0.5], None);
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [0.9, 1.2, 0.0]));
    let (problem, start) = (builder.build().unwrap(), [0.3, 0.4, 0.5]);
    for damping in [Damping::GainRatio, Damping::ErrorProportional] {
        let lengths = [1e-6, 1e-2, 1.0, 100.0].map(|initial| {
            let method = LevenbergMarquardt::new(damping).with_initial_damping(initial);
            moved(&one_step(method, &problem, &start), &start)
        });
        assert!(
            lengths.is_sorted_by(|longer, shorter| *shorter < 0.99 * longer && *shorter > 0.0),
            "{damping:?}: {lengths:?}"
        );
    }
}

/// Two prismatic joints at an angle of 1e-3 rad. As two columns they reach any point; as one they share the motion
/// along both.
#[test]
fn rank_tolerance_merges_similar_columns() {
    const ANGLE: f64 = 1e-3;
    let mut builder = Model::builder("slides");
    let at = Placement::identity();
    let limits = Limits::new(-5.0, 5.0);
    let ways = [
        Vector3::UNITS[0],
        Vector3::new(ANGLE.cos(), ANGLE.sin(), 0.0),
    ];
    let first = builder.prismatic("first", None, at, ways[0], limits);
    let second = builder.prismatic("second", Some(first), at, ways[1], limits);
    let tip = builder.frame("tip", Some(second), at);
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [0.5, 2e-3, 0.0]));
    let problem = builder.build().unwrap();
    let step = |tolerance: f64| {
        let method = GaussNewton::default().with_rank_tolerance(tolerance);
        one_step(method, &problem, &[0.0; 2])
    };
    let two = step(1e-5);
    assert!(two.reached, "{}", two.explain());
    assert!((two.q[1] - 2.0).abs() < 1e-3 && (two.q[0] + 1.5).abs() < 1e-3);
    let one = step(1e-2);
    assert!(!one.reached);
    assert!(
        (one.q[0] - 0.25).abs() < 1e-3 && (one.q[1] - 0.25).abs() < 1e-3,
        "{:?}",
        one.q
    );
}
