//! Consecutive samples of a trajectory.

/// Consecutive samples, the first of which only contribute to differences.
#[derive(Clone, Copy, Debug)]
pub(super) struct SampleSpan {
    /// Index of the first sample in the trajectory.
    pub(super) first: usize,
    /// Number of leading samples that stay fixed.
    pub(super) fixed_count: usize,
}
