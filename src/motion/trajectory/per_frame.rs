//! Initial trajectory, sample by sample: each starts at the previous result, within the velocity limits.

use super::frame_residuals::{FrameAlone, FrameResiduals};
use super::{MotionError, MotionProblem};
use crate::solver::{LevenbergMarquardt, Silent, SolverState, Stopping, minimise};

/// Maximum number of iterations of the first sample, and of each later sample.
const FIRST_STEPS: usize = 200;
const STEPS: usize = 8;
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
    let mut at = start.to_vec();
    for (frame, x) in x.chunks_exact_mut(at.len()).enumerate() {
        let steps = if frame == 0 { FIRST_STEPS } else { STEPS };
        let stopping = Stopping::default()
            .with_max_iterations(steps)
            .with_gradient_tolerance(GRADIENT_TOLERANCE);
        let mut alone = FrameAlone {
            residuals: &mut *residuals,
            frame,
            lower: &lower,
            upper: &upper,
        };
        minimise(&mut alone, &method, &at, &stopping, &mut Silent, &mut state)?;
        if !state.cost().is_finite() {
            return Err(MotionError::NotFinite { frame });
        }
        at.copy_from_slice(state.x());
        x.copy_from_slice(&at);
        for (variable, &most) in bounds.most.iter().enumerate() {
            lower[variable] = bounds.lower[variable].max(at[variable] - most);
            upper[variable] = bounds.upper[variable].min(at[variable] + most);
        }
    }
    Ok(())
}
