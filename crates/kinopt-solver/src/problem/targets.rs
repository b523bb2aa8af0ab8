//! Targets of a problem's tasks: a small value separate from the constant problem.

use super::{Problem, ProblemError, TaskId};
use crate::task::{ErasedResidual, Residual};

/// The residuals of a problem's tasks, with targets that can change.
///
/// A [`Problem`] holds those that it was built with. For other targets, copy them by [`Problem::targets`], change them,
/// and solve [`Problem::with_targets`]. Many threads may solve one problem, each with its own targets.
///
/// ```
/// # use kinopt::model::{Limits, Model};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::Point;
/// # use kinopt::{Problem, Solver, Workspace};
/// # let mut builder = Model::builder("one link");
/// # let z = Vector3::new(0.0, 0.0, 1.0);
/// # let joint = builder.revolute("hinge", None, Placement::identity(), z, Limits::new(-2.0, 2.0));
/// # let tip = builder.frame("tip", Some(joint), Placement::translation([1.0, 0.0, 0.0].into()));
/// # let model = builder.build()?;
/// let mut tasks = Problem::builder(&model);
/// let hand = tasks.add(Point::new(tip, [1.0, 0.0, 0.0]));
/// let problem = tasks.build()?;
///
/// let mut targets = problem.targets();
/// targets.get_mut(hand)?.set_target([0.0, 1.0, 0.0]);
/// let mut workspace = Workspace::new();
/// let instance = problem.with_targets(&targets)?;
/// let solution = Solver::default().solve(instance, &[0.1], &mut workspace)?;
/// assert!(solution.reached);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Targets {
    /// The residual of each task.
    pub(super) residuals: Vec<Box<dyn ErasedResidual>>,
}

impl Targets {
    /// A task's residual.
    ///
    /// # Errors
    /// Returns an error for an id that is out of range or has another residual type.
    pub fn get<R: Residual>(&self, task: TaskId<R>) -> Result<&R, ProblemError> {
        let residual = self.residuals.get(task.index());
        let residual = residual.and_then(|residual| residual.as_any().downcast_ref());
        residual.ok_or_else(|| self.foreign(task.index()))
    }

    /// A task's residual, to change its target.
    ///
    /// Numbers set here are not checked: a target that is not finite ends the solve as non-finite.
    ///
    /// # Errors
    /// Returns the errors of [`get`](Self::get).
    pub fn get_mut<R: Residual>(&mut self, task: TaskId<R>) -> Result<&mut R, ProblemError> {
        // Looked up twice, because a failure would still borrow the returned reference.
        self.get(task)?;
        let residual = self.residuals.get_mut(task.index());
        let residual = residual.and_then(|residual| residual.as_any_mut().downcast_mut());
        residual.ok_or(ProblemError::ForeignTask {
            task: task.index(),
            tasks: Vec::new(),
        })
    }

    fn foreign(&self, task: usize) -> ProblemError {
        let kinds = self.residuals.iter().map(|residual| residual.kind());
        ProblemError::ForeignTask {
            task,
            tasks: kinds.map(str::to_owned).collect(),
        }
    }

    /// True if these are targets of a problem with the same tasks.
    pub(super) fn fit(&self, problem: &Problem) -> bool {
        let residuals = &problem.targets.residuals;
        let mut pairs = self.residuals.iter().zip(residuals);
        self.residuals.len() == residuals.len()
            && pairs.all(|(a, b)| a.as_any().type_id() == b.as_any().type_id())
    }
}
