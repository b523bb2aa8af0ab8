//! Online retargeting to characters.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::DVec3;

use super::super::BodyPart;
use super::feet::at_distance;
use super::motion::{CharacterMotion, extend_configuration};
use super::proportions::LEGS;
use super::transfer::{FootTarget, SubjectFrame};
use crate::motion::ContactDetection;
use crate::motion::contact::smooth;

/// Number of capture frames over which the speed of a foot is measured, because captures are noisy.
const SPEED_WINDOW: usize = 4;
/// Height below which a contact is moved onto the ground, relative to the leg.
const MAX_SNAP_HEIGHT: f64 = 0.045;

/// Online retargeter of a character, without look-ahead.
#[derive(Clone, Debug)]
pub(in super::super) struct CharacterFollower {
    motion: Arc<CharacterMotion>,
    contacts: ContactDetection,
    frame_rate: f64,
    /// Ankle and toe of both legs.
    feet: [[FootContactState; 2]; 2],
    angles: Option<Vec<[f64; 3]>>,
    q: Vec<f64>,
    /// Factor from the unit of the solved body to that of the character.
    inverse_scale: f64,
}

/// Contact of an ankle or a toe.
#[derive(Clone, Debug, Default)]
struct FootContactState {
    /// Last places, the newest at the end.
    history: VecDeque<DVec3>,
    /// Number of capture frames for which the point has been still.
    still_frames: usize,
    /// Place of the contact.
    locked: Option<DVec3>,
    /// Weight of the contact, from 0 (free) to 1.
    level: f64,
}

impl CharacterFollower {
    /// Creates a follower at a configuration, for the contacts and frame rate of its motion. The factor is from the unit
    /// of the solved body to that of the character.
    pub(in super::super) fn new(
        motion: Arc<CharacterMotion>,
        contacts: ContactDetection,
        frame_rate: f64,
        (q, inverse_scale): (Vec<f64>, f64),
    ) -> Self {
        Self {
            motion,
            contacts,
            frame_rate,
            feet: Default::default(),
            angles: None,
            q,
            inverse_scale,
        }
    }

    /// Current configuration.
    pub(in super::super) fn q(&self) -> &[f64] {
        &self.q
    }

    /// Retargets the next capture frame.
    pub(in super::super) fn step(&mut self, subject: SubjectFrame<'_>) {
        let motion = Arc::clone(&self.motion);
        let transfer = &motion.transfer;
        let targets: [Option<FootTarget>; 2] = std::array::from_fn(|leg| {
            let [.., ankle, toe] = LEGS[leg];
            let length = transfer.foot_length(&LEGS[leg]);
            let [ankle_state, toe_state] = &mut self.feet[leg];
            let place = |part: BodyPart, state: &mut FootContactState, other: Option<DVec3>| {
                let place = transfer.foot_place(part, subject)?;
                let clearance = transfer.clearance(part);
                let settings = (&self.contacts, self.frame_rate);
                // Contacts of one foot are at its length.
                let place_of_contact = |place: DVec3| match other {
                    Some(other) => at_distance(place, other, length),
                    None => place,
                };
                let sizes = (clearance, transfer.sizes.leg);
                Some(state.advance(place, sizes, settings, place_of_contact))
            };
            let at_toe = toe_state.locked;
            let ankle_place = place(ankle, ankle_state, at_toe)?;
            let at_ankle = ankle_state.locked;
            let toe_place = place(toe, toe_state, at_ankle);
            let levels = [ankle_state.level, toe_state.level];
            Some(FootTarget::with_length(
                ankle_place,
                toe_place,
                length,
                levels,
            ))
        });
        let (pose, base) = transfer.pose(
            subject,
            Some(&targets),
            |missing| missing,
            self.angles.as_deref(),
        );
        self.q.clear();
        let (rotation, translation) = base;
        let base = (rotation, translation * self.inverse_scale);
        extend_configuration(&mut self.q, base, &pose.angles);
        self.angles = Some(pose.angles);
    }
}

impl FootContactState {
    /// Returns the target at the next place of the point: its contact if it is still, with blends before and after.
    fn advance(
        &mut self,
        place: DVec3,
        (clearance, leg): (f64, f64),
        (contacts, rate): (&ContactDetection, f64),
        place_of_contact: impl FnOnce(DVec3) -> DVec3,
    ) -> DVec3 {
        let oldest = self.history.front();
        let frames = self.history.len().max(1) as f64;
        let moved = oldest.map_or(f64::INFINITY, |oldest| oldest.distance(place));
        let is_still =
            moved * rate / frames <= contacts.speed && place.z - clearance <= contacts.height;
        let shortest = (contacts.shortest_s * rate).ceil().max(1.0) as usize;
        self.still_frames = if is_still {
            (self.still_frames + 1).min(shortest)
        } else {
            0
        };
        if self.history.len() == SPEED_WINDOW {
            self.history.pop_front();
        }
        self.history.push_back(place);
        let above = DVec3::new(place.x, place.y, place.z.max(clearance));
        let step = 1.0 / contacts.lead_frames(rate).max(1) as f64;
        if self.still_frames >= shortest {
            let snapped = match above.z - clearance < MAX_SNAP_HEIGHT * leg {
                true => DVec3::new(above.x, above.y, clearance),
                false => above,
            };
            self.locked.get_or_insert_with(|| place_of_contact(snapped));
            self.level = (self.level + step).min(1.0);
        } else {
            self.level = (self.level - step).max(0.0);
            if self.level == 0.0 {
                self.locked = None;
            }
        }
        self.locked
            .map_or(above, |locked| above.lerp(locked, smooth(self.level)))
    }
}
