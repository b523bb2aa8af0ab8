//! Vectors with a number for every parameter of a problem.

use std::ops::Range;

use super::{CompiledTask, Problem};
use kinopt_kinematics::spatial::Vector3;

/// One number for each parameter that the solution of a [`Problem`] depends on: a change or a derivative.
///
/// A task's target has as many numbers as its residual reports ([`DifferentiableTarget::target_len`]):
/// - three for a position;
/// - six for a pose, along and about the target's axes, metres then radians, as
///   [`Model::integrate`](kinopt_kinematics::model::Model::integrate) moves a free joint;
/// - for a posture one for each joint, three for each ball joint;
/// - none without a target.
///
/// [`DifferentiableTarget::target_len`]: crate::task::DifferentiableTarget::target_len
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterVector {
    targets: Vec<f64>,
    /// Start of each task's target, followed by the end of the last.
    starts: Vec<usize>,
    weights: Vec<f64>,
    /// By joint of the model; empty if joint origins are not parameters.
    joint_origins: Vec<Vector3<f64>>,
}

impl ParameterVector {
    /// Zero for every target and weight of a problem.
    #[must_use]
    pub fn new(problem: &Problem) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        for residual in &problem.targets.residuals {
            end += residual.target_len();
            starts.push(end);
        }
        let blocks = problem.tasks.iter().map(|task| task.blocks.len());
        Self {
            targets: vec![0.0; end],
            starts,
            weights: vec![0.0; blocks.sum()],
            joint_origins: Vec::new(),
        }
    }

    /// Adds the origins of `joints` joints; by default they are not parameters.
    #[must_use]
    pub fn with_joint_origins(mut self, joints: usize) -> Self {
        self.joint_origins = vec![Vector3::zero(); joints];
        self
    }

    /// Entries of all targets, task after task.
    #[must_use]
    pub fn targets(&self) -> &[f64] {
        &self.targets
    }

    /// Entries of all targets, mutable.
    #[must_use]
    pub fn targets_mut(&mut self) -> &mut [f64] {
        &mut self.targets
    }

    /// Entries of the weights, one for each of [`Solution::rows`](crate::Solution).
    ///
    /// A weight multiplies these rows; [`Task::weight`](crate::task::Task::weight) and
    /// [`scale`](crate::task::Task::scale) set it.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Entries of the weights, mutable.
    #[must_use]
    pub fn weights_mut(&mut self) -> &mut [f64] {
        &mut self.weights
    }

    /// Entries of the joint origins on their parents, in the parent's axes, metres: the lengths of links.
    ///
    /// Indexed by [`JointId::index`](kinopt_kinematics::model::JointId::index). Empty unless added by
    /// [`with_joint_origins`](Self::with_joint_origins).
    #[must_use]
    pub fn joint_origins(&self) -> &[Vector3<f64>] {
        &self.joint_origins
    }

    /// Entries of the joint origins, mutable.
    #[must_use]
    pub fn joint_origins_mut(&mut self) -> &mut [Vector3<f64>] {
        &mut self.joint_origins
    }

    /// Entries of one task's target, by its index in the problem; empty if it has none.
    #[must_use]
    pub fn target(&self, task: usize) -> &[f64] {
        self.targets.get(self.range(task)).unwrap_or_default()
    }

    /// Entries of one task's target, mutable.
    #[must_use]
    pub fn target_mut(&mut self, task: usize) -> &mut [f64] {
        let range = self.range(task);
        self.targets.get_mut(range).unwrap_or_default()
    }

    fn range(&self, task: usize) -> Range<usize> {
        match self.starts.get(task..task + 2) {
            Some(&[start, end]) => start..end,
            _ => 0..0,
        }
    }

    /// Sets every number to 0.
    pub fn clear(&mut self) {
        self.targets.fill(0.0);
        self.weights.fill(0.0);
        self.joint_origins.fill(Vector3::zero());
    }

    /// True if its lengths fit a problem, and a model with `joints` joints if it has joint origins.
    pub(crate) fn fits(&self, problem: &Problem, joints: Option<usize>) -> bool {
        let residuals = &problem.targets.residuals;
        let lens = residuals.iter().map(|residual| residual.target_len());
        let starts = self.starts.windows(2).map(|pair| pair[1] - pair[0]);
        let blocks: usize = problem.tasks.iter().map(|task| task.blocks.len()).sum();
        let links = self.joint_origins.is_empty() || joints == Some(self.joint_origins.len());
        lens.eq(starts) && self.weights.len() == blocks && links
    }

    /// The weights of one task's blocks; `first` is the index of its first block in the problem.
    pub(super) fn weights_of(&mut self, first: usize, task: &CompiledTask) -> &mut [f64] {
        &mut self.weights[first..first + task.blocks.len()]
    }
}
