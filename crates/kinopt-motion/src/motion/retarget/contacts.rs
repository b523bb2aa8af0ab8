//! Contacts of limbs in the targets of a capture.

use std::ops::Range;

use super::limb::DrivenLimb;
use super::limbs::Limbs;
use crate::motion::ContactDetection;
use crate::motion::contact::{FootContact, mean_position, plant_at};
use kinopt_kinematics::spatial::Vector3;

/// Height below which a contact is moved onto the ground, metres.
const MAX_SNAP_HEIGHT: f64 = 0.04;

/// Contact of a limb over a span of capture frames.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LimbContact {
    pub(super) limb: usize,
    pub(super) span: Range<usize>,
}

/// Finds the contacts of limbs, and plants their targets (capture frame by capture frame) there, on the ground or above
/// it.
pub(super) fn plant_limbs(
    detection: &ContactDetection,
    limbs: &Limbs,
    rate: f64,
    targets: &mut [Vector3<f64>],
) -> Vec<LimbContact> {
    let n = limbs.all.len();
    let mut contacts = Vec::new();
    let planted = limbs.all.iter().enumerate();
    for (index, limb) in planted.filter(|(_, limb)| limb.makes_contact) {
        let positions: Vec<_> = targets.iter().skip(index).step_by(n).copied().collect();
        let height = |frame: usize| positions[frame].z - limb.clearance;
        let spans = detection.spans(&positions, height, rate);
        let limb_contacts: Vec<_> = spans
            .iter()
            .map(|span| foot_contact(limb, span, &positions))
            .collect();
        let above: Vec<_> = positions
            .iter()
            .map(|position| lifted(*position, limb.clearance))
            .collect();
        let lead = detection.lead_frames(rate);
        let foot = plant_at(&limb_contacts, &above, Vector3::UNITS[2], None, lead);
        let limb_targets = targets.iter_mut().skip(index).step_by(n);
        for (target, position) in limb_targets.zip(foot.positions) {
            *target = position;
        }
        contacts.extend(
            spans
                .into_iter()
                .map(|span| LimbContact { limb: index, span }),
        );
    }
    contacts
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

/// Moves a position below the ground up to it.
pub(super) fn lifted(position: Vector3<f64>, clearance: f64) -> Vector3<f64> {
    Vector3::new(position.x, position.y, position.z.max(clearance))
}
