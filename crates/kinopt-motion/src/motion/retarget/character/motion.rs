//! Retargeting of recorded motions to characters.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DQuat, DVec3};

use super::super::{Capture, RetargetError};
use super::transfer::{CharacterTransfer, FootTargets, SubjectFrame};
use crate::motion::trajectory::MotionError;

/// Transfer of a captured motion to a character.
#[derive(Clone, Debug)]
pub(in super::super) struct CharacterMotion {
    pub(super) transfer: CharacterTransfer,
    pub(super) capture: Capture,
    pub(super) feet: FootTargets,
    /// Frames of the blend to and from contacts.
    pub(super) blend_frames: usize,
}

impl CharacterMotion {
    /// Subject in a capture frame.
    fn subject(&self, frame: usize) -> SubjectFrame<'_> {
        let joints = self.capture.names().len();
        let rotations = self.capture.posed();
        SubjectFrame {
            positions: self.capture.frame(frame).unwrap_or_default(),
            rotations: rotations
                .and_then(|posed| posed.rotations.get(frame * joints..(frame + 1) * joints)),
        }
    }

    /// Returns the configurations frame by frame, in the unit of the solved body.
    pub(in super::super) fn per_frame(
        &self,
        cancelled: Option<&AtomicBool>,
    ) -> Result<Vec<f64>, RetargetError> {
        self.solve(cancelled, |_, missing| missing)
    }

    /// Returns the configurations with smoothly lowered hips, in the unit of the solved body.
    pub(in super::super) fn whole(
        &self,
        cancelled: Option<&AtomicBool>,
    ) -> Result<Vec<f64>, RetargetError> {
        let mut drops = vec![0.0; self.feet.len()];
        self.solve(cancelled, |frame, missing| {
            drops[frame] = missing;
            missing
        })?;
        let drops = smooth_maximum(&drops, self.blend_frames);
        self.solve(cancelled, |frame, _| drops[frame])
    }

    /// Solves all frames. `drop` returns by how much the hips are lowered in a frame, from the missing reach of the legs.
    fn solve(
        &self,
        cancelled: Option<&AtomicBool>,
        mut drop: impl FnMut(usize, f64) -> f64,
    ) -> Result<Vec<f64>, RetargetError> {
        let mut q = Vec::new();
        let mut previous: Option<Vec<[f64; 3]>> = None;
        for (frame, feet) in self.feet.iter().enumerate() {
            if cancelled.is_some_and(|cancelled| cancelled.load(Ordering::Relaxed)) {
                return Err(MotionError::Cancelled.into());
            }
            let subject = self.subject(frame);
            let (pose, base) = self.transfer.pose(
                subject,
                Some(feet),
                |missing| drop(frame, missing),
                previous.as_deref(),
            );
            extend_configuration(&mut q, base, &pose.angles);
            previous = Some(pose.angles);
        }
        Ok(q)
    }
}

/// Appends a configuration: position and quaternion w, x, y, z of the base, and the angles of each bone.
pub(super) fn extend_configuration(q: &mut Vec<f64>, base: (DQuat, DVec3), angles: &[[f64; 3]]) {
    let (rotation, translation) = base;
    q.extend(translation.to_array());
    q.extend([rotation.w, rotation.x, rotation.y, rotation.z]);
    q.extend(angles.iter().flatten());
}

/// Returns a smooth curve above the given values: the mean over a window of the largest value over the window.
fn smooth_maximum(values: &[f64], radius: usize) -> Vec<f64> {
    let window = |k: usize, length: usize| k.saturating_sub(radius)..(k + radius + 1).min(length);
    let count = values.len();
    let largest: Vec<f64> = (0..count)
        .map(|k| values[window(k, count)].iter().copied().fold(0.0, f64::max))
        .collect();
    (0..count)
        .map(|k| {
            let range = window(k, count);
            let length = range.len() as f64;
            largest[range].iter().sum::<f64>() / length
        })
        .collect()
}
