//! Verdict on a configuration by forward kinematics and limits, independent of the solver.

use kinopt::kinematics::ForwardKinematics;
use kinopt::problem::{Evaluation, ProblemInstance, Scratch};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, rotation_log};
use serde::{Deserialize, Serialize};

use crate::{HarnessError, ProblemSet};

/// Largest deviation of a mimic joint from its relation, radians or metres.
const MIMIC_TOLERANCE: f64 = 1e-9;
/// A joint within this fraction of its range from a limit counts as at the limit: changes of variables approach limits
/// without reaching them.
const LIMIT_TOLERANCE: f64 = 1e-6;

/// Distance of a frame from its target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TaskError {
    /// Position error in metres (for rigs, the rig's unit).
    pub position: f64,
    /// Orientation error in radians, 0 … π; `None` if orientations do not count.
    pub orientation: Option<f64>,
}

/// Verdict on a configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// True if exactly within the limits, and every target is within the tolerances.
    pub solved: bool,
    /// True if exactly within the limits, and mimic joints satisfy their relations.
    pub within_limits: bool,
    /// Largest error of any target: relative to the model's size, or in radians.
    pub error: f64,
    /// ½ Σ‖W r‖², in squared metres (for rigs, the rig's unit).
    pub cost: f64,
    /// Errors, one for each frame.
    pub tasks: Vec<TaskError>,
}

/// Judges configurations of one problem set.
#[derive(Debug)]
pub struct Judge<'s> {
    set: &'s ProblemSet,
    kinematics: ForwardKinematics,
    scratch: Option<Scratch>,
    residual: Vec<f64>,
}

impl<'s> Judge<'s> {
    /// Creates a judge of one set.
    ///
    /// # Errors
    /// Returns an error for a frame of another model.
    pub fn new(set: &'s ProblemSet) -> Result<Self, HarnessError> {
        Ok(Self {
            set,
            kinematics: ForwardKinematics::of_frames(set.model(), set.frames())?,
            scratch: None,
            residual: Vec::new(),
        })
    }

    /// Verdict on `q`. A configuration of the wrong length or with a number that is not finite has infinite errors.
    pub fn verdict<'a>(
        &mut self,
        instance: impl Into<ProblemInstance<'a>>,
        targets: &[Placement<f64>],
        q: &[f64],
    ) -> Verdict {
        let usable = q.iter().all(|value| value.is_finite());
        let Some(placed) = self.kinematics.place(q).ok().filter(|_| usable) else {
            return Verdict {
                solved: false,
                within_limits: false,
                error: f64::INFINITY,
                cost: f64::INFINITY,
                tasks: Vec::new(),
            };
        };
        let turns = self.set.turns();
        let errors = placed.iter().zip(targets).map(|(frame, target)| TaskError {
            position: (frame.translation - target.translation).norm(),
            orientation: turns
                .then(|| rotation_log(&(frame.rotation * target.rotation.transpose())).norm()),
        });
        let tasks: Vec<TaskError> = errors.collect();
        let size = self.set.size();
        let relative_errors = tasks.iter().flat_map(|task| {
            let position = task.position / size;
            [position, task.orientation.unwrap_or(0.0)]
        });
        let error = relative_errors.fold(0.0, f64::max);
        let within_limits = self.is_within_limits(q);
        let complete = tasks.len() == targets.len();
        Verdict {
            solved: complete && within_limits && error <= self.set.tolerance(),
            within_limits,
            error,
            cost: self.cost(instance.into(), q),
            tasks,
        }
    }

    /// Names of the joints at a limit at `q`, without locked ones.
    #[must_use]
    pub fn active_limits(&self, q: &[f64]) -> Vec<String> {
        let model = self.set.model();
        let joints = model.moving_joints().iter().zip(model.limits()).zip(q);
        let at_limit = joints.filter(|((_, limits), q)| {
            let margin = LIMIT_TOLERANCE * (limits.upper - limits.lower);
            let margin = if margin.is_finite() {
                margin
            } else {
                LIMIT_TOLERANCE
            };
            !limits.is_locked() && (**q <= limits.lower + margin || **q >= limits.upper - margin)
        });
        let names = at_limit.filter_map(|((id, _), _)| model.joints().get(id.index()));
        names.map(|joint| joint.name.clone()).collect()
    }

    fn is_within_limits(&self, q: &[f64]) -> bool {
        let mut limits = self.set.model().limits().zip(q);
        let contained = limits.all(|(limits, &q)| limits.lower <= q && q <= limits.upper);
        let expected = self.set.within_limits(q);
        let mut mimics = expected.iter().zip(q);
        contained && mimics.all(|(a, b)| (a - b).abs() <= MIMIC_TOLERANCE)
    }

    fn cost(&mut self, instance: ProblemInstance<'_>, q: &[f64]) -> f64 {
        let problem = instance.problem();
        let mut x = vec![0.0; problem.variables()];
        if problem.parameters().reduce(q, &mut x).is_err() {
            return f64::NAN;
        }
        self.residual.resize(problem.rows(), 0.0);
        let scratch = self.scratch.get_or_insert_with(|| problem.scratch());
        Evaluation::new(instance, scratch).residual(&x, &mut self.residual);
        0.5 * self.residual.iter().map(|r| r * r).sum::<f64>()
    }
}
