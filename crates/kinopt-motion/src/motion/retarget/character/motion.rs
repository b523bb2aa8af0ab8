//! Retargeting of recorded motions to characters.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DQuat, DVec3};

use super::super::map_guess::{parts_of_capture, parts_of_character};
use super::super::{
    BodyMap, BodyPart, Capture, FigureTarget, RetargetError, RetargetOptions, Retargeting,
};
use super::feet::{FootTargets, foot_limbs};
use super::transfer::{CharacterTransfer, SubjectFrame};
use crate::motion::trajectory::MotionError;

/// Transfer of a captured motion to a character.
#[derive(Clone, Debug)]
pub(in super::super) struct CharacterMotion {
    pub(super) transfer: CharacterTransfer,
    capture: Capture,
    feet: FootTargets,
    /// Frames of the blend to and from contacts.
    blend_frames: usize,
}

impl<'r> Retargeting<'r> {
    /// Fits a capture to a character by a map. Bones keep their rotations in the world relative to the rest pose, and
    /// feet their places.
    ///
    /// Rest poses (T-pose, A-pose) are aligned. Bones between two mapped bones share the rotation of the joints between
    /// theirs. Fingers correspond by name and tree, and other bones by equal names. A capture
    /// [without rotations](Capture::has_rotations) gets those that its positions determine: directions of limbs and the
    /// planes in which they bend.
    ///
    /// A character with the proportions of the subject gets the subject's rotations unchanged. Otherwise two-bone IK
    /// brings the feet to the scaled places of the subject's feet, and to fixed places during contacts.
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new).
    pub fn onto_character(
        figure: &'r FigureTarget,
        map: &BodyMap,
        capture: &Capture,
        options: RetargetOptions,
    ) -> Result<Self, RetargetError> {
        let up = map.up.unwrap_or(options.up);
        let mut fitted = Self::new(figure.robot(), map, capture, options)?;
        let drives = drives_with_parts(figure, map, capture)?;
        let transfer = CharacterTransfer::new(figure, fitted.unit.scale(), capture, up, &drives);
        let limb_parts: Vec<Option<BodyPart>> = fitted
            .limbs
            .all
            .iter()
            .map(|limb| {
                let drive = drives.iter().find(|(joint, ..)| *joint == limb.joint);
                drive.and_then(|(.., part)| *part)
            })
            .collect();
        fitted.set_foot_limbs(map, capture, &transfer, &limb_parts)?;
        fitted.set_character_targets(capture, &transfer, &limb_parts);
        let foot_limbs = foot_limbs(&limb_parts);
        let feet = fitted.foot_targets(&foot_limbs, &transfer);
        fitted.character = Some(Arc::new(CharacterMotion {
            transfer,
            capture: capture.clone(),
            feet,
            blend_frames: fitted.options.contacts.lead_frames(fitted.frame_rate),
        }));
        Ok(fitted)
    }
}

/// Returns captured joint, bone and part of each drive of a bone. A part is that of the bone, or else of the joint.
fn drives_with_parts(
    figure: &FigureTarget,
    map: &BodyMap,
    capture: &Capture,
) -> Result<Vec<(usize, usize, Option<BodyPart>)>, RetargetError> {
    let parts = parts_of_character(figure.robot().model())?.bones;
    let part_of_bone: BTreeMap<&str, BodyPart> = parts
        .iter()
        .map(|(part, bone)| (bone.frame(), *part))
        .collect();
    let joints = parts_of_capture(capture).joints;
    let mut drives = Vec::new();
    for drive in &map.drives {
        let Ok(bone) = figure.upright().bone(&drive.frame) else {
            continue;
        };
        let part = part_of_bone.get(drive.frame.as_str()).copied();
        drives.push((capture.joint(&drive.joint)?, bone.index(), part));
    }
    let taken: Vec<BodyPart> = drives.iter().filter_map(|(.., part)| *part).collect();
    for (joint, _, part) in &mut drives {
        let of_joint = joints
            .iter()
            .find(|(part, known)| *known == joint && !taken.contains(part));
        *part = part.or(of_joint.map(|(part, _)| *part));
    }
    Ok(drives)
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
