//! Least-squares problems with known minima (Moré, Garbow & Hillstrom 1981, "Testing unconstrained optimization
//! software"). Costs here are half of the sums of squares in that paper.

use kinopt::Scalar;
use kinopt::scalar::Dual;
use kinopt::solver::LeastSquares;
use nalgebra::{DMatrix, DVector};

/// Function r(x), generic over the scalar type.
pub trait Function {
    fn variables(&self) -> usize;
    fn rows(&self) -> usize;
    fn evaluate<S: Scalar>(&self, x: &[S], r: &mut [S]);
}

/// Function with bounds. It panics when it is evaluated outside of them.
pub struct Bounded<F> {
    pub function: F,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

impl<F: Function> Bounded<F> {
    pub fn free(function: F) -> Self {
        let n = function.variables();
        Self::within(
            function,
            &vec![f64::NEG_INFINITY; n],
            &vec![f64::INFINITY; n],
        )
    }

    pub fn within(function: F, lower: &[f64], upper: &[f64]) -> Self {
        Self {
            function,
            lower: lower.to_vec(),
            upper: upper.to_vec(),
        }
    }
}

impl<F: Function> LeastSquares for Bounded<F> {
    fn variables(&self) -> usize {
        self.function.variables()
    }

    fn rows(&self) -> usize {
        self.function.rows()
    }

    fn lower(&self) -> &[f64] {
        &self.lower
    }

    fn upper(&self) -> &[f64] {
        &self.upper
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        for (v, (l, u)) in x.iter().zip(self.lower.iter().zip(&self.upper)) {
            assert!(l <= v && v <= u, "asked at {v}, outside [{l}, {u}]");
        }
        self.function.evaluate(x, residual);
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        let mut r = vec![Dual::<1>::zero(); self.rows()];
        for k in 0..x.len() {
            let at: Vec<Dual<1>> = (0..x.len())
                .map(|j| Dual::new(x[j], [if j == k { 1.0 } else { 0.0 }]))
                .collect();
            self.function.evaluate(&at, &mut r);
            for (row, value) in r.iter().enumerate() {
                jacobian[(row, k)] = value.derivatives()[0];
            }
        }
    }
}

pub struct Linear {
    pub matrix: DMatrix<f64>,
    pub right_side: DVector<f64>,
}

impl Function for Linear {
    fn variables(&self) -> usize {
        self.matrix.ncols()
    }

    fn rows(&self) -> usize {
        self.matrix.nrows()
    }

    fn evaluate<S: Scalar>(&self, x: &[S], r: &mut [S]) {
        for (i, row) in r.iter_mut().enumerate() {
            *row = S::constant(-self.right_side[i]);
            for (j, &value) in x.iter().enumerate() {
                *row += S::constant(self.matrix[(i, j)]) * value;
            }
        }
    }
}

macro_rules! function {
    ($(#[$doc:meta])* $name:ident, $n:literal, $m:literal, |$x:ident, $r:ident, $c:ident| $body:block) => {
        $(#[$doc])*
        pub struct $name;

        impl Function for $name {
            fn variables(&self) -> usize {
                $n
            }

            fn rows(&self) -> usize {
                $m
            }

            fn evaluate<S: Scalar>(&self, $x: &[S], $r: &mut [S]) {
                let $c = S::constant;
                $body
            }
        }
    };
}

function!(
    /// From (−1.2, 1) to 0 at (1, 1).
    Rosenbrock, 2, 2, |x, r, c| {
        r[0] = c(10.0) * (x[1] - x[0] * x[0]);
        r[1] = c(1.0) - x[0];
    }
);
function!(
    /// From (3, −1, 0, 1) to 0 at the origin, where J has rank two.
    PowellSingular, 4, 4, |x, r, c| {
        r[0] = x[0] + c(10.0) * x[1];
        r[1] = c(5.0_f64.sqrt()) * (x[2] - x[3]);
        let bent = x[1] - c(2.0) * x[2];
        r[2] = bent * bent;
        let wide = x[0] - x[3];
        r[3] = c(10.0_f64.sqrt()) * wide * wide;
    }
);
function!(
    /// From (1, 1) to 0 at (3, ½).
    Beale, 2, 3, |x, r, c| {
        let mut power = c(1.0);
        for (row, y) in r.iter_mut().zip([1.5, 2.25, 2.625]) {
            power *= x[1];
            *row = c(y) - x[0] * (c(1.0) - power);
        }
    }
);
function!(
    /// From (−3, −1, −3, −1) to 0 at (1, 1, 1, 1).
    Wood, 4, 6, |x, r, c| {
        r[0] = c(10.0) * (x[1] - x[0] * x[0]);
        r[1] = c(1.0) - x[0];
        r[2] = c(90.0_f64.sqrt()) * (x[3] - x[2] * x[2]);
        r[3] = c(1.0) - x[2];
        r[4] = c(10.0_f64.sqrt()) * (x[1] + x[3] - c(2.0));
        r[5] = (x[1] - x[3]) * c(10.0_f64.sqrt().recip());
    }
);
function!(
    /// From (25, 5, −5, −1) to 85822.20162635628 / 2.
    BrownDennis, 4, 20, |x, r, c| {
        for (i, row) in r.iter_mut().enumerate() {
            let t = (i + 1) as f64 / 5.0;
            let a = x[0] + c(t) * x[1] - c(t.exp());
            let b = x[2] + c(t.sin()) * x[3] - c(t.cos());
            *row = a * a + b * b;
        }
    }
);
function!(
    /// From (1, 1, 1) to 8.214877306578963e-3 / 2.
    Bard, 3, 15, |x, r, c| {
        const Y: [f64; 15] = [
            0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39,
        ];
        for (i, row) in r.iter_mut().enumerate() {
            let (u, v) = ((i + 1) as f64, (15 - i) as f64);
            let w = u.min(v);
            *row = c(Y[i]) - (x[0] + c(u) / (c(v) * x[1] + c(w) * x[2]));
        }
    }
);
function!(
    /// One variable: x³ + x − 2, zero at 1.
    Cubic,
    1,
    1,
    |x, r, c| {
        r[0] = x[0] * x[0] * x[0] + x[0] - c(2.0);
    }
);
function!(
    /// Fewer rows than variables: a sphere and a plane, from anywhere off the axis.
    SphereAndPlane, 5, 2, |x, r, c| {
        r[0] = c(-4.0);
        for &value in x {
            r[0] += value * value;
        }
        r[1] = x[0] + x[1] - c(1.0);
    }
);
