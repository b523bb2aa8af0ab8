//! People's movements on robots: captured places of joints become configurations of any model, within its limits of
//! position and speed, with feet that stand where the person's stood.
//!
//! A [`Capture`] is where joints are in each frame, a [`BodyMap`] which of them drives which frame of the model.
//! [`Retargeting`] fits the one to the other by the lengths of limbs, finds the ground and what stands still, and then
//! follows [frame by frame](Retargeting::per_frame), as a live follower would, or solves the [whole](Retargeting::whole).

mod body_map;
mod bounded_descent;
mod capture;
mod contacts;
mod driven_point;
mod error;
mod follower;
mod limbs;
mod retargeted;
mod retargeting;

pub use super::ContactDetection;
pub use body_map::{BodyMap, Drive, UpAxis};
pub use capture::Capture;
pub use error::RetargetError;
pub use follower::BodyFollower;
pub use retargeted::Retargeted;
pub use retargeting::{RetargetOptions, Retargeting};
