//! Weighted slacks of the inequalities of required tasks, for lower priorities.
//!
//! Slacks are numbered in the priority order, separately from the residual rows.

use std::ops::Range;

use nalgebra::DMatrix;

use super::{CompiledTask, Evaluation, Problem, TaskSubset};

/// An inequality of a required task above some rank.
#[derive(Clone, Debug)]
pub(crate) struct HigherInequality {
    pub(crate) rank: usize,
    /// Its rows and slacks, among those of all ranks above.
    pub(crate) rows: Range<usize>,
    pub(crate) slacks: Range<usize>,
    /// Largest change of its error in favour of lower priorities.
    pub(crate) max_change: f64,
    /// Largest violation of a slack that counts as satisfied.
    pub(crate) tolerance: f64,
}

impl Problem {
    /// Number of slacks of required tasks above a rank.
    pub(crate) fn slacks_above(&self, rank: usize) -> usize {
        let higher_tasks = self.tasks.iter().filter(|task| task.rank < rank);
        higher_tasks.map(|task| task.slack_weights.len()).sum()
    }

    /// The inequalities of required tasks above a rank whose errors must be kept.
    pub(crate) fn inequalities_above(&self, rank: usize) -> impl Iterator<Item = HigherInequality> {
        let higher_tasks = self.tasks_of(TaskSubset::above(rank));
        higher_tasks.flat_map(|(_, task, rows)| {
            let mut end = task.slacks_by_rank.start;
            task.inequalities.iter().filter_map(move |inequality| {
                let edges = end..end + inequality.edges();
                end = edges.end;
                let row_range = inequality.rows();
                let first = task.rows.start + row_range.start;
                let block = task.blocks().find(|block| block.rows.contains(&first))?;
                task.keeps(block).then(|| HigherInequality {
                    rank: task.rank,
                    rows: rows.start + row_range.start..rows.start + row_range.end,
                    slacks: edges,
                    max_change: block.max_change(),
                    tolerance: block.tolerance * block.weight,
                })
            })
        })
    }
}

impl Evaluation<'_> {
    /// Writes the slacks at x of a subset of the first ranks.
    pub(crate) fn slacks(&mut self, x: &[f64], slacks: &mut [f64]) {
        self.forward(x);
        let problem = self.instance.problem;
        for (index, task, _) in problem.tasks_of(self.subset) {
            if task.slack_weights.is_empty() {
                continue;
            }
            Self::gather(self.scratch, task);
            let task_slacks = &mut slacks[task.slacks_by_rank.clone()];
            let (frames, joints) = self.scratch.task_inputs();
            self.instance
                .residual(index)
                .slacks(frames, joints, task_slacks);
            for (slack, weight) in task_slacks.iter_mut().zip(&task.slack_weights) {
                *slack *= weight;
            }
        }
    }

    /// Writes the derivatives of the slacks by the components of a step.
    pub(crate) fn slack_jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.forward(x);
        jacobian.as_mut_slice().fill(0.0);
        let problem = self.instance.problem;
        for (index, task, _) in problem.tasks_of(self.subset) {
            if !task.slack_weights.is_empty() {
                self.differentiate_slacks(index, task);
                self.add_local(x, task, task.slacks_by_rank.start, jacobian);
            }
        }
        let rows = jacobian.nrows();
        let space = self.instance.space();
        space.by_steps(x, rows, jacobian.as_mut_slice());
    }

    /// Writes Jᵀr and adds the slacks' gradients times `multipliers`.
    pub(crate) fn slope_of_all(
        &mut self,
        x: &[f64],
        r: &[f64],
        multipliers: &[f64],
        slope: &mut [f64],
    ) {
        self.start_sweep(x, slope);
        self.push_residual(x, r, slope);
        let problem = self.instance.problem;
        for (index, task, _) in problem.tasks_of(self.subset) {
            let task_multipliers = &multipliers[task.slacks_by_rank.clone()];
            if task_multipliers.iter().any(|multiplier| *multiplier != 0.0) {
                self.differentiate_slacks(index, task);
                self.push_local(x, task, task_multipliers, slope);
            }
        }
        self.end_sweep(slope);
        self.instance.space().by_steps(x, 1, slope);
    }

    /// The weighted local derivatives of one task's slacks at the last forward pass.
    fn differentiate_slacks(&mut self, index: usize, task: &CompiledTask) {
        let residual = self.instance.residual(index);
        Self::gather(self.scratch, task);
        let (frames, joints, local, dual) = self.scratch.differentiation_inputs();
        local.reset(task.slack_weights.len(), frames.len(), joints.len());
        residual.differentiate_slacks(frames, joints, local, dual);
        local.scale_rows(&task.slack_weights);
    }
}
