//! Clips of a state with resolved names.

use std::sync::Arc;

use super::definition::{MotionDefinition, ParameterDefault};
use super::lookup::{Checked, error_at, find, finite};
use crate::animation::clip::named::position;
use crate::animation::{Clip, ClipError, LayerError};

/// Clips along a parameter; a single clip is a blend of one.
#[derive(Clone, Debug)]
pub(super) struct ParameterBlend {
    parameter: Option<usize>,
    /// At least one, in increasing order of the number.
    clips: Vec<(f32, Arc<Clip>)>,
}

/// Active clips at a parameter value: an index, and the weight of the next clip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mix {
    pub(super) first: usize,
    /// Weight of the next clip, within [0, 1); above 0 a next clip exists.
    pub(super) next_weight: f32,
}

impl ParameterBlend {
    pub(super) fn clips(&self) -> impl ExactSizeIterator<Item = &Clip> {
        self.clips.iter().map(|(_, clip)| &**clip)
    }

    pub(super) fn clip(&self, index: usize) -> &Clip {
        &self.clips[index].1
    }

    /// Active clips at the values of the parameters.
    pub(super) fn mix(&self, values: &[ParameterDefault]) -> Mix {
        let single = |first| Mix {
            first,
            next_weight: 0.0,
        };
        let value = match self.parameter.and_then(|index| values.get(index)) {
            Some(ParameterDefault::Number(value)) => *value,
            _ => return single(0),
        };
        let above = self.clips.partition_point(|(at, _)| *at <= value);
        if above == 0 || above == self.clips.len() {
            return single(above.saturating_sub(1));
        }
        let [low, high, value] =
            [self.clips[above - 1].0, self.clips[above].0, value].map(f64::from);
        Mix {
            first: above - 1,
            next_weight: ((value - low) / (high - low)) as f32,
        }
    }

    /// Active clips with their weights, which are above 0 and sum to 1.
    pub(super) fn playing(&self, mix: Mix) -> impl Iterator<Item = (&Clip, f32)> {
        let weights = [1.0 - mix.next_weight, mix.next_weight].into_iter();
        let clips = self.clips().skip(mix.first).zip(weights);
        clips.filter(|(_, weight)| *weight > 0.0)
    }

    /// Duration of a cycle at speed 1 in seconds: the mean over clips of non-zero duration.
    pub(super) fn length(&self, mix: Mix) -> f64 {
        let timed = self.playing(mix).filter(|(clip, _)| clip.duration() > 0.0);
        let [length, weight] = timed.fold([0.0, 0.0], |[length, sum], (clip, weight)| {
            let weight = f64::from(weight);
            [length + weight * clip.duration(), sum + weight]
        });
        if weight > 0.0 { length / weight } else { 0.0 }
    }
}

impl ParameterBlend {
    /// Checks the clips of a state against the given clips and parameters. `bones` is the number of bones of the clips
    /// before.
    pub(super) fn new(
        path: &str,
        given: &MotionDefinition,
        clips: &[Arc<Clip>],
        parameters: &[(String, ParameterDefault)],
        bones: &mut Option<usize>,
    ) -> Checked<Self> {
        let mut motion = Self {
            parameter: None,
            clips: Vec::new(),
        };
        match given {
            MotionDefinition::Clip(name) => {
                let clip = look_up(&format!("{path}.clip"), name, clips, bones)?;
                motion.clips.push((0.0, clip));
            }
            MotionDefinition::Blend(blend) => {
                let parameter_path = || format!("{path}.blend.parameter");
                let numbers = parameters.iter();
                let numbers = numbers.filter(|(_, d)| matches!(d, ParameterDefault::Number(_)));
                let names = numbers.map(|(name, _)| name.as_str());
                find(parameter_path, "number", &blend.parameter, names)?;
                let is_parameter = |(name, _): &(String, _)| *name == blend.parameter;
                motion.parameter = parameters.iter().position(is_parameter);
                for (index, given) in blend.clips.iter().enumerate() {
                    let path = format!("{path}.blend.clips[{index}]");
                    finite(|| format!("{path}.at"), f64::from(given.at))?;
                    let last = motion.clips.last().map(|(before, _)| *before);
                    if let Some(before) = last.filter(|before| *before >= given.at) {
                        let problem = LayerError::NotRising {
                            before,
                            at: given.at,
                        };
                        return Err(error_at(format!("{path}.at"), problem));
                    }
                    let clip = look_up(&format!("{path}.clip"), &given.clip, clips, bones)?;
                    motion.clips.push((given.at, clip));
                }
                if motion.clips.is_empty() {
                    let path = format!("{path}.blend.clips");
                    return Err(error_at(path, LayerError::EmptyBlend));
                }
            }
        }
        Ok(motion)
    }
}

/// Finds a clip and checks that it is of the armature of the previous clips.
fn look_up(
    path: &str,
    name: &str,
    clips: &[Arc<Clip>],
    bones: &mut Option<usize>,
) -> Checked<Arc<Clip>> {
    let names = clips.iter().map(|clip| clip.name());
    let index = position(names, name).map_err(|error| {
        let problem = match error {
            ClipError::UnknownName(unknown) => LayerError::UnknownName(unknown),
            ambiguous => LayerError::ClipName(ambiguous),
        };
        error_at(path, problem)
    })?;
    let clip = &clips[index];
    let namesakes = clips.iter().filter(|other| other.name() == clip.name());
    if namesakes.clone().any(|other| !Arc::ptr_eq(other, clip)) {
        let problem = LayerError::AmbiguousClip {
            clip: name.to_owned(),
            clips: namesakes.count(),
        };
        return Err(error_at(path, problem));
    }
    let expected = *bones.get_or_insert(clip.bones());
    if clip.bones() != expected {
        let problem = LayerError::OtherArmature {
            clip: name.to_owned(),
            bones: clip.bones(),
            expected,
        };
        return Err(error_at(path, problem));
    }
    Ok(Arc::clone(clip))
}
