//! Closing of loop seams.

use glam::Quat;

use crate::animation::rotation::slerp;
use crate::animation::{Armature, Clip, ClipError, Pose};

impl Clip {
    /// Samples the clip and blends its last `seconds` into its first pose, so that it loops without a jump. The
    /// difference at the end is added with the weight 3s² − 2s³, where s is the fraction of `seconds` that has passed.
    /// Rotations take the shorter arc.
    ///
    /// Remove [`root motion`](super::RootMotion) first; otherwise the blend moves the character back to its start.
    ///
    /// # Errors
    /// - `seconds` is not above 0 or exceeds the duration of the clip.
    /// - The rate is invalid, as for [`baked`](Self::baked).
    /// - The armature is not of the clip's size.
    pub fn with_closed_seam(
        &self,
        armature: &Armature,
        seconds: f64,
        keys_per_second: f64,
    ) -> Result<Self, ClipError> {
        let duration = self.duration();
        if !(seconds > 0.0 && seconds <= duration) {
            let given = seconds;
            return Err(ClipError::NotWithin { given, duration });
        }
        let seam_start = f64::from(self.span()[1]) - seconds;
        let closed = self.resampled(armature, keys_per_second, |times, poses| {
            let [first, .., last] = &*poses else {
                return Ok(());
            };
            let (first, last) = (first.clone(), last.clone());
            for (time, pose) in times.iter().zip(&mut *poses) {
                let fraction = ((f64::from(*time) - seam_start) / seconds) as f32;
                if fraction > 0.0 {
                    let ease = fraction * fraction * (3.0 - 2.0 * fraction);
                    add_difference(armature, pose, [&last, &first], ease);
                }
            }
            // Set exactly, without rounding.
            if let Some(end) = poses.last_mut() {
                end.clone_from(&first);
            }
            Ok(())
        });
        closed.map(|(closed, ())| closed)
    }
}

/// Moves a pose by a fraction of the difference between two poses.
fn add_difference(armature: &Armature, pose: &mut Pose, [from, to]: [&Pose; 2], fraction: f32) {
    for bone in armature.bone_ids() {
        let mut local = pose.local_of(bone);
        let (from, to) = (from.local_of(bone), to.local_of(bone));
        local.translation += (to.translation - from.translation) * fraction;
        local.scale += (to.scale - from.scale) * fraction;
        let rotation = slerp(
            Quat::IDENTITY,
            to.rotation * from.rotation.inverse(),
            fraction,
        );
        local.rotation = (rotation * local.rotation).normalize();
        // The sum of finite numbers; if it overflows, the bone does not change.
        let _ = pose.set_local(bone, local);
    }
    let weights = pose.morph_weights_mut().iter_mut();
    for ((weight, from), to) in weights.zip(from.morph_weights()).zip(to.morph_weights()) {
        *weight += (to - from) * fraction;
    }
}
