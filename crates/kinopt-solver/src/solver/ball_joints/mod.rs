//! Variables of ball joints: rotation sets (swing cones, angle limits), and steps at the edge of one.

mod edge_frame;
mod edges;
mod rotation_sets;
mod turn_limit;

pub(crate) use edge_frame::Edge;
pub(crate) use rotation_sets::{RotationSets, Swing};
pub(super) use rotation_sets::{shorten_rotation_step, shorten_rotation_vector};
pub(crate) use turn_limit::TurnLimit;
