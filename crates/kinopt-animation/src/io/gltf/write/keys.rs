//! Curves as glTF keys: step, linear and cubic spline. Other curves are sampled and interpolated linearly.

use glam::{Quat, Vec3A};
use gltf_json::animation::Interpolation;

use super::UnwritableScene;
use crate::animation::rotation::{BetweenRotations, RotationCurve};
use crate::animation::{Channel, EulerCurve};
use kinopt_kinematics::curve::{Between, CurveValue, KeyedCurve};

/// Largest number of samples of one curve; more are taken as a mistake.
const MAX_SAMPLES: f64 = 4e6;

/// Keys of a channel with `N` numbers per output; cubic splines have three outputs per key.
pub(super) struct EncodedKeys<const N: usize> {
    pub(super) times: Vec<f32>,
    pub(super) outputs: Vec<[f32; N]>,
    pub(super) interpolation: Interpolation,
}

/// Keys of translations and scales, or of rotations.
pub(super) enum ChannelKeys {
    Vectors(EncodedKeys<3>),
    Rotations(EncodedKeys<4>),
}

pub(super) fn of_channel(channel: &Channel, rate: f32) -> Result<ChannelKeys, UnwritableScene> {
    Ok(match channel {
        Channel::Translation(curve) | Channel::Scale(curve) => {
            ChannelKeys::Vectors(vectors(curve, rate)?)
        }
        Channel::Rotation(curve) => ChannelKeys::Rotations(rotations(curve, rate)?),
        Channel::Euler(curve) => ChannelKeys::Rotations(euler(curve, rate)?),
    })
}

fn vectors(curve: &KeyedCurve<Vec3A>, rate: f32) -> Result<EncodedKeys<3>, UnwritableScene> {
    match exact(curve) {
        Some((interpolation, outputs)) => Ok(EncodedKeys {
            times: curve.times().to_vec(),
            outputs: outputs.into_iter().map(|value| value.to_array()).collect(),
            interpolation,
        }),
        None => sampled(curve.times(), rate, |time| curve.at(time).to_array()),
    }
}

/// The outputs of a curve that glTF can represent; `None` for others.
pub(super) fn exact<V: CurveValue>(curve: &KeyedCurve<V>) -> Option<(Interpolation, Vec<V>)> {
    let values = curve.values();
    match curve.between() {
        // Cubic splines need at least two keys (section 3.11).
        _ if values.len() == 1 => Some((Interpolation::Step, values.to_vec())),
        Between::Step => Some((Interpolation::Step, values.to_vec())),
        Between::Linear => Some((Interpolation::Linear, values.to_vec())),
        Between::Cubic(rates) => {
            let keys = rates.iter().zip(values);
            let outputs =
                keys.flat_map(|([arriving, leaving], value)| [*arriving, *value, *leaving]);
            Some((Interpolation::CubicSpline, outputs.collect()))
        }
        Between::Eased(_) | Between::Bezier(_) => None,
    }
}

fn rotations(curve: &RotationCurve, rate: f32) -> Result<EncodedKeys<4>, UnwritableScene> {
    let values = || curve.rotations().iter().map(|q| q.to_array());
    let (interpolation, outputs) = match curve.between() {
        BetweenRotations::Step => (Interpolation::Step, values().collect()),
        _ if curve.rotations().len() == 1 => (Interpolation::Step, values().collect()),
        BetweenRotations::Slerp => (Interpolation::Linear, values().collect()),
        BetweenRotations::Cubic(rates) => {
            let keys = rates.iter().zip(values());
            let outputs = keys.flat_map(|([arriving, leaving], value)| {
                [arriving.to_array(), value, leaving.to_array()]
            });
            (Interpolation::CubicSpline, outputs.collect())
        }
        BetweenRotations::Eased(_) | BetweenRotations::Squad(_) | BetweenRotations::Hermite(_) => {
            return sampled(curve.times(), rate, |time| curve.at(time).to_array());
        }
    };
    Ok(EncodedKeys {
        times: curve.times().to_vec(),
        outputs,
        interpolation,
    })
}

fn euler(curve: &EulerCurve, rate: f32) -> Result<EncodedKeys<4>, UnwritableScene> {
    let mut previous = Quat::IDENTITY;
    sampled(curve.angles.times(), rate, |time| {
        // On one hemisphere, for programs that do not choose the shorter arc.
        let rotation = curve.at(time);
        previous = if rotation.dot(previous) < 0.0 {
            -rotation
        } else {
            rotation
        };
        previous.to_array()
    })
}

/// Samples at the given rate and at the keys, with linear interpolation.
fn sampled<const N: usize>(
    keys: &[f32],
    rate: f32,
    mut value_at: impl FnMut(f32) -> [f32; N],
) -> Result<EncodedKeys<N>, UnwritableScene> {
    let times = sample_times(keys, rate)?;
    Ok(EncodedKeys {
        outputs: times.iter().map(|&time| value_at(time)).collect(),
        times,
        interpolation: match keys.len() {
            1 => Interpolation::Step,
            _ => Interpolation::Linear,
        },
    })
}

/// Ascending times: those of the keys, and `rate` samples per second between the first and the last key.
pub(super) fn sample_times(keys: &[f32], rate: f32) -> Result<Vec<f32>, UnwritableScene> {
    let (Some(&first), Some(&last)) = (keys.first(), keys.last()) else {
        return Ok(Vec::new());
    };
    let (start, rate) = (f64::from(first), f64::from(rate));
    let samples = (f64::from(last) - start) * rate;
    if samples > MAX_SAMPLES {
        return Err(UnwritableScene::TooManySamples { samples });
    }
    let grid = (1..samples.ceil() as usize).map(|sample| (start + sample as f64 / rate) as f32);
    // A sample very close to a key is dropped.
    let min_distance = (1e-3 / rate) as f32;
    let is_apart = |time: &f32| {
        let after = keys.partition_point(|key| key < time);
        let neighbours = [after.checked_sub(1), Some(after)].into_iter().flatten();
        let mut neighbours = neighbours.filter_map(|key| keys.get(key));
        neighbours.all(|key| (key - time).abs() > min_distance)
    };
    let mut times: Vec<f32> = keys.iter().copied().chain(grid.filter(is_apart)).collect();
    times.sort_by(f32::total_cmp);
    times.dedup();
    Ok(times)
}
