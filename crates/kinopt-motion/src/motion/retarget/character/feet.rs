//! Targets and contacts of a character's feet.

use super::super::contacts::plant_limbs;
use super::super::{BodyMap, BodyPart, RetargetError, Retargeting};
use super::proportions::LEGS;
use super::transfer::{CharacterTransfer, FootTarget, SubjectFrame};
use crate::motion::retarget::Capture;
use glam::DVec3;
use kinopt_kinematics::spatial::Vector3;

/// Targets of both feet in each frame.
pub(super) type FootTargets = Vec<[Option<FootTarget>; 2]>;

/// Driven limb of each ankle and toe.
pub(super) type FootLimbs = [[Option<usize>; 2]; 2];

/// Returns the driven limbs of ankles and toes.
pub(super) fn foot_limbs(limb_parts: &[Option<BodyPart>]) -> FootLimbs {
    LEGS.map(|[.., ankle, toe]| {
        [ankle, toe].map(|part| limb_parts.iter().position(|known| *known == Some(part)))
    })
}

impl Retargeting<'_> {
    /// Makes the ankles' own frames the driven ones, at their heights over the character's ground.
    pub(super) fn set_foot_limbs(
        &mut self,
        map: &BodyMap,
        capture: &Capture,
        transfer: &CharacterTransfer,
        limb_parts: &[Option<BodyPart>],
    ) -> Result<(), RetargetError> {
        let scale = self.unit.scale();
        for (limb, part) in self.limbs.all.iter_mut().zip(limb_parts) {
            let name = &capture.names()[limb.joint];
            let drive = map.drives.iter().find(|drive| drive.joint == *name);
            if let Some(drive) = drive.filter(|_| limb.is_heel) {
                limb.frame = self.robot.model().frame(&drive.frame)?;
                limb.offset = drive.offset * scale;
                limb.is_heel = false;
            }
            if let Some(part) = part.filter(|part| part.stands()) {
                limb.clearance = transfer.clearance(part);
            }
        }
        self.limbs.stride = transfer.sizes.stride;
        Ok(())
    }

    /// Computes the targets of the driven points from the places of hips and feet, and the contacts of the feet.
    ///
    /// Feet of a character with the subject's proportions have the subject's places, so that its motion stays as it is.
    pub(super) fn set_character_targets(
        &mut self,
        capture: &Capture,
        transfer: &CharacterTransfer,
        limb_parts: &[Option<BodyPart>],
    ) {
        let mut targets: Vec<Vector3<f64>> = Vec::with_capacity(self.targets.len());
        for frame in 0..capture.frames() {
            let positions = capture.frame(frame).unwrap_or_default();
            let subject = SubjectFrame {
                positions,
                rotations: None,
            };
            self.write_character_targets(subject, transfer, limb_parts, &mut targets);
        }
        let mut planted = targets.clone();
        (self.limb_contacts, _) = plant_limbs(
            &self.options.contacts,
            &self.limbs,
            self.frame_rate,
            None,
            &mut planted,
        );
        if !transfer.keeps_places() {
            targets = planted;
        }
        let inverse_scale = self.unit.inverse_scale();
        self.model_targets = targets
            .iter()
            .map(|target| *target * inverse_scale)
            .collect();
        self.targets = targets.into();
    }

    /// Appends the targets of the driven points in one frame.
    fn write_character_targets(
        &self,
        subject: SubjectFrame<'_>,
        transfer: &CharacterTransfer,
        limb_parts: &[Option<BodyPart>],
        targets: &mut Vec<Vector3<f64>>,
    ) {
        let first = targets.len();
        for (limb, part) in self.limbs.all.iter().zip(limb_parts) {
            let place = match part {
                Some(part) if part.stands() => transfer.foot_place(*part, subject),
                Some(BodyPart::Pelvis) => transfer.pelvis_place(subject),
                _ => None,
            };
            let place = place.map(|place| Vector3::from(place.to_array()));
            let position = transfer.upright_joint(limb.joint, subject);
            let from_parent = limb.parent.and_then(|parent| {
                let above = targets.get(first + parent)?;
                let offset =
                    position - transfer.upright_joint(self.limbs.all[parent].joint, subject);
                Some(*above + Vector3::from((offset * limb.scale).to_array()))
            });
            let stride = transfer.sizes.stride;
            let place = place.or(from_parent);
            targets.push(place.unwrap_or_else(|| Vector3::from((position * stride).to_array())));
        }
    }

    /// Returns the targets of the feet in each frame from those of the driven points.
    pub(super) fn foot_targets(&self, limbs: &FootLimbs) -> FootTargets {
        let n = self.limbs.all.len();
        let mut levels = vec![0.0; n];
        let targets = (0..self.frames()).map(|frame| {
            self.contact_levels(frame, &mut levels);
            let at = |limb: usize| {
                let target = self.targets.get(frame * n + limb);
                target.map(|target| DVec3::from_array(target.to_array()))
            };
            limbs.map(|[ankle, toe]| {
                let ankle = ankle?;
                let toe_level = toe.map_or(0.0, |toe| levels[toe]);
                Some(FootTarget {
                    ankle: at(ankle)?,
                    toe: toe.and_then(at),
                    on_toe: toe_level * (1.0 - levels[ankle]),
                })
            })
        });
        targets.collect()
    }
}
