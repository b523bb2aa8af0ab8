//! Singularities of a solution away from limits.

use super::Parts;
use super::kkt_point::{Evaluator, KktPoint};
use super::system::System;
use crate::solver::{LeastSquares, largest};
use kinopt_kinematics::buffer::refill;
use kinopt_kinematics::random::RandomStream;

/// Size of the perturbation that tests generic rank, radians or metres.
const PERTURBATION: f64 = 1e-5;
/// Effect of the parameters along a flat direction, relative to that along an average direction, that counts as none.
const MAX_RELATIVE_EFFECT: f64 = 1e-5;

/// Kind of the directions along which the cost is flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flatness {
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
        point: &mut KktPoint,
    ) -> usize {
        let rank = self.rank();
        if rank >= point.roles.constrained.len() || self.nullity() == 0 {
            return 0;
        }
        let mut random = RandomStream::new(0, 0);
        let direction_count = point.directions.len();
        let direction: Vec<f64> = (0..direction_count)
            .map(|_| 2.0 * random.unit() - 1.0)
            .collect();
        let shifted_x = point.shift_x(&direction, PERTURBATION).to_vec();
        let reduced_jacobian = point.reduced_jacobian.clone();
        let mut jacobian = std::mem::take(&mut point.jacobian);
        let shifted_jacobian = &mut jacobian.clone();
        evaluator
            .evaluation()
            .analytic_jacobian(&shifted_x, shifted_jacobian);
        let rows = shifted_jacobian.nrows();
        point.directions.reduce(
            rows,
            shifted_jacobian.as_slice(),
            &mut point.reduced_jacobian,
        );
        std::mem::swap(&mut point.jacobian, &mut jacobian);
        self.factorise_constrained(point);
        let generic_rank = self.rank();
        point.reduced_jacobian = reduced_jacobian;
        self.factorise_constrained(point);
        generic_rank.saturating_sub(rank)
    }
}

impl Parts {
    /// Returns the largest element of the remaining Newton step, radians or metres.
    pub(super) fn newton_step_size(&mut self) -> f64 {
        let point = &self.point;
        if point.roles.minimised.is_empty() {
            return 0.0;
        }
        refill(&mut self.rates, point.x.len(), 0.0);
        point.slope(&mut self.rates);
        (point.directions).reduce(1, &self.rates, &mut self.slope);
        refill(&mut self.step, point.directions.len(), 0.0);
        (self.system).add_minimising_step(&self.slope, -1.0, &mut self.step);
        largest(&self.step)
    }

    /// Returns the kind of the `flat_directions` along which the reduced cost is flat.
    pub(super) fn flatness(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        flat_directions: usize,
    ) -> Flatness {
        if flat_directions == 0 || self.point.roles.minimised.is_empty() {
            return Flatness::Undecided;
        }
        let mut gradient = std::mem::take(&mut self.gradient);
        let mut effect_along = |parts: &mut Self, y: &[f64]| {
            y.clone_into(&mut parts.step);
            gradient.clear();
            parts.add_slopes_along(evaluator, &mut gradient);
            largest(gradient.targets())
        };
        let mean_direction =
            vec![1.0 / (self.point.directions.len() as f64).sqrt(); self.point.directions.len()];
        let mean_effect = effect_along(self, &mean_direction);
        let mut direction = Vec::new();
        let mut flatness = Flatness::Undecided;
        for k in 0..flat_directions {
            self.system.flat_direction(k, &mut direction);
            if effect_along(self, &direction) > MAX_RELATIVE_EFFECT * mean_effect {
                flatness = Flatness::Singular;
            }
        }
        self.gradient = gradient;
        flatness
    }

    /// Returns a task whose rows vanish just across its bounds while no multiplier pushes against them.
    pub(super) fn task_at_kink(&mut self, evaluator: &mut Evaluator<'_, '_>) -> Option<String> {
        let instance = evaluator.instance;
        let Self {
            point,
            system,
            rows,
            step,
            image,
            ..
        } = self;
        let tasks = instance.problem().compiled_tasks().iter().enumerate();
        let mut bounded_tasks = tasks.filter(|(index, _)| instance.residual(*index).has_edges());
        let is_zero = |row: &usize| point.r[*row] == 0.0;
        let constrained = &point.roles.constrained;
        if !bounded_tasks.any(|(_, task)| {
            constrained
                .iter()
                .any(|row| task.rows.contains(row) && !is_zero(row))
        }) {
            return None;
        }
        // Reflected across the bounds.
        rows.clear();
        rows.extend(point.r.iter().map(|r| 2.0 * r));
        system.restore(point, rows, step);
        point.shift_x(step, 1.0);
        refill(image, rows.len(), 0.0);
        let mut evaluation = evaluator.evaluation();
        evaluation.residual(point.shifted(), image);
        let crosses_bounds = |row: usize| point.r[row] != 0.0 && image[row] == 0.0;
        if !point
            .roles
            .constrained
            .iter()
            .any(|&row| crosses_bounds(row))
        {
            return None;
        }
        // The rows may vanish by rounding, or because the task has no error there.
        let mut shifted_jacobian = point.jacobian.clone();
        evaluation.analytic_jacobian(point.shifted(), &mut shifted_jacobian);
        let has_zero_jacobian =
            |row: usize| shifted_jacobian.row(row).iter().all(|entry| *entry == 0.0);
        let largest = largest(&point.row_weights);
        let problem = instance.problem();
        let task_at_kink = problem.compiled_tasks().iter().find(|task| {
            let constrained_rows = task
                .rows
                .clone()
                .filter(|row| point.roles.constrained.contains(row));
            let mut crossed_rows = constrained_rows
                .filter(|&row| crosses_bounds(row) && has_zero_jacobian(row))
                .peekable();
            let any_crossed = crossed_rows.peek().is_some();
            let push: f64 = crossed_rows
                .map(|row| point.row_weights[row] * point.r[row].signum())
                .sum();
            any_crossed && push <= MIN_RELATIVE_MULTIPLIER * largest
        });
        task_at_kink.map(|task| task.name().to_owned())
    }
}

/// Multiplier, relative to the largest, below which a bound is weakly active.
const MIN_RELATIVE_MULTIPLIER: f64 = 1e-6;
