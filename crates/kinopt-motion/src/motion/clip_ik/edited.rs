//! Result of inverse kinematics over a clip.

use super::BeyondLimit;
use glam::DVec3;

use kinopt_animation::animation::Clip;
use kinopt_kinematics::skeleton::BoneId;

/// Foot plant: interval of a clip in which a foot is in contact with the ground.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FootPlant {
    /// Bone of the foot.
    pub bone: BoneId,
    /// First and last time in the clip, seconds.
    pub span: [f64; 2],
    /// Position of the bone's origin during contact, in the model.
    pub place: DVec3,
    /// Largest distance from `place` at any key of the new clip.
    pub slide: f64,
    /// Largest distance from `place` between keys, where joints are interpolated.
    pub stray: f64,
}

/// Largest error of a bone with a target.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReachResult {
    /// Bone with the target.
    pub bone: BoneId,
    /// Largest distance of the bone's origin from its target at any key of the new clip.
    pub miss: f64,
    /// Time of the largest distance, seconds in the clip.
    pub at: f64,
}

/// Errors of an edited clip. Lengths are in the armature's unit.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct EditReport {
    /// Foot plants, grouped by foot.
    pub stances: Vec<FootPlant>,
    /// Results of the bones with targets, planted feet first.
    pub led: Vec<ReachResult>,
    /// Largest displacement of the root from its position in the clip.
    pub root_moved: f64,
    /// Limits of a rig's joints that its keys exceed within the spans, one entry per angle. Either unchanged keys exceed
    /// them, or no change satisfies all of them at once.
    pub beyond: Vec<BeyondLimit>,
}

/// New clip with a report.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct EditedClip {
    /// New clip. Channels of bones that did not move are unchanged, as are keys outside the spans.
    pub clip: Clip,
    /// Errors of the clip.
    pub report: EditReport,
}
