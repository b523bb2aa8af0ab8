//! Residuals, their derivatives and how problems are stated.

mod builder_errors;
mod derivative_routes;
mod look_at_from_behind;
mod mouse_rays;
mod task_residuals;
mod wrong_shapes;
