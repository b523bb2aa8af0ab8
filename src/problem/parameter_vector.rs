//! A number for every parameter of a problem's solution: a change of them, or a slope by them.

use std::ops::Range;

use super::{CompiledTask, Problem};
use crate::spatial::Vector3;

/// One number for each parameter that the solution of a [`Problem`] depends on: how far each is moved, or how
/// much something else changes with each.
///
/// A task's target has the numbers that its residual says ([`Residual::target_len`]): three for a place, six for
/// a pose (along and about the target's own axes, metres then radians, as
/// [`Model::integrate`](crate::model::Model::integrate) moves a free joint), one a joint of a posture and three a
/// ball of it, none where it has no target.
///
/// [`Residual::target_len`]: crate::task::Residual::target_len
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterVector {
    targets: Vec<f64>,
    /// Where the target of each task begins, and where all end.
    starts: Vec<usize>,
    weights: Vec<f64>,
    /// By joint of the model; empty where none is asked for.
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

    /// The same with joints' origins, of a model of so many joints: without it they are none of the parameters.
    #[must_use]
    pub fn with_joint_origins(mut self, joints: usize) -> Self {
        self.joint_origins = vec![Vector3::zero(); joints];
        self
    }

    getters! {
        /// By all targets, one task's numbers after the other's.
        pub fn targets(&self) -> &[f64] = &self.targets;
        /// The same, to write.
        pub fn targets_mut(&mut self) -> &mut [f64] = &mut self.targets;
        /// By the weights, one for each of [`Solution::rows`](crate::Solution): what multiplies those rows, as
        /// [`Task::weight`](crate::task::Task::weight) and [`times`](crate::task::Task::times) make it.
        pub fn weights(&self) -> &[f64] = &self.weights;
        /// The same, to write.
        pub fn weights_mut(&mut self) -> &mut [f64] = &mut self.weights;
        /// By where each joint's origin stands on its parent (in the parent's axes, metres), by
        /// [`JointId::index`](crate::model::JointId::index): the lengths of links. Empty unless asked for.
        pub fn joint_origins(&self) -> &[Vector3<f64>] = &self.joint_origins;
        /// The same, to write.
        pub fn joint_origins_mut(&mut self) -> &mut [Vector3<f64>] = &mut self.joint_origins;
    }

    /// By the target of one task, by its position in the problem; empty for one that has none.
    #[must_use]
    pub fn target(&self, task: usize) -> &[f64] {
        self.targets.get(self.range(task)).unwrap_or_default()
    }

    /// The same, to write.
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

    /// Whether it is of a problem's shape, and of a model's with so many joints if it has joints.
    pub(crate) fn fits(&self, problem: &Problem, joints: Option<usize>) -> bool {
        let own = &problem.targets.residuals;
        let lens = own.iter().map(|residual| residual.target_len());
        let starts = self.starts.windows(2).map(|pair| pair[1] - pair[0]);
        let blocks: usize = problem.tasks.iter().map(|task| task.blocks.len()).sum();
        let links = self.joint_origins.is_empty() || joints == Some(self.joint_origins.len());
        lens.eq(starts) && self.weights.len() == blocks && links
    }

    /// The weights of one task's blocks, the first of which is `first` of the problem's.
    pub(super) fn weights_of(&mut self, first: usize, task: &CompiledTask) -> &mut [f64] {
        &mut self.weights[first..first + task.blocks.len()]
    }
}
