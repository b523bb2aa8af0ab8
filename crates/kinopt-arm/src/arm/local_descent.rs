//! Local descent from a configuration to the nearest minimum of the cost.
//!
//! Each step minimises ½|r + J d|² + ½ Σ wᵢ dᵢ² over the bounds exactly, and is taken if it lowers the cost. The
//! damping w is at least |r| times the longest column of J, a bound of the curvature that the linearisation leaves out.
//! At the boundary of the reach, a singularity with an error, steps then fall short of the minimum rather than cross
//! it. A stretched arm comes to rest on its side of the elbow.

use nalgebra::{Matrix6, Vector6};

use super::null_space::add_square;
use super::pose_problem::PoseProblem;
use super::workspace::ArmWorkspace;
use kinopt_kinematics::clock::{Instant, is_past};
use kinopt_solver::solver::Termination;

/// Largest number of times that the damping is raised if a step does not lower the cost.
const MAX_DAMPING_RAISES: usize = 12;
/// Slope that counts as none, relative to the error's scale; far above rounding for a stretched arm, to keep its side.
const STATIONARITY_TOLERANCE: f64 = 1e-6;
/// Fraction of the negligible error to which a damped descent continues.
const ANCHORED_ERROR_FRACTION: f64 = 1e-3;
/// Length of the probe from a stationary point, radians.
const PROBE_LENGTH: f64 = 1e-4;
/// Tool motion that counts as none along a probe, relative to the longest Jacobian column.
const NULL_SPACE_TOLERANCE: f64 = 1e-3;
/// Slope that counts as rounding, and shows no side, relative to the error's scale.
const SLOPE_ROUNDING: f64 = 1e-12;
/// Largest number of Newton steps for one step of the descent.
const MAX_NEWTON_STEPS: usize = 24;

/// Parameters of a local descent.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalDescent {
    /// Largest number of steps.
    pub(super) steps: usize,
    /// Cost of motion: ½ of this factor times the squared distance from the start, m² per rad².
    pub(super) anchor: f64,
    pub(super) deadline: Option<Instant>,
}

impl LocalDescent {
    /// Parameters of a descent without a cost of motion.
    pub(super) fn without_anchor(steps: usize, deadline: Option<Instant>) -> Self {
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
    pub(super) fn descend(&mut self, descent: &LocalDescent) -> (Termination, usize) {
        self.anchor.copy_from_slice(&self.x);
        self.descend_anchored(descent)
    }

    /// Descends as [`descend`](Self::descend) does, with motion measured from the workspace's anchor.
    pub(super) fn descend_anchored(&mut self, descent: &LocalDescent) -> (Termination, usize) {
        let mut x = std::mem::take(&mut self.x);
        let result = self.descend_from(&mut x, descent);
        self.x = x;
        result
    }

    fn descend_from(&mut self, x: &mut [f64], descent: &LocalDescent) -> (Termination, usize) {
        let mut damping_factor = 1.0;
        for step in 0..descent.steps {
            let residual = Vector6::from(self.linearise(x));
            let error = residual.norm();
            if !error.is_finite() {
                return (Termination::NonFinite, step);
            }
            // Continue to the last digits, so that a slow target is followed evenly.
            let error_fraction = if descent.anchor > 0.0 {
                ANCHORED_ERROR_FRACTION
            } else {
                1.0
            };
            if error <= error_fraction * self.negligible_error() {
                return (Termination::Reached, step);
            }
            let max_column_norm = self.max_column_norm();
            let cost_before = self.anchored_cost(x, error, descent.anchor);
            if self.is_stationary(
                x,
                &residual,
                STATIONARITY_TOLERANCE * max_column_norm * error,
                descent.anchor,
            ) {
                if self.find_descent_from_ridge(x, &residual, cost_before, descent.anchor) {
                    x.copy_from_slice(&self.trial);
                    continue;
                }
                return (Termination::Stationary, step);
            }
            if is_past(descent.deadline) {
                return (Termination::TimeLimit, step);
            }
            let mut lowered = false;
            for _ in 0..MAX_DAMPING_RAISES {
                let damping = damping_factor * error * max_column_norm;
                self.box_step(x, &residual, damping, descent.anchor);
                let trial = std::mem::take(&mut self.trial);
                let error = Vector6::from(self.residual(&trial)).norm();
                let cost_after = self.anchored_cost(&trial, error, descent.anchor);
                lowered = cost_after < cost_before;
                if lowered {
                    x.copy_from_slice(&trial);
                }
                self.trial = trial;
                if lowered {
                    break;
                }
                damping_factor *= 4.0;
            }
            if !lowered {
                return (Termination::SmallStep, step);
            }
            damping_factor = (0.25 * damping_factor).max(1.0);
        }
        (Termination::IterationLimit, descent.steps)
    }

    /// ½|r|² plus the cost of motion.
    fn anchored_cost(&self, x: &[f64], error: f64, anchor: f64) -> f64 {
        let displacements = x.iter().zip(&self.anchor).zip(&self.scale);
        let displacements: f64 = displacements
            .map(|((x, a), s)| (x - a) * s)
            .map(|displacement| displacement * displacement)
            .sum();
        0.5 * (error * error + anchor * displacements)
    }

    /// Norm of the longest column of the workspace's Jacobian; prismatic joints by the metres that weigh as much as a
    /// radian.
    pub(super) fn max_column_norm(&self) -> f64 {
        let columns = 0..self.scale.len();
        let squares = columns.map(|i| self.column(i).norm_squared());
        squares.fold(0.0, f64::max).sqrt()
    }

    /// Returns true if no joint that can move has a slope of more than `negligible`.
    fn is_stationary(
        &self,
        x: &[f64],
        residual: &Vector6<f64>,
        negligible: f64,
        anchor: f64,
    ) -> bool {
        let PoseProblem { lower, upper, .. } = &self.question;
        self.jacobian.column_iter().enumerate().all(|(i, column)| {
            let scale = self.scale[i];
            let pull = anchor * scale * scale * (x[i] - self.anchor[i]);
            let slope = column.dot(residual) + pull;
            let at_bound = x[i] <= lower[i] && slope > 0.0 || x[i] >= upper[i] && slope < 0.0;
            at_bound || slope.abs() <= negligible * scale
        })
    }

    /// Moves the workspace's x off a ridge: a stationary point with lower cost along the null space of the Jacobian.
    ///
    /// Tries the null-space part of each joint's motion. Returns true if one lowers the cost.
    pub(super) fn step_off_ridge(&mut self) -> bool {
        let x = std::mem::take(&mut self.x);
        let error = Vector6::from(self.linearise(&x)).norm();
        let (cost_before, max_column_norm) = (0.5 * error * error, self.max_column_norm());
        let mut direction = std::mem::take(&mut self.scratch_motion);
        let found_lower = (0..x.len()).any(|joint| {
            direction.fill(0.0);
            direction[joint] = 1.0;
            self.project_to_null(&x, &direction, NULL_SPACE_TOLERANCE * max_column_norm);
            [PROBE_LENGTH, -PROBE_LENGTH]
                .into_iter()
                .any(|probe| self.lowers_cost_along_projected(&x, probe, cost_before, 0.0))
        });
        (self.scratch_motion, self.x) = (direction, x);
        if found_lower {
            self.x.copy_from_slice(&self.trial);
        }
        found_lower
    }

    /// Returns true if a stationary point is a ridge, as for a stretched arm whose target is within reach again.
    ///
    /// Writes a lower configuration near it to `trial`. The probe is in the null space; otherwise the tool would move
    /// aside by more than it approaches. It follows the slope to the side of the elbow, or without a slope any joint,
    /// in both directions.
    fn find_descent_from_ridge(
        &mut self,
        x: &[f64],
        residual: &Vector6<f64>,
        cost_before: f64,
        anchor: f64,
    ) -> bool {
        let mut direction = std::mem::take(&mut self.scratch_motion);
        let max_column_norm = self.max_column_norm();
        let mut steepest = 0.0_f64;
        for (i, direction) in direction.iter_mut().enumerate() {
            *direction = -self.column(i).dot(residual);
            steepest = steepest.max(direction.abs());
        }
        let has_slope = steepest > SLOPE_ROUNDING * max_column_norm * residual.norm();
        let probes = if has_slope { 1 } else { direction.len() };
        let found_lower = (0..probes).any(|joint| {
            if !has_slope {
                direction.fill(0.0);
                direction[joint] = 1.0;
            }
            self.project_to_null(x, &direction, NULL_SPACE_TOLERANCE * max_column_norm);
            [PROBE_LENGTH, -PROBE_LENGTH]
                .into_iter()
                .any(|probe| self.lowers_cost_along_projected(x, probe, cost_before, anchor))
        });
        self.scratch_motion = direction;
        found_lower
    }

    /// Probes a configuration along the projected motion, with the joint that moves farthest moving by `probe` radians.
    ///
    /// Leaves it in `trial`. Returns true if its cost is lower.
    fn lowers_cost_along_projected(
        &mut self,
        x: &[f64],
        probe: f64,
        cost_before: f64,
        anchor: f64,
    ) -> bool {
        let max_motion = self.projected.iter().map(|displacement| displacement.abs());
        let max_motion = max_motion.fold(0.0, f64::max);
        if max_motion == 0.0 {
            return false;
        }
        let mut trial = std::mem::take(&mut self.trial);
        for (i, trial) in trial.iter_mut().enumerate() {
            let displacement = self.projected[i] / self.scale[i] * (probe / max_motion);
            *trial = self.question.clamp(i, x[i] + displacement);
        }
        let error = Vector6::from(self.residual(&trial)).norm();
        let is_lower = self.anchored_cost(&trial, error, anchor) < cost_before;
        self.trial = trial;
        is_lower
    }

    /// Writes the configuration after the best step from x within the bounds to `trial`.
    ///
    /// The dual of the box problem is d(y) = clamp(c − Jᵀy / w) with six multipliers y = r + J d. A semismooth Newton
    /// iteration finds them (Li & Li 2011, "Projections onto a box and hyperplanes").
    fn box_step(&mut self, x: &[f64], residual: &Vector6<f64>, damping: f64, anchor: f64) {
        let weight = |scale: f64| (damping + anchor) * scale * scale;
        let anchor_weight = anchor / (damping + anchor);
        let mut y = Vector6::<f64>::zeros();
        // Bit mask of the joints at a bound; y is exact once it repeats.
        let mut last_mask = None;
        for _ in 0..MAX_NEWTON_STEPS {
            let mut dual_residual = y - residual;
            let mut normal = Matrix6::<f64>::identity();
            let mut bound_mask = 0_u64;
            for (i, &from) in x.iter().enumerate() {
                let column: Vector6<f64> = self.jacobian.fixed_view::<6, 1>(0, i).into();
                let inverse = 1.0 / weight(self.scale[i]);
                let anchor_step = anchor_weight * (self.anchor[i] - from);
                let unclamped = from + (anchor_step - column.dot(&y) * inverse);
                let clamped = self.question.clamp(i, unclamped);
                self.trial[i] = clamped;
                dual_residual -= column * (clamped - from);
                if clamped == unclamped {
                    add_square(&mut normal, &column, inverse);
                } else {
                    bound_mask |= 1 << (i % 64);
                }
            }
            let exact = last_mask == Some(bound_mask) && x.len() <= 64;
            if exact || dual_residual.norm() <= 1e-12 * (y.norm() + residual.norm()) {
                return;
            }
            last_mask = Some(bound_mask);
            let Some(factor) = normal.cholesky() else {
                return;
            };
            y -= factor.solve(&dual_residual);
        }
    }
}
