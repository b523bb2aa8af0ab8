//! Body parts of joint trees: limbs, trunk, toes and fingers.

mod fingers;
mod joint_tree;
mod limb_pairs;
mod name_words;
mod recognition;

pub(super) use fingers::fingers;
pub(super) use joint_tree::JointTree;
pub(super) use name_words::{FingerName, is_twist};
pub(super) use recognition::{Anatomy, recognise};
