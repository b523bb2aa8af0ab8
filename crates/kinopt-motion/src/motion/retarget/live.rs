//! Live retargeting of captured positions, without look-ahead.

use std::collections::VecDeque;

use glam::DQuat;

use super::character::{CharacterFollower, SubjectFrame};
use super::frame_targets::FrameTargets;
use super::limbs::Limbs;
use super::{BodyFollower, RetargetError, Retargeting};
use crate::motion::ContactDetection;
use kinopt_kinematics::spatial::Vector3;

/// Number of capture frames over which the speed of a point is measured, because captures are noisy.
const SPEED_WINDOW: usize = 4;

/// Live retargeter: one capture frame in, its configuration out, in a bounded number of iterations.
///
/// Its [`Retargeting`] has measured the limbs and ground of the subject. Contacts are detected from past capture frames
/// only, so feet are locked some frames later than with a complete capture.
#[derive(Clone, Debug)]
pub struct LiveFollower {
    limbs: Limbs,
    follower: BodyFollower,
    contacts: ContactDetection,
    frame_rate: f64,
    joints: usize,
    positions: Vec<Vector3<f64>>,
    directions: Vec<Vector3<f64>>,
    /// Previous targets of the driven points, the last ones at the end.
    history: VecDeque<Vec<Vector3<f64>>>,
    /// Number of capture frames for which each point has been still.
    still_frames: Vec<usize>,
    contact_levels: Vec<f64>,
    /// Transfer of rotations to a character.
    character: Option<CharacterFollower>,
}

impl Retargeting<'_> {
    /// Creates a live retargeter for the same subject and model. Its capture frames have the joints of the capture.
    ///
    /// # Errors
    /// Returns the errors of [`follower`](Self::follower).
    pub fn live(&self) -> Result<LiveFollower, RetargetError> {
        let limbs = self.limbs.clone();
        let driven = limbs.all.len();
        Ok(LiveFollower {
            follower: self.follower()?,
            contacts: self.options.contacts,
            frame_rate: self.frame_rate,
            joints: self.joints,
            positions: Vec::with_capacity(driven),
            directions: Vec::new(),
            history: VecDeque::with_capacity(SPEED_WINDOW),
            still_frames: vec![0; driven],
            contact_levels: vec![0.0; driven],
            character: self.rotated_character_motion().map(|motion| {
                let q = self.body.model().neutral();
                let contacts = self.options.contacts;
                let inverse_scale = self.unit.inverse_scale();
                CharacterFollower::new(motion, contacts, self.frame_rate, (q, inverse_scale))
            }),
            limbs,
        })
    }
}

impl LiveFollower {
    /// Current configuration.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        match &self.character {
            Some(character) => character.q(),
            None => self.follower.q(),
        }
    }

    /// Number of joints of a capture frame.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Capture frames per second, the rate of the velocity limits.
    #[must_use]
    pub fn frame_rate(&self) -> f64 {
        self.frame_rate
    }

    /// Retargets the next capture frame and returns its configuration.
    ///
    /// `captured` are joint positions in the capture's order, unit and axes. If a position is not finite, the
    /// configuration stays unchanged. A character gets the rotations that the positions determine; see
    /// [`step_with_rotations`](Self::step_with_rotations).
    ///
    /// # Errors
    /// Returns an error if the number of joints is wrong.
    pub fn step(&mut self, captured: &[Vector3<f64>]) -> Result<&[f64], RetargetError> {
        self.step_to(captured, None)
    }

    /// Retargets the next capture frame with the rotations of its joints, and returns its configuration.
    ///
    /// `rotations` are unit quaternions w, x, y, z from the joints to the capture's world, as in
    /// [`JointRotations`](super::JointRotations). They are used if the capture has rotations. If a number is not finite,
    /// the configuration stays unchanged.
    ///
    /// # Errors
    /// Returns an error if the number of joints or rotations is wrong.
    pub fn step_with_rotations(
        &mut self,
        captured: &[Vector3<f64>],
        rotations: &[[f64; 4]],
    ) -> Result<&[f64], RetargetError> {
        if rotations.len() != self.joints {
            return Err(RetargetError::RotationCount {
                what: "rotations",
                given: rotations.len(),
                expected: self.joints,
            });
        }
        let unit = |[w, x, y, z]: &[f64; 4]| {
            let q = DQuat::from_xyzw(*x, *y, *z, *w);
            (q.is_finite() && q.length_squared() > 0.0).then(|| q.normalize())
        };
        let Some(rotations) = rotations.iter().map(unit).collect::<Option<Vec<DQuat>>>() else {
            return Ok(self.q());
        };
        self.step_to(captured, Some(&rotations))
    }

    fn step_to(
        &mut self,
        captured: &[Vector3<f64>],
        rotations: Option<&[DQuat]>,
    ) -> Result<&[f64], RetargetError> {
        if captured.len() != self.joints {
            return Err(RetargetError::NotFrames {
                numbers: 3 * captured.len(),
                joints: self.joints,
            });
        }
        if !captured.iter().all(Vector3::is_finite) {
            return Ok(self.q());
        }
        if let Some(character) = &mut self.character {
            character.step(SubjectFrame {
                positions: captured,
                rotations,
            });
            return Ok(self.q());
        }
        self.limbs
            .write_targets(captured, rotations, &mut self.positions);
        self.directions.clear();
        self.limbs
            .write_directions(captured, rotations, &mut self.directions);
        self.detect_contacts();
        self.follower.follow(&FrameTargets {
            positions: &self.positions,
            directions: &self.directions,
            contacts: &self.contact_levels,
            grasps: &[],
            grounds: &[],
        })?;
        Ok(self.follower.q())
    }

    /// Detects contacts from the speeds over the last capture frames, and keeps contact points above the ground.
    fn detect_contacts(&mut self) {
        let shortest = (self.contacts.shortest_s * self.frame_rate).ceil().max(1.0) as usize;
        let oldest = self.history.front();
        let frames = self.history.len().max(1) as f64;
        let limbs = self.limbs.all.iter().enumerate();
        for (k, limb) in limbs.filter(|(_, limb)| limb.makes_contact) {
            let position = &mut self.positions[k];
            let moved = oldest.map_or(f64::INFINITY, |positions| (*position - positions[k]).norm());
            let is_still = moved * self.frame_rate / frames <= self.contacts.speed
                && position.z - limb.clearance <= self.contacts.height;
            self.still_frames[k] = match is_still {
                true => (self.still_frames[k] + 1).min(shortest),
                false => 0,
            };
            self.contact_levels[k] = self.still_frames[k] as f64 / shortest as f64;
            position.z = position.z.max(limb.clearance);
        }
        if self.history.len() == SPEED_WINDOW {
            self.history.pop_front();
        }
        self.history.push_back(self.positions.clone());
    }
}
