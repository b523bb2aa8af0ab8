//! Cones of the ball joints of a skeleton, by bone.

use std::f64::consts::PI;

use kinopt::model::{BallLimits, Limits, UnknownName};
use kinopt::skeleton::{BoneCone, Cones};
use kinopt::spatial::Vector3;

use crate::error::ErrorKind;
use crate::value::{OrRaise, Value};

/// Parts of a cone: radians, and directions in the axes of the bone.
const KEYS: [&str; 5] = ["swing", "twist", "angle", "axis", "about"];

/// Reads cones by bone. A cone has values by name: `swing`, a number or two with `about`; `twist`, a lower and an upper
/// bound; `angle`, `axis` and `about`. All angles are radians.
///
/// # Errors
/// If a part is unknown, or has another type or range.
pub fn cones<V: Value>(by_bone: Vec<(String, V)>) -> Result<Cones, V::Error> {
    let by_bone = by_bone.into_iter();
    by_bone
        .map(|(bone, cone)| {
            let cone = read_cone(&bone, &cone)?;
            Ok((bone, cone))
        })
        .collect()
}

fn read_cone<V: Value>(bone: &str, value: &V) -> Result<BoneCone, V::Error> {
    let parts = value.entries(&format!("the cone of {bone}"))?;
    for (key, _) in &parts {
        if !KEYS.contains(&key.as_str()) {
            return Err(UnknownName::new("key of a cone", key, KEYS)).or_raise::<V>();
        }
    }
    let invalid = |message: String| V::error(ErrorKind::InvalidValue, message);
    let part = |name: &str| parts.iter().find(|(key, _)| key == name);
    let vector = |name: &str| -> Result<Option<Vector3<f64>>, V::Error> {
        let given = part(name).filter(|(_, value)| !value.is_missing());
        let vector = given.map(|(_, value)| value.array::<3>(&format!("{name} of {bone}")));
        Ok(vector.transpose()?.map(Vector3::from))
    };
    let (axis, about) = (vector("axis")?, vector("about")?);
    let swing = match part("swing") {
        None => [PI; 2],
        Some((_, swing)) => match (swing.number("swing"), about) {
            (Ok(round), None) => [round; 2],
            (Ok(_), Some(_)) => {
                let problem = format!("about of {bone} is for a swing of two numbers");
                return Err(invalid(problem));
            }
            (Err(_), Some(_)) => swing.array::<2>(&format!("swing of {bone}"))?,
            (Err(_), None) => {
                let problem = format!("swing of {bone} must be a number, or two with `about`");
                return Err(invalid(problem));
            }
        },
    };
    let twist = match part("twist") {
        None => Limits::UNBOUNDED,
        Some((_, twist)) => {
            let problem = |_| invalid(format!("twist of {bone} must be (lower, upper)"));
            let [lower, upper] = twist.array("twist").map_err(problem)?;
            Limits::new(lower, upper)
        }
    };
    let mut limits = match about {
        Some(about) => BallLimits::elliptic(about, swing, twist),
        None => BallLimits::cone(swing[0], twist),
    };
    if let Some((_, angle)) = part("angle").filter(|(_, value)| !value.is_missing()) {
        let angle = angle.number(&format!("angle of {bone}"))?;
        // Range of the side file.
        if !(angle > 0.0 && angle <= PI) {
            return Err(invalid(format!(
                "angle of {bone} is {angle}, expected above 0 and at most pi"
            )));
        }
        limits.angle = Some(angle);
    }
    Ok(BoneCone { axis, limits })
}
