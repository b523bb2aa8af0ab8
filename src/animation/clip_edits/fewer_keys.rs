//! Key reduction: removes keys that linear interpolation reproduces within a tolerance.
//!
//! Ramer 1972, "An iterative procedure for the polygonal approximation of plane curves"; Douglas & Peucker 1973.

use glam::{Quat, Vec3A};

use crate::SizeMismatch;
use crate::animation::rotation::exponential::log;
use crate::animation::rotation::{RotationCurve, nearer, slerp};
use crate::animation::{Armature, Channel, Clip};
use crate::curve::{CurveValue, KeyedCurve, lerp};

/// Largest deviation of a reduced channel from the original, at each original key.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct KeyTolerance {
    /// Of a bone's translation, in the file's unit of length.
    pub translation: f32,
    /// Of a bone's rotation, radians.
    pub rotation: f32,
    /// Of a bone's scale along an axis, and of morph target weights; dimensionless.
    pub scale: f32,
}

impl KeyTolerance {
    /// Removes only keys that are exactly on the line between kept keys.
    pub const EXACT: Self = Self {
        translation: 0.0,
        rotation: 0.0,
        scale: 0.0,
    };

    /// Sets the tolerance of translations, in the file's unit of length.
    #[must_use]
    pub fn with_translation(mut self, length: f32) -> Self {
        self.translation = length;
        self
    }

    /// Sets the tolerance of rotations, radians.
    #[must_use]
    pub fn with_rotation(mut self, radians: f32) -> Self {
        self.rotation = radians;
        self
    }

    /// Sets the tolerance of scales and morph target weights.
    #[must_use]
    pub fn with_scale(mut self, share: f32) -> Self {
        self.scale = share;
        self
    }
}

impl Default for KeyTolerance {
    /// The default is [`EXACT`](Self::EXACT).
    fn default() -> Self {
        Self::EXACT
    }
}

impl Clip {
    /// The clip with fewer keys, each linear or slerp channel within the tolerance at all its original keys. For
    /// vectors the tolerance then holds at all times. A channel within the tolerance of one value gets one key.
    ///
    /// Step, cubic and eased curves do not change; [`baked`](Self::baked) makes them linear. Negative tolerances and
    /// NaN count as 0.
    ///
    /// # Errors
    /// The armature is not of the clip's size.
    pub fn with_fewer_keys(
        &self,
        armature: &Armature,
        tolerance: &KeyTolerance,
    ) -> Result<Self, SizeMismatch> {
        let distance = |a: Vec3A, b: Vec3A| (a - b).length();
        let axis_distance = |a: Vec3A, b: Vec3A| (a - b).abs().max_element();
        let map_channel = |channel| match channel {
            Channel::Translation(curve) => {
                Channel::Translation(reduce_linear(curve, distance, tolerance.translation))
            }
            Channel::Scale(curve) => {
                Channel::Scale(reduce_linear(curve, axis_distance, tolerance.scale))
            }
            Channel::Rotation(curve) => Channel::Rotation(reduce_slerp(curve, tolerance.rotation)),
            Channel::Euler(_) => channel,
        };
        let map_weight = |curve| reduce_linear(curve, |a: f32, b| (a - b).abs(), tolerance.scale);
        self.rebuilt([armature; 2], map_channel, map_weight)
    }
}

fn reduce_linear<V: CurveValue<Real = f32>>(
    curve: KeyedCurve<V>,
    distance: impl Fn(V, V) -> f32,
    tolerance: f32,
) -> KeyedCurve<V> {
    if !curve.is_linear() {
        return curve;
    }
    let (times, values) = reduced_keys((curve.times(), curve.values()), lerp, distance, tolerance);
    // A subset of sorted keys is sorted.
    KeyedCurve::linear(times, values).unwrap_or(curve)
}

fn reduce_slerp(curve: RotationCurve, tolerance: f32) -> RotationCurve {
    if !curve.is_slerp() {
        return curve;
    }
    let angle = |a: Quat, b: Quat| log(a.inverse() * nearer(b, a)).length();
    let keys = (curve.times(), curve.rotations());
    let (times, rotations) = reduced_keys(keys, slerp, angle, tolerance);
    RotationCurve::slerp(times, rotations).unwrap_or(curve)
}

/// Indices of the kept keys: the ends, then repeatedly the key farthest from the line between two kept keys. Stops when
/// no key is farther than the tolerance.
fn reduced_keys<V: Copy>(
    (times, values): (&[f32], &[V]),
    between: impl Fn(V, V, f32) -> V,
    distance: impl Fn(V, V) -> f32,
    tolerance: f32,
) -> (Vec<f32>, Vec<V>) {
    let tolerance = tolerance.max(0.0);
    let Some((&first, last)) = values.first().zip(values.len().checked_sub(1)) else {
        return (Vec::new(), Vec::new());
    };
    let mut needed = vec![false; values.len()];
    needed[0] = true;
    if values
        .iter()
        .any(|value| distance(first, *value) > tolerance)
    {
        needed[last] = true;
        let mut intervals = vec![(0, last)];
        while let Some((from, to)) = intervals.pop() {
            let deviation = |key: usize| {
                let fraction = (times[key] - times[from]) / (times[to] - times[from]);
                distance(between(values[from], values[to], fraction), values[key])
            };
            let keys = (from + 1..to).map(|key| (deviation(key), key));
            let worst = keys.max_by(|one, other| one.0.total_cmp(&other.0));
            if let Some((_, key)) = worst.filter(|(distance, _)| *distance > tolerance) {
                needed[key] = true;
                intervals.extend([(from, key), (key, to)]);
            }
        }
    }
    let keys = times.iter().zip(values).zip(needed);
    keys.filter(|(_, needed)| *needed)
        .map(|((time, value), _)| (*time, *value))
        .unzip()
}
