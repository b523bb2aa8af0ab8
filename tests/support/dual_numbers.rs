//! Dual numbers of the library and of num-dual under one trait, so that one test checks both.

use kinopt::Scalar;
use kinopt::nalgebra::{Const, SVector, U1};
use kinopt::num_dual::{Derivative, DualSVec64};
use kinopt::scalar::Dual;

/// A scalar with derivatives along `N` directions.
pub trait DualNumber<const N: usize>: Scalar<Mask = bool> {
    fn with_derivatives(value: f64, derivatives: [f64; N]) -> Self;

    /// Derivative 1 along `direction`, 0 along all other directions.
    fn variable(value: f64, direction: usize) -> Self;

    fn value(&self) -> f64;

    fn derivatives(&self) -> [f64; N];
}

impl<const N: usize> DualNumber<N> for Dual<N> {
    fn with_derivatives(value: f64, derivatives: [f64; N]) -> Self {
        Dual::new(value, derivatives)
    }

    fn variable(value: f64, direction: usize) -> Self {
        Dual::variable(value, direction)
    }

    fn value(&self) -> f64 {
        Dual::value(self)
    }

    fn derivatives(&self) -> [f64; N] {
        Dual::derivatives(self)
    }
}

impl<const N: usize> DualNumber<N> for DualSVec64<N> {
    fn with_derivatives(value: f64, derivatives: [f64; N]) -> Self {
        DualSVec64::new(value, Derivative::some(SVector::from(derivatives)))
    }

    fn variable(value: f64, direction: usize) -> Self {
        DualSVec64::from_re(value).derivative(direction)
    }

    fn value(&self) -> f64 {
        self.re
    }

    fn derivatives(&self) -> [f64; N] {
        self.eps.unwrap_generic(Const::<N>, U1).into()
    }
}
