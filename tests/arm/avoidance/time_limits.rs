//! Promise: with obstacles a time limit ends a search at the next check of the clock, at most a group of attempts
//! later. An observer ends it at once. The tests do not measure time.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::time::Duration;

use kinopt::arm::{Arm, ArmBuilder, Search};
use kinopt::collision::{Checker, CollisionModel, Resolution, Shape, SphereModel, World};
use kinopt::robot::Robot;
use kinopt::solver::{Iteration, Stopping, Termination};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::Point;
use kinopt::{Problem, Solver, Workspace};
use support::random::{Random, cases};

/// Lanes of the widest SIMD group: iterations of one lockstep.
const LOCK_STEP: usize = 8;
/// Attempts that are compared between two looks at the clock, and the most iterations of one.
const COMPARED_ATTEMPTS_AND_ITERATIONS: (usize, usize) = (LOCK_STEP, 2);

/// Checker with everything above the Panda's base filled: every reaching solution is in contact.
fn all_blocked(robot: &Robot, with_spheres: bool) -> Checker {
    let bodies = CollisionModel::of(robot).unwrap();
    let mut world = World::new();
    let down = Placement::new(
        rotation_exp(Vector3::new(PI, 0.0, 0.0)),
        Vector3::new(0.0, 0.0, 0.25),
    );
    world.add("ceiling", Shape::half_space(), down).unwrap();
    let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.03)).unwrap();
    let checker = Checker::new(bodies).with_world(&world).unwrap();
    match with_spheres {
        true => checker.with_spheres(spheres),
        false => checker,
    }
}

/// Solves a target at the start with contacts and no time.
fn ends_at_once(search: Search, with_spheres: bool, most: (usize, usize)) {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let checker = all_blocked(&robot, with_spheres);
    let rest = robot.model().neutral();
    let arm = |change: fn(ArmBuilder<'_>) -> ArmBuilder<'_>| {
        let builder = Arm::builder(&robot, "base", "flange").with_atlas(false);
        let arm = change(builder.with_search(search)).build().unwrap();
        arm.with_checker(&checker, &rest).unwrap()
    };
    let hurried = arm(|builder| builder.with_time_limit(Duration::ZERO));
    let patient = arm(|builder| builder);
    let mut random = Random::new(71);
    for _ in cases(6, 2) {
        let start = random.configuration(&hurried);
        let target = hurried.base_from_tool(&start).unwrap();
        let [cut, whole] = [&hurried, &patient].map(|arm| arm.solve(target, &start).unwrap());
        assert_eq!(cut.termination, Termination::TimeLimit, "{search:?}");
        assert!(!cut.reached && !cut.collisions().is_empty());
        assert!(
            cut.attempts <= most.0 && cut.iterations <= most.1,
            "{search:?}: {} attempts, {} iterations",
            cut.attempts,
            cut.iterations
        );
        // An unlimited search makes many more attempts.
        assert!(whole.attempts > 2 * cut.attempts, "{}", whole.attempts);
    }
}

#[test]
fn arm_with_zero_time_makes_no_further_attempt() {
    for with_spheres in [true, false] {
        for search in [Search::Start, Search::First] {
            ends_at_once(search, with_spheres, (1 + LOCK_STEP, LOCK_STEP));
        }
        // The plain and the collision-free search each collect candidates.
        let (attempts, iterations) = COMPARED_ATTEMPTS_AND_ITERATIONS;
        let twice = (2 * attempts, 2 * attempts * iterations);
        ends_at_once(Search::Nearest, with_spheres, twice);
    }
}

#[test]
fn robot_with_zero_time_does_not_move() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let checker = all_blocked(&robot, false);
    let model = robot.model();
    let start = model.neutral();
    let tip = model.frame("flange").unwrap();
    let at = kinopt::kinematics::ForwardKinematics::new(model)
        .place(&start)
        .unwrap()[tip.index()]
    .translation;
    // At its present pose, so that only contacts remain, and elsewhere.
    for target in [at, at + Vector3::new(0.1, 0.1, -0.2)] {
        let mut tasks = Problem::builder(model);
        tasks.parameters(robot.map().clone());
        tasks.add(Point::new(tip, target));
        tasks.keep_clear(&checker);
        let problem = tasks.build().unwrap();
        let solve = |stopping: Stopping| {
            let solver = Solver::default().with_stopping(stopping);
            solver.solve_once(&problem, &start).unwrap()
        };
        let cut = solve(Stopping::default().with_time_limit(Duration::ZERO));
        assert_eq!(cut.termination, Termination::TimeLimit);
        assert!(!cut.reached && !cut.collisions().is_empty());
        assert_eq!((cut.iterations, cut.attempts), (0, 1));
        let whole = solve(Stopping::default());
        assert!(whole.attempts > 1 && whole.iterations > 10);
    }
}

/// An observer's stop ends the search at once at any stage, also during depenetration.
#[test]
fn cancelled_depenetration_stops_at_once() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let checker = all_blocked(&robot, false);
    let model = robot.model();
    let tip = model.frame("flange").unwrap();
    let mut tasks = Problem::builder(model);
    tasks.parameters(robot.map().clone());
    tasks.add(Point::new(tip, [0.3, 0.2, 0.6]));
    tasks.keep_clear(&checker);
    let problem = tasks.build().unwrap();
    for stop in 1..30 {
        let mut seen = 0;
        let mut watch = |_: &Iteration<'_>| {
            seen += 1;
            match seen < stop {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        };
        let (start, mut workspace) = (model.neutral(), Workspace::new());
        let reported =
            Solver::default().solve_observed(&problem, &start, &mut workspace, &mut watch);
        assert_eq!(
            reported.unwrap().termination,
            Termination::Cancelled,
            "{stop}"
        );
        // One search ends and the next starts when required tasks are reached.
        assert!(seen <= stop + 1, "{seen} after {stop}");
    }
}
