//! Treatment of soft tasks relative to required tasks.

/// The effect of soft tasks on required tasks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Preferences {
    /// No effect: soft tasks act in the null space of the required tasks.
    ///
    /// The required tasks are solved as if they were alone. Then ½ Σ ‖W r‖² of the soft tasks is minimised while every
    /// required task keeps its error, reached or not. A required task with only infinite tolerances is never unreached
    /// and is solved with the soft tasks.
    #[default]
    WithinGoals,
    /// Weighted: the sum of required and soft tasks is minimised at once.
    ///
    /// A reachable required task may then have an error. With several [levels](crate::task::Task::at_level), soft tasks
    /// are weighted against the last level.
    Traded,
}
