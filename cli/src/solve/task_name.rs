//! Names and default priority levels of the tasks of a query.

/// Task of a query, in the order of the solution's tasks.
#[derive(Clone, Debug)]
pub(crate) struct TaskName {
    /// Frame as typed; for a held tip the name of its bone.
    pub(crate) frame: String,
    /// True for a held tip that keeps its pose; false for a target or task.
    pub(crate) held: bool,
}

/// Level of all other required tasks if frames are held or balanced by name.
pub(crate) const GOALS: usize = 2;

/// Level of a task without --level.
#[derive(Clone, Copy, Debug)]
pub(crate) enum DefaultLevel {
    /// Level of the task file.
    Given(usize),
    /// Level if frames are held or balanced by name; otherwise 0.
    IfPrioritised(usize),
}
