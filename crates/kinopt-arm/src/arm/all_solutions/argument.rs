//! Arguments for the completeness of solution sets.

/// Argument for the completeness of a solution set.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Argument {
    /// Closed form: the last three axes meet in a point.
    SphericalWrist,
    /// Closed form: the first three axes meet in a point.
    SphericalShoulder,
    /// Closed form: three successive inner axes are parallel.
    ThreeParallelAxes,
    /// All real roots of a polynomial of one joint, isolated by Descartes' rule of signs.
    UnivariatePolynomial {
        /// Largest deviation of the determinant from the polynomial, relative to the largest determinant.
        ///
        /// It measures rounding: about 1e-15 for a well-conditioned arm.
        deviation: f64,
    },
    /// None: the set may lack solutions.
    None,
}
