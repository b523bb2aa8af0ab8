//! Initial trajectory, sample by sample: each starts at the previous result, within the velocity limits.

use super::frame_residuals::{FrameResiduals, SingleFrame};
use super::{MotionError, MotionProblem};
use kinopt_solver::solver::{LevenbergMarquardt, Silent, SolverState, Stopping, minimise};

/// Maximum number of iterations of the first sample, and of each later sample.
const FIRST_FRAME_ITERATIONS: usize = 200;
const FRAME_ITERATIONS: usize = 8;
/// Gradient tolerance; an initial trajectory need not be more accurate.
const GRADIENT_TOLERANCE: f64 = 1e-4;

/// Writes all samples, starting with the variables `start`.
pub(super) fn per_frame(
    motion: &MotionProblem,
    residuals: &mut FrameResiduals<'_>,
    start: &[f64],
    x: &mut [f64],
) -> Result<(), MotionError> {
    let method = LevenbergMarquardt::default();
    let mut state = SolverState::default();
    let bounds = &motion.bounds;
    let (mut lower, mut upper) = (bounds.lower.clone(), bounds.upper.clone());
    let mut previous = start.to_vec();
    for (frame, x) in x.chunks_exact_mut(previous.len()).enumerate() {
        let steps = if frame == 0 {
            FIRST_FRAME_ITERATIONS
        } else {
            FRAME_ITERATIONS
        };
        let stopping = Stopping::default()
            .with_max_iterations(steps)
            .with_gradient_tolerance(GRADIENT_TOLERANCE);
        let mut single_frame = SingleFrame {
            residuals: &mut *residuals,
            frame,
            lower: &lower,
            upper: &upper,
        };
        minimise(
            &mut single_frame,
            &method,
            &previous,
            &stopping,
            &mut Silent,
            &mut state,
        )?;
        if !state.cost().is_finite() {
            return Err(MotionError::NotFinite { frame });
        }
        previous.copy_from_slice(state.x());
        x.copy_from_slice(&previous);
        for (variable, &step) in bounds.max_step.iter().enumerate() {
            lower[variable] = bounds.lower[variable].max(previous[variable] - step);
            upper[variable] = bounds.upper[variable].min(previous[variable] + step);
        }
    }
    Ok(())
}
