//! Order and stopping criteria of the trials of a search.
//!
//! Attempts end when they stall, because another start usually helps more than more steps. If none reaches the goals,
//! the best attempt is continued until it converges. The attempt from the caller's start is continued as well, and
//! returned if its cost is nearly as low. An unreached target costs a few times the steps of one converged attempt.

use super::Restarts;
use crate::problem::{ProblemInstance, TaskSubset};
use crate::solver::{Stopping, Termination};

/// Number of steps without halving the cost after which the attempt from the caller's start stalls. That start is
/// usually near a solution, or a singular rest pose without progress.
const START_STALL_STEPS: usize = 6;
/// Number of steps without halving the cost after which an attempt stalls.
const STALL_STEPS: usize = 9;
/// As [`STALL_STEPS`], for searches that count agreement: 10 slow steps pass before the solver uses finite differences.
const AGREEMENT_STALL_STEPS: usize = 10;

/// Number of stalled attempts after which the best one is continued. It often reaches slow targets, such as those of
/// stretched limbs.
const STALLED_ATTEMPTS_BEFORE_BEST: usize = 8;
/// Default number of agreeing attempts that end a search of converged attempts.
const AGREEING_ATTEMPTS: usize = 3;

/// One run of an engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trial {
    /// An attempt that ends when it stalls.
    Quick(usize),
    /// Continues the stalled attempt from the caller's start until it converges, if its targets are near.
    NearbyFirst,
    /// Continues the best attempt until it converges, if it stalled.
    FinishBest,
    /// Continues the attempt from the caller's start, if another one is the best.
    FinishFirst,
    /// An attempt that runs until it converges.
    Full(usize),
    /// Continues the best attempt after attempts agreed or the steps were used up, unless it converged.
    FinishAtLast,
}

impl Trial {
    /// Reports whether the trial continues the best attempt.
    pub(super) fn continues_best(self) -> bool {
        matches!(self, Self::FinishBest | Self::FinishAtLast)
    }
}

/// Schedule of the attempts of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Schedule {
    restarts: Restarts,
    attempts: usize,
    stopping: Stopping,
    kind: Kind,
    hops: bool,
}

/// Kind of attempts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Attempts that first end when they stall.
    Quick,
    /// Attempts that all run until they converge.
    Patient,
    /// Sweeps of a geometric solver: a stalled attempt counts as converged, and none is continued.
    Sweeps,
}

impl Schedule {
    /// Schedule of searches for a task subset of a problem, each within `stopping`. With `patient` all run until they
    /// converge.
    #[doc(hidden)]
    pub fn of_searches(
        (instance, subset): (ProblemInstance<'_>, TaskSubset),
        restarts: Restarts,
        stopping: Stopping,
        patient: bool,
    ) -> Self {
        let kind = match patient {
            true => Kind::Patient,
            false => Kind::Quick,
        };
        // Hops from a low end often return to its cost, so they must not count as agreement.
        let hops = !patient && restarts.agreeing.is_none();
        Self {
            attempts: restarts.attempts_for(instance, subset),
            hops: hops && instance.problem.has_free_joint(),
            restarts,
            stopping,
            kind,
        }
    }

    /// Schedule of sweeps, each within `stopping`.
    pub(crate) fn of_sweeps(
        instance: ProblemInstance<'_>,
        restarts: Restarts,
        stopping: Stopping,
    ) -> Self {
        Self {
            attempts: restarts.attempts_for(instance, TaskSubset::All),
            hops: false,
            restarts,
            stopping,
            kind: Kind::Sweeps,
        }
    }

    /// The schedule with the caller's start only.
    pub(crate) fn once(self) -> Self {
        Self {
            attempts: 1,
            hops: false,
            restarts: self.restarts.with_attempts(1),
            ..self
        }
    }

    /// Source of the starts of attempts.
    #[must_use]
    pub(super) fn restarts(&self) -> &Restarts {
        &self.restarts
    }

    /// Largest number of attempts.
    #[must_use]
    pub(super) fn attempts(&self) -> usize {
        self.attempts
    }

    /// Later attempts may start at the end of an earlier one.
    #[must_use]
    pub(super) fn hops(&self) -> bool {
        self.hops
    }

    /// The trials in order.
    pub(super) fn trials(&self) -> impl Iterator<Item = Trial> + use<> {
        let agreeing = self.restarts.agreeing;
        let quick_attempts = match self.attempts {
            attempts if self.kind == Kind::Quick && attempts > 1 => {
                attempts.min(STALLED_ATTEMPTS_BEFORE_BEST)
            }
            _ => 0,
        };
        // Only converged attempts can agree.
        let later = match quick_attempts > 0 && agreeing.is_none() {
            true => Trial::Quick,
            false => Trial::Full,
        };
        let best = (quick_attempts > 0).then_some(Trial::FinishBest);
        let first = (quick_attempts > 0 && agreeing.is_none()).then_some(Trial::FinishFirst);
        let at_last = (self.kind != Kind::Sweeps).then_some(Trial::FinishAtLast);
        let nearby = (quick_attempts > 0).then_some(Trial::NearbyFirst);
        (0..quick_attempts.min(1))
            .map(Trial::Quick)
            .chain(nearby)
            .chain((1..quick_attempts).map(Trial::Quick))
            .chain(best)
            .chain((quick_attempts..self.attempts).map(later))
            .chain(best)
            .chain(first)
            .chain(at_last)
    }

    /// Stopping criteria of a trial.
    pub(super) fn stopping(&self, trial: Trial) -> Stopping {
        let Trial::Quick(index) = trial else {
            return self.stopping;
        };
        self.stopping
            .with_max_patience(match self.restarts.agreeing {
                _ if index == 0 => START_STALL_STEPS,
                None => STALL_STEPS,
                Some(_) => AGREEMENT_STALL_STEPS,
            })
    }

    /// Reports whether a trial is useless after an attempt at the proven lower bound of the cost: another start, unless
    /// the caller set a number of agreeing attempts.
    pub(super) fn may_end_at_optimum(&self, trial: Trial) -> bool {
        self.restarts.agreeing.is_none() && matches!(trial, Trial::Quick(_) | Trial::Full(_))
    }

    /// Number of agreeing attempts that end the search.
    pub(super) fn agreement_limit(&self) -> usize {
        let default_limit = match self.kind {
            Kind::Quick => usize::MAX,
            Kind::Patient | Kind::Sweeps => AGREEING_ATTEMPTS,
        };
        self.restarts.agreeing.unwrap_or(default_limit)
    }

    /// Reports whether the search counts agreeing attempts. Sweeps do not: equal costs may only mean equally slow
    /// progress.
    pub(super) fn counts_agreement(&self) -> bool {
        self.kind != Kind::Sweeps
    }

    /// Reports whether an attempt converged. A stalled attempt of sweeps counts as converged.
    pub(super) fn is_converged(&self, termination: Termination) -> bool {
        match self.kind {
            Kind::Sweeps => {
                matches!(termination, Termination::SmallStep | Termination::Stalled)
            }
            _ => termination.is_settled(),
        }
    }

    /// Reports whether a trial counts as evidence of what can be reached. Perturbed starts do not: they lead to the
    /// local minimum near the start.
    pub(super) fn counts_for_agreement(&self, trial: Trial) -> bool {
        match trial {
            Trial::Quick(index) | Trial::Full(index) => self.kind == Kind::Sweeps || index % 2 == 0,
            _ => true,
        }
    }
}
