//! Singularities of a solution away from limits.

use super::Parts;
use super::kkt_point::{Evaluator, Place};
use super::system::System;
use crate::buffer::refill;
use crate::random::RandomStream;
use crate::solver::{LeastSquares, largest};

/// Size of the perturbation that tests generic rank, radians or metres.
const BESIDE: f64 = 1e-5;
/// Effect of the parameters along a flat direction, relative to that along an average direction, that counts as none.
const UNFELT: f64 = 1e-5;

/// Kind of the directions along which the cost is flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flat {
    /// The solution is free along them, and no parameter changes that.
    Undecided,
    /// Parameters push along them: the solution jumps.
    Singular,
}

impl System {
    /// Returns the number of constrained rows that are dependent only at this configuration.
    pub(super) fn lost_ranks(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        place: &mut Place,
    ) -> usize {
        let rank = self.rank();
        if rank >= place.roles.held.len() || self.nullity() == 0 {
            return 0;
        }
        let mut random = RandomStream::new(0, 0);
        let free = place.directions.len();
        let beside: Vec<f64> = (0..free).map(|_| 2.0 * random.unit() - 1.0).collect();
        let at = place.moved(&beside, BESIDE).to_vec();
        let here = place.along.clone();
        let mut jacobian = std::mem::take(&mut place.jacobian);
        let there = &mut jacobian.clone();
        evaluator.evaluation().analytic_jacobian(&at, there);
        let rows = there.nrows();
        place
            .directions
            .reduce(rows, there.as_slice(), &mut place.along);
        std::mem::swap(&mut place.jacobian, &mut jacobian);
        self.take_held(place);
        let generic = self.rank();
        place.along = here;
        self.take_held(place);
        generic.saturating_sub(rank)
    }
}

impl Parts {
    /// Returns the largest element of the remaining Newton step, radians or metres.
    pub(super) fn distance_left(&mut self) -> f64 {
        let place = &self.place;
        if place.roles.pulled.is_empty() {
            return 0.0;
        }
        refill(&mut self.rates, place.x.len(), 0.0);
        place.slope(&mut self.rates);
        (place.directions).reduce(1, &self.rates, &mut self.slope);
        refill(&mut self.step, place.directions.len(), 0.0);
        (self.system).add_pull(&self.slope, -1.0, &mut self.step);
        largest(&self.step)
    }

    /// Returns the kind of the `flat` directions along which the reduced cost is flat.
    pub(super) fn flatness(&mut self, evaluator: &mut Evaluator<'_, '_>, flat: usize) -> Flat {
        if flat == 0 || self.place.roles.pulled.is_empty() {
            return Flat::Undecided;
        }
        let mut gradient = std::mem::take(&mut self.gradient);
        let mut along = |parts: &mut Self, y: &[f64]| {
            y.clone_into(&mut parts.step);
            gradient.clear();
            parts.add_slopes_along(evaluator, &mut gradient);
            largest(gradient.targets())
        };
        let all =
            vec![1.0 / (self.place.directions.len() as f64).sqrt(); self.place.directions.len()];
        let usual = along(self, &all);
        let mut direction = Vec::new();
        let mut flatness = Flat::Undecided;
        for k in 0..flat {
            self.system.flat_direction(k, &mut direction);
            if along(self, &direction) > UNFELT * usual {
                flatness = Flat::Singular;
            }
        }
        self.gradient = gradient;
        flatness
    }

    /// Returns a task whose rows vanish just across its bounds while no multiplier pushes against them.
    pub(super) fn task_at_kink(&mut self, evaluator: &mut Evaluator<'_, '_>) -> Option<String> {
        let question = evaluator.question;
        let Self {
            place,
            system,
            rows,
            step,
            image,
            ..
        } = self;
        let tasks = question.problem().compiled_tasks().iter().enumerate();
        let mut edged = tasks.filter(|(index, _)| question.residual(*index).has_edges());
        let none = |row: &usize| place.r[*row] == 0.0;
        let held = &place.roles.held;
        if !edged.any(|(_, task)| held.iter().any(|row| task.rows.contains(row) && !none(row))) {
            return None;
        }
        // Reflected across the bounds.
        rows.clear();
        rows.extend(place.r.iter().map(|r| 2.0 * r));
        system.restore(place, rows, step);
        place.moved(step, 1.0);
        refill(image, rows.len(), 0.0);
        let mut evaluation = evaluator.evaluation();
        evaluation.residual(place.shifted(), image);
        let vanish = |row: usize| place.r[row] != 0.0 && image[row] == 0.0;
        if !place.roles.held.iter().any(|&row| vanish(row)) {
            return None;
        }
        // The rows may vanish by rounding, or because the task has no error there.
        let mut there = place.jacobian.clone();
        evaluation.analytic_jacobian(place.shifted(), &mut there);
        let idle = |row: usize| there.row(row).iter().all(|entry| *entry == 0.0);
        let largest = largest(&place.counts);
        let problem = question.problem();
        let task_at_kink = problem.compiled_tasks().iter().find(|task| {
            let own = task
                .rows
                .clone()
                .filter(|row| place.roles.held.contains(row));
            let mut crossed = own.filter(|&row| vanish(row) && idle(row)).peekable();
            let vanishes = crossed.peek().is_some();
            let push: f64 = crossed
                .map(|row| place.counts[row] * place.r[row].signum())
                .sum();
            vanishes && push <= WEAK * largest
        });
        task_at_kink.map(|task| task.name().to_owned())
    }
}

/// Multiplier, relative to the largest, below which a bound is weakly active.
const WEAK: f64 = 1e-6;
