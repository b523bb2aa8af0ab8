//! Solver of trajectories, as one problem or in windows.

use std::sync::atomic::AtomicBool;

use super::bounds::Inward;
use super::evaluator::SampleEvaluator;
use super::frame_residuals::FrameResiduals;
use super::interior_point::{InteriorPointOptions, Window};
use super::motion_report::WindowResults;
use super::per_frame::per_frame;
use super::stretch::SampleSpan;
use super::{MotionError, MotionProblem, MotionReport};
use kinopt_kinematics::Trajectory;
use kinopt_kinematics::bad_option::{AT_LEAST_0, AT_LEAST_ONE, BadOption};
use kinopt_solver::search::check_start;

/// Division of a trajectory into windows.
///
/// Each window is solved with some samples ahead, which the next window solves again. The last samples of a window stay
/// fixed in the next one, so the trajectory is continuous at the seam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Windows {
    /// Number of samples that a window keeps.
    pub frames: usize,
    /// Number of additional samples that a window solves.
    pub ahead: usize,
}

impl Windows {
    /// Creates windows that keep `frames` samples and solve `ahead` more.
    #[must_use]
    pub fn new(frames: usize, ahead: usize) -> Self {
        Self { frames, ahead }
    }
}

/// Solver of a [`MotionProblem`]: an initial trajectory sample by sample, then all samples together.
///
/// Memory and time are linear in the number of samples. With windows, the memory is that of one window.
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
    /// Returns a solver with tolerance 1e-8, sliding 1e-8 m, 200 iterations per window, curvature, and no windows.
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            max_iterations: 200,
            curvature: true,
            slip_m: 1e-8,
            windows: None,
            inward: Inward::ALL_VARIABLES,
        }
    }
}

impl MotionSolver {
    /// Sets the tolerance: the predicted decrease and the complementarity gap, relative to the cost. At least 0.
    #[must_use]
    pub fn with_tolerance(mut self, ratio: f64) -> Self {
        self.tolerance = ratio;
        self
    }

    /// Sets the maximum number of iterations per window.
    #[must_use]
    pub fn with_max_iterations(mut self, iterations: usize) -> Self {
        self.max_iterations = iterations;
        self
    }

    /// Sets whether the full Hessian is used, after ten steps or after a shortened step. Otherwise it is always
    /// JᵀJ.
    ///
    /// That is less accurate for targets far out of reach, but much cheaper per step.
    #[must_use]
    pub fn with_curvature(mut self, curvature: bool) -> Self {
        self.curvature = curvature;
        self
    }

    /// Sets the largest sliding of contacts between consecutive samples, metres, if six multiplier updates suffice.
    /// At least 0.
    #[must_use]
    pub fn with_slip(mut self, metres: f64) -> Self {
        self.slip_m = metres;
        self
    }

    /// Sets the windows; `None` solves all samples together.
    #[must_use]
    pub fn with_windows(mut self, windows: Option<Windows>) -> Self {
        self.windows = windows;
        self
    }

    /// Treats the start as good and moves it only slightly off its bounds.
    #[must_use]
    pub(in crate::motion) fn with_good_start(mut self) -> Self {
        self.inward = Inward::ACTIVE_BOUNDS;
        self
    }

    /// Solves a trajectory from a configuration near that of its first sample.
    ///
    /// # Errors
    /// Returns an error if `start` is invalid, an option is out of range, velocity limits separate fixed samples, or a
    /// residual is not finite.
    pub fn solve(
        &self,
        motion: &MotionProblem,
        start: &[f64],
    ) -> Result<Trajectory<MotionReport>, MotionError> {
        let n = motion.variables();
        let first = variables(motion, start)?;
        let mut x = vec![0.0; motion.frames * n];
        per_frame(motion, &mut FrameResiduals::new(motion), &first, &mut x)?;
        self.minimise(motion, x, &mut |_| (), None)
    }

    /// Solves a trajectory from an initial one: one configuration per sample, one after another. It may violate limits.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    pub fn solve_near(
        &self,
        motion: &MotionProblem,
        start: &[f64],
    ) -> Result<Trajectory<MotionReport>, MotionError> {
        self.solve_near_with_progress(motion, start, &mut |_| ())
    }

    /// Solves like [`solve_near`](Self::solve_near). `progress` receives the number of solved samples after each
    /// window.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    pub fn solve_near_with_progress(
        &self,
        motion: &MotionProblem,
        start: &[f64],
        progress: &mut dyn FnMut(usize),
    ) -> Result<Trajectory<MotionReport>, MotionError> {
        self.solve_near_unless(motion, start, progress, None)
    }

    /// Solves like [`solve_near_with_progress`](Self::solve_near_with_progress). Every iteration checks the flag
    /// `cancelled`.
    pub(in crate::motion) fn solve_near_unless(
        &self,
        motion: &MotionProblem,
        start: &[f64],
        progress: &mut dyn FnMut(usize),
        cancelled: Option<&AtomicBool>,
    ) -> Result<Trajectory<MotionReport>, MotionError> {
        let n = motion.configuration_len();
        if start.len() != motion.frames * n {
            return Err(MotionError::Length {
                what: "the initial trajectory".to_owned(),
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
    ) -> Result<Trajectory<MotionReport>, MotionError> {
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
        let limits = InteriorPointOptions {
            tolerance: self.tolerance,
            iterations: self.max_iterations,
            curvature: self.curvature,
            slip_m: self.slip_m,
            inward: self.inward,
        };
        let mut evaluator = SampleEvaluator::new(motion);
        let mut report = WindowResults::new(motion);
        let mut begin = 0;
        while begin < motion.frames {
            let kept_end = (begin + windows.frames).min(motion.frames);
            let end = (kept_end + windows.ahead).min(motion.frames);
            let fixed_count = begin.min(motion.bandwidth());
            let stretch = begin - fixed_count..end;
            let mut window = Window {
                motion,
                evaluator: &mut evaluator,
                stretch: SampleSpan {
                    first: stretch.start,
                    fixed_count,
                },
                fixed: motion.fixed(&stretch, fixed_count),
                cancelled,
            };
            let window_x = &mut x[stretch.start * n..stretch.end * n];
            let outcome = window.minimise(window_x, limits)?;
            report.add(&outcome, stretch.start, begin..kept_end);
            begin = if end == motion.frames { end } else { kept_end };
            progress(begin);
        }
        Ok(report.finish(&mut evaluator, &x))
    }
}

/// Returns the variables of a configuration.
fn variables(motion: &MotionProblem, q: &[f64]) -> Result<Vec<f64>, MotionError> {
    check_start(&motion.problem, q)?;
    let mut x = vec![0.0; motion.variables()];
    motion.problem.parameters().gather(q, &mut x);
    Ok(x)
}
