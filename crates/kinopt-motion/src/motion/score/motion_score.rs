//! Figures of a scored motion.

use super::{ScoreTerm, Spread};

/// Figures of a motion. The total is the sum of the terms: smaller is better.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionScore {
    /// Number of scored samples.
    pub frames: usize,
    /// Samples per second.
    pub frame_rate: f64,
    /// Weighted sum of the terms.
    pub total: f64,
    /// Terms of the total, with their weights.
    pub terms: Vec<ScoreTerm>,
    /// Rotation about the vertical from the capture to the motion, degrees.
    pub heading: f64,
    /// Direction errors of the limbs. Empty without a subject.
    pub limbs: Vec<LimbAngle>,
    /// Position errors of hands and feet. Empty without a subject.
    pub ends: Vec<EndError>,
    /// Feet during contact; `None` if the model has no known feet.
    pub feet: Option<FootMotion>,
    /// Penetration of the ground by the model.
    pub penetration: GroundPenetration,
    /// Jerk of joints and of hands, feet and head.
    pub jerk: JerkScore,
    /// Joint positions and velocities outside their limits.
    pub limits: LimitExcess,
    /// Collisions, if a checker is given.
    pub collisions: Option<CollisionShare>,
}

/// Direction error of a limb.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LimbAngle {
    /// Name of the limb, such as `left_forearm`.
    pub limb: String,
    /// Angle between the limb of the subject and that of the model, degrees.
    pub angle: Spread,
}

/// Position error of a hand or a foot.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct EndError {
    /// Name of the end, such as `left_hand`.
    pub end: String,
    /// Distance between the ends of subject and model, relative to the length of the limb. Each is measured from its
    /// shoulder or hip joint and divided by the length of its arm or leg.
    pub error: Spread,
}

/// Motion of the feet during contact.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FootMotion {
    /// True if the contacts are those of the subject; else a point near its lowest height is in contact.
    pub of_subject: bool,
    /// Number of contacts.
    pub contacts: usize,
    /// Largest horizontal distance from the touchdown position, over the contacts, metres.
    pub sliding: Spread,
    /// Horizontal speed over the samples in contact, m/s.
    pub sliding_speed: Spread,
    /// Contacts of the subject that the model does not hold.
    pub lost_contacts: Vec<LostSubjectContact>,
}

/// Contact of the subject that the model does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LostSubjectContact {
    /// First sample more than 3 cm from the touchdown position, for a leg of 0.9 m. The distance is relative to the
    /// leg.
    pub frame: usize,
    /// Captured joint of the foot.
    pub joint: String,
}

/// Penetration of the ground by the shapes of a model, or without shapes by its frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct GroundPenetration {
    /// Depth of the lowest point below the ground over all samples, metres; 0 above the ground.
    pub depth: Spread,
    /// Share of the samples deeper than 1 mm.
    pub share: f64,
}

/// Jerk of a motion: third differences over the sample time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct JerkScore {
    /// Jerk of the joint angles without the base, rad/s³.
    pub joints: Spread,
    /// Jerk of head, hands and ankles, m/s³.
    pub ends: Spread,
    /// Jerk of the subject's head, hands and ankles, scaled to the model's legs, m/s³.
    pub subject_ends: Option<Spread>,
}

/// Joint positions and velocities outside their limits.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LimitExcess {
    /// Share of the samples with a joint outside its position or velocity limits.
    pub share: f64,
    /// Share of the samples with a joint outside its position limits.
    pub position_share: f64,
    /// Largest distance outside the position limits, radians or metres.
    pub position: f64,
    /// Share of the samples with a joint faster than its velocity limit.
    pub velocity_share: f64,
    /// Largest ratio of a joint's velocity to its limit; 0 if no joint has a velocity limit.
    pub velocity_ratio: f64,
    /// Names of the joints outside their limits.
    pub joints: Vec<String>,
}

/// Samples in collision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CollisionShare {
    /// Share of the samples in collision.
    pub share: f64,
    /// Largest penetration depth of a pair, metres.
    pub depth: f64,
}
