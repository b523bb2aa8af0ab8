//! Names of the tasks of a query.

/// A task of a query, in the order of the solution's tasks.
#[derive(Clone, Debug)]
pub(super) struct TaskName {
    /// The frame as it was typed; for a held tip the bone's name.
    pub(super) frame: String,
    /// A pinned tip that is kept where it was, rather than something asked for.
    pub(super) held: bool,
}
