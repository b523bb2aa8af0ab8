//! The four ways to a Jacobian.

/// How a problem's derivatives are found. All give the same numbers, to rounding for the exact
/// routes and to about 1e-7 (forward) or 1e-10 (central) for the differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Derivatives {
    /// The geometric Jacobian, and reverse mode for the gradient: exact, and the fastest by far.
    #[default]
    Analytic,
    /// The forward pass on dual numbers, six variables at a time: exact.
    Dual,
    /// (r(x + h) − r(x)) / h with h = √ε · max(1, |x|).
    ForwardDifference,
    /// (r(x + h) − r(x − h)) / 2h with h = ∛ε · max(1, |x|).
    CentralDifference,
}

impl Derivatives {
    /// All routes, in the order of their speed.
    pub const ALL: [Self; 4] = [
        Self::Analytic,
        Self::Dual,
        Self::ForwardDifference,
        Self::CentralDifference,
    ];
}
