//! Failures of a command.

use std::fmt::Display;

/// A [`Failure`] for a reason that is put together as `format!` does.
macro_rules! failure {
    ($($reason:tt)+) => { $crate::failure::Failure::new(format_args!($($reason)+)) };
}

/// As `failure!`, of options that do not go together.
macro_rules! usage {
    ($($reason:tt)+) => { $crate::failure::Failure::usage(format_args!($($reason)+)) };
}

/// What ends a command early.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A reason for people, in one line.
    Reason(String),
    /// Options that do not go together for this model, in one line.
    Usage(String),
    /// What --fail-on-miss says to scripts, in one line.
    Missed(String),
    /// What check says to scripts, in one line.
    Touching(String),
    /// Whoever reads the output has gone: nobody is left to read.
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

/// Every error of the library names the thing and the valid names already.
impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::new(error)
    }
}
