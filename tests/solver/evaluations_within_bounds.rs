//! Promise: solvers evaluate a problem only within its bounds, also for trial steps and finite differences. The
//! reported evaluation counts are exact.

use kinopt::solver::{Counts, LeastSquares, Silent, SolverState, Stopping, minimise};
use nalgebra::DMatrix;
use support::methods::methods;

/// Function of Brown and Dennis (Moré, Garbow & Hillstrom 1981, number 16), whose large residual slows convergence. A
/// fifth variable without influence has a range of 1e-9. The function is undefined outside its bounds.
struct Narrow {
    lower: [f64; 5],
    upper: [f64; 5],
    evaluations: usize,
    counts: Counts,
}

impl Narrow {
    fn enter(&mut self, x: &[f64]) {
        let bounds = self.lower.iter().zip(&self.upper);
        for (x, (lower, upper)) in x.iter().zip(bounds) {
            assert!(
                lower <= x && x <= upper,
                "{x} is not within {lower} and {upper}"
            );
        }
        self.evaluations += 1;
    }

    fn parts(x: &[f64], row: usize) -> (f64, [f64; 2]) {
        let t = 0.2 * (row + 1) as f64;
        (
            t,
            [x[0] + t * x[1] - t.exp(), x[2] + x[3] * t.sin() - t.cos()],
        )
    }
}

impl LeastSquares for Narrow {
    fn variables(&self) -> usize {
        5
    }

    fn rows(&self) -> usize {
        20
    }

    fn lower(&self) -> &[f64] {
        &self.lower
    }

    fn upper(&self) -> &[f64] {
        &self.upper
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        self.enter(x);
        self.counts.residuals += 1;
        for (row, value) in residual.iter_mut().enumerate() {
            let (_, [a, b]) = Self::parts(x, row);
            *value = a * a + b * b;
        }
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.enter(x);
        self.counts.jacobians += 1;
        for row in 0..20 {
            let (t, [a, b]) = Self::parts(x, row);
            let slopes = [2.0 * a, 2.0 * a * t, 2.0 * b, 2.0 * b * t.sin(), 0.0];
            for (column, slope) in slopes.into_iter().enumerate() {
                jacobian[(row, column)] = slope;
            }
        }
    }

    fn gradient(
        &mut self,
        x: &[f64],
        residual: &[f64],
        gradient: &mut [f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        self.jacobian(x, jacobian);
        self.counts.jacobians -= 1;
        self.counts.gradients += 1;
        for (slope, column) in gradient.iter_mut().zip(jacobian.column_iter()) {
            *slope = column.iter().zip(residual).map(|(j, r)| j * r).sum();
        }
    }
}

#[test]
fn evaluations_stay_within_problem_bounds() {
    const BOUND_WIDTH: f64 = 1e-9;
    // Near the lower and near the upper bound.
    for at in [0.2, 0.8] {
        let mut differences = 0;
        for method in methods() {
            let mut problem = Narrow {
                lower: [-50.0, -50.0, -50.0, -50.0, 0.2],
                upper: [50.0, 50.0, 50.0, 50.0, 0.2 + BOUND_WIDTH],
                evaluations: 0,
                counts: Counts::default(),
            };
            let start = [25.0, 5.0, -5.0, -1.0, 0.2 + at * BOUND_WIDTH];
            let mut memory = SolverState::default();
            let stopping = Stopping::default();
            minimise(
                &mut problem,
                &*method,
                &start,
                &stopping,
                &mut Silent,
                &mut memory,
            )
            .unwrap();
            let counts = memory.counts();
            // The reported counts are the actual ones, except for residuals that a difference of gradients needs.
            let Counts {
                residuals,
                jacobians,
                gradients,
                ..
            } = problem.counts;
            assert_eq!(counts.jacobians, jacobians, "{}", method.name());
            assert_eq!(counts.gradients, gradients, "{}", method.name());
            assert!((counts.residuals..=counts.residuals + gradients).contains(&residuals));
            assert!(
                problem.evaluations > 10 && memory.cost() < 1e5,
                "{}",
                method.name()
            );
            // A method with a Jacobian requests gradients only for finite differences.
            differences += usize::from(counts.jacobians > 5 && counts.gradients > 5);
        }
        assert!(
            differences > 0,
            "no search took its curvature from differences"
        );
    }
}
