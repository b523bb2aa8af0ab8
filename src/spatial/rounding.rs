//! What is left of a placement's digits at the end of a chain.

/// How far rounding may put the end of a chain from where it truly stands: metres and radians. For so
/// many joints, whose angles have a sum of magnitudes `turned` (radians: a large angle has coarse
/// steps), over a way of length `size` (metres, every part counted with its magnitude, as parts that
/// cancel leave their rounding behind).
///
/// Each product of placements rounds its rotation and translation once in a component and twice in a
/// sum: two units of 2⁻⁵² a joint, the base and the tool.
#[inline(always)]
pub(crate) fn rounding(joints: usize, turned: f64, size: f64) -> (f64, f64) {
    let radians = f64::EPSILON * (2.0 * (joints as f64 + 2.0) + turned);
    (radians * size, radians)
}

/// An error that is to count: as it is, unless only rounding may have brought it below the tolerance.
#[inline(always)]
pub(crate) fn resolved(error: f64, rounding: f64, tolerance: f64) -> f64 {
    if error <= tolerance && error + rounding > tolerance {
        error + rounding
    } else {
        error
    }
}
