//! An answer in terms of the whole model.

use kinopt::Solution;

/// What came out for one question.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    /// All moving joints of the model, in radians and metres.
    pub(super) q: Vec<f64>,
    /// Further answers where several distinct ones are wanted, nearest to the start first.
    pub(super) alternatives: Vec<Vec<f64>>,
    /// The truth about it; its own `q` may hold fewer joints.
    pub(super) solution: Solution,
    /// Time spent solving, in microseconds; none where it was solved together with others.
    pub(super) micros: Option<f64>,
}

/// A task of a question, in the order of the solution's tasks.
#[derive(Clone, Debug)]
pub(super) struct AskedTask {
    /// The frame as it was typed; for a held tip the bone's name.
    pub(super) frame: String,
    /// A pinned tip that is kept where it was, rather than something asked for.
    pub(super) held: bool,
}

/// A target of one frame, and where the search for it starts.
#[derive(Clone, Debug)]
pub(super) struct Question {
    /// Where the tip should stand in the base.
    pub(super) base_from_tip: kinopt::spatial::Placement<f64>,
    /// A configuration of the model within its limits.
    pub(super) start: Vec<f64>,
}
