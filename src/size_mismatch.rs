//! So many things where there must be so many others.

/// Two things came together that are not of one size: an armature and a pose, weights and a mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{given} {what} where there must be {expected}")]
#[non_exhaustive]
pub struct SizeMismatch {
    /// Bones, rest positions, …
    pub what: &'static str,
    /// How many were given.
    pub given: usize,
    /// How many there must be.
    pub expected: usize,
}

impl SizeMismatch {
    /// Checks one count.
    pub(crate) fn check(what: &'static str, given: usize, expected: usize) -> Result<(), Self> {
        if given == expected {
            return Ok(());
        }
        Err(Self {
            what,
            given,
            expected,
        })
    }
}
