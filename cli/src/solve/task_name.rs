//! Names of the tasks of a query.

/// Task of a query, in the order of the solution's tasks.
#[derive(Clone, Debug)]
pub(super) struct TaskName {
    /// Frame as typed; for a held tip the name of its bone.
    pub(super) frame: String,
    /// True for a held tip that keeps its pose; false for a target or task.
    pub(super) held: bool,
}
