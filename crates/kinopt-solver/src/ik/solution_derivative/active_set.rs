//! Active set of joint limits at a solution.

use super::differentiability::NoDerivative;
use super::kkt_point::KktPoint;
use super::system::System;
use crate::problem::ProblemInstance;

/// Multiplier, relative to the terms that cancel in it, below which a limit is weakly active.
const MIN_RELATIVE_MULTIPLIER: f64 = 1e-6;

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
    pub(super) fn select_active_limits(
        &mut self,
        instance: ProblemInstance<'_>,
        point: &mut KktPoint,
    ) -> Limits {
        let mut limits = match point.roles.minimised.is_empty() {
            true => self.select_without_multipliers(instance, point),
            false => self.select_by_multipliers(instance, point),
        };
        // The curvature of these edges is unknown here, so the solution counts as not differentiable.
        let edge = instance.space().ball_at_angle_limit(&point.x);
        let weak = limits.weak.take();
        limits.weak = weak.or_else(|| edge.map(|variable| on_limit(instance, variable)));
        limits
    }

    /// Selects the active set without minimised rows: joints stay at their limits if the constrained rows keep their
    /// rank.
    fn select_without_multipliers(
        &mut self,
        instance: ProblemInstance<'_>,
        point: &mut KktPoint,
    ) -> Limits {
        point.compute_directions(instance);
        self.factorise_constrained(point);
        let mut limits = Limits {
            weak: None,
            undecided: self.nullity(),
        };
        let mut idle = point.bounds.iter().filter(|bound| !bound.is_locked);
        if let Some(first) = idle.next().copied() {
            let rank = self.rank();
            set_held(point, false);
            point.compute_directions(instance);
            self.factorise_constrained(point);
            limits.undecided = self.nullity();
            if self.rank() == rank {
                set_held(point, true);
                point.compute_directions(instance);
                self.factorise_constrained(point);
            } else {
                limits.weak = Some(on_limit(instance, first.variable));
            }
        }
        limits
    }

    /// Removes the limits that are pulled inward from the active set, one by one.
    fn select_by_multipliers(
        &mut self,
        instance: ProblemInstance<'_>,
        point: &mut KktPoint,
    ) -> Limits {
        let mut slope = vec![0.0; point.x.len()];
        loop {
            point.compute_directions(instance);
            self.factorise_constrained(point);
            self.compute_row_weights(point);
            if point.bounds.is_empty() {
                return Limits::default();
            }
            point.slope(&mut slope);
            let negligible = MIN_RELATIVE_MULTIPLIER * point.max_slope_terms();
            let pushes = point.bounds.iter().enumerate();
            let pushes = pushes
                .filter(|(_, bound)| bound.is_held && !bound.is_locked)
                .map(|(k, bound)| (k, bound.push(&slope)));
            let least_pushed = pushes.min_by(|one, other| one.1.total_cmp(&other.1));
            match least_pushed {
                Some((k, push)) if push < -negligible => point.bounds[k].is_held = false,
                Some((k, push)) if push <= negligible => {
                    return Limits {
                        weak: Some(on_limit(instance, point.bounds[k].variable)),
                        undecided: 0,
                    };
                }
                _ => return Limits::default(),
            }
        }
    }
}

fn set_held(point: &mut KktPoint, is_held: bool) {
    for bound in point.bounds.iter_mut().filter(|bound| !bound.is_locked) {
        bound.is_held = is_held;
    }
}

fn on_limit(instance: ProblemInstance<'_>, variable: usize) -> NoDerivative {
    let names = &instance.problem().names().variables;
    NoDerivative::OnLimit {
        joint: names.get(variable).cloned().unwrap_or_default(),
    }
}
