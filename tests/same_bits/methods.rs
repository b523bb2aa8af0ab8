//! Promise: so it is for the methods themselves, step by step: on plain functions between bounds, where a residual stays large,
//! where J loses rank, with every setting and every end of a search, in memory that was used for something else.
#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;

use kinopt::Scalar;
use kinopt::solver::{
    AnyMethod, Damping, FirstStep, GaussNewton, Iteration, LeastSquares, LevenbergMarquardt,
    ProjectedGradient, SolverState, Stopping, minimise,
};
use support::classics::{
    Bard, Beale, Bounded, Cubic, Function, Linear, Rosenbrock, SphereAndPlane,
};
use support::random::Random;

use crate::digest::{Digest, Value, check};

/// Two curves that do not meet, and one that both variables bend: a residual that stays large.
struct Apart;

impl Function for Apart {
    fn variables(&self) -> usize {
        3
    }

    fn rows(&self) -> usize {
        4
    }

    fn evaluate<S: Scalar>(&self, x: &[S], r: &mut [S]) {
        let c = S::constant;
        r[0] = x[0] * x[0] + x[1] * x[1] + c(3.0);
        r[1] = x[0] * x[1] - x[2] * c(4.0);
        r[2] = (x[2] - x[0]) * (x[1] + c(2.0));
        r[3] = x[2].sin_cos().0 + x[1] * c(2.0) - c(5.0);
    }
}

/// Not a number past one half.
struct Broken;

impl Function for Broken {
    fn variables(&self) -> usize {
        1
    }

    fn rows(&self) -> usize {
        1
    }

    fn evaluate<S: Scalar>(&self, x: &[S], r: &mut [S]) {
        r[0] = (x[0] - S::constant(0.5)).ln() + S::constant(1.0);
    }
}

fn settings() -> Vec<Box<dyn AnyMethod>> {
    vec![
        Box::new(LevenbergMarquardt::new(Damping::GainRatio)),
        Box::new(LevenbergMarquardt::new(Damping::GainRatio).with_initial_damping(10.0)),
        Box::new(LevenbergMarquardt::new(Damping::ErrorProportional)),
        Box::new(LevenbergMarquardt::new(Damping::ErrorProportional).with_initial_damping(1e-4)),
        Box::new(GaussNewton::default()),
        Box::new(GaussNewton::default().with_rank_tolerance(0.1)),
        Box::new(ProjectedGradient::default()),
        Box::new(ProjectedGradient::new(FirstStep::Fixed(0.01))),
        Box::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein)),
    ]
}

/// NaN is one: which of its bits are set is the machine's own.
fn sound(numbers: &[f64]) -> impl Iterator<Item = f64> {
    numbers
        .iter()
        .map(|v| if v.is_nan() { f64::NAN } else { *v })
}

/// A search, step by step, and what is left in memory.
fn searched(
    digest: &mut Digest,
    problem: &mut dyn LeastSquares,
    method: &dyn AnyMethod,
    start: &[f64],
    stopping: &Stopping,
    state: &mut SolverState,
) {
    digest.text(method.name());
    digest.word(method.needs_jacobian().into());
    let mut seen = |step: &Iteration<'_>| {
        digest.word(step.index as u64);
        digest.doubles(sound(&[step.cost, step.step, step.control]));
        digest.doubles(step.projected_gradient);
        digest.doubles(step.x.iter().copied());
        ControlFlow::Continue(())
    };
    let outcome = minimise(problem, method, start, stopping, &mut seen, state);
    digest.noted(&outcome);
    let [x, residual, step, gradient] =
        [state.x(), state.residual(), state.step(), state.gradient()];
    for part in [x, residual, step, gradient, state.trial_residual()] {
        digest.doubles(sound(part));
    }
    digest.doubles(sound(&[state.cost(), state.column_norm()]));
    digest.noted(&(state.counts(), state.free()));
    digest.doubles(sound(state.jacobian().as_slice()));
}

fn by_steps() -> [Value; 2] {
    let (mut plain, mut bounded) = (Digest::new(), Digest::new());
    let mut state = SolverState::default();
    let mut random = Random::new(141);
    let inf = f64::INFINITY;
    let stopping = Stopping::default().with_max_iterations(40);
    for method in settings() {
        let mut go = |digest: &mut Digest, problem: &mut dyn LeastSquares, start: &[f64]| {
            searched(digest, problem, &*method, start, &stopping, &mut state);
        };
        go(&mut plain, &mut Bounded::free(Rosenbrock), &[-1.2, 1.0]);
        go(&mut plain, &mut Bounded::free(Apart), &[1.0, -1.0, 0.5]);
        go(&mut plain, &mut Bounded::free(Beale), &[1.0, 1.0]);
        go(&mut plain, &mut Bounded::free(Cubic), &[4.0]);
        go(
            &mut plain,
            &mut Bounded::free(SphereAndPlane),
            &[0.5, 0.1, -0.3, 0.2, 0.9],
        );
        go(&mut plain, &mut Bounded::free(Bard), &[1.0, 1.0, 1.0]);
        go(&mut plain, &mut Bounded::free(Broken), &[0.9]);
        go(
            &mut bounded,
            &mut Bounded::within(Rosenbrock, &[-2.0, 1.2], &[0.8, inf]),
            &[-1.2, 1.0],
        );
        go(
            &mut bounded,
            &mut Bounded::within(Apart, &[-0.5, -0.5, 0.0], &[0.4, 0.5, 0.0]),
            &[1.0, -1.0, 0.5],
        );
        go(
            &mut bounded,
            &mut Bounded::within(Bard, &[0.0, 0.0, 1.0], &[0.05, 3.0, 2.0]),
            &[1.0, 1.0, 1.0],
        );
        for (rows, columns) in [(3, 5), (5, 3), (4, 4)] {
            let mut matrix =
                nalgebra::DMatrix::from_fn(rows, columns, |_, _| random.within(-1.0, 1.0));
            if rows > 3 {
                let twice = matrix.row(0) * 2.0;
                matrix.set_row(3, &twice);
            }
            let right_side = nalgebra::DVector::from_fn(rows, |_, _| random.within(-2.0, 2.0));
            let lower: Vec<f64> = (0..columns).map(|k| [-inf, -0.2, 0.1][k % 3]).collect();
            let upper: Vec<f64> = (0..columns).map(|k| [inf, 0.3, 0.1][k % 3]).collect();
            let linear = Linear { matrix, right_side };
            let start: Vec<f64> = (0..columns).map(|_| random.within(-1.0, 1.0)).collect();
            go(
                &mut bounded,
                &mut Bounded::within(linear, &lower, &upper),
                &start,
            );
        }
    }
    [plain.value(), bounded.value()]
}

/// Every way that a search ends, and what is refused before one begins.
fn ends() -> Value {
    let mut digest = Digest::new();
    let mut state = SolverState::default();
    let few = Stopping::default();
    let method = LevenbergMarquardt::default();
    for stopping in [
        few.with_max_iterations(0),
        few.with_max_iterations(3),
        few.with_gradient_tolerance(0.1),
        few.with_gradient_tolerance(0.0).with_step_tolerance(0.05),
        few.with_gradient_tolerance(0.0).with_step_tolerance(0.0),
        few.with_patience(Some(2)),
        few.with_patience(None),
    ] {
        digest.noted(&(
            stopping.max_iterations(),
            stopping.patience(),
            stopping.gradient_tolerance(),
            stopping.step_tolerance(),
            stopping.time_limit(),
        ));
        for start in [[1.0, -1.0, 0.5], [0.0, 0.0, 0.0]] {
            searched(
                &mut digest,
                &mut Bounded::free(Apart),
                &method,
                &start,
                &stopping,
                &mut state,
            );
        }
        searched(
            &mut digest,
            &mut Bounded::free(Rosenbrock),
            &GaussNewton::default(),
            &[-1.2, 1.0],
            &stopping,
            &mut state,
        );
        searched(
            &mut digest,
            &mut Bounded::free(Rosenbrock),
            &method,
            &[1.0, 1.0],
            &stopping,
            &mut state,
        );
        searched(
            &mut digest,
            &mut Bounded::free(Broken),
            &method,
            &[0.2],
            &stopping,
            &mut state,
        );
    }
    let mut steps = 0;
    let mut stop = |_: &Iteration<'_>| {
        steps += 1;
        if steps > 3 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let mut problem = Bounded::free(Rosenbrock);
    digest.noted(&minimise(
        &mut problem,
        &method,
        &[-1.2, 1.0],
        &few,
        &mut stop,
        &mut state,
    ));
    let mut refused = |method: &dyn AnyMethod, start: &[f64], stopping: Stopping| {
        let mut problem = Bounded::free(Rosenbrock);
        let silent = &mut kinopt::solver::Silent;
        digest.refusal(minimise(
            &mut problem,
            method,
            start,
            &stopping,
            silent,
            &mut SolverState::default(),
        ));
    };
    refused(&method, &[1.0], few);
    refused(&method, &[1.0, f64::NAN], few);
    refused(&method, &[1.0, 1.0], few.with_gradient_tolerance(-1.0));
    refused(&method, &[1.0, 1.0], few.with_step_tolerance(f64::NAN));
    for initial in [0.0, -1.0, f64::INFINITY, 1e-300] {
        refused(
            &LevenbergMarquardt::default().with_initial_damping(initial),
            &[1.0, 1.0],
            few,
        );
    }
    for tolerance in [0.0, 0.6, f64::NAN, 0.5] {
        refused(
            &GaussNewton::default().with_rank_tolerance(tolerance),
            &[1.0, 1.0],
            few,
        );
    }
    let mut short = Bounded::free(Rosenbrock);
    short.lower.pop();
    digest.refusal(minimise(
        &mut short,
        &method,
        &[1.0, 1.0],
        &few,
        &mut kinopt::solver::Silent,
        &mut state,
    ));
    let mut short = Bounded::free(Rosenbrock);
    short.upper.pop();
    digest.refusal(minimise(
        &mut short,
        &method,
        &[1.0, 1.0],
        &few,
        &mut kinopt::solver::Silent,
        &mut state,
    ));
    digest.value()
}

#[test]
fn of_methods() {
    let [plain, bounded] = by_steps();
    check(&[
        ("methods step by step, unbounded", plain),
        ("methods step by step, between bounds", bounded),
        ("every end of a search", ends()),
    ]);
}
