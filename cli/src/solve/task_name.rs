//! Names of the tasks of a query.

/// Task of a query, in the order of the solution's tasks.
#[derive(Clone, Debug)]
pub(crate) struct TaskName {
    /// Frame as typed; for a held tip the name of its bone.
    pub(crate) frame: String,
    /// True for a held tip that keeps its pose; false for a target or task.
    pub(crate) held: bool,
}
