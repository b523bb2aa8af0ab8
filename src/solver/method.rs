//! A solver is one step; everything around the step is shared.

use super::{LeastSquares, Memory};

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Step {
    /// x moved.
    Taken,
    /// x stays; the next step will be more careful.
    Refused,
    /// No acceptable step is left.
    Stuck,
}

/// One way to go from x to a better x.
pub trait Method: Send + Sync {
    /// The name used in files, messages and on the command line.
    fn name(&self) -> &'static str;

    /// Whether [`step`](Self::step) needs the Jacobian or only the gradient.
    fn needs_jacobian(&self) -> bool;

    /// Prepares the memory at the start of a search, after the first derivatives.
    fn begin(&self, memory: &mut Memory);

    /// Tries one step. The derivatives in `memory` are those at its x.
    fn step(&self, problem: &mut dyn LeastSquares, memory: &mut Memory) -> Step;
}
