//! Local descent from a configuration to the nearest minimum of the cost.
//!
//! Each step minimises ½|r + J d|² + ½ Σ wᵢ dᵢ² over the bounds exactly, and is taken if it lowers the cost. The
//! damping w is at least |r| times the longest column of J, a bound of the curvature that the linearisation leaves out.
//! At the boundary of the reach, a singularity with an error, steps then fall short of the minimum rather than cross
//! it. A stretched arm comes to rest on its side of the elbow.

use nalgebra::{Matrix6, Vector6};

use super::null_space::add_square;
use super::pose_question::PoseQuestion;
use super::workspace::ArmWorkspace;
use crate::clock::{Instant, is_past};
use crate::solver::Termination;

/// Largest number of times that the damping is raised if a step does not lower the cost.
const RAISES: usize = 12;
/// Slope that counts as none, relative to the error's scale; far above rounding for a stretched arm, to keep its side.
const LEVEL: f64 = 1e-6;
/// Fraction of the negligible error to which a damped descent continues.
const LAST_DIGITS: f64 = 1e-3;
/// Length of the probe from a stationary point, radians.
const PROBE: f64 = 1e-4;
/// Tool motion that counts as none along a probe, relative to the longest Jacobian column.
const BLUNT: f64 = 1e-3;
/// Slope that counts as rounding, and shows no side, relative to the error's scale.
const STRAIGHT: f64 = 1e-12;
/// Largest number of Newton steps for one step of the descent.
const NEWTON: usize = 24;

/// Parameters of a local descent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settling {
    /// Largest number of steps.
    pub(super) steps: usize,
    /// Cost of motion: ½ of this factor times the squared distance from the start, m² per rad².
    pub(super) anchor: f64,
    pub(super) deadline: Option<Instant>,
}

impl Settling {
    /// Parameters of a descent without a cost of motion.
    pub(super) fn freely(steps: usize, deadline: Option<Instant>) -> Self {
        let anchor = 0.0;
        Self {
            steps,
            anchor,
            deadline,
        }
    }
}

impl ArmWorkspace {
    /// Lowers the cost from x, which must be within the bounds. Returns the termination and the number of steps.
    ///
    /// Nothing is allocated.
    pub(super) fn settle_near(&mut self, how: &Settling) -> (Termination, usize) {
        self.anchor.copy_from_slice(&self.x);
        self.settle_anchored(how)
    }

    /// Descends as [`settle_near`](Self::settle_near) does, with motion measured from the workspace's anchor.
    pub(super) fn settle_anchored(&mut self, how: &Settling) -> (Termination, usize) {
        let mut x = std::mem::take(&mut self.x);
        let ended = self.settle_from(&mut x, how);
        self.x = x;
        ended
    }

    fn settle_from(&mut self, x: &mut [f64], how: &Settling) -> (Termination, usize) {
        let mut raised = 1.0;
        for step in 0..how.steps {
            let residual = Vector6::from(self.linearise(x));
            let error = residual.norm();
            if !error.is_finite() {
                return (Termination::NonFinite, step);
            }
            // Continue to the last digits, so that a slow target is followed evenly.
            let near = if how.anchor > 0.0 { LAST_DIGITS } else { 1.0 };
            if error <= near * self.negligible_error() {
                return (Termination::Reached, step);
            }
            let longest = self.longest_column();
            let before = self.anchored_cost(x, error, how.anchor);
            if self.is_level(x, &residual, LEVEL * longest * error, how.anchor) {
                if self.falls_beyond(x, &residual, before, how.anchor) {
                    x.copy_from_slice(&self.trial);
                    continue;
                }
                return (Termination::Stationary, step);
            }
            if is_past(how.deadline) {
                return (Termination::TimeLimit, step);
            }
            let mut lowered = false;
            for _ in 0..RAISES {
                let damping = raised * error * longest;
                self.box_step(x, &residual, damping, how.anchor);
                let trial = std::mem::take(&mut self.trial);
                let error = Vector6::from(self.residual(&trial)).norm();
                let after = self.anchored_cost(&trial, error, how.anchor);
                lowered = after < before;
                if lowered {
                    x.copy_from_slice(&trial);
                }
                self.trial = trial;
                if lowered {
                    break;
                }
                raised *= 4.0;
            }
            if !lowered {
                return (Termination::SmallStep, step);
            }
            raised = (0.25 * raised).max(1.0);
        }
        (Termination::IterationLimit, how.steps)
    }

    /// ½|r|² plus the cost of motion.
    fn anchored_cost(&self, x: &[f64], error: f64, anchor: f64) -> f64 {
        let moved = x.iter().zip(&self.anchor).zip(&self.scale);
        let moved: f64 = moved.map(|((x, a), s)| (x - a) * s).map(|by| by * by).sum();
        0.5 * (error * error + anchor * moved)
    }

    /// Norm of the longest column of the workspace's Jacobian; prismatic joints by the metres that weigh as much as a
    /// radian.
    pub(super) fn longest_column(&self) -> f64 {
        let columns = 0..self.scale.len();
        let squares = columns.map(|i| self.column(i).norm_squared());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Returns true if no joint that can move has a slope of more than `negligible`.
    fn is_level(&self, x: &[f64], residual: &Vector6<f64>, negligible: f64, anchor: f64) -> bool {
        let PoseQuestion { lower, upper, .. } = &self.question;
        self.jacobian.column_iter().enumerate().all(|(i, column)| {
            let scale = self.scale[i];
            let pull = anchor * scale * scale * (x[i] - self.anchor[i]);
            let slope = column.dot(residual) + pull;
            let held = x[i] <= lower[i] && slope > 0.0 || x[i] >= upper[i] && slope < 0.0;
            held || slope.abs() <= negligible * scale
        })
    }

    /// Moves the workspace's x off a ridge: a stationary point with lower cost along the null space of the Jacobian.
    ///
    /// Tries the null-space part of each joint's motion. Returns true if one lowers the cost.
    pub(super) fn step_off_ridge(&mut self) -> bool {
        let x = std::mem::take(&mut self.x);
        let error = Vector6::from(self.linearise(&x)).norm();
        let (before, longest) = (0.5 * error * error, self.longest_column());
        let mut direction = std::mem::take(&mut self.wanted);
        let falls = (0..x.len()).any(|joint| {
            direction.fill(0.0);
            direction[joint] = 1.0;
            self.project_to_null(&x, &direction, BLUNT * longest);
            [PROBE, -PROBE]
                .into_iter()
                .any(|probe| self.falls_along_projected(&x, probe, before, 0.0))
        });
        (self.wanted, self.x) = (direction, x);
        if falls {
            self.x.copy_from_slice(&self.trial);
        }
        falls
    }

    /// Returns true if a stationary point is a ridge, as for a stretched arm whose target is within reach again.
    ///
    /// Writes a lower configuration near it to `trial`. The probe is in the null space; otherwise the tool would move
    /// aside by more than it approaches. It follows the slope to the side of the elbow, or without a slope any joint,
    /// in both directions.
    fn falls_beyond(
        &mut self,
        x: &[f64],
        residual: &Vector6<f64>,
        before: f64,
        anchor: f64,
    ) -> bool {
        let mut way = std::mem::take(&mut self.wanted);
        let longest = self.longest_column();
        let mut steepest = 0.0_f64;
        for (i, way) in way.iter_mut().enumerate() {
            *way = -self.column(i).dot(residual);
            steepest = steepest.max(way.abs());
        }
        let bent = steepest > STRAIGHT * longest * residual.norm();
        let ways = if bent { 1 } else { way.len() };
        let falls = (0..ways).any(|joint| {
            if !bent {
                way.fill(0.0);
                way[joint] = 1.0;
            }
            self.project_to_null(x, &way, BLUNT * longest);
            [PROBE, -PROBE]
                .into_iter()
                .any(|probe| self.falls_along_projected(x, probe, before, anchor))
        });
        self.wanted = way;
        falls
    }

    /// Probes a configuration along the projected motion, with the joint that moves farthest moving by `probe` radians.
    ///
    /// Leaves it in `trial`. Returns true if its cost is lower.
    fn falls_along_projected(&mut self, x: &[f64], probe: f64, before: f64, anchor: f64) -> bool {
        let furthest = self.projected.iter().map(|by| by.abs());
        let furthest = furthest.fold(0.0, f64::max);
        if furthest == 0.0 {
            return false;
        }
        let mut trial = std::mem::take(&mut self.trial);
        for (i, trial) in trial.iter_mut().enumerate() {
            let by = self.projected[i] / self.scale[i] * (probe / furthest);
            *trial = self.question.clamp(i, x[i] + by);
        }
        let error = Vector6::from(self.residual(&trial)).norm();
        let falls = self.anchored_cost(&trial, error, anchor) < before;
        self.trial = trial;
        falls
    }

    /// Writes the configuration after the best step from x within the bounds to `trial`.
    ///
    /// The dual of the box problem is d(y) = clamp(c − Jᵀy / w) with six multipliers y = r + J d. A semismooth Newton
    /// iteration finds them (Li & Li 2011, "Projections onto a box and hyperplanes").
    fn box_step(&mut self, x: &[f64], residual: &Vector6<f64>, damping: f64, anchor: f64) {
        let weight = |scale: f64| (damping + anchor) * scale * scale;
        let share = anchor / (damping + anchor);
        let mut y = Vector6::<f64>::zeros();
        // Bit mask of the joints at a bound; y is exact once it repeats.
        let mut last = None;
        for _ in 0..NEWTON {
            let mut miss = y - residual;
            let mut normal = Matrix6::<f64>::identity();
            let mut bound = 0_u64;
            for (i, &from) in x.iter().enumerate() {
                let column: Vector6<f64> = self.jacobian.fixed_view::<6, 1>(0, i).into();
                let inverse = 1.0 / weight(self.scale[i]);
                let home = share * (self.anchor[i] - from);
                let free = from + (home - column.dot(&y) * inverse);
                let held = self.question.clamp(i, free);
                self.trial[i] = held;
                miss -= column * (held - from);
                if held == free {
                    add_square(&mut normal, &column, inverse);
                } else {
                    bound |= 1 << (i % 64);
                }
            }
            let exact = last == Some(bound) && x.len() <= 64;
            if exact || miss.norm() <= 1e-12 * (y.norm() + residual.norm()) {
                return;
            }
            last = Some(bound);
            let Some(factor) = normal.cholesky() else {
                return;
            };
            y -= factor.solve(&miss);
        }
    }
}
