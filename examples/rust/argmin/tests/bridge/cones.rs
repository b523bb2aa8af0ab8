//! Promise: unbounded solvers keep a ball joint within its cone. Cost and derivatives given to them equal the
//! reported ones.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::FRAC_PI_2;

use argmin::core::{CostFunction, Executor};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use kinopt::Problem;
use kinopt::argmin_bridge::{BoundedProblem, UnboundedProblem};
use kinopt::model::{BallLimits, Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use nalgebra::DVector;

const HALF_ANGLE: f64 = 0.5;

/// Rod of 1 m on a shoulder; it starts along the cone's axis.
fn shoulder() -> Model {
    let mut builder = Model::builder("shoulder");
    let z = Vector3::UNITS[2];
    let cone = BallLimits::cone(HALF_ANGLE, Limits::new(-0.3, 0.3));
    let ball = builder.ball("ball", None, Placement::identity(), z, Some(cone));
    builder.frame("hand", Some(ball), Placement::translation(z));
    builder.build().unwrap()
}

fn reaching(model: &Model, target: [f64; 3]) -> Problem {
    let mut builder = Problem::builder(model);
    builder.add(Point::new(model.frame("hand").unwrap(), target));
    builder.build().unwrap()
}

#[test]
fn both_swings_at_their_ends_are_on_the_cone() {
    let model = shoulder();
    let problem = reaching(&model, [0.3, -0.9, 0.4]);
    let unbounded = UnboundedProblem::new(&problem);
    for signs in [[1.0, 1.0], [-1.0, 1.0], [1.0, -0.5]] {
        let end = HALF_ANGLE * FRAC_PI_2;
        let y = DVector::from_vec(vec![signs[0] * end, signs[1] * end, 0.1]);
        let x = unbounded.variables_at(&y);
        let swing = x[0].hypot(x[1]);
        assert!((swing - HALF_ANGLE).abs() < 1e-12, "{x:?}");
        let bounded_cost = BoundedProblem::new(&problem).cost(&DVector::from_vec(x));
        let difference = unbounded.cost(&y).unwrap() - bounded_cost.unwrap();
        assert!(difference.abs() < 1e-14, "{difference}");
    }
}

#[test]
fn unreachable_target_is_approached_within_the_cone() {
    let model = shoulder();
    let problem = reaching(&model, [0.8, -0.6, 0.0]);
    let unbounded = UnboundedProblem::new(&problem);
    let y = unbounded.start(&model.neutral()).unwrap();
    let lbfgs = LBFGS::new(MoreThuenteLineSearch::new(), 7);
    let run = Executor::new(unbounded.clone(), lbfgs)
        .configure(|state| state.param(y.clone()).max_iters(200))
        .run();
    let solution = unbounded.solution_from(&y, run).unwrap();
    assert!(!solution.reached && model.is_within_limits(&solution.q));
}
