//! Promise: every method finds the known minima of one battery of least-squares problems.

use std::ops::ControlFlow;

use kinopt::solver::{
    AnyMethod, GaussNewton, Iteration, LeastSquares, Outcome, Silent, SolverState, Stopping,
    Termination, minimise,
};
use nalgebra::{DMatrix, DVector};
use support::classics::{
    Bard, Beale, Bounded, BrownDennis, Cubic, Function, Linear, PowellSingular, Rosenbrock,
    SphereAndPlane, Wood,
};
use support::methods::methods;
use support::random::Random;

const UNBOUNDED: f64 = f64::INFINITY;

/// Gradient descent needs 20 times as many iterations as the other methods.
fn patience(method: &dyn AnyMethod) -> Stopping {
    let iterations = if method.needs_jacobian() {
        1_000
    } else {
        20_000
    };
    Stopping::default().with_max_iterations(iterations)
}

fn search<F: Function>(
    problem: &mut Bounded<F>,
    method: &dyn AnyMethod,
    start: &[f64],
) -> (SolverState, Outcome) {
    let mut memory = SolverState::default();
    let (lower, upper) = (problem.lower.clone(), problem.upper.clone());
    let mut lowest = f64::INFINITY;
    let mut watch = |seen: &Iteration<'_>| {
        for (v, (l, u)) in seen.x.iter().zip(lower.iter().zip(&upper)) {
            assert!(l <= v && v <= u);
        }
        lowest = lowest.min(seen.cost);
        ControlFlow::Continue(())
    };
    let stopping = patience(method);
    let outcome = minimise(problem, method, start, &stopping, &mut watch, &mut memory).unwrap();
    assert!(
        memory.cost() <= lowest,
        "{}: not the best seen",
        method.name()
    );
    let half: f64 = memory.residual().iter().map(|r| 0.5 * r * r).sum();
    assert!((memory.cost() - half).abs() <= 1e-15 * half);
    (memory, outcome)
}

/// Asserts that every method from `start` converges to the minimum's cost. Gradient descent has 10⁴ times the
/// tolerance, because it converges at the rate of the condition number.
fn finds<F: Function>(
    name: &str,
    mut problem: Bounded<F>,
    start: &[f64],
    minimum: f64,
    minimiser: Option<(&[f64], f64)>,
) {
    for method in methods() {
        let (memory, outcome) = search(&mut problem, &*method, start);
        let method_name = method.name();
        let slack = if method.needs_jacobian() { 1e-10 } else { 1e-6 };
        let excess = memory.cost() - minimum;
        assert!(
            (-1e-9 * minimum..=slack * minimum.max(1.0)).contains(&excess),
            "{name} by {method_name}: cost {} is not {minimum} ({outcome:?})",
            memory.cost()
        );
        if let Some((expected, within)) = minimiser.filter(|_| method.needs_jacobian()) {
            for (ours, theirs) in memory.x().iter().zip(expected) {
                let error = (ours - theirs).abs();
                assert!(error < within, "{name} by {method_name}: {:?}", memory.x());
            }
        }
    }
}

/// Random linear problem with a known constrained minimiser: Aᵀr* is zero for free variables and points outward for
/// fixed ones.
fn linear_with_known_answer(
    seed: u64,
    rows: usize,
    answer: &[f64],
    multipliers: &[f64],
) -> (Linear, f64) {
    let mut random = Random::new(seed);
    let n = answer.len();
    let matrix = DMatrix::from_fn(rows, n, |_, _| random.within(-1.0, 1.0));
    let gram = matrix.transpose() * &matrix;
    let gradient = DVector::from_column_slice(multipliers);
    let left = &matrix * gram.lu().solve(&gradient).unwrap();
    let right_side = &matrix * DVector::from_column_slice(answer) - &left;
    let cost = 0.5 * left.norm_squared();
    (Linear { matrix, right_side }, cost)
}

#[test]
fn linear_problem_finds_the_known_active_set() {
    for seed in 0..5 {
        // The second variable is on its upper bound, the fourth on its lower.
        let result = [0.3, 1.0, -0.2, -1.0];
        let pushes = [0.0, -0.7, 0.0, 0.4];
        let (linear, cost) = linear_with_known_answer(seed, 7, &result, &pushes);
        let problem = Bounded::within(linear, &[-1.0; 4], &[1.0; 4]);
        finds("linear", problem, &[0.0; 4], cost, Some((&result, 1e-8)));
    }
}

#[test]
fn rosenbrock_free_and_bounded() {
    let start = [-1.2, 1.0];
    finds(
        "rosenbrock",
        Bounded::free(Rosenbrock),
        &start,
        0.0,
        Some((&[1.0, 1.0], 1e-6)),
    );
    // With x ≤ ½ the minimum is at (½, ¼): ½ (1 − ½)².
    let bounded = Bounded::within(Rosenbrock, &[-2.0, -2.0], &[0.5, 2.0]);
    finds(
        "bounded rosenbrock",
        bounded,
        &start,
        0.125,
        Some((&[0.5, 0.25], 1e-7)),
    );
    // With y ≤ ½, stationary where d/dx [50 (½ − x²)² + ½ (1 − x)²] = 0.
    let bounded = Bounded::within(Rosenbrock, &[-0.5, -2.0], &[2.0, 0.5]);
    let mut x = 0.7_f64;
    for _ in 0..50 {
        let slope = -200.0 * x * (0.5 - x * x) - (1.0 - x);
        x -= slope / (-100.0 + 600.0 * x * x + 1.0);
    }
    let cost = 50.0 * (0.5 - x * x).powi(2) + 0.5 * (1.0 - x).powi(2);
    finds(
        "rosenbrock under a lid",
        bounded,
        &[0.0, 0.0],
        cost,
        Some((&[x, 0.5], 1e-6)),
    );
}

#[test]
fn powell_singular() {
    let start = [3.0, -1.0, 0.0, 1.0];
    finds(
        "powell singular",
        Bounded::free(PowellSingular),
        &start,
        0.0,
        None,
    );
}

#[test]
fn beale() {
    finds(
        "beale",
        Bounded::free(Beale),
        &[1.0, 1.0],
        0.0,
        Some((&[3.0, 0.5], 1e-5)),
    );
}

#[test]
fn wood() {
    let start = [-3.0, -1.0, -3.0, -1.0];
    finds(
        "wood",
        Bounded::free(Wood),
        &start,
        0.0,
        Some((&[1.0; 4], 1e-5)),
    );
}

#[test]
fn brown_and_dennis() {
    let minimum = 85_822.201_626_356_28 / 2.0;
    let start = [25.0, 5.0, -5.0, -1.0];
    finds(
        "brown-dennis",
        Bounded::free(BrownDennis),
        &start,
        minimum,
        None,
    );
}

#[test]
fn bard() {
    let minimum = 8.214_877_306_578_963e-3 / 2.0;
    finds("bard", Bounded::free(Bard), &[1.0; 3], minimum, None);
}

#[test]
fn cubic_of_one_variable() {
    finds(
        "cubic",
        Bounded::free(Cubic),
        &[3.0],
        0.0,
        Some((&[1.0], 1e-9)),
    );
    let bounded = Bounded::within(Cubic, &[1.5], &[4.0]);
    let cost = 0.5 * (3.375_f64 - 0.5).powi(2);
    finds("held cubic", bounded, &[3.0], cost, Some((&[1.5], 1e-300)));
}

#[test]
fn fewer_rows_than_variables() {
    let start = [0.3, -0.4, 0.5, 0.1, -0.2];
    finds(
        "sphere and plane",
        Bounded::free(SphereAndPlane),
        &start,
        0.0,
        None,
    );
    let bounded = Bounded::within(SphereAndPlane, &[-1.0; 5], &[1.0; 5]);
    finds("sphere and plane in a box", bounded, &start, 0.0, None);
}

#[test]
fn start_at_the_optimum_takes_no_step() {
    for method in methods() {
        let mut problem = Bounded::free(Rosenbrock);
        let (memory, outcome) = search(&mut problem, &*method, &[1.0, 1.0]);
        assert_eq!(outcome.iterations, 0, "{}", method.name());
        assert_eq!(outcome.termination, Termination::Reached);
        assert_eq!(memory.x(), [1.0, 1.0]);

        let mut bounded = Bounded::within(Rosenbrock, &[-2.0, -2.0], &[0.5, 2.0]);
        let (memory, outcome) = search(&mut bounded, &*method, &[0.5, 0.25]);
        assert_eq!(outcome.iterations, 0, "{}", method.name());
        assert_eq!(outcome.termination, Termination::Stationary);
        assert_eq!(memory.x(), [0.5, 0.25]);
    }
}

#[test]
fn starts_on_and_outside_bounds_converge() {
    let corners = [
        [-2.0, -2.0],
        [0.5, 2.0],
        [-2.0, 2.0],
        [0.5, -2.0],
        [9.0, -1e300],
    ];
    for corner in corners {
        let bounded = Bounded::within(Rosenbrock, &[-2.0, -2.0], &[0.5, 2.0]);
        finds(
            "from a corner",
            bounded,
            &corner,
            0.125,
            Some((&[0.5, 0.25], 1e-7)),
        );
    }
}

#[test]
fn variables_without_range_stay_fixed() {
    let fixed = Bounded::within(Rosenbrock, &[0.3, -UNBOUNDED], &[0.3, UNBOUNDED]);
    let cost = 0.5 * 0.49;
    finds(
        "one fixed",
        fixed,
        &[5.0, 5.0],
        cost,
        Some((&[0.3, 0.09], 1e-9)),
    );
}

#[test]
fn gauss_newton_step_has_minimum_norm() {
    for (seed, rows, columns, rank) in [(1, 5, 3, 2), (2, 3, 6, 2), (3, 6, 6, 3), (4, 8, 5, 1)] {
        let mut random = Random::new(seed);
        let mut part = |r, c| DMatrix::from_fn(r, c, |_, _| random.within(-1.0, 1.0));
        let matrix = part(rows, rank) * part(rank, columns);
        let right_side = part(rows, 1).column(0).into_owned();
        let start = part(columns, 1).column(0).into_owned();
        let inverse = matrix.clone().pseudo_inverse(1e-10).unwrap();
        let expected = &start + inverse * (&right_side - &matrix * &start);
        let mut problem = Bounded::free(Linear { matrix, right_side });
        let mut memory = SolverState::default();
        let once = Stopping::default().with_max_iterations(1);
        let method = GaussNewton::default();
        minimise(
            &mut problem,
            &method,
            start.as_slice(),
            &once,
            &mut Silent,
            &mut memory,
        )
        .unwrap();
        let error = (DVector::from_column_slice(memory.x()) - expected).amax();
        assert!(
            error < 1e-12,
            "{rows} × {columns} of rank {rank}: {error:e}"
        );
    }
}

#[test]
fn outcome_reports_the_projected_gradient() {
    let mut problem = Bounded::within(Rosenbrock, &[-2.0, -2.0], &[0.5, 2.0]);
    for method in methods() {
        let (memory, outcome) = search(&mut problem, &*method, &[-1.2, 1.0]);
        let mut jacobian = DMatrix::zeros(2, 2);
        problem.jacobian(memory.x(), &mut jacobian);
        let gradient = jacobian.transpose() * DVector::from_column_slice(memory.residual());
        let moved = memory.x().iter().zip(&gradient).enumerate();
        let norm = moved.fold(0.0, |largest: f64, (k, (x, g))| {
            let projected = (x - g).clamp(problem.lower[k], problem.upper[k]);
            largest.max((projected - x).abs())
        });
        let reported = outcome.projected_gradient.unwrap();
        assert!(
            (reported - norm).abs() <= 1e-12 + 1e-9 * norm,
            "{reported} is not {norm}"
        );
    }
}
