//! Options with a fixed set of names for values of the library.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use kinopt::task::Axis;

/// Axes by letter.
pub(crate) const AXES: [(&str, Axis); 3] = [("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)];

/// Parser of the names of choices; returns the value of the given name.
pub(crate) fn among<const N: usize, T: Copy + Send + Sync + 'static>(
    choices: [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    let names = choices.map(|(name, _)| name);
    PossibleValuesParser::new(names).try_map(move |given| {
        let mut named = choices.iter().filter(|(name, _)| *name == given);
        let chosen = named.next().map(|(_, value)| *value);
        chosen.ok_or("unknown choice")
    })
}

/// First given option of several.
pub(crate) fn first_given<const N: usize>(
    options: [(&'static str, bool); N],
) -> Option<&'static str> {
    let mut given = options.into_iter().filter(|(_, given)| *given);
    given.next().map(|(option, _)| option)
}
