//! `--skinning`: skinning methods by name.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use kinopt::skinning::SkinningMethod;

/// Accepts the names that the ways to skin give themselves.
pub(crate) fn parser() -> impl TypedValueParser<Value = SkinningMethod> {
    let named = SkinningMethod::ALL.map(|method| {
        PossibleValue::new(method.name()).help(match method {
            SkinningMethod::DualQuaternion => "Dual quaternions, which keep twisted skin's volume",
            _ => "Linear blend, fastest",
        })
    });
    PossibleValuesParser::new(named).try_map(|name| name.parse::<SkinningMethod>())
}
