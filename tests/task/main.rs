//! Residuals, their derivatives and how problems are stated.

mod builder_errors;
mod derivative_routes;
mod error_units;
mod look_at_from_behind;
mod mouse_rays;
mod moved_targets;
mod numeric_residuals;
mod own_derivatives;
mod posture_weights;
mod room_and_bases;
mod rooms;
mod support_points;
mod target_slopes;
mod task_residuals;
mod whole_bodies;
mod wrong_shapes;
