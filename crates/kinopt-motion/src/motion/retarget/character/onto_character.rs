//! Fits captures to characters.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::super::map_guess::{parts_of_capture, parts_of_character};
use super::super::{
    BodyMap, BodyPart, Capture, FigureTarget, RetargetError, RetargetOptions, Retargeting,
};
use super::feet::foot_limbs;
use super::motion::CharacterMotion;
use super::transfer::CharacterTransfer;

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
