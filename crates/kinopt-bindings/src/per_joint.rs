//! Numbers of joints: a list, one number for all joints, or numbers by joint name.

use kinopt::Model;
use kinopt::model::UnknownName;

use crate::error::ErrorKind;
use crate::value::{OrRaise, Value};

/// Reads one number for each joint of `names`: a list, one number for all joints, or numbers by name.
///
/// A joint without a number has the `default`. The length of a list is not checked.
///
/// # Errors
/// If the value has another type, names an unknown joint, or omits a joint without a default.
pub fn per_joint<V: Value>(
    value: &V,
    what: &str,
    names: &[String],
    default: Option<f64>,
) -> Result<Vec<f64>, V::Error> {
    if let Some(number) = value.as_number() {
        return Ok(vec![number; names.len()]);
    }
    if !value.is_map() {
        return value.numbers(what);
    }
    let mut numbers = vec![default; names.len()];
    fill(value, what, names, |joint, number| {
        numbers[joint] = Some(number)
    })?;
    let numbers = numbers.into_iter().zip(names);
    let required = |(number, name): (Option<f64>, &String)| {
        let missing = || format!("{what} has no number for joint `{name}`: add it");
        number.ok_or_else(|| V::error(ErrorKind::InvalidValue, missing()))
    };
    numbers.map(required).collect()
}

/// Reads a configuration of the joints `names`: a list, or positions by name. Other joints keep the position of `start`.
///
/// # Errors
/// If the value has another type, or names an unknown joint.
pub fn configuration<V: Value>(
    value: &V,
    what: &str,
    names: &[String],
    start: &[f64],
) -> Result<Vec<f64>, V::Error> {
    if !value.is_map() {
        return value.numbers(what);
    }
    let mut q = start.to_vec();
    fill(value, what, names, |joint, position| {
        if let Some(q) = q.get_mut(joint) {
            *q = position;
        }
    })?;
    Ok(q)
}

fn fill<V: Value>(
    value: &V,
    what: &str,
    names: &[String],
    mut set: impl FnMut(usize, f64),
) -> Result<(), V::Error> {
    for (name, number) in value.numbers_by_name(what, &format!("a joint of {what}"))? {
        let joint = names.iter().position(|known| *known == name);
        let unknown = || UnknownName::new("joint", &name, names.iter().map(String::as_str));
        set(joint.ok_or_else(unknown).or_raise::<V>()?, number);
    }
    Ok(())
}

/// Reads a configuration of a model from positions by joint name. Other joints keep the position of `start`.
///
/// A ball joint has a quaternion w, x, y, z.
///
/// # Errors
/// If the value has another type, or names an unknown or fixed joint.
pub fn configuration_of<V: Value>(
    value: &V,
    what: &str,
    model: &Model,
    mut start: Vec<f64>,
) -> Result<Vec<f64>, V::Error> {
    for (name, position) in value.entries(what)? {
        let joint = model.joint(&name).or_raise::<V>()?;
        let count = model.joints()[joint.index()].kind.coordinates();
        let range = model.coordinate(joint).map(|first| first..first + count);
        let Some(numbers) = range.and_then(|range| start.get_mut(range)) else {
            let message = format!("{what}: joint `{name}` is fixed, remove it");
            return Err(V::error(ErrorKind::InvalidValue, message));
        };
        let what = format!("{what} of joint `{name}`");
        match numbers {
            [number] => *number = position.number(&what)?,
            numbers => numbers.copy_from_slice(&position.vector(&what, count)?),
        }
    }
    Ok(start)
}
