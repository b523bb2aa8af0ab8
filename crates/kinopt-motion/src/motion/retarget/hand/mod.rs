//! Retargeting of hands: fingertips of a robot hand follow those of a subject.
//!
//! The followed vectors are those from the base of each finger to its tip, and from the thumb's tip to the other tips
//! (Qin et al. 2023, "AnyTeleop", arXiv 2307.04577). They are scaled, and followed within the joint limits. Orientation
//! and sizes of both hands are measured, so no robot needs numbers of its own.

mod finger;
mod hand_map;
mod hand_retargeting;
mod palm;

pub use finger::Finger;
pub use hand_map::{FingerDrive, HandMap};
pub use hand_retargeting::{HandFollower, HandReport, HandRetargeting};
