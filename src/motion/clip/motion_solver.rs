//! Solves motions: all frames as one, or window by window.

use std::sync::atomic::AtomicBool;

use super::bounds::Inward;
use super::evaluator::{Evaluator, Stretch};
use super::frame_residuals::FrameResiduals;
use super::interior_point::{Limits, Window};
use super::per_frame::per_frame;
use super::solution::Report;
use super::{MotionError, MotionProblem, MotionSolution};
use crate::bad_option::{AT_LEAST_0, AT_LEAST_ONE, BadOption};
use crate::search::check_start;

/// How a motion is cut into windows: each is solved with some frames ahead of its own, which the next one solves anew
/// from where the first ended. Neighbours agree at their seam, as the second begins with the first one's last frames
/// held, and what is beyond the frames ahead hardly pulls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Windows {
    /// How many frames a window keeps.
    pub frames: usize,
    /// How many more it looks at.
    pub ahead: usize,
}

impl Windows {
    /// Windows that keep so many frames and look at so many more.
    #[must_use]
    pub fn new(frames: usize, ahead: usize) -> Self {
        Self { frames, ahead }
    }
}

/// Solves a [`MotionProblem`]: a first motion frame by frame, then all frames together.
///
/// Memory and time are linear in the frames; in windows, memory is that of one.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionSolver {
    tolerance: f64,
    max_iterations: usize,
    curvature: bool,
    slip_m: f64,
    windows: Option<Windows>,
    inward: Inward,
}

impl Default for MotionSolver {
    /// To 1e-8 of the cost and 1e-8 m of slip a frame, 200 iterations a window, with curvature, all frames as one.
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            max_iterations: 200,
            curvature: true,
            slip_m: 1e-8,
            windows: None,
            inward: Inward::ALL,
        }
    }
}

impl MotionSolver {
    setters! {
        /// Ends where a step promises, and bounds withhold, no more than this share of the cost. At least 0.
        pub fn with_tolerance(mut self, share: f64) { self.tolerance = share }
        /// At most so many iterations a window.
        pub fn with_max_iterations(mut self, iterations: usize) { self.max_iterations = iterations }
        /// Whether frames bend as they do, after ten steps or where a step had to be cut, or as JᵀJ says all the time:
        /// less exact where targets are far out of reach, and much less work a step.
        pub fn with_curvature(mut self, curvature: bool) { self.curvature = curvature }
        /// What is held slips by no more than this from a frame to the next, in metres, where six rounds suffice. At least 0.
        pub fn with_slip(mut self, metres: f64) { self.slip_m = metres }
        /// In windows, or all frames as one.
        pub fn with_windows(mut self, windows: Option<Windows>) { self.windows = windows }
    }

    /// Takes the start for a good one, which is hardly moved off its bounds.
    #[must_use]
    pub(in crate::motion) fn with_good_start(mut self) -> Self {
        self.inward = Inward::LITTLE;
        self
    }

    /// Solves a motion, from a configuration near its first frame's.
    ///
    /// # Errors
    /// A start that is none of the model's, options out of range, fixed frames that speed limits part, residuals that
    /// are not finite.
    pub fn solve(
        &self,
        motion: &MotionProblem,
        start: &[f64],
    ) -> Result<MotionSolution, MotionError> {
        let n = motion.variables();
        let first = variables(motion, start)?;
        let mut x = vec![0.0; motion.frames * n];
        per_frame(motion, &mut FrameResiduals::new(motion), &first, &mut x)?;
        self.minimise(motion, x, &mut |_| (), None)
    }

    /// Solves a motion from one near it: a configuration a frame, one after the other. It need not keep any limit.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_near(
        &self,
        motion: &MotionProblem,
        start: &[f64],
    ) -> Result<MotionSolution, MotionError> {
        self.solve_near_with_progress(motion, start, &mut |_| ())
    }

    /// The same; `progress` hears after each window how many frames are done.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_near_with_progress(
        &self,
        motion: &MotionProblem,
        start: &[f64],
        progress: &mut dyn FnMut(usize),
    ) -> Result<MotionSolution, MotionError> {
        self.solve_near_unless(motion, start, progress, None)
    }

    /// As [`solve_near_with_progress`](Self::solve_near_with_progress), until the flag is set, which every iteration reads.
    pub(in crate::motion) fn solve_near_unless(
        &self,
        motion: &MotionProblem,
        start: &[f64],
        progress: &mut dyn FnMut(usize),
        cancelled: Option<&AtomicBool>,
    ) -> Result<MotionSolution, MotionError> {
        let n = motion.configuration_len();
        if start.len() != motion.frames * n {
            return Err(MotionError::Length {
                what: "a motion to start from".to_owned(),
                given: start.len(),
                expected: motion.frames * n,
            });
        }
        let mut x = Vec::with_capacity(motion.frames * motion.variables());
        for q in start.chunks_exact(n.max(1)) {
            x.extend(variables(motion, q)?);
        }
        self.minimise(motion, x, progress, cancelled)
    }

    fn minimise(
        &self,
        motion: &MotionProblem,
        mut x: Vec<f64>,
        progress: &mut dyn FnMut(usize),
        cancelled: Option<&AtomicBool>,
    ) -> Result<MotionSolution, MotionError> {
        BadOption::check("tolerance", self.tolerance, AT_LEAST_0)?;
        BadOption::check("slip", self.slip_m, AT_LEAST_0)?;
        let windows = self.windows.unwrap_or(Windows {
            frames: motion.frames,
            ahead: 0,
        });
        BadOption::check(
            "the frames of a window",
            windows.frames as f64,
            AT_LEAST_ONE,
        )?;
        let n = motion.variables();
        let [first, last] = &motion.ends;
        if let Some(first) = first {
            x[..n].copy_from_slice(first);
        }
        if let Some(last) = last {
            x[(motion.frames - 1) * n..].copy_from_slice(last);
        }
        let limits = Limits {
            tolerance: self.tolerance,
            iterations: self.max_iterations,
            curvature: self.curvature,
            slip_m: self.slip_m,
            inward: self.inward,
        };
        let mut evaluator = Evaluator::new(motion);
        let mut report = Report::new(motion);
        let mut begin = 0;
        while begin < motion.frames {
            let keep = (begin + windows.frames).min(motion.frames);
            let end = (keep + windows.ahead).min(motion.frames);
            let held = begin.min(motion.bandwidth());
            let stretch = begin - held..end;
            let mut window = Window {
                motion,
                evaluator: &mut evaluator,
                at: Stretch {
                    first: stretch.start,
                    held,
                },
                fixed: motion.fixed(&stretch, held),
                cancelled,
            };
            let own = &mut x[stretch.start * n..stretch.end * n];
            let outcome = window.minimise(own, limits)?;
            report.take(&outcome, stretch.start, begin..keep);
            begin = if end == motion.frames { end } else { keep };
            progress(begin);
        }
        Ok(report.finish(&mut evaluator, &x))
    }
}

/// The variables of a configuration.
fn variables(motion: &MotionProblem, q: &[f64]) -> Result<Vec<f64>, MotionError> {
    check_start(&motion.problem, q)?;
    let mut x = vec![0.0; motion.variables()];
    motion.problem.parameters().gather(q, &mut x);
    Ok(x)
}
