//! Promise: the step of each method equals its formula in dense algebra, over the free variables and clamped to the
//! bounds.

use std::ops::ControlFlow;

use kinopt::solver::{
    AnyMethod, Damping, FirstStep, GaussNewton, Iteration, LeastSquares, LevenbergMarquardt,
    ProjectedGradient, SolverState, Stopping, minimise,
};
use nalgebra::{DMatrix, DVector};
use support::random::Random;

/// r = A x − b within bounds, with a start.
struct Linear {
    a: DMatrix<f64>,
    b: DVector<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    start: DVector<f64>,
}

impl LeastSquares for Linear {
    fn variables(&self) -> usize {
        self.a.ncols()
    }

    fn rows(&self) -> usize {
        self.a.nrows()
    }

    fn lower(&self) -> &[f64] {
        &self.lower
    }

    fn upper(&self) -> &[f64] {
        &self.upper
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        let r = &self.a * DVector::from_column_slice(x) - &self.b;
        residual.copy_from_slice(r.as_slice());
    }

    fn jacobian(&mut self, _: &[f64], jacobian: &mut DMatrix<f64>) {
        jacobian.copy_from(&self.a);
    }
}

impl Linear {
    /// Variables inside, on either bound and without range; rows may be linearly dependent.
    fn random(random: &mut Random, rows: usize, columns: usize) -> Self {
        let mut a = DMatrix::from_fn(rows, columns, |_, _| random.within(-1.0, 1.0));
        if rows > 3 {
            let twice = a.row(0) * 2.0;
            a.set_row(3, &twice);
        }
        let b = DVector::from_fn(rows, |_, _| random.within(-1.0, 1.0));
        let start = DVector::from_fn(columns, |_, _| random.within(-0.5, 0.5));
        let bound = |side: f64| {
            move |(j, x): (usize, &f64)| match (j % 4, side > 0.0) {
                (1, true) | (2, false) => *x,
                _ if j == 3 => *x,
                _ => x + side * 0.6,
            }
        };
        let [lower, upper] = [-1.0, 1.0].map(|side| start.iter().enumerate().map(bound(side)));
        let (lower, upper) = (lower.collect(), upper.collect());
        Self {
            a,
            b,
            lower,
            upper,
            start,
        }
    }

    /// Makes the gradient of the variable without range exactly zero, so that only its bounds fix it.
    fn level(mut self) -> Self {
        let (rows, last) = (self.a.nrows(), self.a.ncols() - 1);
        self.a.row_mut(rows - 1).fill(0.0);
        self.a.column_mut(last).fill(0.0);
        let residual = &self.a * &self.start - &self.b;
        self.a[(0, last)] = 1.0;
        self.a[(rows - 1, last)] = 1.0;
        self.b[0] += self.start[last];
        self.b[rows - 1] = self.start[last] + residual[0];
        (self.lower[last], self.upper[last]) = (self.start[last], self.start[last]);
        self
    }

    fn at(&self, x: &DVector<f64>) -> (f64, DVector<f64>) {
        let r = &self.a * x - &self.b;
        (0.5 * r.norm_squared(), self.a.transpose() * r)
    }

    fn cut(&self, x: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(x.len(), |j, _| x[j].max(self.lower[j]).min(self.upper[j]))
    }

    /// A without the columns of variables that bounds fix at the start.
    fn free_columns(&self) -> DMatrix<f64> {
        let (_, gradient) = self.at(&self.start);
        let mut free = self.a.clone();
        for j in 0..free.ncols() {
            let (x, g) = (self.start[j], gradient[j]);
            let held = self.lower[j] >= self.upper[j]
                || (x <= self.lower[j] && g > 0.0)
                || (x >= self.upper[j] && g < 0.0);
            if held {
                free.column_mut(j).fill(0.0);
            }
        }
        free
    }

    /// Iterates at the start and after one and two steps, with the damping of each.
    fn steps(&mut self, method: &dyn AnyMethod) -> Vec<(DVector<f64>, f64)> {
        let mut seen = Vec::new();
        let mut watch = |step: &Iteration<'_>| {
            seen.push((DVector::from_column_slice(step.x), step.control));
            ControlFlow::Continue(())
        };
        let stopping = Stopping::default().with_max_iterations(2);
        let start = self.start.clone();
        let mut memory = SolverState::default();
        minimise(
            self,
            method,
            start.as_slice(),
            &stopping,
            &mut watch,
            &mut memory,
        )
        .unwrap();
        seen
    }

    /// Backtracking along the projected path, and the accepted step fraction.
    fn halved(
        &self,
        from: &DVector<f64>,
        step: &DVector<f64>,
        mut share: f64,
    ) -> (DVector<f64>, f64) {
        let (cost, gradient) = self.at(from);
        loop {
            let to = self.cut(&(from + step * share));
            let promised = gradient.dot(&(&to - from));
            if promised < 0.0 && self.at(&to).0 <= cost + 1e-4 * promised {
                return (to, share);
            }
            share *= 0.5;
        }
    }
}

fn problems() -> Vec<Linear> {
    let mut random = Random::new(7);
    let shapes = [(3, 6), (6, 6), (9, 5), (5, 9), (2, 4), (8, 8)];
    let mut all: Vec<Linear> = Vec::new();
    for (rows, columns) in shapes {
        all.push(Linear::random(&mut random, rows, columns));
        all.push(Linear::random(&mut random, rows, columns).level());
    }
    all
}

fn assert_close(a: &DVector<f64>, b: &DVector<f64>, what: &str) {
    let apart = (a - b).amax();
    assert!(apart < 1e-9 * (1.0 + b.amax()), "{what}: {apart:e}\n{a}{b}");
}

#[test]
fn levenberg_marquardt_step_follows_the_formula() {
    for (k, mut problem) in problems().into_iter().enumerate() {
        let (cost, gradient) = problem.at(&problem.start);
        let free = problem.free_columns();
        let largest = problem
            .a
            .column_iter()
            .map(|c| c.norm_squared())
            .fold(0.0, f64::max);
        for (rule, damping) in [
            (Damping::GainRatio, 1e-3 * largest),
            (Damping::ErrorProportional, 0.1 * cost),
        ] {
            let steps = problem.steps(&LevenbergMarquardt::new(rule));
            assert!(
                (steps[0].1 - damping).abs() <= 1e-12 * damping,
                "{k} {rule:?}"
            );
            let mut normal = free.transpose() * &free;
            for j in 0..normal.ncols() {
                normal[(j, j)] += damping;
            }
            let slope = DVector::from_fn(gradient.len(), |j, _| {
                free.column(j)
                    .dot(&(&problem.a * &problem.start - &problem.b))
            });
            let full = &problem.start - normal.lu().solve(&slope).unwrap();
            let to = problem.cut(&full);
            if problem.at(&to).0 < cost {
                assert_close(&steps[1].0, &to, &format!("{k} {rule:?}"));
            } else {
                assert_eq!(steps[1].0, problem.start, "{k} {rule:?}");
            }
        }
    }
}

#[test]
fn gauss_newton_takes_the_minimum_norm_step() {
    for (k, mut problem) in problems().into_iter().enumerate() {
        let free = problem.free_columns();
        let residual = &problem.a * &problem.start - &problem.b;
        let step = -free.svd(true, true).solve(&residual, 1e-7).unwrap();
        let (expected, share) =
            problem.halved(&problem.start, &step, (10.0 / step.amax()).min(1.0));
        let steps = problem.steps(&GaussNewton::default());
        assert_close(&steps[1].0, &expected, &format!("{k}"));
        assert_eq!(steps[1].1, share);
    }
}

/// The threshold for a zero column is relative to the longest column, whatever the unit of the residual.
#[test]
fn residual_unit_does_not_change_the_step() {
    for (k, mut problem) in problems().into_iter().enumerate() {
        let usual = problem.steps(&GaussNewton::default());
        let unit = 0.5_f64.powi(60);
        problem.a *= unit;
        problem.b *= unit;
        let small = problem.steps(&GaussNewton::default());
        assert_eq!(small[1].0, usual[1].0, "{k}");
    }
}

#[test]
fn projected_gradient_steps_follow_the_formula() {
    for (k, mut problem) in problems().into_iter().enumerate() {
        let (_, gradient) = problem.at(&problem.start);
        let steps = problem.steps(&ProjectedGradient::new(FirstStep::Fixed(10_000.0)));
        let (expected, share) = problem.halved(&problem.start, &-&gradient, 10_000.0);
        assert_close(&steps[1].0, &expected, &format!("{k} fixed"));
        assert_eq!(steps[1].1, share);

        let steps = problem.steps(&ProjectedGradient::new(FirstStep::BarzilaiBorwein));
        let largest = problem
            .a
            .column_iter()
            .map(|c| c.norm_squared())
            .fold(0.0, f64::max);
        let (expected, _) = problem.halved(&problem.start, &-&gradient, 1.0 / largest);
        assert_close(&steps[1].0, &expected, &format!("{k} spectral, first"));
        let (cost, next) = problem.at(&expected);
        let (moved, turned) = (&expected - &problem.start, &next - &gradient);
        let spectral = moved.norm_squared() / moved.dot(&turned);
        let to = problem.cut(&(&expected - &next * spectral));
        // A spectral step may increase the cost, but not above the initial cost.
        let bound = problem.at(&problem.start).0;
        if problem.at(&to).0 <= bound.min(bound + 1e-4 * next.dot(&(&to - &expected))) {
            assert_close(
                &steps[2].0,
                &to,
                &format!("{k} spectral, second, from {cost}"),
            );
        }
    }
}

/// Spectral steps may increase the cost, but never above the largest of the last ten.
#[test]
fn spectral_steps_stay_below_the_last_ten() {
    let lengths = [1.0, 2.0, 5.0, 13.0, 41.0, 100.0];
    let n = lengths.len();
    let mut problem = Linear {
        a: DMatrix::from_diagonal(&DVector::from_column_slice(&lengths)),
        b: DVector::zeros(n),
        lower: vec![f64::NEG_INFINITY; n],
        upper: vec![f64::INFINITY; n],
        start: DVector::from_fn(n, |j, _| 1.0 + 0.1 * j as f64),
    };
    let mut costs: Vec<f64> = Vec::new();
    let mut watch = |step: &Iteration<'_>| {
        costs.push(step.cost);
        ControlFlow::Continue(())
    };
    let start = problem.start.clone();
    minimise(
        &mut problem,
        &ProjectedGradient::new(FirstStep::BarzilaiBorwein),
        start.as_slice(),
        &Stopping::default(),
        &mut watch,
        &mut SolverState::default(),
    )
    .unwrap();
    let climbed = costs.windows(2).filter(|pair| pair[1] > pair[0]).count();
    assert!(costs.len() > 20 && climbed > 3, "{}", costs.len());
    for step in 1..costs.len() {
        let last = &costs[step.saturating_sub(10)..step];
        let worst = last.iter().copied().fold(0.0, f64::max);
        assert!(costs[step] < worst, "{step}: {} {worst}", costs[step]);
    }
}

/// Linear problem of separable rows: each step's normal equations contain the variables that are free at the time. Few
/// steps reach a point at which no feasible change lowers the cost.
#[test]
fn separable_rows_follow_the_free_variables() {
    let mut random = Random::new(71);
    let mut released = 0;
    for case in 0..60 {
        // Four rows for each group of three variables, and four rows for all variables.
        let (rows, n) = (12, 8);
        let a = DMatrix::from_fn(rows, n, |row, column| {
            let inside = row / 4 == 2 || column >= 6 || row / 4 == column / 3;
            random.within(-1.0, 1.0) * f64::from(u8::from(inside))
        });
        let b = DVector::from_fn(rows, |_, _| random.within(-1.0, 1.0));
        let [lower, upper] = [-0.3, 0.3].map(|bound| vec![bound; n]);
        let start = DVector::from_fn(n, |_, _| [-0.3, 0.0, 0.3][random.below(3)]);
        let mut problem = Linear {
            a,
            b,
            lower,
            upper,
            start,
        };
        let start = problem.start.clone();
        let held = |problem: &Linear, x: &DVector<f64>| -> Vec<bool> {
            let (_, gradient) = problem.at(x);
            let down = x - gradient;
            let cut = problem.cut(&down);
            (0..n).map(|j| cut[j] == x[j]).collect()
        };
        let mut state = SolverState::default();
        let method = LevenbergMarquardt::default();
        let stopping = Stopping::default().with_gradient_tolerance(1e-10);
        let ended = minimise(
            &mut problem,
            &method,
            start.as_slice(),
            &stopping,
            &mut kinopt::solver::Silent,
            &mut state,
        );
        let iterations = ended.unwrap().iterations;
        let x = DVector::from_column_slice(state.x());
        let (_, gradient) = problem.at(&x);
        let deviation = (problem.cut(&(&x - gradient)) - &x).amax();
        let (first, last) = (held(&problem, &start), held(&problem, &x));
        released += usize::from(first.iter().zip(&last).any(|(a, b)| *a && !b));
        assert!(
            iterations < 30 && deviation < 1e-7,
            "{case}: {iterations} {deviation:e}"
        );
    }
    assert!(released >= 10, "{released}");
}
