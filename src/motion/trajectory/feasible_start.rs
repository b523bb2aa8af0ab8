//! Feasible start for limits on several variables together.
//!
//! The search moves the variables from sample to sample within their displacement bounds, such that the next fixed
//! sample stays reachable.

use std::f64::consts::TAU;

use super::bounds::{FrameBounds, Frames, TooFar};
use super::length_limits::LengthLimit;
use super::space::{is_bounded, rotation};
use crate::bisection::bisect;
use crate::model::BallVariables;
use crate::spatial::{Quaternion, Vector3};

/// Fractions of the displacement bounds that are tried for a path to a fixed sample if that of the start is too small.
const SHARES: [f64; 4] = [0.999, 0.999_99, 0.999_999_9, 1.0];
/// Number of halvings of a bisection.
const HALVINGS: usize = 40;
/// Clearance of a twist from its ends, relative to its range.
const OFF_ENDS: f64 = 1e-3;

/// Three variables with all limits on them.
pub(super) struct Together<'a> {
    bounds: &'a FrameBounds,
    limits: &'a [LengthLimit],
    variables: [usize; 3],
    ball: Option<BallVariables>,
}

impl<'a> Together<'a> {
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
    pub(super) fn draw(&self, x: &mut Frames<'_>, share: f64) -> Result<(), TooFar> {
        for frame in (0..x.frames()).filter(|&frame| !x.fixed[frame]) {
            self.draw_inside(x.frame_mut(frame), share);
        }
        if !self.limits.iter().any(LengthLimit::is_of_move) {
            return Ok(());
        }
        // Stretches between fixed samples, before the first and after the last.
        let mut begin = 0;
        for end in 0..=x.frames() {
            if end == x.frames() || x.fixed[end] {
                self.draw_stretch(x, begin, end, share)?;
                begin = end;
            }
        }
        Ok(())
    }

    /// Moves a sample to within its swing and angle limits.
    fn draw_inside(&self, x: &mut [f64], share: f64) {
        for limit in self.limits.iter().filter(|limit| !limit.is_of_move()) {
            let is_inside = |x: &[f64]| limit.rho(x, x).norm() <= share * limit.most;
            if is_inside(x) {
                continue;
            }
            let from = self.variables.map(|variable| x[variable]);
            let to = self.inside(limit);
            let within = bisect(1.0, 0.0, HALVINGS, |share| {
                self.put(x, from, to, share);
                is_inside(x)
            });
            self.put(x, from, to, within);
        }
    }

    fn put(&self, x: &mut [f64], from: [f64; 3], to: [f64; 3], share: f64) {
        for (k, variable) in self.variables.into_iter().enumerate() {
            x[variable] = from[k] + share * (to[k] - from[k]);
        }
    }

    /// Returns a point within a limit of one sample: zero swing, and the twist nearest to zero.
    fn inside(&self, limit: &LengthLimit) -> [f64; 3] {
        let third = self.variables[2];
        let (low, high) = (self.bounds.lower[third], self.bounds.upper[third]);
        let nearest = 0.0_f64.clamp(low, high);
        let room = (high - low).min(limit.most - nearest.abs());
        let off = OFF_ENDS * room.min(1.0);
        [0.0, 0.0, 0.0_f64.clamp(low + off, high - off)]
    }

    /// Moves the samples of a stretch, which begins at a fixed or the first sample and ends before the next fixed one.
    fn draw_stretch(
        &self,
        x: &mut Frames<'_>,
        begin: usize,
        end: usize,
        share: f64,
    ) -> Result<(), TooFar> {
        let goal = (end < x.frames()).then(|| x.frame(end).to_vec());
        let from_fixed = x.fixed[begin];
        let mut most = share;
        if let (Some(goal), true) = (&goal, from_fixed)
            && begin < end
        {
            let steps = (end - begin) as f64;
            let longest = self.longest_step(x.frame(begin), goal, end - begin);
            let shares = std::iter::once(share).chain(SHARES);
            let enough = shares.into_iter().find(|share| longest <= *share);
            most = enough.ok_or(TooFar {
                variable: self.variables[0],
            })?;
            if self.line(x.frame(begin), goal) > most * steps {
                // Only the straight path is known to lead there.
                for frame in begin + 1..end {
                    let at = (frame - begin) as f64 / steps;
                    let place = self.between(x.frame(begin), goal, at);
                    x.put(frame, self.variables, place);
                }
                return Ok(());
            }
        }
        for frame in begin..end {
            if x.fixed[frame] {
                continue;
            }
            let left = (end - frame) as f64;
            let mut wanted = x.frame(frame).to_vec();
            let reaches = |place: &[f64]| {
                let goal = goal.as_ref();
                goal.is_none_or(|goal| self.line(place, goal) <= most * left)
            };
            if frame == begin {
                // Without a predecessor, the sample may be anywhere from which the next fixed one is reachable.
                if let Some(goal) = goal.as_ref().filter(|_| !reaches(&wanted)) {
                    let at = most * left / self.line(goal, &wanted);
                    let place = self.between(goal, &wanted, at * (1.0 - f64::EPSILON));
                    x.put(frame, self.variables, place);
                }
                continue;
            }
            let before = x.frame(frame - 1).to_vec();
            let place = self.towards(&before, &wanted, most);
            self.write(&mut wanted, place);
            if let Some(goal) = goal.as_ref().filter(|_| !reaches(&wanted)) {
                let mut straight = before.clone();
                self.write(
                    &mut straight,
                    self.between(&before, goal, 1.0 / (left + 1.0)),
                );
                let aside = wanted.clone();
                let mut part = 0.5;
                let found = (0..HALVINGS).find_map(|_| {
                    let place = self.between(&straight, &aside, part);
                    self.write(&mut wanted, place);
                    part *= 0.5;
                    let is_near = self.moved(&before, &wanted) <= most;
                    (is_near && reaches(&wanted)).then_some(place)
                });
                let place = found.unwrap_or_else(|| self.variables.map(|k| straight[k]));
                self.write(&mut wanted, place);
            }
            let place = self.variables.map(|variable| wanted[variable]);
            x.put(frame, self.variables, place);
        }
        Ok(())
    }

    fn write(&self, x: &mut [f64], place: [f64; 3]) {
        for (variable, value) in self.variables.into_iter().zip(place) {
            x[variable] = value;
        }
    }

    /// Returns the farthest point on the path between two samples within the displacement bounds.
    fn towards(&self, from: &[f64], to: &[f64], most: f64) -> [f64; 3] {
        let mut at = to.to_vec();
        if self.moved(from, to) <= most {
            return self.variables.map(|variable| to[variable]);
        }
        let within = bisect(0.0, 1.0, HALVINGS, |share| {
            self.write(&mut at, self.between(from, to, share));
            self.moved(from, &at) <= most
        });
        self.between(from, to, within)
    }

    /// Returns the displacement between two samples relative to its bound.
    fn moved(&self, from: &[f64], to: &[f64]) -> f64 {
        let moves = self.limits.iter().filter(|limit| limit.is_of_move());
        let together = moves.map(|limit| limit.rho(from, to).norm() / limit.most);
        let alone = self.variables.into_iter().map(|variable| {
            let most = self.bounds.most[variable];
            match most.is_finite() {
                true => (to[variable] - from[variable]).abs() / most,
                false => 0.0,
            }
        });
        together.chain(alone).fold(0.0, f64::max)
    }

    /// Interpolates between two samples: by the shortest rotation for a ball joint without limits, else linearly.
    fn between(&self, from: &[f64], to: &[f64], share: f64) -> [f64; 3] {
        match &self.ball {
            Some(ball) if !is_bounded(ball) => {
                let start = rotation(ball, from);
                let turn = (start.conjugate() * rotation(ball, to)).log();
                ball.chart.variables(start * Quaternion::exp(turn * share))
            }
            _ => {
                let way = self.way(from, to);
                [0, 1, 2].map(|k| from[self.variables[k]] + share * way[k])
            }
        }
    }

    /// Returns the difference of two samples; for an unlimited twist the shorter direction.
    fn way(&self, from: &[f64], to: &[f64]) -> [f64; 3] {
        let mut way = self.variables.map(|variable| to[variable] - from[variable]);
        let swings = self.ball.is_some_and(|ball| ball.swing.is_some());
        let third = self.variables[2];
        if swings && self.bounds.upper[third] == f64::INFINITY {
            way[2] -= TAU * (way[2] / TAU).round();
        }
        way
    }

    /// Returns an upper bound on the path length between two samples, relative to the displacement bound.
    fn line(&self, from: &[f64], to: &[f64]) -> f64 {
        let Some(ball) = self.ball.filter(is_bounded) else {
            return self.moved(from, to);
        };
        // A rotation vector is at most as long as the sum of its parts, swing and twist.
        let [first, second, third] = self.way(from, to);
        let turn = match ball.swing {
            None => Vector3::new(first, second, third).norm(),
            Some(_) => (first * first + second * second).sqrt() + third.abs(),
        };
        let moves = self.limits.iter().filter(|limit| limit.is_of_move());
        moves.map(|limit| turn / limit.most).fold(0.0, f64::max)
    }

    /// Returns the longest of `steps` equal steps between two samples, relative to its bound.
    fn longest_step(&self, from: &[f64], to: &[f64], steps: usize) -> f64 {
        let (mut last, mut next) = (from.to_vec(), from.to_vec());
        let mut longest = 0.0_f64;
        for step in 1..=steps {
            let place = self.between(from, to, step as f64 / steps as f64);
            self.write(&mut next, place);
            longest = longest.max(self.moved(&last, &next));
            std::mem::swap(&mut last, &mut next);
        }
        longest
    }
}

/// Groups consecutive limits on the same variables.
pub(super) fn groups(limits: &[LengthLimit]) -> impl Iterator<Item = &[LengthLimit]> {
    limits.chunk_by(|a, b| a.variables == b.variables)
}
