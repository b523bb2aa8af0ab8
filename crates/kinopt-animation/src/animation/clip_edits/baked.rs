//! Clips from sampled poses.

use crate::animation::rotation::RotationCurve;
use crate::animation::{Armature, Channel, Clip, ClipError, Cursor, Playback, Pose};
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::curve::{CurveValue, KeyError, KeyedCurve, check_count, check_times};

/// Largest number of samples.
const MAX_SAMPLES: f64 = 4e6;
/// Rounding tolerance of the last sample time, as a fraction of a step. It is raised to `ROUNDING_INCREMENTS`
/// increments of single precision.
const MIN_TIME_TOLERANCE: f64 = 1e-6;
const ROUNDING_INCREMENTS: f64 = 4.0;

impl Clip {
    /// Clip through poses at increasing times in seconds. Values between poses are linear, rotations use slerp. A
    /// property that is equal in all poses has one key, or none if it is at rest.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// use kinopt::animation::{Armature, Clip};
    /// # use kinopt::io::rig::Rig;
    ///
    /// # let skeleton = Rig::read("models/humanoid/humanoid.json")?.skeleton;
    /// let armature = Armature::of_skeleton(&skeleton);
    /// let poses = vec![armature.rest().clone(); 3];
    /// let clip = Clip::through_poses("stand", &armature, &[0.0, 0.5, 1.0], &poses)?;
    /// assert_eq!((clip.span(), clip.channels(&armature)?.len()), ([0.0, 1.0], 0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// - There are no poses, or not one for each time.
    /// - The times do not increase.
    /// - A pose is of another armature.
    pub fn through_poses(
        name: impl Into<String>,
        armature: &Armature,
        times: &[f32],
        poses: &[Pose],
    ) -> Result<Self, ClipError> {
        check_times(times)?;
        check_count("poses", poses.len(), times.len())?;
        for pose in poses {
            armature.rest().check_same_size(pose)?;
        }
        let rest = armature.rest();
        let mut builder = Self::builder(name, armature);
        for bone in armature.bone_ids() {
            let locals = || poses.iter().map(|pose| pose.local_of(bone));
            let at_rest = rest.local_of(bone);
            let translations = locals().map(|local| local.translation).collect();
            if let Some(curve) = linear_curve(times, translations, at_rest.translation)? {
                builder.channel(bone, Channel::Translation(curve))?;
            }
            let rotations = locals().map(|local| local.rotation).collect();
            if let Some((times, rotations)) = keys(times, rotations, at_rest.rotation) {
                let curve = RotationCurve::slerp(times, rotations)?;
                builder.channel(bone, Channel::Rotation(curve))?;
            }
            let scales = locals().map(|local| local.scale).collect();
            if let Some(curve) = linear_curve(times, scales, at_rest.scale)? {
                builder.channel(bone, Channel::Scale(curve))?;
            }
        }
        for (target, &at_rest) in rest.morph_weights().iter().enumerate() {
            let weights = poses
                .iter()
                .filter_map(|pose| pose.morph_weights().get(target));
            if let Some(curve) = linear_curve(times, weights.copied().collect(), at_rest)? {
                builder.morph_weight(target, curve)?;
            }
        }
        if let [first, .., last] | [first @ last] = times {
            builder.span(*first, *last)?;
        }
        Ok(builder.build())
    }

    /// Samples the clip at `keys_per_second` from start to end, with linear interpolation between the samples. Events
    /// are preserved.
    ///
    /// # Errors
    /// - The rate is not a finite number above 0, or gives more than four million keys.
    /// - The armature is not of the clip's size.
    pub fn baked(&self, armature: &Armature, keys_per_second: f64) -> Result<Self, ClipError> {
        self.resampled(armature, keys_per_second, |_, _| Ok(()))
            .map(|(baked, ())| baked)
    }

    /// Samples the clip at an even rate and applies `change` to the poses first; returns its result as well.
    pub(super) fn resampled<T>(
        &self,
        armature: &Armature,
        keys_per_second: f64,
        change: impl FnOnce(&[f32], &mut [Pose]) -> Result<T, ClipError>,
    ) -> Result<(Self, T), ClipError> {
        let times = self.sample_times(keys_per_second)?;
        let mut poses = self.poses_at(armature, &times)?;
        let report = change(&times, &mut poses)?;
        let changed = Self::through_poses(self.name(), armature, &times, &poses)?;
        Ok((changed.with_events_of(self), report))
    }

    /// Evenly spaced times from start to end, both included.
    fn sample_times(&self, per_second: f64) -> Result<Vec<f32>, ClipError> {
        let [start, end] = self.span();
        let steps = self.duration() * per_second;
        if !(per_second > 0.0 && steps < MAX_SAMPLES) {
            return Err(ClipError::BadRate {
                keys_per_second: per_second,
            });
        }
        let max_time = f64::from(start.abs().max(end.abs()));
        let rounding = ROUNDING_INCREMENTS * f64::from(f32::EPSILON) * max_time * per_second;
        let tolerance = rounding.clamp(MIN_TIME_TOLERANCE, 0.5);
        let inner = 1..(steps - tolerance).ceil().max(0.0) as usize;
        let inner = inner.map(|step| (f64::from(start) + step as f64 / per_second) as f32);
        let mut times = vec![start];
        times.extend(inner);
        times.push(end);
        // Removes equal times, in a clip of zero duration or of samples too close for single precision.
        times.dedup();
        Ok(times)
    }

    /// Poses at times of the clip.
    fn poses_at(&self, armature: &Armature, times: &[f32]) -> Result<Vec<Pose>, SizeMismatch> {
        let mut cursor = Cursor::new();
        let poses = times.iter().map(|&time| {
            let mut pose = armature.rest().clone();
            self.sample(f64::from(time), Playback::Hold, &mut cursor, &mut pose)?;
            Ok(pose)
        });
        poses.collect()
    }
}

fn linear_curve<V: CurveValue<Real = f32> + PartialEq>(
    times: &[f32],
    values: Vec<V>,
    rest_value: V,
) -> Result<Option<KeyedCurve<V>>, KeyError> {
    let keys = keys(times, values, rest_value);
    keys.map(|(times, values)| KeyedCurve::linear(times, values))
        .transpose()
}

/// Keys of a property: one if it is constant, none if it is at rest.
fn keys<V: Copy + PartialEq>(
    times: &[f32],
    mut values: Vec<V>,
    rest_value: V,
) -> Option<(Vec<f32>, Vec<V>)> {
    let (first, mut times) = (*values.first()?, times.to_vec());
    if values.iter().all(|value| *value == first) {
        if first == rest_value {
            return None;
        }
        times.truncate(1);
        values.truncate(1);
    }
    Some((times, values))
}
