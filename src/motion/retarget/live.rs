//! A person's places as they come, on a model: nothing waits for what comes later.

use std::collections::VecDeque;

use super::limbs::Limbs;
use super::{BodyFollower, RetargetError, Retargeting};
use crate::motion::ContactDetection;
use crate::spatial::Vector3;

/// The places of so many frames back tell how fast something moves, as captures tremble.
const BACK: usize = 4;

/// Follows a person live: one frame's places in, that frame's configuration out, in a bounded number of steps.
///
/// The [`Retargeting`] that it is made by has measured the person: their limbs and the ground. What stands is known here
/// from the frames before alone, so a foot is held some frames later than where a whole capture is known.
#[derive(Clone, Debug)]
pub struct LiveFollower {
    limbs: Limbs,
    follower: BodyFollower,
    contacts: ContactDetection,
    frame_rate: f64,
    joints: usize,
    places: Vec<Vector3<f64>>,
    /// Where the driven points should have been, the last frame at the end.
    before: VecDeque<Vec<Vector3<f64>>>,
    /// Over how many frames each has been still.
    still: Vec<usize>,
    firmness: Vec<f64>,
}

impl Retargeting<'_> {
    /// A follower of the same person on the same model for frames that are still to come, whose joints are the
    /// capture's.
    ///
    /// # Errors
    /// As [`follower`](Self::follower).
    pub fn live(&self) -> Result<LiveFollower, RetargetError> {
        let limbs = self.limbs.clone();
        let driven = limbs.all.len();
        Ok(LiveFollower {
            follower: self.follower()?,
            contacts: self.options.contacts,
            frame_rate: self.frame_rate,
            joints: self.joints,
            places: Vec::with_capacity(driven),
            before: VecDeque::with_capacity(BACK),
            still: vec![0; driven],
            firmness: vec![0.0; driven],
            limbs,
        })
    }
}

impl LiveFollower {
    getters! {
        /// Where the body is.
        pub fn q(&self) -> &[f64] = self.follower.q();
        /// How many joints a frame has.
        pub fn joints(&self) -> usize = self.joints;
        /// Frames a second, at which limits of speed hold.
        pub fn frame_rate(&self) -> f64 = self.frame_rate;
    }

    /// Goes on to the next frame: where the capture's joints are, in its order, unit and axes. Returns the configuration.
    /// Where a place is not finite, the body stays.
    ///
    /// # Errors
    /// Another number of joints.
    pub fn step(&mut self, captured: &[Vector3<f64>]) -> Result<&[f64], RetargetError> {
        if captured.len() != self.joints {
            return Err(RetargetError::NotFrames {
                numbers: 3 * captured.len(),
                joints: self.joints,
            });
        }
        if !captured.iter().all(Vector3::is_finite) {
            return Ok(self.follower.q());
        }
        self.limbs.place(captured, &mut self.places);
        self.feel();
        self.follower.follow(&self.places, &self.firmness)?;
        Ok(self.follower.q())
    }

    /// Tells what stands by how far it has come in the last frames, and keeps it over the ground.
    fn feel(&mut self) {
        let shortest = (self.contacts.shortest_s * self.frame_rate).ceil().max(1.0) as usize;
        let oldest = self.before.front();
        let frames = self.before.len().max(1) as f64;
        let limbs = self.limbs.all.iter().enumerate();
        for (k, limb) in limbs.filter(|(_, limb)| limb.stands) {
            let at = &mut self.places[k];
            let moved = oldest.map_or(f64::INFINITY, |places| (*at - places[k]).norm());
            let is_still = moved * self.frame_rate / frames <= self.contacts.speed
                && at.z - limb.clearance <= self.contacts.height;
            self.still[k] = match is_still {
                true => (self.still[k] + 1).min(shortest),
                false => 0,
            };
            self.firmness[k] = self.still[k] as f64 / shortest as f64;
            at.z = at.z.max(limb.clearance);
        }
        if self.before.len() == BACK {
            self.before.pop_front();
        }
        self.before.push_back(self.places.clone());
    }
}
