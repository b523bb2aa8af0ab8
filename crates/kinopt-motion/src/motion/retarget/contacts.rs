//! Contacts of limbs in the targets of a capture.

use std::ops::Range;

use super::limb::DrivenLimb;
use super::limbs::Limbs;
use super::on_terrain::LimbGround;
use super::orientations::{direction, horizontal};
use super::terrain::{GroundPlane, Terrain};
use crate::motion::ContactDetection;
use crate::motion::contact::{FootContact, mean_position, plant_at};
use kinopt_kinematics::spatial::Vector3;

/// Height below which a contact is moved onto the ground, metres.
const MAX_SNAP_HEIGHT: f64 = 0.04;

/// Largest slope from the flat position to which a foot in contact is levelled.
const MAX_LEVELLED_SLOPE: f64 = 0.3;

/// Contact of a limb over a span of capture frames.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LimbContact {
    pub(super) limb: usize,
    pub(super) span: Range<usize>,
}

/// Finds the contacts of limbs, and plants their targets (capture frame by capture frame) there, on the ground or above
/// it. Returns the contacts, and the ground under each limb.
pub(super) fn plant_limbs(
    detection: &ContactDetection,
    limbs: &Limbs,
    rate: f64,
    terrain: Option<&Terrain>,
    targets: &mut [Vector3<f64>],
) -> (Vec<LimbContact>, Vec<LimbGround>) {
    let n = limbs.all.len();
    let mut contacts: Vec<LimbContact> = Vec::new();
    let mut grounds: Vec<LimbGround> = Vec::new();
    let planted = limbs.all.iter().enumerate();
    for (index, limb) in planted.filter(|(_, limb)| limb.makes_contact) {
        let positions: Vec<_> = targets.iter().skip(index).step_by(n).copied().collect();
        let height = |frame: usize| positions[frame].z - limb.clearance;
        let spans = detection.spans(&positions, height, rate);
        let limb_contacts = spans.iter().map(|span| {
            let contact = foot_contact(limb, span, &positions);
            let ankle = ankle_contact(limbs, index, span, &contacts)
                .map(|frame| targets[frame * n + limb.parent.unwrap_or(0)]);
            match ankle {
                Some(ankle) => levelled(limbs, index, ankle, contact),
                None => contact,
            }
        });
        let mut limb_contacts: Vec<_> = limb_contacts.collect();
        let planes = limb_contacts.iter_mut().map(|contact| {
            let middle = (contact.span.start + contact.span.end) / 2;
            let plane = terrain.map_or(GroundPlane::LEVEL, |terrain| {
                terrain.plane(&foot_positions(
                    limbs,
                    index,
                    contact.position,
                    &targets[middle * n..][..n],
                ))
            });
            contact.ground = plane.height(contact.position.x, contact.position.y)
                + limb.clearance * (1.0 / plane.normal().z - 1.0);
            plane
        });
        let planes: Vec<GroundPlane> = planes.collect();
        let above: Vec<_> = positions
            .iter()
            .map(|position| lifted(*position, limb.clearance))
            .collect();
        let lead = detection.lead_frames(rate);
        let height = |position: Vector3<f64>| {
            terrain.map_or(0.0, |terrain| terrain.height(position.x, position.y))
        };
        let ground: Option<&dyn Fn(Vector3<f64>) -> f64> = match terrain {
            Some(_) => Some(&height),
            None => None,
        };
        let foot = plant_at(&limb_contacts, &above, Vector3::UNITS[2], ground, lead);
        let limb_targets = targets.iter_mut().skip(index).step_by(n);
        for (target, position) in limb_targets.zip(foot.positions) {
            *target = position;
        }
        grounds.push(LimbGround {
            limb: index,
            heights: foot.ground,
            planes,
        });
        contacts.extend(
            spans
                .into_iter()
                .map(|span| LimbContact { limb: index, span }),
        );
    }
    (contacts, grounds)
}

/// Returns the positions of ankle and toe of a foot whose limb is in contact at a position, as x and y.
fn foot_positions(
    limbs: &Limbs,
    limb: usize,
    position: Vector3<f64>,
    targets: &[Vector3<f64>],
) -> Vec<(f64, f64)> {
    let parent = limbs.all[limb].parent;
    let is_of_foot = |(other, candidate): &(usize, &DrivenLimb)| {
        let is_related = parent == Some(*other) || candidate.parent == Some(limb);
        candidate.makes_contact && is_related
    };
    let others = limbs.all.iter().enumerate().filter(is_of_foot);
    let others = others.map(|(other, _)| (targets[other].x, targets[other].y));
    others.chain([(position.x, position.y)]).collect()
}

/// Returns a contact at the mean position over a span, on the ground if it is near.
pub(super) fn foot_contact(
    limb: &DrivenLimb,
    span: &Range<usize>,
    positions: &[Vector3<f64>],
) -> FootContact {
    let mut position = lifted(mean_position(&positions[span.clone()]), limb.clearance);
    if position.z - limb.clearance < MAX_SNAP_HEIGHT {
        position.z = limb.clearance;
    }
    FootContact {
        span: span.clone(),
        position,
        ground: 0.0,
    }
}

/// Returns the middle frame of the longest contact of a toe's ankle during a contact of the toe.
fn ankle_contact(
    limbs: &Limbs,
    toe: usize,
    span: &Range<usize>,
    contacts: &[LimbContact],
) -> Option<usize> {
    limbs.orientations.foot_of_toe(toe)?;
    let ankle = limbs.all[toe].parent?;
    let common = contacts.iter().filter(|contact| contact.limb == ankle);
    let common =
        common.map(|contact| contact.span.start.max(span.start)..contact.span.end.min(span.end));
    let longest = common
        .filter(|common| !common.is_empty())
        .max_by_key(ExactSizeIterator::len)?;
    Some((longest.start + longest.end) / 2)
}

/// Moves the contact of a toe to where it is on a flat foot with the ankle at a position, unless the foot is steep.
fn levelled(
    limbs: &Limbs,
    toe: usize,
    ankle: Vector3<f64>,
    mut contact: FootContact,
) -> FootContact {
    let offset = contact.position - ankle;
    let flat = limbs
        .orientations
        .foot_of_toe(toe)
        .zip(direction(horizontal(offset)));
    if let Some((foot, forward)) = flat {
        let flat = foot.flat_toe_offset(forward);
        if (flat - offset).norm() < MAX_LEVELLED_SLOPE * flat.norm() {
            contact.position = ankle + flat;
        }
    }
    contact
}

/// Moves a position below the ground up to it.
pub(super) fn lifted(position: Vector3<f64>, clearance: f64) -> Vector3<f64> {
    Vector3::new(position.x, position.y, position.z.max(clearance))
}
