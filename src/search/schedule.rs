//! Which trials are made, in order, and how long each goes on.
//!
//! Attempts give up as soon as they stall, because another start most often does better than patience; if
//! none arrives, the best of them is finished, and the caller's own, which stays where it comes to nearly
//! the same. So a miss costs a few times what one attempt costs that runs to its end.

use super::Restarts;
use crate::problem::{Question, Share};
use crate::solver::{Stopping, Termination};

/// Steps without halving the cost after which an attempt gives up. The caller's start is most often a
/// neighbour of the answer, which is then found at once, or a singular rest pose, which leads nowhere.
/// After ten slow steps a search takes its curvature from differences, which is what it waits for where
/// others will run to their ends, and saves where all give up.
const PATIENCE_AT_START: usize = 6;
const PATIENCE: usize = 9;
const PATIENCE_BEFORE_AGREEING: usize = 10;

/// After so many attempts that gave up the best of them is finished for the first time: it often reaches
/// what only takes long, as where limbs are stretched.
const QUICK_BEFORE_BEST: usize = 8;
/// Where attempts run to their ends anyway, so many that agree end the search.
const AGREEING: usize = 3;

/// One run of an engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trial {
    /// An attempt that gives up when it stalls.
    Quick(usize),
    /// The attempt from the caller's start to its end, if it gave up when it stalled and its targets are near.
    NearbyFirst,
    /// The best attempt so far goes on to its end, if it gave up when it stalled.
    FinishBest,
    /// The caller's own attempt does, if another is the best.
    FinishFirst,
    /// An attempt that runs to its end.
    Full(usize),
    /// When attempts agree or the steps are used up, the best of all goes on, unless it came to its
    /// end.
    FinishAtLast,
}

impl Trial {
    /// Whether the trial goes on from where the best one stands.
    pub(super) fn goes_on(self) -> bool {
        matches!(self, Self::FinishBest | Self::FinishAtLast)
    }
}

/// How attempts are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Schedule {
    restarts: Restarts,
    attempts: usize,
    stopping: Stopping,
    kind: Kind,
    hops: bool,
}

/// What its attempts are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Searches that give up at first.
    Quick,
    /// Searches that all run to their ends.
    Patient,
    /// Sweeps, which creep: one that stalls is at its end, and none goes on later.
    Sweeps,
}

impl Schedule {
    /// Of searches for a share of a question within these limits each; `patient` ones all run to their ends.
    pub(crate) fn of_searches(
        (question, share): (Question<'_>, Share),
        restarts: Restarts,
        stopping: Stopping,
        patient: bool,
    ) -> Self {
        let kind = match patient {
            true => Kind::Patient,
            false => Kind::Quick,
        };
        // What hops from a low place end at agrees with it by its start.
        let hops = !patient && restarts.agreeing.is_none();
        Self {
            attempts: restarts.attempts_for(question, share),
            hops: hops && question.problem.has_free_joint(),
            restarts,
            stopping,
            kind,
        }
    }

    /// Of sweeps within these limits each.
    pub(crate) fn of_sweeps(
        question: Question<'_>,
        restarts: Restarts,
        stopping: Stopping,
    ) -> Self {
        Self {
            attempts: restarts.attempts_for(question, Share::All),
            hops: false,
            restarts,
            stopping,
            kind: Kind::Sweeps,
        }
    }

    /// The same from the start alone.
    pub(crate) fn once(self) -> Self {
        Self {
            attempts: 1,
            hops: false,
            restarts: self.restarts.with_attempts(1),
            ..self
        }
    }

    getters! {
        /// Where attempts start.
        pub(super) fn restarts(&self) -> &Restarts = &self.restarts;
        /// How many there are at most.
        pub(super) fn attempts(&self) -> usize = self.attempts;
        /// Whether later attempts begin at the end of an earlier one.
        pub(super) fn hops(&self) -> bool = self.hops;
    }

    /// The runs, in order.
    pub(super) fn trials(&self) -> impl Iterator<Item = Trial> + use<> {
        let agreeing = self.restarts.agreeing;
        let quick = match self.attempts {
            attempts if self.kind == Kind::Quick && attempts > 1 => attempts.min(QUICK_BEFORE_BEST),
            _ => 0,
        };
        // Only attempts that came to their ends can agree.
        let later = match quick > 0 && agreeing.is_none() {
            true => Trial::Quick,
            false => Trial::Full,
        };
        let best = (quick > 0).then_some(Trial::FinishBest);
        let first = (quick > 0 && agreeing.is_none()).then_some(Trial::FinishFirst);
        let at_last = (self.kind != Kind::Sweeps).then_some(Trial::FinishAtLast);
        let nearby = (quick > 0).then_some(Trial::NearbyFirst);
        (0..quick.min(1))
            .map(Trial::Quick)
            .chain(nearby)
            .chain((1..quick).map(Trial::Quick))
            .chain(best)
            .chain((quick..self.attempts).map(later))
            .chain(best)
            .chain(first)
            .chain(at_last)
    }

    /// How long a trial goes on.
    pub(super) fn stopping(&self, trial: Trial) -> Stopping {
        let Trial::Quick(index) = trial else {
            return self.stopping;
        };
        self.stopping.impatient(match self.restarts.agreeing {
            _ if index == 0 => PATIENCE_AT_START,
            None => PATIENCE,
            Some(_) => PATIENCE_BEFORE_AGREEING,
        })
    }

    /// How many attempts that agree end the search.
    pub(super) fn enough(&self) -> usize {
        let unset = match self.kind {
            Kind::Quick => usize::MAX,
            Kind::Patient | Kind::Sweeps => AGREEING,
        };
        self.restarts.agreeing.unwrap_or(unset)
    }

    /// Whether a search says how many attempts agree: sweeps that end alike may creep alike.
    pub(super) fn tells_agreement(&self) -> bool {
        self.kind != Kind::Sweeps
    }

    /// Whether an attempt ended because nothing better is near, rather than for lack of patience.
    pub(super) fn settles(&self, termination: Termination) -> bool {
        match self.kind {
            Kind::Sweeps => {
                matches!(termination, Termination::SmallStep | Termination::Stalled)
            }
            _ => termination.is_settled(),
        }
    }

    /// Whether a trial's end says something of its own about what can be reached: nudged starts of searches
    /// fall into the hole that the start is in.
    pub(super) fn counts_for_agreement(&self, trial: Trial) -> bool {
        match trial {
            Trial::Quick(index) | Trial::Full(index) => self.kind == Kind::Sweeps || index % 2 == 0,
            _ => true,
        }
    }
}
