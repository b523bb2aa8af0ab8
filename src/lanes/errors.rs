//! How far a tip is from its goal.

/// How far the tip is from its goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Errors {
    /// Metres.
    pub(crate) position: f64,
    /// Radians, 0 to π.
    pub(crate) orientation: f64,
}
