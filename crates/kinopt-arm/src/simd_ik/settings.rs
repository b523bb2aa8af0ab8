//! Parameters of the iteration, in lengths of the solver.

use super::axis_goal::AxisGoal;
use super::options::LaneOptions;

/// Parameters of the iteration, equal for all lanes; lengths are those of the solver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    /// Position tolerance, lengths of the solver.
    pub(crate) position_tolerance: f64,
    /// Orientation tolerance, radians.
    pub(crate) orientation_tolerance: f64,
    /// Lengths of the solver that weigh as much as one radian.
    pub(crate) length_per_radian: f64,
    /// Initial damping: λ is this factor times twice the cost.
    pub(crate) damping: f64,
    /// True unless the goal is the full pose.
    pub(crate) weighted: bool,
    /// Weights and dead bands of the six components of a weighted goal.
    pub(crate) axes: AxisGoal,
    /// Twice the cost below which one more step should reach the goal, lengths of the solver squared.
    pub(crate) closing_twice_cost: f64,
    /// Twice the cost of a start below which only the first attempt is made, lengths of the solver squared.
    pub(crate) nearby_twice_cost: f64,
    /// True if any short step onto the goal by its linear model ends an attempt, not only one from a near point.
    pub(crate) is_continuation: bool,
    /// Number of iterations without halving the error after which an attempt ends.
    pub(crate) stall_limit: f64,
}

/// Twice the cost per tolerance below which one more step should reach the goal, in lengths of the solver.
const CLOSING_TWICE_COST_PER_TOLERANCE: f64 = 0.1;

impl Settings {
    /// Converts options that are checked already.
    pub(crate) fn new(options: &LaneOptions, lengths_per_metre: f64) -> Self {
        // Slightly smaller, as the final check may round differently.
        let margin = 0.999;
        let position_tolerance = options.position_tolerance * lengths_per_metre;
        let length_per_radian = options.metres_per_radian * lengths_per_metre;
        let smaller = position_tolerance.min(options.orientation_tolerance * length_per_radian);
        let nearby = options.nearby * length_per_radian;
        let mut axes = options.axes;
        let half_widths = &mut axes.position_half_widths;
        *half_widths = half_widths.map(|half_width| half_width * lengths_per_metre);
        Self {
            position_tolerance: position_tolerance * margin,
            orientation_tolerance: options.orientation_tolerance * margin,
            length_per_radian,
            damping: options.damping,
            stall_limit: f64::from(options.stall_limit),
            weighted: !options.axes.is_full_pose(),
            axes,
            // Convergence is quadratic: the error after a step is about its square, in lengths.
            closing_twice_cost: CLOSING_TWICE_COST_PER_TOLERANCE * smaller,
            nearby_twice_cost: nearby * nearby,
            is_continuation: false,
        }
    }
}
