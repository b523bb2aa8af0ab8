//! The same problem with other numbers: what a solution is differentiated by can be moved.

use std::sync::Arc;

use super::compiled_task::Block;
use super::{CompiledTask, Problem, ProblemError, Ranks};
use crate::kinematics::Tree;
use crate::model::Model;

impl Problem {
    /// What multiplies the rows: a weight for each of [`Solution::rows`](crate::Solution), as
    /// [`Task::weight`](crate::task::Task::weight) and [`times`](crate::task::Task::times) made it.
    #[must_use]
    pub fn weights(&self) -> Vec<f64> {
        let blocks = self.tasks.iter().flat_map(CompiledTask::blocks);
        blocks.map(|block| block.weight).collect()
    }

    /// The same problem with other [weights](Self::weights); its targets stay those that it was built with.
    ///
    /// # Errors
    /// Another number of weights, one that is negative or not finite, and a problem that keeps clear of something: the
    /// clearance's weight follows from the others.
    pub fn with_weights(mut self, weights: &[f64]) -> Result<Self, ProblemError> {
        let expected = self.tasks.iter().map(|task| task.blocks.len()).sum();
        if weights.len() != expected {
            return Err(ProblemError::WeightCount {
                given: weights.len(),
                expected,
            });
        }
        self.check_restated("weights")?;
        let mut weights = weights.iter();
        for task in &mut self.tasks {
            for (block, &weight) in task.blocks.iter_mut().zip(&mut weights) {
                block.weight = Block::weight_of(&task.name, block.measure.quantity, weight)?;
            }
            task.weigh();
        }
        self.ranks = Ranks::of(&mut self.tasks, self.preferences);
        self.mark_moving();
        Ok(self.apart())
    }

    /// The same problem where the joints stand elsewhere on their parents, as they do in `model`: that of the problem
    /// [moved](Model::with_joint_origins). Its weights, limits and lengths to judge by stay. A residual that keeps a
    /// model's lengths itself, as [`Manipulability`](crate::task::Manipulability) does, keeps them.
    ///
    /// # Errors
    /// A model with other joints or frames, and a problem that keeps clear of something: a checker has the links' lengths.
    pub fn with_joint_origins(mut self, model: &Model) -> Result<Self, ProblemError> {
        if !self.is_of(model) {
            return Err(ProblemError::ForeignModel {
                given: model.name().to_owned(),
                expected: self.names.model.clone(),
            });
        }
        self.check_restated("joint origins")?;
        let frames: Vec<_> = self.tree.frames().collect();
        self.tree = Tree::new(model, &self.map, &frames);
        Ok(self.apart())
    }

    /// Whether `model` has the shape of the one that it was stated on.
    pub(crate) fn is_of(&self, model: &Model) -> bool {
        let known = model.frames().len();
        model.name() == self.names.model
            && model.configuration_len() == self.configuration_len()
            && self.tree.frames().all(|frame| frame.index() < known)
    }

    fn check_restated(&self, what: &'static str) -> Result<(), ProblemError> {
        match self.fence {
            None => Ok(()),
            Some(_) => Err(ProblemError::KeepsClear { what }),
        }
    }

    /// Memory of the problem that it was is not its own: what was placed there stands elsewhere now.
    fn apart(mut self) -> Self {
        self.names = Arc::new((*self.names).clone());
        self
    }
}
