//! How preferences stand to goals, and the shares of a problem that follow from it.

use std::ops::Range;

use super::CompiledTask;

/// What preferences may cost the goals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Preferences {
    /// Nothing. The goals are solved as if they were alone; then the preferences' ½ Σ ‖W r‖² falls as
    /// far as it can while every goal keeps the error that it came to. So it is on a miss too: the
    /// goals' nearest place first, the preferences among the configurations that are as near.
    ///
    /// A goal whose every tolerance is infinite is never missed, and pulls with the preferences.
    #[default]
    WithinGoals,
    /// Their weights' worth: the weighted sum of goals and preferences is minimised at once, so that
    /// a goal within reach is missed by a little or by much.
    Traded,
}

/// A part of a problem's tasks; [`CompiledTask`] says which bind and which pull.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Share {
    /// Every task.
    All,
    /// Those that bind: the goals that can be missed.
    Goals,
    /// All others: preferences, and goals for which any error will do.
    Pulls,
}

impl CompiledTask {
    /// Where the task's rows stand among those of a share, if it belongs to that.
    pub(crate) fn rows_in(&self, share: Share) -> Option<Range<usize>> {
        match share {
            Share::All => Some(self.rows.clone()),
            Share::Goals if self.binds => Some(self.rows_of_share.clone()),
            Share::Pulls if !self.binds => Some(self.rows_of_share.clone()),
            Share::Goals | Share::Pulls => None,
        }
    }
}
