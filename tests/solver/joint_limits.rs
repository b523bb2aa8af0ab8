//! Promise: no iterate and no result violates a limit, exactly, for every method, derivative route and start, reached
//! or not.

use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::model::{Limits, Model, ParameterMap};
use kinopt::problem::{Derivatives, Problem};
use kinopt::solver::{Iteration, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Orientation, Point, Posture};
use kinopt::{Solver, Workspace};
use support::bones::RandomRig;
use support::maps::maps_of;
use support::methods::solvers;
use support::placement;
use support::random::{Random, part};
use support::trees::RandomTree;

fn assert_within(label: &str, values: &[f64], limits: impl Iterator<Item = Limits>) {
    for (k, (value, limits)) in values.iter().zip(limits).enumerate() {
        assert!(
            limits.lower <= *value && *value <= limits.upper,
            "{label}: value {k} is {value:?}, outside {limits:?}"
        );
    }
}

fn bounds(problem: &Problem) -> Vec<Limits> {
    let both = problem.lower().iter().zip(problem.upper());
    both.map(|(&l, &u)| Limits::new(l, u)).collect()
}

/// Solves from `start` and checks every iterate and the result.
fn check(label: &str, solver: &Solver, model: &Model, problem: &Problem, start: &[f64]) {
    let box_of_x = bounds(problem);
    let mut watch = |seen: &Iteration<'_>| {
        assert_within(label, seen.x, box_of_x.iter().copied());
        ControlFlow::Continue(())
    };
    let mut workspace = Workspace::new();
    let solution = solver
        .solve_observed(problem, start, &mut workspace, &mut watch)
        .unwrap();
    assert_within(label, &solution.q, model.limits());
    let mut x = vec![f64::NAN; problem.variables()];
    for (value, &leader) in x.iter_mut().zip(problem.parameters().leaders()) {
        *value = solution.q[leader];
    }
    assert_within(label, &x, box_of_x.iter().copied());
}

/// Starts inside, in the corners of the box, and far outside.
fn starts(model: &Model, random: &mut Random) -> Vec<Vec<f64>> {
    let finite = |v: f64| v.clamp(-1e3, 1e3);
    let inside = support::trees::configuration_of(model, random);
    let corner = model
        .limits()
        .map(|l| {
            finite(if random.unit() < 0.5 {
                l.lower
            } else {
                l.upper
            })
        })
        .collect();
    let outside = inside.iter().map(|_| random.within(-50.0, 50.0)).collect();
    let huge = inside.iter().map(|v| 1e300 * v.signum()).collect();
    vec![inside, corner, outside, huge]
}

fn short() -> (Stopping, Restarts) {
    (
        Stopping::default().with_max_iterations(15),
        Restarts::default().with_attempts(2),
    )
}

#[test]
fn trees_with_all_maps_stay_within_limits() {
    for seed in part(0..4, 2) {
        let tree = RandomTree::new(seed, 10);
        let mut random = Random::new(seed);
        for expected in maps_of(&tree) {
            // A reachable target and one beyond the reach.
            let q = expected.expand(&expected.variables(&mut random));
            let reachable = tree.frames_at(&q)[9];
            let mut hopeless = reachable;
            hopeless.translation.vector += random.vector(30.0);
            for target in [reachable, hopeless] {
                let mut builder = Problem::builder(&tree.model);
                builder.parameters(expected.map.clone());
                builder.add(FramePose::new(tree.far_frame(), placement(&target)));
                let problem = builder.build().unwrap();
                for (k, solver) in solvers().into_iter().enumerate() {
                    let (stopping, restarts) = short();
                    let solver = solver.with_stopping(stopping).with_restarts(restarts);
                    let route = Derivatives::ALL[(k + seed as usize) % 4];
                    let problem = problem.clone().with_derivatives(route);
                    let label = format!(
                        "tree {seed}, {}, {}, {route:?}",
                        expected.name,
                        solver.method()
                    );
                    for start in starts(&tree.model, &mut random) {
                        check(&label, &solver, &tree.model, &problem, &start);
                    }
                }
            }
        }
    }
}

#[test]
fn rigs_at_their_limits_stay_within_limits() {
    for seed in part(0..2, 2) {
        let rig = RandomRig::new(seed);
        let model = rig.skeleton.model();
        let mut random = Random::new(seed);
        let problem = rig.drawn_to(|| random.vector(1.5));
        for solver in solvers() {
            let (stopping, restarts) = short();
            let solver = solver.with_stopping(stopping).with_restarts(restarts);
            for route in [Derivatives::Analytic, Derivatives::Dual] {
                let problem = problem.clone().with_derivatives(route);
                for start in starts(model, &mut random).into_iter().skip(1).take(2) {
                    let label = format!("rig {seed}, {}, {route:?}", solver.method());
                    check(&label, &solver, model, &problem, &start);
                }
            }
        }
    }
}

#[test]
fn limits_without_exact_sum_are_not_exceeded() {
    // Thirds and tenths: x + Δ rounds beyond them unless it is clamped.
    let model = support::planar_arm(&[0.3, 0.3, 0.3], Some((-1.0 / 3.0, 0.1)));
    let tip = model.frame("tip").unwrap();
    let mut random = Random::new(1);
    for _ in 0..50 {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, random.vector(1.0)));
        let problem = builder.build().unwrap();
        for solver in solvers() {
            let start = starts(&model, &mut random).swap_remove(2);
            check(solver.method(), &solver, &model, &problem, &start);
        }
    }
}

#[test]
fn problem_bounds_hold() {
    let tree = RandomTree::new(7, 9);
    let mut random = Random::new(7);
    let mut builder = Problem::builder(&tree.model);
    let target = nalgebra::Rotation3::identity().into_inner();
    builder.add(Orientation::new(tree.far_frame(), target));
    let moving = tree.model.moving_joints();
    for (k, (&joint, limits)) in moving.iter().zip(tree.model.limits()).enumerate() {
        let middle = limits.clamp(0.0);
        let narrow = match k % 3 {
            0 => Limits::new(middle, middle),
            1 => Limits::new(middle - 0.1, middle + 0.01),
            _ => Limits::new(f64::NEG_INFINITY, middle + 0.02),
        };
        builder.bound(joint, narrow);
    }
    let problem = builder.build().unwrap();
    for solver in solvers() {
        for start in starts(&tree.model, &mut random) {
            check(solver.method(), &solver, &tree.model, &problem, &start);
        }
    }
}

#[test]
fn problem_bounds_on_mimic_joints_hold() {
    let tree = RandomTree::new(11, 10);
    let moving = tree.model.moving_joints();
    let limits: Vec<Limits> = tree.model.limits().collect();
    let mut random = Random::new(11);
    for expected in maps_of(&tree) {
        let q = expected.expand(&expected.variables(&mut random));
        let mut builder = Problem::builder(&tree.model);
        builder.parameters(expected.map.clone());
        let mut goal = tree.frames_at(&q)[9];
        goal.translation.vector += random.vector(1.0);
        builder.add(FramePose::new(tree.far_frame(), placement(&goal)));
        // Narrow bounds around one configuration of the map.
        let rooms: Vec<Limits> = q.iter().map(|v| Limits::new(v - 0.05, v + 0.03)).collect();
        for (&joint, &bounds) in moving.iter().zip(&rooms) {
            builder.bound(joint, bounds);
        }
        let problem = builder.build().unwrap();
        for solver in solvers() {
            let (stopping, restarts) = short();
            let solver = solver.with_stopping(stopping).with_restarts(restarts);
            for start in starts(&tree.model, &mut random) {
                let solution = solver.solve_once(&problem, &start).unwrap();
                let label = format!("{}, {}", expected.name, solver.method());
                assert_within(&label, &solution.q, rooms.iter().copied());
                assert_within(&label, &solution.q, limits.iter().copied());
            }
        }
    }
}

/// With its source joint on a bound, a mimic joint is on or within its own bound despite rounding.
#[test]
fn rounding_keeps_mimic_joints_within_bounds() {
    let mut random = Random::new(12);
    let (mut on_bound, wide) = (0, Limits::new(-20.0, 20.0));
    for case in 0..200 {
        let (origin, z) = (Placement::identity(), Vector3::UNITS[2]);
        let mut builder = Model::builder("leader and follower");
        let leader = builder.revolute("leader", None, origin, z, wide);
        let follower = builder.revolute("follower", Some(leader), origin, z, wide);
        let model = builder.build().unwrap();
        let (ratio, offset) = (random.within(0.2, 3.0), random.within(-1.0, 1.0));
        let bounds = Limits::new(random.within(-3.0, -2.0), random.within(2.0, 3.0));
        let map = ParameterMap::builder(&model).with_coupled(follower, leader, ratio, offset);
        let mut builder = Problem::builder(&model);
        builder.parameters(map.build().unwrap());
        builder.bound(follower, bounds);
        let target = if case % 2 == 0 { 19.0 } else { -19.0 };
        builder.add(Posture::of_joints([(leader, target)]));
        let solution = Solver::default().solve_once(&builder.build().unwrap(), &[0.0; 2]);
        let q = solution.unwrap().q[1];
        assert!(bounds.contains(q), "{case}: {q:?} in {bounds:?}");
        on_bound += usize::from(q == bounds.lower || q == bounds.upper);
    }
    assert!(on_bound > 100, "{on_bound}");
}
