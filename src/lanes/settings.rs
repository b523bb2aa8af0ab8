//! The task, as the iteration needs it.

use super::axis_goal::AxisGoal;
use super::options::LaneOptions;

/// The numbers of the iteration, the same for all lanes; lengths are those of the solver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    /// Position counts as reached below this, lengths.
    pub(crate) position_tolerance: f64,
    /// Orientation counts as reached below this, radians.
    pub(crate) orientation_tolerance: f64,
    /// Lengths that weigh as much as one radian.
    pub(crate) length_per_radian: f64,
    /// λ = damping · twice the cost at the start of an attempt.
    pub(crate) damping: f64,
    /// Whether the goal is not the full pose.
    pub(crate) weighted: bool,
    /// Weights and dead bands of the six components of such a goal.
    pub(crate) axes: AxisGoal,
    /// Twice the cost below which one more step should reach.
    pub(crate) closing_twice_cost: f64,
    /// Twice the cost of a start below which the first attempt alone is made.
    pub(crate) nearby_twice_cost: f64,
    /// Whether a step that leads onto the goal by its linear model, and is short, ends the attempt, and not only one from so near.
    pub(crate) carries: bool,
    /// An attempt whose error has not halved in this many iterations is given up.
    pub(crate) stall_limit: f64,
}

/// One more step is trusted to reach below twice the cost of this times the tolerance, lengths.
const CLOSING: f64 = 0.1;

impl Settings {
    /// The numbers that valid options ask for.
    pub(crate) fn new(options: &LaneOptions, lengths_per_metre: f64) -> Self {
        // Slightly inside, so that rounding in the judge's other order of operations cannot refuse.
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
            closing_twice_cost: CLOSING * smaller,
            nearby_twice_cost: nearby * nearby,
            carries: false,
        }
    }
}
