//! How preferences stand to goals.

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
    /// a goal within reach is missed by a little or by much. Of goals of several
    /// [levels](crate::task::Task::at_level) the last is traded.
    Traded,
}
