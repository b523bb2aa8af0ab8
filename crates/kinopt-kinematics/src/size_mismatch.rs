//! Error for a wrong number of elements.

/// Two objects whose sizes do not match: an armature and a pose, weights and a mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{given} {what} given, expected {expected}")]
#[non_exhaustive]
pub struct SizeMismatch {
    /// Name of the elements: bones, rest positions, …
    pub what: &'static str,
    /// Given number.
    pub given: usize,
    /// Required number.
    pub expected: usize,
}

impl SizeMismatch {
    /// Returns an error if the numbers differ.
    #[doc(hidden)]
    pub fn check(what: &'static str, given: usize, expected: usize) -> Result<(), Self> {
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
