//! Problems with changed parameters: weights and joint origins.

use std::sync::Arc;

use super::compiled_task::Block;
use super::{CompiledTask, Problem, ProblemError, Ranks};
use kinopt_kinematics::kinematics::Tree;
use kinopt_kinematics::model::Model;

impl Problem {
    /// The factors on the rows, one for each of [`Solution::rows`](crate::Solution).
    ///
    /// [`Task::weight`](crate::task::Task::weight) and [`scale`](crate::task::Task::scale) set them.
    #[must_use]
    pub fn weights(&self) -> Vec<f64> {
        let blocks = self.tasks.iter().flat_map(CompiledTask::blocks);
        blocks.map(|block| block.weight).collect()
    }

    /// The problem with other [weights](Self::weights); its targets stay those that it was built with.
    ///
    /// # Errors
    /// Returns an error for a wrong number of weights, or a weight that is negative or not finite. A problem with
    /// collision avoidance is an error too, because the clearance's weight depends on the weights of the tasks.
    pub fn with_weights(mut self, weights: &[f64]) -> Result<Self, ProblemError> {
        let expected = self.tasks.iter().map(|task| task.blocks.len()).sum();
        if weights.len() != expected {
            return Err(ProblemError::WeightCount {
                given: weights.len(),
                expected,
            });
        }
        self.check_no_collision_avoidance("weights")?;
        let mut weights = weights.iter();
        for task in &mut self.tasks {
            for (block, &weight) in task.blocks.iter_mut().zip(&mut weights) {
                block.weight = Block::weight_of(&task.name, block.measure.quantity, weight)?;
            }
            task.update_weights();
        }
        self.ranks = Ranks::of(&mut self.tasks, self.preferences);
        self.mark_task_variables();
        Ok(self.with_new_identity())
    }

    /// The problem with the joint origins of `model`: its own model [moved](Model::with_joint_origins).
    ///
    /// Weights, limits and the reach stay. A residual that stores lengths, such as
    /// [`Manipulability`](crate::task::Manipulability), keeps them.
    ///
    /// # Errors
    /// Returns an error for a model with other joints or frames. A problem with collision avoidance is an error too,
    /// because its checker stores the lengths of links.
    pub fn with_joint_origins(mut self, model: &Model) -> Result<Self, ProblemError> {
        if !self.is_of(model) {
            return Err(ProblemError::ForeignModel {
                given: model.name().to_owned(),
                expected: self.names.model.clone(),
            });
        }
        self.check_no_collision_avoidance("joint origins")?;
        let frames: Vec<_> = self.tree.frames().collect();
        self.tree = Tree::new(model, &self.map, &frames);
        Ok(self.with_new_identity())
    }

    /// True if `model` has the joints and frames of the problem's model.
    pub(crate) fn is_of(&self, model: &Model) -> bool {
        let known = model.frames().len();
        model.name() == self.names.model
            && model.configuration_len() == self.configuration_len()
            && self.tree.frames().all(|frame| frame.index() < known)
    }

    fn check_no_collision_avoidance(&self, what: &'static str) -> Result<(), ProblemError> {
        match self.collision_constraint {
            None => Ok(()),
            Some(_) => Err(ProblemError::KeepsClear { what }),
        }
    }

    /// Gives the problem a new identity, because workspaces of the old one hold outdated placements.
    fn with_new_identity(mut self) -> Self {
        self.names = Arc::new((*self.names).clone());
        self
    }
}
