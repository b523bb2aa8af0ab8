//! Hinges of the bones of scenes and captures.

use kinopt::io::cones;
use kinopt::model::Limits;
use kinopt::motion::posing::guess_hinges;
use kinopt::skeleton::{Hinge, Hinges, Skeleton};
use kinopt_bindings::problem_file::{BoneHinges, HingeChoice, ModelSettings};

use crate::failure::Outcome;

/// A skeleton with the hinges of the settings. Bones with a cone get no guessed hinge.
///
/// # Errors
/// A file of cones that cannot be read, or hinges that do not match the bones.
pub(crate) fn applied(
    skeleton: Skeleton,
    settings: &ModelSettings,
    file: &str,
) -> Outcome<Skeleton> {
    let hinges = match &settings.hinges {
        Some(BoneHinges::Choice(HingeChoice::None)) => Hinges::new(),
        Some(BoneHinges::ByBone(by_bone)) => {
            let hinges = by_bone.iter().map(|(bone, hinge)| {
                let [lower, upper] = hinge.range.map(f64::to_radians);
                let limits = Limits::new(lower, upper);
                let axis = hinge.axis.into();
                (bone.clone(), Hinge { axis, limits })
            });
            hinges.collect()
        }
        None | Some(BoneHinges::Choice(HingeChoice::Guessed)) => {
            let cones = settings.cones.as_ref().map(cones::read).transpose()?;
            let cones = cones.unwrap_or_default();
            let guesses = guess_hinges(&skeleton).into_iter();
            let guesses = guesses.filter(|guess| !cones.contains_key(&guess.bone));
            guesses.map(|guess| (guess.bone, guess.hinge)).collect()
        }
    };
    if hinges.is_empty() {
        return Ok(skeleton);
    }
    let hinged = skeleton.with_hinges(&hinges);
    hinged.map_err(|error| failure!("{file}: {error}"))
}
