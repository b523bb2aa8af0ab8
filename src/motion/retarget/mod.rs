//! People's movements on robots: captured places of joints become configurations of any model, within its limits of
//! position and speed, with feet that stand where the person's stood.
//!
//! A [`Capture`] is where joints are in each frame, a [`BodyMap`] which of them drives which frame of the model.
//! [`Retargeting`] fits the one to the other by the lengths of limbs, finds the ground and what stands still, and then
//! follows [frame by frame](Retargeting::per_frame), as a live follower would, or solves the [whole](Retargeting::whole).

mod body_map;
mod body_part;
mod bounded_descent;
mod capture;
mod clear_frames;
mod contacts;
mod driven_point;
mod error;
mod errors_of_frames;
mod feet;
mod figure_target;
mod first_stance;
pub mod folder;
mod follower;
mod foot_shapes;
mod footholds;
mod hip_line;
mod known_maps;
mod limb_lengths;
mod limb_tree;
mod limbs;
mod limits_met;
mod live;
mod map_guess;
mod obstacles;
mod over_ground;
mod part_names;
mod problem_of_frame;
mod proportions;
mod retargeted;
mod retargeting;
mod sole;
mod switchable_residual;
mod up_detection;
mod whole_movement;

pub use super::ContactDetection;
pub use body_map::{BodyMap, Drive, UpAxis};
pub use body_part::BodyPart;
pub use capture::Capture;
pub use error::RetargetError;
pub use figure_target::FigureTarget;
pub use follower::BodyFollower;
pub use foot_shapes::FootShapes;
pub use known_maps::KnownSkeleton;
pub use limits_met::LimitMet;
pub use live::LiveFollower;
pub use map_guess::MapGuess;
pub use retargeted::{GivenUp, Retargeted, Touching};
pub use retargeting::{RetargetOptions, Retargeting};
