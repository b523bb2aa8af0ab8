//! Interpolation of keys, an extension of kinopt to the format. The default is Catmull-Rom.

use super::json::TrackEntry;
use crate::animation::EulerInterpolation;
use crate::curve::TensionContinuityBias;

const LINEAR: &str = EulerInterpolation::LINEAR;
const CATMULL_ROM: &str = EulerInterpolation::CATMULL_ROM;
const KOCHANEK_BARTELS: &str = EulerInterpolation::KOCHANEK_BARTELS;

/// Interpolation of a track, or the faulty key and its problem.
pub(super) fn read(track: &TrackEntry) -> Result<EulerInterpolation, (String, String)> {
    let name = track.interpolation.as_deref().unwrap_or(CATMULL_ROM);
    let interpolation = match name {
        LINEAR => EulerInterpolation::Linear,
        CATMULL_ROM => EulerInterpolation::CatmullRom,
        KOCHANEK_BARTELS => {
            let controls = (0..track.keys.len()).map(|key| controls(track, key));
            return Ok(EulerInterpolation::KochanekBartels(
                controls.collect::<Result<_, _>>()?,
            ));
        }
        other => {
            let problem = format!(
                "unknown interpolation `{other}`; valid: {LINEAR}, {CATMULL_ROM}, {KOCHANEK_BARTELS}"
            );
            return Err(("interpolation".into(), problem));
        }
    };
    match track.keys.iter().position(|key| key.tcb.is_some()) {
        None => Ok(interpolation),
        Some(key) => Err((
            format!("keys[{key}].tcb"),
            format!("is for the interpolation {KOCHANEK_BARTELS}, and this track's is {name}"),
        )),
    }
}

fn controls(track: &TrackEntry, key: usize) -> Result<TensionContinuityBias, (String, String)> {
    let given = track.keys.get(key).and_then(|key| key.tcb.as_deref());
    match given {
        None => Ok(TensionContinuityBias::default()),
        Some(&[tension, continuity, bias]) => Ok(TensionContinuityBias {
            tension,
            continuity,
            bias,
        }),
        Some(other) => Err((
            format!("keys[{key}].tcb"),
            format!("has {} numbers instead of 3", other.len()),
        )),
    }
}

/// Writes the name of the interpolation and the controls of the keys; nothing for Catmull-Rom.
pub(super) fn write(interpolation: &EulerInterpolation, track: &mut TrackEntry) {
    if *interpolation == EulerInterpolation::CatmullRom {
        return;
    }
    track.interpolation = Some(interpolation.name().into());
    if let EulerInterpolation::KochanekBartels(controls) = interpolation {
        for (key, c) in track.keys.iter_mut().zip(controls) {
            key.tcb = Some(vec![c.tension, c.continuity, c.bias]);
        }
    }
}
