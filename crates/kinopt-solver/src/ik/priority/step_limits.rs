//! Iteration limits of descents.

/// Iterations of soft tasks.
const SOFT_TASK_STEPS: usize = 60;
/// Iterations of soft tasks below an unreached level; fewer, because each computes a curvature.
const SOFT_TASK_STEPS_BELOW_UNREACHED: usize = 15;
/// Iterations of soft tasks in a frame of a drag.
const SOFT_TASK_STEPS_PER_FRAME: usize = 2;
/// Largest number of search iterations in a frame after which soft tasks below an unreached level act.
const MAX_SEARCH_ITERATIONS_AT_REST: usize = 3;
/// Iterations of a level of required tasks.
const LEVEL_STEPS: usize = 100;
/// Iterations of a level of required tasks in a frame of a drag.
const LEVEL_STEPS_PER_FRAME: usize = 8;
/// Maximum number of halvings of a step that does not decrease the cost.
const HALVINGS: usize = 6;

/// Maximum number of steps, and of halvings of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepLimits {
    pub(super) steps: usize,
    pub(super) halvings: usize,
}

/// Effort spent on levels below the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::ik) enum Extent {
    /// Until convergence.
    Whole,
    /// The limits of one frame; the following frames continue.
    Frame,
    /// The limits of one frame for required tasks, and none for soft tasks.
    Goals,
    /// None: only reaching all required tasks together counts.
    Attempt,
}

impl Extent {
    /// Returns the iteration limits of soft tasks; `reached`: whether the required tasks are reached.
    pub(super) fn soft_task_steps(self, reached: bool) -> StepLimits {
        let (steps, halvings) = match (self, reached) {
            (Self::Whole, true) => (SOFT_TASK_STEPS, HALVINGS),
            (Self::Whole, false) => (SOFT_TASK_STEPS_BELOW_UNREACHED, HALVINGS),
            (Self::Frame, true) => (SOFT_TASK_STEPS_PER_FRAME, HALVINGS),
            (Self::Frame, false) => (1, 1),
            (Self::Goals | Self::Attempt, _) => (0, 0),
        };
        StepLimits { steps, halvings }
    }

    /// Returns the iteration limits of a level of required tasks.
    pub(super) fn level_steps(self) -> StepLimits {
        let steps = match self {
            Self::Whole => LEVEL_STEPS,
            Self::Frame | Self::Goals | Self::Attempt => LEVEL_STEPS_PER_FRAME,
        };
        StepLimits {
            steps,
            halvings: HALVINGS,
        }
    }

    /// Returns whether the descent of levels continues from the start of the solve unless their search found better.
    ///
    /// The results of frames with a limited number of iterations would otherwise alternate between local minima.
    pub(super) fn continues_from_start(self) -> bool {
        matches!(self, Self::Frame | Self::Goals)
    }

    /// Returns whether soft tasks act after a search of `iterations` iterations.
    ///
    /// They wait while a drag still moves towards an unreached target, because each of their steps computes a curvature
    /// there.
    pub(super) fn runs_soft_tasks(self, reached: bool, iterations: usize) -> bool {
        match self {
            Self::Whole => true,
            Self::Frame => reached || iterations <= MAX_SEARCH_ITERATIONS_AT_REST,
            Self::Goals | Self::Attempt => false,
        }
    }
}
