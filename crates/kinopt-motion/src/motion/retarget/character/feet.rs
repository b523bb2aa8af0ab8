//! Targets and contacts of a character's feet.

use super::super::contacts::{LimbContact, foot_contact, lifted};
use super::super::{BodyMap, BodyPart, RetargetError, Retargeting};
use super::proportions::LEGS;
use super::transfer::{CharacterTransfer, FootTarget, FootTargets, SubjectFrame};
use crate::motion::contact::{FootContact, plant_at};
use crate::motion::retarget::Capture;
use glam::DVec3;
use kinopt_kinematics::spatial::Vector3;

/// Driven limb of each ankle and toe.
pub(super) type FootLimbs = [[Option<usize>; 2]; 2];

/// Moves contacts of an ankle and a toe to the length of the foot. Of two contacts at one time the later one moves.
fn keep_foot_length(contacts: &mut [Vec<FootContact>], limbs: [usize; 2], length: f64) {
    let mut order: Vec<(usize, usize)> = limbs
        .iter()
        .flat_map(|&limb| (0..contacts[limb].len()).map(move |contact| (limb, contact)))
        .collect();
    order.sort_by_key(|(limb, contact)| (contacts[*limb][*contact].span.start, *limb));
    for (k, &(limb, contact)) in order.iter().enumerate() {
        let start = contacts[limb][contact].span.start;
        let earlier = order[..k].iter().rev();
        let other = earlier
            .filter(|(other, _)| *other != limb)
            .map(|(other, contact)| &contacts[*other][*contact])
            .find(|other| other.span.end > start);
        let Some(other) = other.map(|other| DVec3::from_array(other.position.to_array())) else {
            continue;
        };
        let position = &mut contacts[limb][contact].position;
        let place = at_distance(DVec3::from_array(position.to_array()), other, length);
        *position = Vector3::from(place.to_array());
    }
}

/// Moves a place to a distance from another one, horizontally if the heights allow.
pub(super) fn at_distance(place: DVec3, from: DVec3, distance: f64) -> DVec3 {
    let offset = place - from;
    let level = DVec3::new(offset.x, offset.y, 0.0);
    let squared = distance * distance - offset.z * offset.z;
    match squared > 0.0 && level.length() > 0.0 {
        true => from + level.normalize() * squared.sqrt() + DVec3::Z * offset.z,
        false => from + offset.normalize_or(DVec3::Y) * distance,
    }
}

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
        let planted = self.plant_feet(transfer, limb_parts, &targets);
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

    /// Finds the contacts of ankles and toes, and returns the targets with planted feet. Contacts of an ankle and a toe at
    /// one time are at the length of the foot.
    fn plant_feet(
        &mut self,
        transfer: &CharacterTransfer,
        limb_parts: &[Option<BodyPart>],
        targets: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        let (n, rate) = (self.limbs.all.len(), self.frame_rate);
        let detection = self.options.contacts;
        let path = |limb: usize| -> Vec<Vector3<f64>> {
            targets.iter().skip(limb).step_by(n).copied().collect()
        };
        let mut contacts: Vec<Vec<FootContact>> = vec![Vec::new(); n];
        for (limb, contacts) in contacts.iter_mut().enumerate() {
            let driven = &self.limbs.all[limb];
            if !driven.makes_contact {
                continue;
            }
            let positions = path(limb);
            let height = |frame: usize| positions[frame].z - driven.clearance;
            let spans = detection.spans(&positions, height, rate);
            let found = spans
                .iter()
                .map(|span| foot_contact(driven, span, &positions));
            contacts.extend(found);
        }
        for (leg, limbs) in LEGS.iter().zip(foot_limbs(limb_parts)) {
            if let [Some(ankle), Some(toe)] = limbs {
                keep_foot_length(&mut contacts, [ankle, toe], transfer.foot_length(leg));
            }
        }
        let lead = detection.lead_frames(rate);
        let mut planted = targets.to_vec();
        for (limb, contacts) in contacts.iter().enumerate() {
            if !self.limbs.all[limb].makes_contact {
                continue;
            }
            let clearance = self.limbs.all[limb].clearance;
            let above: Vec<_> = path(limb)
                .into_iter()
                .map(|at| lifted(at, clearance))
                .collect();
            let foot = plant_at(contacts, &above, Vector3::UNITS[2], None, lead);
            let of_limb = planted.iter_mut().skip(limb).step_by(n);
            for (target, position) in of_limb.zip(foot.positions) {
                *target = position;
            }
        }
        let spans = contacts
            .into_iter()
            .enumerate()
            .flat_map(|(limb, contacts)| {
                let spans = contacts.into_iter().map(|contact| contact.span);
                spans.map(move |span| LimbContact { limb, span })
            });
        self.limb_contacts = spans.collect();
        planted
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
    pub(super) fn foot_targets(
        &self,
        limbs: &FootLimbs,
        transfer: &CharacterTransfer,
    ) -> FootTargets {
        let n = self.limbs.all.len();
        let mut levels = vec![0.0; n];
        let targets = (0..self.frames()).map(|frame| {
            self.contact_levels(frame, &mut levels);
            let at = |limb: usize| {
                let target = self.targets.get(frame * n + limb);
                target.map(|target| DVec3::from_array(target.to_array()))
            };
            std::array::from_fn(|leg| {
                let [ankle, toe] = limbs[leg];
                let ankle = ankle?;
                let contacts = [levels[ankle], toe.map_or(0.0, |toe| levels[toe])];
                let length = transfer.foot_length(&LEGS[leg]);
                let toe = toe.and_then(at);
                Some(FootTarget::with_length(at(ankle)?, toe, length, contacts))
            })
        });
        targets.collect()
    }
}
