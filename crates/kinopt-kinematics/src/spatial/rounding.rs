//! Rounding error of a placement at the end of a kinematic chain.

/// Bound on the rounding error of the end of a chain: (metres, radians).
///
/// - `joints`: number of joints in the chain.
/// - `angle_sum`: sum of the magnitudes of the joint angles, radians; large angles have coarse steps.
/// - `size`: sum of the magnitudes of all parts of the chain, metres; parts that cancel still leave their rounding.
///
/// Each product of placements rounds its rotation and translation once in a component and twice in a sum. This gives
/// two units of 2⁻⁵² for each joint, for the base and for the tool.
#[inline(always)]
#[doc(hidden)]
pub fn rounding(joints: usize, angle_sum: f64, size: f64) -> (f64, f64) {
    let radians = f64::EPSILON * (2.0 * (joints as f64 + 2.0) + angle_sum);
    (radians * size, radians)
}

/// The error to compare with a tolerance: `error + rounding` if only rounding could have put it within the tolerance.
#[inline(always)]
#[doc(hidden)]
pub fn resolved(error: f64, rounding: f64, tolerance: f64) -> f64 {
    if error <= tolerance && error + rounding > tolerance {
        error + rounding
    } else {
        error
    }
}
