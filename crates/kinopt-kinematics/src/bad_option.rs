//! Error for an option out of its range, common to all engines.

/// An option whose value is out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("option {option} is {value}, allowed: {allowed}")]
pub struct BadOption {
    /// The name of the option.
    pub option: &'static str,
    /// The given value.
    pub value: f64,
    /// The allowed values, in words.
    pub allowed: &'static str,
}

/// The test of an option's value, and the allowed values in words.
#[doc(hidden)]
pub type Range = (fn(f64) -> bool, &'static str);

#[doc(hidden)]
pub const POSITIVE: Range = (|v| v > 0.0 && v.is_finite(), "a positive finite number");
#[doc(hidden)]
pub const NOT_NEGATIVE: Range = (
    |v| v >= 0.0 && v.is_finite(),
    "a finite number of at least 0",
);
/// A limit of a rate.
#[doc(hidden)]
pub const ABOVE_0: Range = (|v| v > 0.0, "a number above 0 (infinity for none)");
#[doc(hidden)]
pub const AT_LEAST_0: Range = (|v| v >= 0.0, "a number of at least 0");
#[doc(hidden)]
pub const AT_LEAST_ONE: Range = (|v| v >= 1.0, "at least 1");

impl BadOption {
    /// Returns an error for a value that is out of its range.
    #[doc(hidden)]
    pub fn check(option: &'static str, value: f64, range: Range) -> Result<(), Self> {
        let (is_allowed, allowed) = range;
        match is_allowed(value) {
            true => Ok(()),
            false => Err(Self {
                option,
                value,
                allowed,
            }),
        }
    }
}
