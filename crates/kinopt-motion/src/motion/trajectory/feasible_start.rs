//! Feasible start for limits on several variables together.
//!
//! The search moves the variables from sample to sample within their displacement bounds, such that the next fixed
//! sample stays reachable.

use std::f64::consts::TAU;

use super::bounds::{FrameBounds, SampleVariables, TooFar};
use super::length_limits::LengthLimit;
use super::space::{is_bounded, rotation};
use kinopt_kinematics::bisection::bisect;
use kinopt_kinematics::model::BallVariables;
use kinopt_kinematics::spatial::{Quaternion, Vector3};

/// Fractions of the displacement bounds that are tried for a path to a fixed sample if that of the start is too small.
const STEP_FRACTIONS: [f64; 4] = [0.999, 0.999_99, 0.999_999_9, 1.0];
/// Number of halvings of a bisection.
const HALVINGS: usize = 40;
/// Clearance of a twist from its ends, relative to its range.
const TWIST_CLEARANCE: f64 = 1e-3;

/// Three variables with all limits on them.
pub(super) struct LimitGroup<'a> {
    bounds: &'a FrameBounds,
    limits: &'a [LengthLimit],
    variables: [usize; 3],
    ball: Option<BallVariables>,
}

impl<'a> LimitGroup<'a> {
    /// Creates it from limits on the same variables.
    pub(super) fn new(bounds: &'a FrameBounds, limits: &'a [LengthLimit]) -> Self {
        Self {
            bounds,
            limits,
            variables: limits[0].variables,
            ball: limits[0].ball().copied(),
        }
    }

    /// Moves samples to within a fraction of the limits. Fixed samples stay.
    ///
    /// # Errors
    /// Returns an error if a fixed sample cannot be reached from the one before.
    pub(super) fn move_inside(
        &self,
        x: &mut SampleVariables<'_>,
        fraction: f64,
    ) -> Result<(), TooFar> {
        for frame in (0..x.frames()).filter(|&frame| !x.fixed[frame]) {
            self.move_inside_limits(x.frame_mut(frame), fraction);
        }
        if !self.limits.iter().any(LengthLimit::limits_displacement) {
            return Ok(());
        }
        // Stretches between fixed samples, before the first and after the last.
        let mut begin = 0;
        for end in 0..=x.frames() {
            if end == x.frames() || x.fixed[end] {
                self.move_stretch(x, begin, end, fraction)?;
                begin = end;
            }
        }
        Ok(())
    }

    /// Moves a sample to within its swing and angle limits.
    fn move_inside_limits(&self, x: &mut [f64], fraction: f64) {
        for limit in self
            .limits
            .iter()
            .filter(|limit| !limit.limits_displacement())
        {
            let is_inside = |x: &[f64]| limit.rho(x, x).norm() <= fraction * limit.max_length;
            if is_inside(x) {
                continue;
            }
            let from = self.variables.map(|variable| x[variable]);
            let to = self.inner_point(limit);
            let within = bisect(1.0, 0.0, HALVINGS, |fraction| {
                self.set_interpolated(x, from, to, fraction);
                is_inside(x)
            });
            self.set_interpolated(x, from, to, within);
        }
    }

    fn set_interpolated(&self, x: &mut [f64], from: [f64; 3], to: [f64; 3], fraction: f64) {
        for (k, variable) in self.variables.into_iter().enumerate() {
            x[variable] = from[k] + fraction * (to[k] - from[k]);
        }
    }

    /// Returns a point within a limit of one sample: zero swing, and the twist nearest to zero.
    fn inner_point(&self, limit: &LengthLimit) -> [f64; 3] {
        let third = self.variables[2];
        let (low, high) = (self.bounds.lower[third], self.bounds.upper[third]);
        let nearest = 0.0_f64.clamp(low, high);
        let available = (high - low).min(limit.max_length - nearest.abs());
        let clearance = TWIST_CLEARANCE * available.min(1.0);
        [0.0, 0.0, 0.0_f64.clamp(low + clearance, high - clearance)]
    }

    /// Moves the samples of a stretch, which begins at a fixed or the first sample and ends before the next fixed one.
    fn move_stretch(
        &self,
        x: &mut SampleVariables<'_>,
        begin: usize,
        end: usize,
        fraction: f64,
    ) -> Result<(), TooFar> {
        let goal = (end < x.frames()).then(|| x.frame(end).to_vec());
        let from_fixed = x.fixed[begin];
        let mut max_step = fraction;
        if let (Some(goal), true) = (&goal, from_fixed)
            && begin < end
        {
            let steps = (end - begin) as f64;
            let longest = self.longest_step(x.frame(begin), goal, end - begin);
            let fractions = std::iter::once(fraction).chain(STEP_FRACTIONS);
            let feasible = fractions.into_iter().find(|fraction| longest <= *fraction);
            max_step = feasible.ok_or(TooFar {
                variable: self.variables[0],
            })?;
            if self.path_length(x.frame(begin), goal) > max_step * steps {
                // Only the straight path is known to lead there.
                for frame in begin + 1..end {
                    let progress = (frame - begin) as f64 / steps;
                    let values = self.interpolate(x.frame(begin), goal, progress);
                    x.set_variables(frame, self.variables, values);
                }
                return Ok(());
            }
        }
        for frame in begin..end {
            if x.fixed[frame] {
                continue;
            }
            let remaining_steps = (end - frame) as f64;
            let mut target = x.frame(frame).to_vec();
            let reaches = |sample: &[f64]| {
                let goal = goal.as_ref();
                goal.is_none_or(|goal| self.path_length(sample, goal) <= max_step * remaining_steps)
            };
            if frame == begin {
                // Without a predecessor, the sample may be anywhere from which the next fixed one is reachable.
                if let Some(goal) = goal.as_ref().filter(|_| !reaches(&target)) {
                    let progress = max_step * remaining_steps / self.path_length(goal, &target);
                    let values = self.interpolate(goal, &target, progress * (1.0 - f64::EPSILON));
                    x.set_variables(frame, self.variables, values);
                }
                continue;
            }
            let before = x.frame(frame - 1).to_vec();
            let values = self.towards(&before, &target, max_step);
            self.write(&mut target, values);
            if let Some(goal) = goal.as_ref().filter(|_| !reaches(&target)) {
                let mut straight_sample = before.clone();
                self.write(
                    &mut straight_sample,
                    self.interpolate(&before, goal, 1.0 / (remaining_steps + 1.0)),
                );
                let original = target.clone();
                let mut blend = 0.5;
                let blended = (0..HALVINGS).find_map(|_| {
                    let values = self.interpolate(&straight_sample, &original, blend);
                    self.write(&mut target, values);
                    blend *= 0.5;
                    let is_near = self.relative_step(&before, &target) <= max_step;
                    (is_near && reaches(&target)).then_some(values)
                });
                let values = blended.unwrap_or_else(|| self.variables.map(|k| straight_sample[k]));
                self.write(&mut target, values);
            }
            let values = self.variables.map(|variable| target[variable]);
            x.set_variables(frame, self.variables, values);
        }
        Ok(())
    }

    fn write(&self, x: &mut [f64], values: [f64; 3]) {
        for (variable, value) in self.variables.into_iter().zip(values) {
            x[variable] = value;
        }
    }

    /// Returns the farthest point on the path between two samples within the displacement bounds.
    fn towards(&self, from: &[f64], to: &[f64], max_step: f64) -> [f64; 3] {
        let mut sample = to.to_vec();
        if self.relative_step(from, to) <= max_step {
            return self.variables.map(|variable| to[variable]);
        }
        let within = bisect(0.0, 1.0, HALVINGS, |fraction| {
            self.write(&mut sample, self.interpolate(from, to, fraction));
            self.relative_step(from, &sample) <= max_step
        });
        self.interpolate(from, to, within)
    }

    /// Returns the displacement between two samples relative to its bound.
    fn relative_step(&self, from: &[f64], to: &[f64]) -> f64 {
        let moves = self
            .limits
            .iter()
            .filter(|limit| limit.limits_displacement());
        let group = moves.map(|limit| limit.rho(from, to).norm() / limit.max_length);
        let single = self.variables.into_iter().map(|variable| {
            let max_step = self.bounds.max_step[variable];
            match max_step.is_finite() {
                true => (to[variable] - from[variable]).abs() / max_step,
                false => 0.0,
            }
        });
        group.chain(single).fold(0.0, f64::max)
    }

    /// Interpolates between two samples: by the shortest rotation for a ball joint without limits, else linearly.
    fn interpolate(&self, from: &[f64], to: &[f64], fraction: f64) -> [f64; 3] {
        match &self.ball {
            Some(ball) if !is_bounded(ball) => {
                let start = rotation(ball, from);
                let rotation_vector = (start.conjugate() * rotation(ball, to)).log();
                ball.chart
                    .variables(start * Quaternion::exp(rotation_vector * fraction))
            }
            _ => {
                let displacement = self.displacement(from, to);
                [0, 1, 2].map(|k| from[self.variables[k]] + fraction * displacement[k])
            }
        }
    }

    /// Returns the difference of two samples; for an unlimited twist the shorter direction.
    fn displacement(&self, from: &[f64], to: &[f64]) -> [f64; 3] {
        let mut displacement = self.variables.map(|variable| to[variable] - from[variable]);
        let has_swing = self.ball.is_some_and(|ball| ball.swing.is_some());
        let third = self.variables[2];
        if has_swing && self.bounds.upper[third] == f64::INFINITY {
            displacement[2] -= TAU * (displacement[2] / TAU).round();
        }
        displacement
    }

    /// Returns an upper bound on the path length between two samples, relative to the displacement bound.
    fn path_length(&self, from: &[f64], to: &[f64]) -> f64 {
        let Some(ball) = self.ball.filter(is_bounded) else {
            return self.relative_step(from, to);
        };
        // A rotation vector is at most as long as the sum of its parts, swing and twist.
        let [first, second, third] = self.displacement(from, to);
        let angle = match ball.swing {
            None => Vector3::new(first, second, third).norm(),
            Some(_) => (first * first + second * second).sqrt() + third.abs(),
        };
        let moves = self
            .limits
            .iter()
            .filter(|limit| limit.limits_displacement());
        moves
            .map(|limit| angle / limit.max_length)
            .fold(0.0, f64::max)
    }

    /// Returns the longest of `steps` equal steps between two samples, relative to its bound.
    fn longest_step(&self, from: &[f64], to: &[f64], steps: usize) -> f64 {
        let (mut last, mut next) = (from.to_vec(), from.to_vec());
        let mut longest = 0.0_f64;
        for step in 1..=steps {
            let values = self.interpolate(from, to, step as f64 / steps as f64);
            self.write(&mut next, values);
            longest = longest.max(self.relative_step(&last, &next));
            std::mem::swap(&mut last, &mut next);
        }
        longest
    }
}

/// Groups consecutive limits on the same variables.
pub(super) fn groups(limits: &[LengthLimit]) -> impl Iterator<Item = &[LengthLimit]> {
    limits.chunk_by(|a, b| a.variables == b.variables)
}
