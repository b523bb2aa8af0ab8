//! How far descents go.

/// Steps of a preference, …
const STEPS: usize = 60;
/// … and below a miss, where each costs a curvature.
const STEPS_BELOW_A_MISS: usize = 15;
/// Steps of a preference in a frame of a drag, …
const STEPS_A_FRAME: usize = 2;
/// … which below a miss waits until the goals' own search takes no more steps than these.
const AT_REST: usize = 3;
/// Steps of a level's goals, …
const STEPS_OF_A_LEVEL: usize = 100;
/// … and in a frame of a drag.
const STEPS_OF_A_LEVEL_A_FRAME: usize = 8;
/// Halvings of a step that gains nothing.
const HALVINGS: usize = 6;

/// Steps at most, and halvings of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    pub(super) steps: usize,
    pub(super) halvings: usize,
}

/// How far what ranks below others goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::ik) enum Extent {
    /// To where nothing more is gained.
    Whole,
    /// A frame's share of it: the next ones go on.
    Frame,
    /// Nowhere for preferences, a frame's share for goals.
    Goals,
    /// Nowhere: only whether all goals are reached together counts.
    Attempt,
}

impl Extent {
    /// Steps of a preference, where the goals are reached or not.
    pub(super) fn of_preferences(self, reached: bool) -> Steps {
        let (steps, halvings) = match (self, reached) {
            (Self::Whole, true) => (STEPS, HALVINGS),
            (Self::Whole, false) => (STEPS_BELOW_A_MISS, HALVINGS),
            (Self::Frame, true) => (STEPS_A_FRAME, HALVINGS),
            (Self::Frame, false) => (1, 1),
            (Self::Goals | Self::Attempt, _) => (0, 0),
        };
        Steps { steps, halvings }
    }

    /// Steps of a level's goals.
    pub(super) fn of_levels(self) -> Steps {
        let steps = match self {
            Self::Whole => STEPS_OF_A_LEVEL,
            Self::Frame | Self::Goals | Self::Attempt => STEPS_OF_A_LEVEL_A_FRAME,
        };
        Steps {
            steps,
            halvings: HALVINGS,
        }
    }

    /// Whether levels that give way go on from where they began, unless their search found better: what frames of a drag are cut at
    /// is not found again by the next ones otherwise, and the body would go to and fro.
    pub(super) fn goes_on(self) -> bool {
        matches!(self, Self::Frame | Self::Goals)
    }

    /// Whether preferences make sense after a search of the goals that took so many steps. While a body still
    /// goes after a target that it misses, its posture can wait: a step there costs a curvature.
    pub(super) fn follows(self, reached: bool, iterations: usize) -> bool {
        match self {
            Self::Whole => true,
            Self::Frame => reached || iterations <= AT_REST,
            Self::Goals | Self::Attempt => false,
        }
    }
}
