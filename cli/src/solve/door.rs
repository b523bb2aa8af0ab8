//! Who answers questions about one frame: the arm's front door or the general solvers.

use super::answer::{Answer, AskedTask, Path, Question};
use crate::failure::Outcome;

/// Answers one question after another, with memory that each thread has its own of.
pub(super) trait Door: Sync {
    /// The memory.
    type Desk;

    fn desk(&self) -> Outcome<Self::Desk>;

    /// Answers, and takes the time of that alone.
    fn answer(&self, desk: &mut Self::Desk, question: &Question) -> Outcome<Answer>;

    /// Answers questions each of which starts from the answer to the one before; the start of the
    /// first counts. `told` hears of every step.
    fn path(&self, questions: &[Question], told: &dyn Fn()) -> Outcome<Path>;

    /// Answers all questions together, on the threads of the current pool where `parallel`. Returns
    /// the microseconds that took.
    fn batch(&self, questions: &[Question], parallel: bool) -> Outcome<(Vec<Answer>, f64)>;

    /// The tasks behind every question.
    fn tasks(&self) -> Vec<AskedTask>;
}
