//! `--skinning`: skinning methods by name.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use kinopt::skinning::SkinningMethod;

/// Parser of the names of skinning methods.
pub(crate) fn parser() -> impl TypedValueParser<Value = SkinningMethod> {
    let named = SkinningMethod::ALL.map(|method| {
        PossibleValue::new(method.name()).help(match method {
            SkinningMethod::DualQuaternion => "Dual quaternions, keep the volume of twisted skin",
            _ => "Linear blend, fastest",
        })
    });
    PossibleValuesParser::new(named).try_map(|name| name.parse::<SkinningMethod>())
}
