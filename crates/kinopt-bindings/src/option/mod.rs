//! Options by name, with type, range, default and documentation.
//!
//! An option is one row of a table: [`arm`], [`path`], [`retarget`], [`robot`], [`servo`], [`solver`],
//! [`trajectory`]. Every interface
//! accepts, reads and documents it by that row.

pub mod arm;
pub mod path;
pub mod retarget;
pub mod robot;
pub mod servo;
pub mod solver;
pub mod trajectory;

use std::time::Duration;

use kinopt::Arm;
use kinopt::model::UnknownName;
use kinopt::spatial::Placement;
use kinopt::task::PoseBounds;

use crate::per_joint::{configuration, per_joint};
use crate::value::{Arguments, ErrorOf, OrRaise, Ranges, Value};

/// An option of `B`, the object that it is set on.
pub struct OptionSpec<B> {
    /// Name in snake case.
    pub name: &'static str,
    /// Type, with the function that sets a value.
    pub set: Setter<B>,
    /// Meaning, unit and range.
    pub doc: &'static str,
    /// Value of an option that is not given.
    pub default: &'static str,
}

/// Type of an option, with the function that sets a value.
pub enum Setter<B> {
    /// A boolean.
    Switch(fn(B, bool) -> B),
    /// A whole number from 0 to 2^32 - 1.
    Whole(fn(B, u32) -> B),
    /// A whole number from 0 to 2^64 - 1.
    LongWhole(fn(B, u64) -> B),
    /// A number.
    Number(fn(B, f64) -> B),
    /// A list of numbers.
    Numbers(fn(B, Vec<f64>) -> B),
    /// One number for each joint; one number counts for all joints, and joints that a map omits have the default.
    PerJoint(fn(B, Vec<f64>) -> B, Option<f64>),
    /// A configuration; joints that a map omits are at the default start.
    Configuration(fn(B, Vec<f64>) -> B),
    /// A time limit in seconds.
    TimeLimit(fn(B, Duration) -> B),
    /// A placement.
    Placement(fn(B, Placement<f64>) -> B),
    /// Goal bounds.
    PoseBounds(fn(B, PoseBounds) -> B),
    /// Numbers by the names of joints.
    ByJoint(fn(B, Vec<(String, f64)>) -> B),
    /// Lower and upper bounds by name.
    Ranges(fn(B, Ranges) -> B),
    /// A name of a value.
    Named(fn(B, &str) -> Result<B, UnknownName>),
    /// An object of the interface, or an option that is read with another one.
    Elsewhere,
}

impl<B> OptionSpec<B> {
    /// Documentation: name, meaning and default.
    #[must_use]
    pub fn documentation(&self) -> String {
        format!("{}: {} Default: {}.", self.name, self.doc, self.default)
    }
}

/// Joints of the object that options are set on.
pub struct Joints<'a> {
    /// Names of the joints.
    pub names: &'a [String],
    /// Default start configuration.
    pub start: &'a [f64],
}

impl Joints<'_> {
    /// Calls a function with the joints of an arm.
    pub fn of_arm<T>(arm: &Arm, call: impl FnOnce(&Joints<'_>) -> T) -> T {
        let names: Vec<String> = arm.joints().map(str::to_owned).collect();
        call(&Joints {
            names: &names,
            start: arm.default_start(),
        })
    }

    /// Applies all given options with numbers for each joint to `target`.
    ///
    /// # Errors
    /// If an option has another type, or names an unknown joint.
    pub fn apply<A: Arguments, B>(
        &self,
        arguments: &A,
        options: &[OptionSpec<B>],
        mut target: B,
    ) -> Result<B, ErrorOf<A>> {
        for option in options {
            let what = &A::Value::label(option.name);
            let (set, default) = match option.set {
                Setter::PerJoint(set, default) => (set, Some(default)),
                Setter::Configuration(set) => (set, None),
                _ => continue,
            };
            let Some(value) = arguments.get(option.name)? else {
                continue;
            };
            let numbers = match default {
                Some(default) => per_joint(&value, what, self.names, default)?,
                None => configuration(&value, what, self.names, self.start)?,
            };
            target = set(target, numbers);
        }
        Ok(target)
    }
}

/// Applies all given options of a table to `target`, except those with numbers for each joint: see [`Joints::apply`].
///
/// # Errors
/// If an option has another type, or names an unknown value.
pub fn apply<A: Arguments, B>(
    arguments: &A,
    options: &[OptionSpec<B>],
    mut target: B,
) -> Result<B, ErrorOf<A>> {
    for option in options {
        if let Some(value) = arguments.get(option.name)? {
            target = set(option, &value, target)?;
        }
    }
    Ok(target)
}

fn set<V: Value, B>(option: &OptionSpec<B>, value: &V, target: B) -> Result<B, V::Error> {
    let what = &V::label(option.name);
    Ok(match option.set {
        Setter::Switch(set) => set(target, value.switch(what)?),
        Setter::Whole(set) => {
            let whole = value.whole(what, u32::MAX.into())?;
            set(target, u32::try_from(whole).unwrap_or(u32::MAX))
        }
        Setter::LongWhole(set) => set(target, value.whole(what, u64::MAX)?),
        Setter::Number(set) => set(target, value.number(what)?),
        Setter::Numbers(set) => set(target, value.numbers(what)?),
        Setter::TimeLimit(set) => set(target, value.time_limit(what)?),
        Setter::Placement(set) => set(target, value.placement(what)?),
        Setter::PoseBounds(set) => set(target, value.pose_bounds(what)?),
        Setter::ByJoint(set) => {
            let keys = format!("a joint of {what}");
            set(target, value.numbers_by_name(what, &keys)?)
        }
        Setter::Ranges(set) => set(target, value.ranges(what)?),
        Setter::Named(set) => set(target, &value.word(what)?).or_raise::<V>()?,
        Setter::PerJoint(..) | Setter::Configuration(_) | Setter::Elsewhere => target,
    })
}

/// Names of a table, in its order.
#[must_use]
pub fn names<B>(options: &[OptionSpec<B>]) -> Vec<&'static str> {
    options.iter().map(|option| option.name).collect()
}

/// Documentation of a table, one option a line.
#[must_use]
pub fn documentation<B>(options: &[OptionSpec<B>]) -> String {
    let lines: Vec<String> = options.iter().map(OptionSpec::documentation).collect();
    lines.join("\n")
}

/// Checks the name of an option; `kind` describes it in the message.
///
/// # Errors
/// If the table has no option of this name.
pub fn check_name<B>(
    kind: &'static str,
    name: &str,
    options: &[OptionSpec<B>],
) -> Result<(), UnknownName> {
    match options.iter().any(|option| option.name == name) {
        true => Ok(()),
        false => Err(UnknownName::new(kind, name, names(options))),
    }
}
