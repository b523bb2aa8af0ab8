//! Residuals, their derivatives and problem statements.

mod bounds_and_bases;
mod builder_errors;
mod derivative_routes;
mod error_units;
mod handwritten_derivatives;
mod inequalities;
mod look_at_from_behind;
mod numeric_residuals;
mod posture_weights;
mod support_polygons;
mod target_slopes;
mod target_steps;
mod task_residuals;
mod viewing_rays;
mod whole_robots;
mod wrong_shapes;
