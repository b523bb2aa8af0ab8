//! Free, locked, coupled and narrowed joints.

use kinopt::Model;
use kinopt::model::{JointKind, Limits, ParameterMapBuilder};

use crate::error::ErrorKind;
use crate::value::{Arguments, ErrorOf, Value, joint_of};

/// Options that [`apply`] reads.
pub const OPTIONS: [&str; 3] = ["locked", "only", "held"];

/// Applies the options of free and locked joints: see [`lock`] and [`only`].
///
/// # Errors
/// If an option has another type, or names an unknown joint.
pub fn apply<'m, A: Arguments>(
    builder: ParameterMapBuilder<'m>,
    model: &Model,
    arguments: &A,
) -> Result<ParameterMapBuilder<'m>, ErrorOf<A>> {
    let locked = arguments.entries("locked")?;
    let names = arguments.get("only")?;
    let names = names.map(|names| names.names("only")).transpose()?;
    let held = arguments.get("held")?;
    let held = held.map(|held| held.numbers("held")).transpose()?;
    let builder = lock(builder, model, locked, |name| format!("locked.{name}"))?;
    only::<A::Value>(builder, model, names.as_deref(), ("held", held))
}

/// Locks joints at values, radians or metres; of a ball joint a quaternion w, x, y, z. `what` names a value in
/// messages.
///
/// # Errors
/// If the model has no joint of a name, or a value is no number.
pub fn lock<'m, V: Value>(
    mut builder: ParameterMapBuilder<'m>,
    model: &Model,
    locked: Vec<(String, V)>,
    what: impl Fn(&str) -> String,
) -> Result<ParameterMapBuilder<'m>, V::Error> {
    for (name, value) in locked {
        let (joint, what) = (joint_of::<V>(model, &name)?, what(&name));
        builder = match model.joints()[joint.index()].kind {
            JointKind::Ball => builder.with_locked_ball(joint, value.array(&what)?),
            _ => builder.with_locked(joint, value.number(&what)?),
        };
    }
    Ok(builder)
}

/// Narrows limits of joints.
///
/// # Errors
/// If the model has no joint of a name.
pub fn narrow<'m, V: Value>(
    mut builder: ParameterMapBuilder<'m>,
    model: &Model,
    narrowed: Vec<(String, Limits)>,
) -> Result<ParameterMapBuilder<'m>, V::Error> {
    for (name, limits) in narrowed {
        builder = builder.with_narrowed(joint_of::<V>(model, &name)?, limits);
    }
    Ok(builder)
}

/// Frees only the joints of these names. All others are locked at a configuration, by default the neutral one; `at`
/// is the name of that option.
///
/// # Errors
/// If the model has no joint of a name, or a configuration is given without names.
pub fn only<'m, V: Value>(
    builder: ParameterMapBuilder<'m>,
    model: &Model,
    names: Option<&[String]>,
    (at, configuration): (&str, Option<Vec<f64>>),
) -> Result<ParameterMapBuilder<'m>, V::Error> {
    match (names, configuration) {
        (Some(names), configuration) => {
            let free = names.iter().map(|name| joint_of::<V>(model, name));
            let free = free.collect::<Result<Vec<_>, _>>()?;
            let q = configuration.unwrap_or_else(|| model.neutral());
            Ok(builder.with_only(&free, &q))
        }
        (None, Some(_)) => Err(V::error(
            ErrorKind::InvalidValue,
            format!("{at} needs `only`: it is the configuration of the joints that `only` omits"),
        )),
        (None, None) => Ok(builder),
    }
}
