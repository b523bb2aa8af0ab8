//! Retargeting to characters by rotations.
//!
//! | file | content |
//! |---|---|
//! | `correspondence.rs` | source of each bone's rotation: chains, fingers, equal names, twist bones |
//! | `source.rs`, `alignment.rs` | reference pose of the subject, and alignment of the character's rest pose |
//! | `position_frames.rs` | rotations from positions, for captures without rotations |
//! | `proportions.rs`, `feet.rs` | ratio of the legs, targets and contacts of the feet |
//! | `transfer.rs`, `leg.rs` | one frame: rotations, hips, two-bone IK of the legs |
//! | `trunk.rs`, `stance.rs` | directions of trunk and neck, places of hips and free feet |
//! | `onto_character.rs` | fit of a capture to a character |
//! | `motion.rs`, `follower.rs` | recorded motions, online frames |

mod alignment;
mod angles;
mod bones;
mod correspondence;
mod feet;
mod follower;
mod leg;
mod motion;
mod onto_character;
mod pose;
mod position_frames;
mod proportions;
mod rotation;
mod source;
mod stance;
mod transfer;
mod trunk;

pub(super) use follower::CharacterFollower;
pub(super) use motion::CharacterMotion;
pub(super) use transfer::SubjectFrame;
