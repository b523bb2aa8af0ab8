//! Derivative methods.

/// The method for a problem's derivatives.
///
/// All methods give the same numbers: exact ones up to rounding, forward differences to about 1e-7, central differences
/// to about 1e-10.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Derivatives {
    /// The geometric Jacobian, and reverse mode for the gradient: exact, and much faster than all other methods.
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
    /// All methods, fastest first.
    pub const ALL: [Self; 4] = [
        Self::Analytic,
        Self::Dual,
        Self::ForwardDifference,
        Self::CentralDifference,
    ];
}
