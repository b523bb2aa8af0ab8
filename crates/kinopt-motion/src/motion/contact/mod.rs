//! Contact of a character with its surroundings: detection, foot plants, shapes of feet, and points held in a trajectory.
//!
//! [`ContactDetection`] finds when a point rests. A foot plant then gives it one position for each contact.
//! [`FootShapes`] has the shapes that touch the ground, and [`Contact`] is a constraint of a trajectory.

mod detection;
mod foot_shapes;
mod held_points;
mod planting;

pub use detection::ContactDetection;
pub(super) use detection::{NOMINAL_LEG_LENGTH_M, smooth};
pub(super) use foot_shapes::FootBall;
pub use foot_shapes::FootShapes;
pub use held_points::Contact;
pub(super) use planting::{FootContact, Ground, PlantedFoot, mean_position, plant, plant_at};
