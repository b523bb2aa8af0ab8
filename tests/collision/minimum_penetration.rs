//! Promise: if required tasks are reachable only in contact, the penetration is the smallest that they allow on the
//! branch.

use kinopt::collision::{Checker, CollisionModel, CollisionObject, Shape, World};
use kinopt::ik::Restarts;
use kinopt::model::{FrameId, Limits, Model};
use kinopt::problem::Preferences;
use kinopt::solver::Termination;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Plane, Posture, Task};
use kinopt::{Problem, Solver};

/// Sphere on two prismatic joints, and a larger one with its centre at `aside`.
fn balls(aside: f64) -> (Model, FrameId, Checker) {
    let mut builder = Model::builder("slides");
    let [x, y, _] = Vector3::UNITS;
    let (origin, rock_pose) = (Placement::identity(), Placement::translation(x * aside));
    let first = builder.prismatic("x", None, origin, x, Limits::new(-1.0, 1.0));
    let second = builder.prismatic("y", Some(first), origin, y, Limits::new(-0.05, 0.03));
    let ball = builder.frame("ball", Some(second), origin);
    let model = builder.build().unwrap();
    let shape = Shape::sphere(0.05).unwrap();
    let object = CollisionObject::new("ball", ball, origin, shape);
    let mut world = World::new();
    world.add_sphere("rock", 0.1, rock_pose).unwrap();
    let checker = Checker::new(CollisionModel::new(&model, vec![object]).unwrap());
    let checker = checker.with_world(&world).unwrap();
    (model, ball, checker)
}

/// On a line through the larger sphere: the farther the free joint moves, the smaller the depth.
#[test]
fn depth_is_minimal_within_tasks_and_limits() {
    let (model, ball, checker) = balls(0.0);
    let x = Vector3::UNITS[0];
    // A solver without restarts finds one side, with or without a soft task to the rock's centre.
    for (start, y) in [(0.01, 0.03_f64), (-0.01, -0.05)] {
        for pulled in [false, true] {
            let mut tasks = Problem::builder(&model);
            tasks.add(Plane::new(ball, [0.0; 3], x));
            if pulled {
                tasks.add(Task::new(Posture::new(&model, &[0.0, 0.0])).preference());
            }
            tasks.keep_clear(&checker);
            let problem = tasks.build().unwrap();
            let solver = Solver::default().with_restarts(Restarts::none());
            let solution = solver.solve_once(&problem, &[0.02, start]).unwrap();
            assert!(!solution.reached && solution.goals_reached());
            assert_eq!(solution.termination, Termination::Stationary);
            let depth = solution.collisions()[0].depth();
            assert!((depth - (0.15 - y.abs())).abs() < 1e-6, "{start} {depth}");
            assert!((solution.q[1] - y).abs() < 1e-6, "{:?}", solution.q);
        }
    }
}

/// Weighted soft tasks do not weigh contacts against required tasks: the line off the centre is kept.
#[test]
fn contact_is_not_weighted_against_tasks() {
    let (model, ball, checker) = balls(0.02);
    for preferences in [Preferences::WithinGoals, Preferences::Traded] {
        let mut tasks = Problem::builder(&model);
        tasks.add(Plane::new(ball, [0.0; 3], Vector3::UNITS[0]));
        tasks.preferences(preferences).keep_clear(&checker);
        let problem = tasks.build().unwrap();
        let solver = Solver::default().with_restarts(Restarts::none());
        let solution = solver.solve_once(&problem, &[0.02, -0.01]).unwrap();
        assert!(!solution.reached && solution.goals_reached());
        let depth = solution.collisions()[0].depth();
        let smallest = 0.15 - 0.02_f64.hypot(0.05);
        assert!((depth - smallest).abs() < 1e-6, "{preferences:?}: {depth}");
    }
}
