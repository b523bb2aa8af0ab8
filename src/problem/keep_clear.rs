//! What a body keeps clear of: asked for here, answered by [`collision::Checker`](crate::collision::Checker) or by one's own.

use std::fmt::Debug;

use super::builder::{ClearanceAs, PendingTask};
use super::{Collision, Problem, ProblemBuilder, ProblemError};
use crate::task::{Residual, Task};

/// How much more a clearance counts that holds than one that leads. A goal that pulls into something by e metres comes e/w² into
/// what the clearance adds to the margin, which at a millimetre so holds a pull of ten metres.
const HOLDING: f64 = 100.0;

/// What tells whether a body touches something.
///
/// A [`collision::Checker`](crate::collision::Checker) is one; so can be a distance field or a check on another device. A
/// problem is given one by [`ProblemBuilder::keep_clear`].
pub trait KeepClear {
    /// The residual that leads out of what is touched.
    type Clearance: Residual;
    /// A check with memory of its own.
    type Check: ClearanceCheck + 'static;

    /// How many numbers a configuration has that it checks.
    fn configuration_len(&self) -> usize;

    /// The residual that leads out of what is touched: within its tolerance only where nothing is.
    fn clearance(&self) -> Task<Self::Clearance>;

    /// A check with memory of its own.
    fn check(&self) -> Self::Check;
}

/// Checks configurations one after the other: all of the right length and finite.
pub trait ClearanceCheck: Clone + Debug + Send + Sync {
    /// The pairs that are too near at a configuration, the deepest first.
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision>;

    /// Whether no pair is too near.
    fn is_free(&mut self, q: &[f64]) -> bool {
        self.collisions(q).is_empty()
    }

    /// What ends the way from one configuration to another, on which all joints move evenly, [on the way](Collision::on_the_way);
    /// `None` where all of it is surely free.
    fn blocked(&mut self, from: &[f64], to: &[f64]) -> Option<Collision>;

    /// The share of such a way after which there is still some room to move: 1 where all of it is so.
    fn free_share(&mut self, from: &[f64], to: &[f64]) -> f64;
}

/// A check without its type.
pub(crate) trait AnyClearanceCheck: Debug + Send + Sync {
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision>;
    fn is_free(&mut self, q: &[f64]) -> bool;
    fn blocked(&mut self, from: &[f64], to: &[f64]) -> Option<Collision>;
    fn free_share(&mut self, from: &[f64], to: &[f64]) -> f64;
    fn boxed(&self) -> Box<dyn AnyClearanceCheck>;
}

impl<C: ClearanceCheck + 'static> AnyClearanceCheck for C {
    answers! {
        fn collisions(&mut self, q: &[f64]) -> Vec<Collision> = ClearanceCheck::collisions(self, q);
        fn is_free(&mut self, q: &[f64]) -> bool = ClearanceCheck::is_free(self, q);
        fn boxed(&self) -> Box<dyn AnyClearanceCheck> = Box::new(self.clone());
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
        // Of what is inside, not of the box.
        (**self).boxed()
    }
}

/// What a builder was given to keep clear of.
#[derive(Clone, Debug)]
pub(super) struct ClearanceRequest {
    configuration_len: usize,
    clearance: PendingTask,
    check: Box<dyn AnyClearanceCheck>,
}

/// What a problem keeps clear of.
#[derive(Clone, Debug)]
pub(crate) struct Fence {
    /// The same tasks, and after them the clearance: solved only where an answer without it touches something.
    leading: Problem,
    /// The same with a clearance that holds against what pulls into something.
    holding: Problem,
    /// The same with the clearance within what the goals leave free: as little is touched as they allow.
    yielding: Problem,
    check: Box<dyn AnyClearanceCheck>,
}

impl Fence {
    getters! {
        /// The same tasks, and after them the clearance. Targets of the problem without it are targets of this one.
        pub(crate) fn leading(&self) -> &Problem = &self.leading;
        /// The same with a clearance that holds against what pulls into something.
        pub(crate) fn holding(&self) -> &Problem = &self.holding;
        /// The same with the clearance within what the goals leave free: as little is touched as they allow.
        pub(crate) fn yielding(&self) -> &Problem = &self.yielding;
        /// A check with memory of its own.
        pub(crate) fn check(&self) -> Box<dyn AnyClearanceCheck> = self.check.clone();
    }

    pub(super) fn with_derivatives(mut self, route: super::Derivatives) -> Self {
        self.leading = self.leading.with_derivatives(route);
        self.holding = self.holding.with_derivatives(route);
        self.yielding = self.yielding.with_derivatives(route);
        self
    }
}

impl ProblemBuilder<'_> {
    /// Keeps the body clear of what a checker has: the obstacles of a world, and itself. A solution is then reached only if
    /// nothing touches, by the checker, and says which pairs do otherwise
    /// ([`Solution::collisions`](crate::Solution::collisions)).
    ///
    /// Not seen among the tasks: the goals are solved as if nothing were in the way, and where that touches something
    /// the checker's clearance joins the goals of the first level.
    pub fn keep_clear<C: KeepClear>(&mut self, of: &C) -> &mut Self {
        self.clear_of = Some(ClearanceRequest {
            configuration_len: of.configuration_len(),
            clearance: PendingTask::new(of.clearance()),
            check: Box::new(of.check()),
        });
        self
    }

    /// The problem with the clearance among its goals.
    pub(super) fn fence(&self, asked: ClearanceRequest) -> Result<Fence, ProblemError> {
        let (given, expected) = (asked.configuration_len, self.model.configuration_len());
        if given != expected {
            return Err(ProblemError::ForeignChecker {
                given,
                model: self.model.name().to_owned(),
                expected,
            });
        }
        let mut holding = asked.clearance.clone();
        holding.factor *= HOLDING;
        let with = |clearance: &PendingTask, counts| {
            let clearance = (clearance.clone(), counts);
            self.clone().compile(Some(clearance))
        };
        Ok(Fence {
            leading: with(&asked.clearance, ClearanceAs::Goal)?,
            holding: with(&holding, ClearanceAs::Goal)?,
            yielding: with(&holding, ClearanceAs::OnlyPreference)?,
            check: asked.check,
        })
    }
}
