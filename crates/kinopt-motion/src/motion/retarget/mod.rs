//! Motion retargeting: captured joint positions become configurations of a model.
//!
//! The result respects the limits of position and velocity, and feet are in contact where the subject's feet were. A
//! [`Capture`] has the joint positions of each capture frame. A [`BodyMap`] assigns captured joints to frames of the
//! model. [`Retargeting`] scales the capture by limb lengths and finds the ground and contacts. It then solves [frame
//! by frame](Retargeting::per_frame), like an online retargeter, or the [whole trajectory](Retargeting::whole).

mod active_limits;
mod aligned_axis;
mod anatomy;
mod body_map;
mod body_part;
mod body_structure;
mod bounded_descent;
mod capture;
mod character;
mod collision_free_frames;
mod contacts;
mod driven_point;
mod error;
mod feet;
mod figure_target;
mod follower;
mod foot_headings;
mod footholds;
mod frame_errors;
mod frame_problem;
mod frame_targets;
mod hand;
mod held_object;
mod human_bones;
mod initial_pose;
mod joint_rotations;
mod known_maps;
mod limb;
mod limb_lengths;
mod limb_tree;
mod limbs;
mod live;
mod map_guess;
mod marker_set;
mod obstacles;
mod on_terrain;
mod orientations;
mod over_ground;
mod part_names;
mod pelvis_heading;
mod point_difference;
mod proportions;
mod relative_limb;
mod retarget_report;
mod retargeting;
mod sole;
mod stick_person;
mod subject_pose;
mod switchable_residual;
mod terrain;
mod unit;
mod up_detection;
mod whole_trajectory;

pub use super::contact::{ContactDetection, FootShapes};
pub use active_limits::LimitMet;
pub use body_map::{BodyMap, Drive, UpAxis};
pub use body_part::BodyPart;
pub use capture::Capture;
pub use error::RetargetError;
pub use figure_target::FigureTarget;
pub use follower::BodyFollower;
pub use hand::{Finger, FingerDrive, HandFollower, HandMap, HandReport, HandRetargeting};
pub use held_object::{HeldObject, ObjectShape};
pub use human_bones::HumanBones;
pub use joint_rotations::JointRotations;
pub use known_maps::KnownSkeleton;
pub use live::LiveFollower;
pub use map_guess::MapGuess;
pub(super) use part_names::parts_of;
pub use retarget_report::{LostContact, RetargetReport, Touching};
pub use retargeting::{RetargetOptions, Retargeting};
pub use terrain::{Terrain, TerrainPatch};

pub(super) use map_guess::parts_of_capture;
pub(super) use part_names::bare;
pub(super) use stick_person::stick_person;
