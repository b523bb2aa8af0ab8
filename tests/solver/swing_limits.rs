//! Promise: a swing outside its cone, round or elliptic, is projected to the closest swing.

use kinopt::model::{BallLimits, Limits, Model};
use kinopt::problem::Evaluation;
use kinopt::solver::{LeastSquares, Termination};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{Orientation, Point, Posture};
use kinopt::{Problem, Solver};
use support::random::Random;

#[test]
fn swing_projects_to_the_closest_ellipse_point() {
    let mut random = Random::new(8);
    for half in [[0.5, 0.5], [1.2, 0.4], [0.02, 1.5], [0.7, 0.9]] {
        let limits = BallLimits::elliptic([1.0, 0.0, 0.0], half, Limits::new(-1.0, 1.0));
        let mut builder = Model::builder("joint");
        let axis = Vector3::UNITS[2];
        let ball = builder.ball("ball", None, Placement::identity(), axis, Some(limits));
        builder.frame("tip", Some(ball), Placement::identity());
        let model = builder.build().unwrap();
        let mut tasks = Problem::builder(&model);
        tasks.add(Posture::new(&model, &model.neutral()));
        let problem = tasks.build().unwrap();
        let mut scratch = problem.scratch();
        let evaluation = Evaluation::new(&problem, &mut scratch);
        let space = evaluation.space();
        let share = |[u, v]: [f64; 2]| (u / half[0]).hypot(v / half[1]);
        for case in 0..200 {
            let from = [(); 2].map(|()| random.within(-3.0, 3.0));
            let mut x = [from[0], from[1], 0.3];
            space.project(&mut x);
            let put = [x[0], x[1]];
            let message = || format!("{half:?}, case {case}: {from:?} to {put:?}");
            assert_eq!(x[2], 0.3);
            if share(from) < 1.0 {
                assert_eq!(put, from, "{}", message());
                continue;
            }
            assert!((share(put) - 1.0).abs() < 1e-12, "{}", message());
            // The displacement is along the edge's inward normal.
            let displacement = [from[0] - put[0], from[1] - put[1]];
            let normal = [put[0] / (half[0] * half[0]), put[1] / (half[1] * half[1])];
            let lengths = displacement[0].hypot(displacement[1]) * normal[0].hypot(normal[1]);
            let aside = (displacement[0] * normal[1] - displacement[1] * normal[0]) / lengths;
            assert!(aside.abs() < 1e-9, "{}: {aside:e}", message());
            assert!(
                displacement[0] * normal[0] + displacement[1] * normal[1] > 0.0,
                "{}",
                message()
            );
        }
    }
}

/// A miss with the swing on its edge and a prismatic joint on a limit is stationary: gradients into active limits do
/// not count.
#[test]
fn miss_on_edge_and_limits_is_stationary() {
    let [x, _, z] = Vector3::UNITS;
    for side in [-1.0, 1.0] {
        let mut builder = Model::builder("arm");
        let cone = BallLimits::cone(0.5, Limits::UNBOUNDED);
        let hip = builder.ball("hip", None, Placement::identity(), z, Some(cone));
        let at = Placement::translation(z);
        let slide = builder.prismatic("slide", Some(hip), at, x, Limits::new(-0.2, 0.2));
        let tip = builder.frame("tip", Some(slide), at);
        let model = builder.build().unwrap();
        let mut tasks = Problem::builder(&model);
        tasks.add(Point::new(tip, [5.0 * side, 0.3, 0.1]));
        let problem = tasks.build().unwrap();
        let start = [1.0, 0.0, 0.0, 0.0, 0.01];
        let solution = Solver::default().solve_once(&problem, &start).unwrap();
        assert_eq!(solution.termination, Termination::Stationary);
        assert!(
            !solution.reached && solution.active_limits().count() >= 2,
            "{}",
            solution.explain()
        );
        let left = solution.projected_gradient.unwrap();
        assert!(left < 1e-6, "{left} {}", solution.explain());
    }
}

/// A ball joint with an unlimited swing is limited by either end of its twist.
#[test]
fn each_end_of_a_twist_is_enforced() {
    use std::f64::consts::PI;
    for (twist, beyond, end) in [
        (Limits::new(-0.5, PI), -1.2, -0.5),
        (Limits::new(-PI, 0.5), 1.2, 0.5),
    ] {
        let mut builder = Model::builder("joint");
        let axis = Vector3::UNITS[2];
        let cone = BallLimits::cone(PI, twist);
        let ball = builder.ball("ball", None, Placement::identity(), axis, Some(cone));
        let tip = builder.frame("tip", Some(ball), Placement::identity());
        let model = builder.build().unwrap();
        let mut tasks = Problem::builder(&model);
        tasks.add(Orientation::new(
            tip,
            Matrix3::rotation(axis, f64::sin_cos(beyond)),
        ));
        let problem = tasks.build().unwrap();
        let solution = Solver::default()
            .solve_once(&problem, &model.neutral())
            .unwrap();
        let twisted = 2.0 * f64::atan2(solution.q[3], solution.q[0]);
        let within = (twisted + PI).rem_euclid(2.0 * PI) - PI;
        assert!(
            !solution.reached && (within - end).abs() < 1e-6,
            "{within} {:?}",
            solution.q
        );
        assert!(
            twist.lower - 1e-9 <= within && within <= twist.upper + 1e-9,
            "{within}"
        );
    }
}
