//! Promise: the configuration space of ball joints steps, measures and bounds like one of scalars, also on edges and
//! beyond half a turn.

use std::f64::consts::{PI, TAU};

use kinopt::model::{BallLimits, Limits, Model};
use kinopt::problem::ProblemInstance;
use kinopt::solver::Termination;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{Orientation, Point};
use kinopt::{Problem, Solver};
use support::random::Random;

/// Chain of ball joints: unlimited, with a total angle, a cone, an elliptic cone, and a cone within an angle.
fn body() -> Model {
    let twist = Limits::new(-0.6, 0.9);
    let limits = [
        None,
        Some(BallLimits::within_angle(1.1)),
        Some(BallLimits::cone(0.8, twist)),
        Some(BallLimits::elliptic(
            [1.0, 0.0, 0.0],
            [0.4, 1.3],
            Limits::new(-2.0, 0.2),
        )),
        Some(BallLimits::cone(1.0, twist).with_angle(1.05)),
    ];
    let [_, _, z] = Vector3::UNITS;
    let mut builder = Model::builder("balls");
    let mut carrier = None;
    for (k, limits) in limits.into_iter().enumerate() {
        let at = Placement::translation(z * 0.3);
        carrier = Some(builder.ball(format!("ball {k}"), carrier, at, z, limits));
    }
    builder.frame("tip", carrier, Placement::translation(z));
    builder.build().unwrap()
}

fn problem_of(model: &Model) -> Problem {
    let mut builder = Problem::builder(model);
    builder.add(Point::new(model.frame("tip").unwrap(), [0.5, 0.4, 0.9]));
    builder.build().unwrap()
}

fn is_within(problem: &Problem, model: &Model, x: &[f64]) -> bool {
    let mut q = model.neutral();
    problem.parameters().expand(x, &mut q).unwrap();
    model.is_within_limits(&q)
}

/// Steps connect configurations. A step out of the set leaves it, and a step back does not.
#[test]
fn steps_and_differences_are_inverse() {
    let model = body();
    let problem = problem_of(&model);
    let question = ProblemInstance::from(&problem);
    let (space, n) = (question.space(), problem.variables());
    let mut random = Random::new(81);
    let (mut to, mut step, mut back) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut on_edges = 0;
    for round in 0..400 {
        // Mostly inside, or projected onto edges from far outside.
        let range = if round % 2 == 0 { 0.3 } else { 4.0 };
        let mut x: Vec<f64> = (0..n).map(|_| random.within(-range, range)).collect();
        space.project(&mut x);
        assert!(is_within(&problem, &model, &x), "round {round}");
        let mut again = x.clone();
        space.project(&mut again);
        let moved = space.distance(&again, &x, &mut back);
        assert!(moved < 1e-9, "round {round}: {moved:e}");

        step.fill_with(|| random.within(-1e-3, 1e-3));
        space.integrate(&x, &step, &mut to);
        space.difference(&to, &x, &mut back);
        let deviation_of = |a: &[f64], b: &[f64]| {
            let both = a.iter().zip(b);
            both.fold(0.0_f64, |largest, (a, b)| largest.max((a - b).abs()))
        };
        assert!(
            deviation_of(&back, &step) < 1e-12,
            "round {round}: {back:?} {step:?}"
        );
        let longest = step
            .iter()
            .fold(0.0_f64, |largest, value| largest.max(value.abs()));
        assert!((space.distance(&to, &x, &mut back) - longest).abs() < 1e-12);

        for k in 0..n {
            // One component equals a full step with all others zero, and returns exactly.
            let mut alone = x.clone();
            let taken = space.integrate_one(&x, k, 1e-3, &mut alone);
            step.fill(0.0);
            step[k] = taken;
            space.integrate(&x, &step, &mut to);
            assert!(deviation_of(&alone, &to) < 1e-15, "round {round}, {k}");
            space.return_one(&x, k, &mut alone);
            assert_eq!(alone, x, "round {round}, {k}");

            let (down, up) = space.room(&x, k);
            for (sign, slack) in [(-1.0, down), (1.0, up)] {
                let taken = space.integrate_one(&x, k, sign * 1e-4, &mut alone);
                assert_eq!(space.stopped_step(&x, k, taken).is_some(), 1e-4 > slack);
                let left = !is_within(&problem, &model, &alone);
                if slack == 0.0 {
                    assert!(left, "round {round}: {k} goes {sign} from {x:?} and stays");
                    on_edges += 1;
                    // A configuration outside is projected back to its origin or near it.
                    space.project(&mut alone);
                    let moved = space.distance(&alone, &x, &mut back);
                    assert!(moved < 1e-3, "round {round}, {k}: {moved:e}");
                } else if slack == f64::INFINITY && sign < 0.0 {
                    // From an edge straight inward.
                    let curved = left && {
                        space.project(&mut alone);
                        space.distance(&alone, &x, &mut back) < 0.5e-4
                    };
                    assert!(
                        !curved,
                        "round {round}: {k} does not leave the edge at {x:?}"
                    );
                }
                space.return_one(&x, k, &mut alone);
            }
        }
    }
    assert!(on_edges > 200, "{on_edges}");
}

/// A rotation beyond half a turn equals a shorter one in the opposite direction, and no step is longer for it.
#[test]
fn half_a_turn_is_not_an_edge() {
    let model = body();
    let problem = problem_of(&model);
    let question = ProblemInstance::from(&problem);
    let (space, n) = (question.space(), problem.variables());
    let mut random = Random::new(82);
    let mut back = vec![0.0; n];
    for _ in 0..100 {
        let axis = random.direction();
        let mut x = vec![0.0; n];
        let (short, over) = (random.within(0.01, 0.2), random.within(0.01, 0.2));
        for k in 0..3 {
            x[k] = (PI - short) * axis[k];
        }
        let mut beyond = x.clone();
        for k in 0..3 {
            beyond[k] = (PI + over) * axis[k];
        }
        space.project(&mut beyond);
        for k in 0..3 {
            assert!((beyond[k] - (PI + over - TAU) * axis[k]).abs() < 1e-12);
        }
        let longest = (0..3).fold(0.0_f64, |largest, k| largest.max(axis[k].abs()));
        let moved = space.distance(&beyond, &x, &mut back);
        let expected = longest * (short + over);
        assert!((moved - expected).abs() < 1e-12, "{moved} {expected}");
    }
}

/// A ball joint that only twists, with equal twist and total angle limits, stops there.
#[test]
fn twist_stops_at_an_equal_total_angle() {
    let [x, ..] = Vector3::UNITS;
    let still = Placement::identity();
    // Also nearly equal, as after rounding of degrees.
    for (twist, angle) in [(0.6, 0.6), (0.6, 0.6 + 1e-8), (0.6, 2.0), (2.0, 0.6)] {
        let limits = BallLimits::cone(1.0, Limits::new(-twist, twist)).with_angle(angle);
        let mut builder = Model::builder("arm");
        let shoulder = builder.ball("shoulder", None, still, x, Some(limits));
        let hand = builder.frame("hand", Some(shoulder), still);
        let model = builder.build().unwrap();
        for turn in [-1.0, 1.0] {
            let mut tasks = Problem::builder(&model);
            tasks.add(Orientation::new(hand, rotation_exp(x * turn)));
            let problem = tasks.build().unwrap();
            let solution = Solver::default().solve_once(&problem, &model.neutral());
            let solution = solution.unwrap();
            let missed = solution.orientation_error().unwrap();
            assert!((missed - 0.4).abs() < 1e-9, "{twist} {angle}: {missed}");
            assert_eq!(solution.active_limits().count(), 1);
            assert_eq!(solution.termination, Termination::Stationary);
        }
    }
}
