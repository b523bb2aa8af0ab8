//! Options that change a problem.

use kinopt_bindings::problem_file::ProblemSettings;

/// Group of options that changes a problem.
pub(crate) trait ProblemOptions {
    /// Replaces values of the problem by those given; `degrees` is the unit of typed angles.
    fn add_to(&self, problem: &mut ProblemSettings, degrees: bool);
}

/// Replaces a value by a given one.
pub(crate) fn set<T: Clone>(value: &mut Option<T>, given: Option<&T>) {
    if given.is_some() {
        *value = given.cloned();
    }
}

/// Replaces a list by a given one that is not empty.
pub(crate) fn set_list<T>(list: &mut Vec<T>, given: impl ExactSizeIterator<Item = T>) {
    if given.len() > 0 {
        *list = given.collect();
    }
}
