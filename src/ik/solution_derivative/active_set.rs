//! Active set of joint limits at a solution.

use super::differentiability::NoDerivative;
use super::kkt_point::Place;
use super::system::System;
use crate::problem::ProblemInstance;

/// Multiplier, relative to the terms that cancel in it, below which a limit is weakly active.
const WEAK: f64 = 1e-6;

/// Result of the active set selection.
#[derive(Clone, Debug, Default)]
pub(super) struct Limits {
    /// First weakly active limit, at which the solution is not differentiable.
    pub(super) weak: Option<NoDerivative>,
    /// Dimension of the null space without the limits that need not be active.
    pub(super) undecided: usize,
}

impl System {
    /// Determines the active bounds, and computes the constrained rows and their multipliers for them.
    pub(super) fn take_limits(
        &mut self,
        question: ProblemInstance<'_>,
        place: &mut Place,
    ) -> Limits {
        let mut limits = match place.roles.pulled.is_empty() {
            true => self.hold_idle(question, place),
            false => self.hold_pushed(question, place),
        };
        // The curvature of these edges is unknown here, so the solution counts as not differentiable.
        let edge = question.space().on_edge_of_turn(&place.x);
        let told = limits.weak.take();
        limits.weak = told.or_else(|| edge.map(|variable| on_limit(question, variable)));
        limits
    }

    /// Selects the active set without minimised rows: joints stay at their limits if the constrained rows keep their
    /// rank.
    fn hold_idle(&mut self, question: ProblemInstance<'_>, place: &mut Place) -> Limits {
        place.set_free(question);
        self.take_held(place);
        let mut limits = Limits {
            weak: None,
            undecided: self.nullity(),
        };
        let mut idle = place.bounds.iter().filter(|bound| !bound.is_locked);
        if let Some(first) = idle.next().copied() {
            let held = self.rank();
            hold(place, false);
            place.set_free(question);
            self.take_held(place);
            limits.undecided = self.nullity();
            if self.rank() == held {
                hold(place, true);
                place.set_free(question);
                self.take_held(place);
            } else {
                limits.weak = Some(on_limit(question, first.variable));
            }
        }
        limits
    }

    /// Removes the limits that are pulled inward from the active set, one by one.
    fn hold_pushed(&mut self, question: ProblemInstance<'_>, place: &mut Place) -> Limits {
        let mut slope = vec![0.0; place.x.len()];
        loop {
            place.set_free(question);
            self.take_held(place);
            self.balance(place);
            if place.bounds.is_empty() {
                return Limits::default();
            }
            place.slope(&mut slope);
            let negligible = WEAK * place.slope_scale();
            let pushes = place.bounds.iter().enumerate();
            let pushes = pushes
                .filter(|(_, bound)| bound.is_held && !bound.is_locked)
                .map(|(k, bound)| (k, bound.push(&slope)));
            let least = pushes.min_by(|one, other| one.1.total_cmp(&other.1));
            match least {
                Some((k, push)) if push < -negligible => place.bounds[k].is_held = false,
                Some((k, push)) if push <= negligible => {
                    return Limits {
                        weak: Some(on_limit(question, place.bounds[k].variable)),
                        undecided: 0,
                    };
                }
                _ => return Limits::default(),
            }
        }
    }
}

fn hold(place: &mut Place, is_held: bool) {
    for bound in place.bounds.iter_mut().filter(|bound| !bound.is_locked) {
        bound.is_held = is_held;
    }
}

fn on_limit(question: ProblemInstance<'_>, variable: usize) -> NoDerivative {
    let names = &question.problem().names().variables;
    NoDerivative::OnLimit {
        joint: names.get(variable).cloned().unwrap_or_default(),
    }
}
