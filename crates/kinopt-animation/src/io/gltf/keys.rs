//! Keys of an animation's sampler as curves.

use glam::{Quat, Vec4};
use gltf_json::animation::Interpolation;

use super::source::GltfSource;
use crate::animation::rotation::RotationCurve;
use crate::io::ReadError;
use kinopt_kinematics::curve::{CurveValue, KeyError, KeyedCurve};

/// The keys of a sampler.
pub(super) struct SamplerKeys<T> {
    pub(super) times: Vec<f32>,
    /// One output per key; with cubic splines in-tangent, value and out-tangent.
    pub(super) outputs: Vec<T>,
    pub(super) interpolation: Interpolation,
    /// Name in messages, such as "animation `walk`, rotation of node `hip`".
    pub(super) user: String,
    pub(super) path: String,
}

impl<T: Clone> SamplerKeys<T> {
    fn fail(&self, source: &GltfSource<'_>, error: &KeyError) -> ReadError {
        source.fail(self.path.as_str(), format!("{}: {error}", self.user))
    }

    /// The outputs of curve `index` of `width` curves with common keys. `side` selects in-tangents, values or
    /// out-tangents of cubic splines. For each key the file lists the in-tangents of all curves, then their values,
    /// then the out-tangents (section 3.11).
    fn outputs_of(&self, index: usize, width: usize, side: usize) -> Vec<T> {
        let sides = self.sides();
        let curve_outputs = self
            .outputs
            .iter()
            .skip(side * width + index)
            .step_by(sides * width);
        curve_outputs.cloned().collect()
    }

    fn sides(&self) -> usize {
        match self.interpolation {
            Interpolation::CubicSpline => 3,
            Interpolation::Linear | Interpolation::Step => 1,
        }
    }

    /// Removes each key whose successor has the same time, and returns the number of removed keys. Does nothing if the
    /// number of outputs is no multiple of that of keys.
    pub(super) fn remove_repeated_times(&mut self) -> usize {
        let keys = self.times.len();
        let repeated = |key: usize| self.times.get(key) == self.times.get(key + 1);
        let kept: Vec<usize> = (0..keys).filter(|&key| !repeated(key)).collect();
        if kept.len() == keys || !self.outputs.len().is_multiple_of(keys) {
            return 0;
        }
        let width = self.outputs.len() / keys;
        let outputs = kept
            .iter()
            .filter_map(|key| self.outputs.get(key * width..(key + 1) * width));
        self.outputs = outputs.flatten().cloned().collect();
        self.times = kept
            .iter()
            .filter_map(|&key| self.times.get(key).copied())
            .collect();
        keys - kept.len()
    }

    fn check(&self, source: &GltfSource<'_>, width: usize) -> Result<(), ReadError> {
        let (given, keys) = (self.outputs.len(), self.times.len());
        let needed = keys.checked_mul(self.sides() * width);
        if needed == Some(given) {
            return Ok(());
        }
        let values_per_key = self.sides() * width;
        let problem = format!(
            "{}: {given} values for {keys} keys of {values_per_key} each",
            self.user
        );
        Err(source.fail(self.path.as_str(), problem))
    }
}

/// `width` curves with common keys.
pub(super) fn curve<V>(
    source: &GltfSource<'_>,
    keys: SamplerKeys<V>,
    width: usize,
) -> Result<Vec<KeyedCurve<V>>, ReadError>
where
    V: CurveValue<Real = f32> + Clone,
{
    keys.check(source, width)?;
    source.charge::<f32>(keys.times.len().saturating_mul(width), &keys.path)?;
    let curves = (0..width).map(|index| {
        let times = keys.times.clone();
        let side = |side| keys.outputs_of(index, width, side);
        let curve = match keys.interpolation {
            Interpolation::Step => KeyedCurve::step(times, side(0)),
            Interpolation::Linear => KeyedCurve::linear(times, side(0)),
            Interpolation::CubicSpline => {
                let tangents = side(0).into_iter().zip(side(2)).map(|(a, b)| [a, b]);
                KeyedCurve::cubic(times, side(1), tangents.collect())
            }
        };
        curve.map_err(|error| keys.fail(source, &error))
    });
    curves.collect()
}

pub(super) fn rotation(
    source: &GltfSource<'_>,
    keys: SamplerKeys<Vec4>,
) -> Result<RotationCurve, ReadError> {
    keys.check(source, 1)?;
    let times = keys.times.clone();
    let rotations = |side| {
        keys.outputs_of(0, 1, side)
            .into_iter()
            .map(Quat::from_vec4)
            .collect()
    };
    let curve = match keys.interpolation {
        Interpolation::Step => RotationCurve::step(times, rotations(0)),
        Interpolation::Linear => RotationCurve::slerp(times, rotations(0)),
        Interpolation::CubicSpline => {
            let tangents = keys
                .outputs_of(0, 1, 0)
                .into_iter()
                .zip(keys.outputs_of(0, 1, 2));
            let tangents = tangents.map(|(a, b)| [a, b]).collect();
            RotationCurve::cubic(times, rotations(1), tangents)
        }
    };
    curve.map_err(|error| keys.fail(source, &error))
}
