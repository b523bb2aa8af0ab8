//! `--interpolation`: interpolation between keyframes of a rig.

use kinopt::animation::curve::TensionContinuityBias;
use kinopt::animation::{EulerInterpolation, EulerTrack, Playback};
use kinopt_bindings::problem_file::number_list;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;

/// Interpolation of all tracks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum InterpolationChoice {
    Linear,
    CatmullRom,
    KochanekBartels(TensionContinuityBias),
}

impl InterpolationChoice {
    /// Parses `linear`, `catmull-rom` or `kochanek-bartels[:T,C,B]`.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let (name, numbers) = match text.split_once(':') {
            Some((name, numbers)) => (name, Some(numbers)),
            None => (text, None),
        };
        match (name, numbers) {
            ("linear", None) => Ok(Self::Linear),
            ("catmull-rom", None) => Ok(Self::CatmullRom),
            ("kochanek-bartels", None) => Ok(Self::KochanekBartels(Default::default())),
            ("kochanek-bartels", Some(numbers)) => {
                let what = "tension, continuity and bias";
                let [tension, continuity, bias] =
                    number_list::parse_exactly::<3>(numbers, what)?.map(|number| number as f32);
                Ok(Self::KochanekBartels(TensionContinuityBias {
                    tension,
                    continuity,
                    bias,
                }))
            }
            ("linear" | "catmull-rom", Some(_)) => Err(format!("`{name}` takes no numbers")),
            _ => Err(format!(
                "unknown interpolation `{name}`; expected linear, catmull-rom or \
                 kochanek-bartels:T,C,B"
            )),
        }
    }

    fn of(self, track: &EulerTrack) -> EulerInterpolation {
        match self {
            Self::Linear => EulerInterpolation::Linear,
            Self::CatmullRom => EulerInterpolation::CatmullRom,
            Self::KochanekBartels(controls) => {
                EulerInterpolation::kochanek_bartels(track, controls)
            }
        }
    }
}

/// Playback of `--loop`.
pub(crate) fn playback(looped: bool) -> Playback {
    match looped {
        true => Playback::Loop,
        false => Playback::Hold,
    }
}

impl LoadedModel {
    /// Replaces the interpolation of the file; `None` keeps it.
    pub(crate) fn interpolate_keyframes(
        &mut self,
        choice: Option<InterpolationChoice>,
    ) -> Outcome<()> {
        if let (Some(choice), Some(rig)) = (choice, &mut self.rig) {
            let clip = std::mem::take(&mut rig.clip).interpolated(|track| choice.of(track));
            rig.clip = clip.map_err(|error| usage!("--interpolation: {error}"))?;
        }
        Ok(())
    }
}
