//! A clip whose end meets its start.

use glam::Quat;

use crate::animation::rotation::slerp;
use crate::animation::{Armature, ChannelError, Clip, Pose};

impl Clip {
    /// The clip by samples, whose last seconds lead over to its first pose, so that it repeats without a jump: what is missing at its
    /// end is added little by little, by 3s² − 2s³ of the share s of those seconds that has passed, rotations along the shorter arc.
    /// What travels would be brought back; [`root motion`](super::RootMotion) takes that out first.
    ///
    /// # Errors
    /// Seconds that are not above 0 or more than the clip lasts, a rate as for [`baked`](Self::baked), or another armature.
    pub fn with_closed_seam(
        &self,
        armature: &Armature,
        seconds: f64,
        keys_per_second: f64,
    ) -> Result<Self, ChannelError> {
        let duration = self.duration();
        if !(seconds > 0.0 && seconds <= duration) {
            let given = seconds;
            return Err(ChannelError::NotWithin { given, duration });
        }
        let lead = f64::from(self.span()[1]) - seconds;
        let closed = self.resampled(armature, keys_per_second, |times, poses| {
            let [first, .., last] = &*poses else {
                return Ok(());
            };
            let (first, last) = (first.clone(), last.clone());
            for (time, pose) in times.iter().zip(&mut *poses) {
                let share = ((f64::from(*time) - lead) / seconds) as f32;
                if share > 0.0 {
                    let ease = share * share * (3.0 - 2.0 * share);
                    add_difference(armature, pose, [&last, &first], ease);
                }
            }
            // Exactly, whatever the way there rounds to.
            if let Some(end) = poses.last_mut() {
                end.clone_from(&first);
            }
            Ok(())
        });
        closed.map(|(closed, ())| closed)
    }
}

/// Moves a pose by a share of what leads from one pose to another.
fn add_difference(armature: &Armature, pose: &mut Pose, [from, to]: [&Pose; 2], share: f32) {
    for bone in armature.bone_ids() {
        let mut own = pose.local_of(bone);
        let (from, to) = (from.local_of(bone), to.local_of(bone));
        own.translation += (to.translation - from.translation) * share;
        own.scale += (to.scale - from.scale) * share;
        let turn = slerp(Quat::IDENTITY, to.rotation * from.rotation.inverse(), share);
        own.rotation = (turn * own.rotation).normalize();
        // The sum of finite numbers; one that overflows leaves the bone as it was.
        let _ = pose.set_local(bone, own);
    }
    let weights = pose.morph_weights_mut().iter_mut();
    for ((own, from), to) in weights.zip(from.morph_weights()).zip(to.morph_weights()) {
        *own += (to - from) * share;
    }
}
