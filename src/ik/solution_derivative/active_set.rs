//! Which of the limits that a solution stands on hold it.

use super::existence::NoDerivative;
use super::place::Place;
use super::system::System;
use crate::problem::Question;

/// A push of less than this share of what cancels in it is none.
const WEAK: f64 = 1e-6;

/// What is known of the limits.
#[derive(Clone, Debug, Default)]
pub(super) struct Limits {
    /// One on which nothing decides.
    pub(super) weak: Option<NoDerivative>,
    /// In how many directions nothing decides once the limits that need not hold are left aside.
    pub(super) undecided: usize,
}

impl System {
    /// Says which bounds hold, and takes the held rows and their multipliers with those held.
    pub(super) fn take_limits(&mut self, question: Question<'_>, place: &mut Place) -> Limits {
        let mut limits = match place.roles.pulled.is_empty() {
            true => self.hold_idle(question, place),
            false => self.hold_pushed(question, place),
        };
        // How the edge of a whole angle or of a move bends is not known here: what is told there is no derivative.
        let edge = question.space().on_edge_of_turn(&place.x);
        let told = limits.weak.take();
        limits.weak = told.or_else(|| edge.map(|variable| on_limit(question, variable)));
        limits
    }

    /// Where nothing pulls nothing pushes: joints stay on their limits where the held rows can do without them.
    fn hold_idle(&mut self, question: Question<'_>, place: &mut Place) -> Limits {
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

    /// Lets go, one after the other, of limits that are pulled away from.
    fn hold_pushed(&mut self, question: Question<'_>, place: &mut Place) -> Limits {
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

fn on_limit(question: Question<'_>, variable: usize) -> NoDerivative {
    let names = &question.problem().names().variables;
    NoDerivative::OnLimit {
        joint: names.get(variable).cloned().unwrap_or_default(),
    }
}
