//! Tolerances of skin weights.

/// Largest deviation from 1 of the sum of a vertex's weights. Files with six digits and a dozen influences are within
/// it; weights that are not normalised are not.
pub const ROW_SUM_TOLERANCE: f64 = 1e-5;

/// Largest absolute value of a negative weight. Smooth weights of an optimiser undershoot by less; larger values move
/// skin visibly against its bone.
pub const NEGATIVE_TOLERANCE: f64 = 1e-2;
