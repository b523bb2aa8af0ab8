//! A clip that was solved over, and the truth about it.

use glam::DVec3;

use crate::animation::Clip;
use crate::skeleton::BoneId;

/// A foot that stands over some seconds of a clip.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FootPlant {
    /// Which bone.
    pub bone: BoneId,
    /// The first and last moment of the clip, in seconds.
    pub span: [f64; 2],
    /// Where its origin stands, in the model.
    pub place: DVec3,
    /// How far it is from there at most at any key of the new clip.
    pub slide: f64,
    /// How far it is from there at most between keys: lines turn joints and do not lead feet.
    pub stray: f64,
}

/// A bone that was led, and how well.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReachResult {
    /// Which bone.
    pub bone: BoneId,
    /// How far its origin is from where it should be, at most at any key of the new clip.
    pub miss: f64,
    /// When that is, in seconds of the clip.
    pub at: f64,
}

/// A new clip and what is true of it. Lengths are in the armature's unit.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct EditedClip {
    /// The clip: channels of bones that did not move are as they were, keys outside the spans as well.
    pub clip: Clip,
    /// Where feet stand, foot by foot.
    pub stances: Vec<FootPlant>,
    /// What was asked for, planted feet first.
    pub led: Vec<ReachResult>,
    /// How far the root moves from where the clip has it, at most.
    pub root_moved: f64,
}
