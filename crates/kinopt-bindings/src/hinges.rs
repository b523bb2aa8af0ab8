//! Hinges of the bones of a skeleton, by bone.

use kinopt::model::{Limits, UnknownName};
use kinopt::skeleton::{Hinge, Hinges};
use kinopt::spatial::Vector3;

use crate::error::ErrorKind;
use crate::value::{OrRaise, Value};

/// Parts of a hinge, and parts of a guessed hinge that are ignored.
const KEYS: [&str; 4] = ["axis", "range", "rest_bend", "source"];

/// Reads hinges by bone. A hinge has values by name: `axis`, a direction in the axes of the bone, and `range`, a lower
/// and an upper bound in radians from rest. `rest_bend` and `source` of a guessed hinge are ignored.
///
/// # Errors
/// If a part is missing or unknown, or has another type.
pub fn hinges<V: Value>(by_bone: Vec<(String, V)>) -> Result<Hinges, V::Error> {
    let by_bone = by_bone.into_iter();
    by_bone
        .map(|(bone, hinge)| {
            let hinge = read_hinge(&bone, &hinge)?;
            Ok((bone, hinge))
        })
        .collect()
}

fn read_hinge<V: Value>(bone: &str, value: &V) -> Result<Hinge, V::Error> {
    let parts = value.entries(&format!("the hinge of {bone}"))?;
    for (key, _) in &parts {
        if !KEYS.iter().any(|known| V::label(known) == *key) {
            return Err(UnknownName::new("key of a hinge", key, KEYS)).or_raise::<V>();
        }
    }
    let part = |name: &str| {
        let part = parts.iter().find(|(key, _)| key == name);
        part.map(|(_, value)| value).ok_or_else(|| {
            V::error(
                ErrorKind::InvalidValue,
                format!("the hinge of {bone} has no {name}"),
            )
        })
    };
    let axis = part("axis")?.array::<3>(&format!("axis of {bone}"))?;
    let [lower, upper] = part("range")?.array::<2>(&format!("range of {bone}"))?;
    Ok(Hinge {
        axis: Vector3::from(axis),
        limits: Limits::new(lower, upper),
    })
}
