//! Collision avoidance of problems, by `collision::Checker` or the caller's own checker.

use std::fmt::Debug;

use super::builder::{ClearanceAs, PendingTask};
use super::{Collision, Problem, ProblemBuilder, ProblemError};
use crate::task::{InequalityResidual, Task};

/// Weight factor of the strong clearance relative to the plain one.
///
/// A required task with an error of e metres inside an obstacle violates the clearance's additional distance by e/w².
/// With a distance of 1 mm, this factor withstands an error of 10 m.
const STRONG_CLEARANCE_FACTOR: f64 = 100.0;

/// A collision checker.
///
/// `collision::Checker` is one. Others may use a distance field or another device.
/// [`ProblemBuilder::keep_clear`] adds one to a problem.
pub trait CollisionAvoidance {
    /// The residual that moves the body out of collisions.
    type Clearance: InequalityResidual;
    /// A check with its own workspace.
    type Check: ClearanceCheck + 'static;

    /// Number of coordinates of the configurations it checks.
    fn configuration_len(&self) -> usize;

    /// The residual that moves the body out of collisions; within its tolerance only without collision.
    fn clearance(&self) -> Task<Self::Clearance>;

    /// A check with its own workspace.
    fn check(&self) -> Self::Check;
}

/// Checks configurations one after the other; all have the right length and are finite.
pub trait ClearanceCheck: Clone + Debug + Send + Sync {
    /// The pairs in collision at a configuration, deepest first.
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision>;

    /// True if no pair is in collision.
    fn is_free(&mut self, q: &[f64]) -> bool {
        self.collisions(q).is_empty()
    }

    /// The collision that [blocks](Collision::on_the_way) the motion between two configurations.
    ///
    /// The motion interpolates all joints linearly. `None` if the whole motion is proven collision-free.
    fn blocked(&mut self, from: &[f64], to: &[f64]) -> Option<Collision>;

    /// The fraction of such a motion that ends with some clearance left; 1 for the whole motion.
    fn free_share(&mut self, from: &[f64], to: &[f64]) -> f64;
}

/// A type-erased check.
#[doc(hidden)]
pub trait AnyClearanceCheck: Debug + Send + Sync {
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision>;
    fn is_free(&mut self, q: &[f64]) -> bool;
    fn blocked(&mut self, from: &[f64], to: &[f64]) -> Option<Collision>;
    fn free_share(&mut self, from: &[f64], to: &[f64]) -> f64;
    fn boxed(&self) -> Box<dyn AnyClearanceCheck>;
}

impl<C: ClearanceCheck + 'static> AnyClearanceCheck for C {
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision> {
        ClearanceCheck::collisions(self, q)
    }

    fn is_free(&mut self, q: &[f64]) -> bool {
        ClearanceCheck::is_free(self, q)
    }

    fn boxed(&self) -> Box<dyn AnyClearanceCheck> {
        Box::new(self.clone())
    }

    fn blocked(&mut self, from: &[f64], to: &[f64]) -> Option<Collision> {
        ClearanceCheck::blocked(self, from, to)
    }

    fn free_share(&mut self, from: &[f64], to: &[f64]) -> f64 {
        ClearanceCheck::free_share(self, from, to)
    }
}

impl Clone for Box<dyn AnyClearanceCheck> {
    fn clone(&self) -> Self {
        // Clone the content, not the box.
        (**self).boxed()
    }
}

/// The collision avoidance that a builder was given.
#[derive(Clone, Debug)]
pub(super) struct ClearanceRequest {
    configuration_len: usize,
    clearance: PendingTask,
    check: Box<dyn AnyClearanceCheck>,
}

/// The collision constraint of a problem.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct CollisionConstraint {
    /// The tasks and then the clearance: solved only if a solution without clearance is in collision.
    with_clearance: Problem,
    /// The tasks and a clearance that withstands required tasks inside obstacles.
    with_strong_clearance: Problem,
    /// The tasks and a clearance in the null space of the required ones: as few collisions as they allow.
    with_soft_clearance: Problem,
    check: Box<dyn AnyClearanceCheck>,
}

impl CollisionConstraint {
    /// The tasks and then the clearance. Accepts targets of the problem without clearance.
    #[must_use]
    pub(crate) fn with_clearance(&self) -> &Problem {
        &self.with_clearance
    }

    /// The tasks and a clearance that withstands required tasks inside obstacles.
    #[must_use]
    #[doc(hidden)]
    pub fn with_strong_clearance(&self) -> &Problem {
        &self.with_strong_clearance
    }

    /// The tasks and a clearance in the null space of the required ones: as few collisions as they allow.
    #[must_use]
    pub(crate) fn with_soft_clearance(&self) -> &Problem {
        &self.with_soft_clearance
    }

    /// A check with its own workspace.
    #[must_use]
    #[doc(hidden)]
    pub fn check(&self) -> Box<dyn AnyClearanceCheck> {
        self.check.clone()
    }

    pub(super) fn with_derivatives(mut self, route: super::Derivatives) -> Self {
        self.with_clearance = self.with_clearance.with_derivatives(route);
        self.with_strong_clearance = self.with_strong_clearance.with_derivatives(route);
        self.with_soft_clearance = self.with_soft_clearance.with_derivatives(route);
        self
    }
}

impl ProblemBuilder<'_> {
    /// Avoids collisions with the obstacles of a checker's world, and self-collisions.
    ///
    /// A solution is then reached only if the checker finds no collision.
    /// [`Solution::collisions`](crate::Solution::collisions) lists the pairs otherwise. The tasks are first solved
    /// without collision avoidance. If that solution is in collision, the checker's clearance is added to the required
    /// tasks of the first level. It does not appear in reports on tasks.
    pub fn keep_clear<C: CollisionAvoidance>(&mut self, checker: &C) -> &mut Self {
        self.clearance_request = Some(ClearanceRequest {
            configuration_len: checker.configuration_len(),
            clearance: PendingTask::new(checker.clearance()),
            check: Box::new(checker.check()),
        });
        self
    }

    /// The collision constraint: the problem with the clearance among its tasks.
    pub(super) fn collision_constraint(
        &self,
        request: ClearanceRequest,
    ) -> Result<CollisionConstraint, ProblemError> {
        let (given, expected) = (request.configuration_len, self.model.configuration_len());
        if given != expected {
            return Err(ProblemError::ForeignChecker {
                given,
                model: self.model.name().to_owned(),
                expected,
            });
        }
        let mut strong_clearance = request.clearance.clone();
        strong_clearance.factor *= STRONG_CLEARANCE_FACTOR;
        let compile_with = |clearance: &PendingTask, role| {
            let clearance = (clearance.clone(), role);
            self.clone().compile(Some(clearance))
        };
        Ok(CollisionConstraint {
            with_clearance: compile_with(&request.clearance, ClearanceAs::Goal)?,
            with_strong_clearance: compile_with(&strong_clearance, ClearanceAs::Goal)?,
            with_soft_clearance: compile_with(&strong_clearance, ClearanceAs::SoftTask)?,
            check: request.check,
        })
    }
}
