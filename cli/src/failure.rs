//! Failures of a command.

use std::fmt::Display;

/// [`Failure`] with a reason from `format!` arguments.
macro_rules! failure {
    ($($reason:tt)+) => { $crate::failure::Failure::new(format_args!($($reason)+)) };
}

/// Usage error from `format!` arguments.
macro_rules! usage {
    ($($reason:tt)+) => { $crate::failure::Failure::usage(format_args!($($reason)+)) };
}

/// Failure that ends a command.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Reason in one line.
    Reason(String),
    /// Usage error of options for this model, in one line.
    Usage(String),
    /// Message of --fail-on-miss, in one line.
    Missed(String),
    /// Message of `check` about a collision, in one line.
    Touching(String),
    /// The reader of standard output has closed it.
    ReaderGone,
}

pub(crate) type Outcome<T> = Result<T, Failure>;

impl Failure {
    pub(crate) fn new(reason: impl Display) -> Self {
        // A file name may contain line breaks, but the reason stays on one line.
        Self::Reason(one_line(reason))
    }

    pub(crate) fn usage(reason: impl Display) -> Self {
        Self::Usage(one_line(reason))
    }
}

fn one_line(reason: impl Display) -> String {
    reason.to_string().replace(['\n', '\r'], " ")
}

/// Errors of the library name the object and the valid names.
impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::new(error)
    }
}
