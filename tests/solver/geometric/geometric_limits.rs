//! Promise: geometric methods never violate joint limits, also between start and end, and report misses correctly.

use std::ops::ControlFlow;

use kinopt::geometric::{Ccd, Elbow, Fabrik, Geometric, TwoBone};
use kinopt::ik::SolveError;
use kinopt::ik::{BoundKind, MoveLimits, Restarts, Side};
use kinopt::model::{Limits, Model};
use kinopt::problem::ProblemInstance;
use kinopt::solver::{Iteration, Termination};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Quantity};
use kinopt::{Problem, Solution};
use nalgebra as na;
use support::bones::RandomRig;
use support::random::Random;

/// Solves and checks that every iterate is within bounds.
fn watched(solver: &dyn Geometric, problem: &Problem, start: &[f64]) -> Solution {
    let mut observe = |iteration: &Iteration<'_>| {
        let bounds = problem.lower().iter().zip(problem.upper());
        for (&value, (&lower, &upper)) in iteration.x.iter().zip(bounds) {
            assert!(lower <= value && value <= upper, "{}", solver.name());
        }
        ControlFlow::Continue(())
    };
    let solved = solver.solve_question(problem.into(), start, &mut observe);
    solved.unwrap()
}

/// Checks every solution against its true errors `missed`.
fn check(name: &str, model: &Model, solution: &Solution, missed: &[f64]) {
    for (&value, limits) in solution.q.iter().zip(model.limits()) {
        assert!(limits.contains(value), "{name}");
    }
    let reported = solution.tasks().map(|task| task.position_error().unwrap());
    for (reported, missed) in reported.zip(missed) {
        assert!(
            (reported - missed).abs() < 1e-12,
            "{name}: {reported} is {missed}"
        );
    }
    let cost = 0.5 * missed.iter().map(|m| m * m).sum::<f64>();
    assert!(
        (solution.cost - cost).abs() < 1e-12 * cost.max(1.0),
        "{name}"
    );
    let reached = missed.iter().all(|&m| m <= 1e-6);
    assert_eq!(solution.reached, reached, "{name}");
    assert_eq!(
        solution.termination == Termination::Reached,
        reached,
        "{name}"
    );
    for limit in solution.active_limits() {
        let joint = &model.joints()[model.joint(limit.joint).unwrap().index()];
        let end = match limit.side {
            Side::Lower => joint.limits.lower,
            Side::Upper => joint.limits.upper,
        };
        assert!(!reached && limit.push > 0.0, "{name}");
        assert_eq!(limit.value.to_bits(), end.to_bits(), "{name}");
    }
}

#[test]
fn rigs_with_five_tips_stay_within_limits() {
    let solvers: [&dyn Geometric; 2] = [
        &Ccd::default().with_restarts(Restarts::default().with_attempts(3)),
        &Fabrik::default().with_restarts(Restarts::default().with_attempts(2)),
    ];
    let mut seen = [0; 2];
    for seed in 0..6 {
        let rig = RandomRig::new(seed);
        let model = rig.skeleton.model();
        let mut random = Random::new(seed);
        for scatter in [0.0, 0.3, 5.0] {
            let goal = model.random_configuration(seed);
            let goal: Vec<f64> = goal.iter().map(|v| 0.2 * v).collect();
            let posed = rig.transforms(&goal);
            let count = if scatter == 0.0 { 1 } else { rig.tips.len() };
            let targets: Vec<na::Vector3<f64>> = rig.tips[..count]
                .iter()
                .map(|&tip| rig.tip(&posed, tip) + random.vector(scatter))
                .collect();
            let mut builder = Problem::builder(model);
            builder.tolerance(Quantity::Metres, 1e-6);
            for (&tip, &target) in rig.tips.iter().zip(&targets) {
                builder.add(Point::new(rig.skeleton.tip(tip), target));
            }
            let problem = builder.build().unwrap();
            let start = model.random_configuration(seed + 100);
            for solver in solvers {
                let solution = watched(solver, &problem, &start);
                let found = rig.transforms(&solution.q);
                let tips = rig.tips.iter().zip(&targets);
                let missed = tips.map(|(&tip, target)| (rig.tip(&found, tip) - target).norm());
                check(
                    solver.name(),
                    model,
                    &solution,
                    &missed.collect::<Vec<f64>>(),
                );
                seen[usize::from(solution.reached)] += 1;
                let again = watched(solver, &problem, &start);
                assert_eq!(again.q, solution.q, "{}", solver.name());
            }
        }
    }
    assert!(
        seen.iter().all(|&count| count >= 8),
        "both must occur: {seen:?}"
    );
}

/// Tip position of the arm below. A rotation about y by b moves x towards −z.
fn reach(lengths: [f64; 2], [a, b, c]: [f64; 3]) -> na::Vector3<f64> {
    let along = |b: f64| na::Vector3::new(b.cos(), 0.0, -b.sin());
    let flat = along(b) * lengths[0] + along(b + c) * lengths[1];
    na::Rotation3::from_axis_angle(&na::Vector3::z_axis(), a) * flat
}

/// Shoulder, elbow and tip: turn, lift and bend. Random targets exceed the limits, are beyond the arm's length, or too
/// near.
#[test]
fn two_bone_arm_stays_within_limits() {
    let lengths = [0.9, 0.4];
    let [x, y, z] = Vector3::UNITS;
    let still = Placement::identity();
    let mut random = Random::new(9);
    let mut seen = [0; 2];
    for k in 0..60 {
        let mut builder = Model::builder("arm");
        let mut limits = || Limits::new(random.within(-3.0, -0.3), random.within(0.3, 3.0));
        let [turn, lift, bend] = [limits(), limits(), limits()];
        let turn = builder.revolute("turn", None, still, z, turn);
        let lift = builder.revolute("lift", Some(turn), still, y, lift);
        let elbow = Placement::translation(x * lengths[0]);
        let bend = builder.revolute("bend", Some(lift), elbow, y, bend);
        let tip = builder.frame("tip", Some(bend), Placement::translation(x * lengths[1]));
        let model = builder.build().unwrap();
        // Every other target is reachable.
        let target = match k % 2 {
            0 => random.direction().into_inner() * random.within(0.1, 1.6),
            _ => {
                let [a, b, c] = *model.random_configuration(k) else {
                    panic!()
                };
                reach(lengths, [a, b, c])
            }
        };
        let distance = target.norm();
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, target));
        let problem = builder.build().unwrap();
        let solvers: [&dyn Geometric; 5] = [
            &TwoBone::new(Elbow::Positive),
            &TwoBone::new(Elbow::Negative),
            &TwoBone::new(Elbow::Towards(random.vector(1.0).into())),
            &Ccd::default(),
            &Fabrik::default(),
        ];
        for solver in solvers {
            let solution = watched(solver, &problem, &[0.1, 0.1, 0.1]);
            let [a, b, c] = *solution.q else { panic!() };
            let missed = (reach(lengths, [a, b, c]) - target).norm();
            check(solver.name(), &model, &solution, &[missed]);
            let least = (distance - 1.3).max(0.5 - distance).max(0.0);
            assert!(missed >= least - 1e-12);
            seen[usize::from(solution.reached)] += 1;
        }
    }
    assert!(
        seen.iter().all(|&count| count >= 20),
        "both must occur: {seen:?}"
    );
}

/// At most the move limit from the start, exactly, whether the target is reached or not.
#[test]
fn move_limits_hold_exactly() {
    let solvers: [&dyn Geometric; 2] = [
        &Ccd::default().with_restarts(Restarts::default().with_attempts(3)),
        &Fabrik::default().with_restarts(Restarts::default().with_attempts(3)),
    ];
    let (mut reached, mut held) = (0, 0);
    for seed in 0..12 {
        let rig = RandomRig::new(seed);
        let model = rig.skeleton.model();
        let mut random = Random::new(seed);
        let start = model.random_configuration(seed);
        let step = [0.02, 0.3][seed as usize % 2];
        let moves: Vec<f64> = start.iter().map(|_| random.within(0.0, step)).collect();
        // A position within these moves, or beyond them.
        let goal: Vec<f64> = (start.iter().zip(&moves).zip(model.limits()))
            .map(|((q, most), limits)| limits.clamp(q + random.within(-most, *most)))
            .collect();
        let beyond = if seed % 3 == 0 { 1.0 } else { 0.0 };
        let target = rig.tip(&rig.transforms(&goal), rig.tips[0]) + random.vector(beyond);
        let mut builder = Problem::builder(model);
        builder.add(Point::new(rig.skeleton.tip(rig.tips[0]), target));
        let problem = builder.build().unwrap();
        let limits = MoveLimits::new(&problem, &moves, &start).unwrap();
        let question = ProblemInstance::from(&problem).with_moves(&limits).unwrap();
        for solver in solvers {
            let mut silent = |_: &Iteration<'_>| ControlFlow::Continue(());
            let solution = solver
                .solve_question(question, &start, &mut silent)
                .unwrap();
            for ((q, start), most) in solution.q.iter().zip(&start).zip(&moves) {
                assert!((q - start).abs() <= *most, "{} {seed}", solver.name());
            }
            let mut ends = solution.active_limits();
            held += usize::from(ends.any(|end| end.kind == BoundKind::Move));
            reached += usize::from(solution.reached);
        }
    }
    assert!(reached >= 6 && held >= 6, "{reached} reached, {held} held");
}

#[test]
fn two_bone_limb_keeps_move_limits() {
    let (x, y) = (Vector3::UNITS[0], Vector3::UNITS[1]);
    let mut builder = Model::builder("limb");
    let limits = Limits::new(-3.0, 3.0);
    let lift = builder.revolute("lift", None, Placement::identity(), y, limits);
    let bend = builder.revolute("bend", Some(lift), Placement::translation(x), y, limits);
    let tip = builder.frame("tip", Some(bend), Placement::translation(x));
    let model = builder.build().unwrap();
    let mut random = Random::new(3);
    for _ in 0..40 {
        let start = [random.within(-1.0, 1.0), random.within(-1.0, 1.0)];
        let most = [random.within(0.0, 0.4), random.within(0.0, 0.4)];
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, random.vector(2.0)));
        let problem = builder.build().unwrap();
        let moves = MoveLimits::new(&problem, &most, &start).unwrap();
        for elbow in [Elbow::Positive, Elbow::Negative, Elbow::Towards(y)] {
            let question = ProblemInstance::from(&problem).with_moves(&moves).unwrap();
            let solution = TwoBone::new(elbow).solve(question, &start).unwrap();
            for k in 0..2 {
                assert!((solution.q[k] - start[k]).abs() <= most[k]);
            }
        }
    }
}

/// A move limit of a ball joint is no range of a variable: it is rejected by name like any ball joint.
#[test]
fn ball_joints_are_rejected_with_move_limits() {
    let mut builder = Model::builder("arm");
    let x = Vector3::UNITS[0];
    let ball = builder.ball("shoulder", None, Placement::identity(), x, None);
    let hand = builder.frame("hand", Some(ball), Placement::translation(x));
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(hand, [0.0, 1.0, 0.0]));
    let problem = builder.build().unwrap();
    let start = model.neutral();
    let moves = MoveLimits::new(&problem, &[0.1; 4], &start).unwrap();
    let question = ProblemInstance::from(&problem).with_moves(&moves).unwrap();
    for refused in [
        Ccd::default().solve(question, &start),
        Fabrik::default().solve(question, &start),
    ] {
        assert!(matches!(refused, Err(SolveError::BallJoint { joint, .. }) if joint == "shoulder"));
    }
}
