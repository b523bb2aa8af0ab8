//! Scores of robot motions: limb directions and ends next to the person, feet, ground, jerk, limits and collisions.
//!
//! A [`MotionScorer`] measures the configurations of any program. The subject is the captured person, by its joint
//! positions, so no figure depends on targets that a retargeter computed. Without a subject, the score has the figures
//! that need none. The total is a weighted sum: smaller is better.

mod body_points;
mod definitions;
mod error;
mod feet;
mod ground;
mod heading;
mod joint_excess;
mod limb_angles;
mod motion_score;
mod score_terms;
mod scorer;
mod smoothness;
mod spread;
mod subject;

pub use error::ScoreError;
pub use heading::Heading;
pub use motion_score::{
    CollisionShare, EndError, FootMotion, GroundPenetration, JerkScore, LimbAngle, LimitExcess,
    LostSubjectContact, MotionScore,
};
pub use score_terms::{ScoreTerm, ScoreWeights};
pub use scorer::MotionScorer;
pub use spread::Spread;
