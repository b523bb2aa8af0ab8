//! Projection of joint motions into the null space of the tool's Jacobian.

use nalgebra::{DMatrix, Matrix6, Vector6};

use super::arm::Arm;
use super::workspace::ArmWorkspace;

/// Fraction of the trace of J Jᵀ that is added to its diagonal, so that it can be factored.
const REGULARISATION: f64 = 1e-14;

/// Factorisation of J Jᵀ + δ².
#[derive(Clone, Copy, Debug)]
pub(super) struct Factor {
    /// Inverse of the Cholesky factor: a lower triangle, by rows.
    inverse: [[f64; 6]; 6],
    /// Lower bound of the smallest singular value of J.
    min_singular_value: f64,
}

impl ArmWorkspace {
    /// Writes the null-space part of `motion` to `projected`: (1 − Jᵀ (J Jᵀ + δ²)⁻¹ J) motion.
    ///
    /// Both are in radians per joint, prismatic joints by the metres that weigh as much. δ is `delta`, in metres per
    /// radian: directions that move the tool by far less count as null space. Joints at a bound of the query stay
    /// within it. The workspace must hold the Jacobian at x.
    ///
    /// Returns a lower bound of the smallest singular value, metres per radian, or 0 if there is none. It is too small
    /// by a factor of at most √6.
    pub(super) fn project_to_null(&mut self, x: &[f64], motion: &[f64], delta: f64) -> f64 {
        let mut projected = std::mem::take(&mut self.projected);
        projected.copy_from_slice(motion);
        let min_singular_value = self.project_within_bounds(x, motion, delta, &mut projected);
        for (i, joint_motion) in projected.iter_mut().enumerate() {
            if self.leaves_bounds(x, i, *joint_motion) {
                *joint_motion = 0.0;
            }
        }
        self.projected = projected;
        min_singular_value
    }

    /// Factors J Jᵀ for several motions. Returns `None` if a joint is at a bound, which may lock it.
    pub(super) fn factor_without_bounds(&self, x: &[f64]) -> Option<Factor> {
        let bounds = self.question.lower.iter().zip(&self.question.upper);
        let free = |(x, (lower, upper))| lower < x && x < upper;
        let all_free = x.iter().zip(bounds).all(free);
        all_free.then(|| self.factor(0.0, |_| true)).flatten()
    }

    /// Projects as [`project_to_null`](Self::project_to_null) with δ = 0, by a factor of
    /// [`factor_without_bounds`](Self::factor_without_bounds).
    pub(super) fn project_without_bounds(&mut self, factor: &Factor, motion: &[f64]) -> f64 {
        let mut tool_motion = [0.0; 6];
        for (column, (joint_motion, scale)) in
            columns(&self.jacobian).zip(motion.iter().zip(&self.per_scale))
        {
            add(&mut tool_motion, column, joint_motion * scale);
        }
        let multipliers = factor.solve(&tool_motion);
        let joints = motion.iter().zip(&self.per_scale).zip(&mut self.projected);
        for (column, ((joint_motion, scale), projected)) in columns(&self.jacobian).zip(joints) {
            *projected = joint_motion - scale * dot(column, &multipliers);
        }
        factor.min_singular_value
    }

    /// Writes the least joint motion that moves the tool by `motion` to `projected`, radians per joint.
    ///
    /// `motion` has the rows and weights of the workspace's Jacobian, at x. Directions that move the tool by far less
    /// than `singular` of the longest column are left out.
    pub(super) fn joint_motion_of(
        &mut self,
        x: &[f64],
        motion: &nalgebra::Vector6<f64>,
        singular: f64,
    ) {
        debug_assert_eq!(x.len(), self.projected.len());
        let Some(factor) = self.factor(singular * self.max_column_norm(), |_| true) else {
            self.projected.fill(0.0);
            return;
        };
        let wrench = factor.solve(&(*motion).into());
        let joints = self.per_scale.iter().zip(&mut self.projected);
        for (column, (scale, projected)) in columns(&self.jacobian).zip(joints) {
            *projected = scale * dot(column, &wrench);
        }
    }

    fn factor(&self, delta: f64, moves: impl Fn(usize) -> bool) -> Option<Factor> {
        let mut normal = [[0.0; 6]; 6];
        let joints = columns(&self.jacobian).zip(&self.per_scale).enumerate();
        for (_, (column, scale)) in joints.filter(|(i, _)| moves(*i)) {
            let weight = scale * scale;
            for k in 0..6 {
                let weighted_entry = weight * column[k];
                for i in 0..=k {
                    normal[k][i] += weighted_entry * column[i];
                }
            }
        }
        Factor::new(normal, delta)
    }

    fn project_within_bounds(
        &self,
        x: &[f64],
        motion: &[f64],
        delta: f64,
        projected: &mut [f64],
    ) -> f64 {
        let mut min_singular_value = 0.0;
        // Joints that would leave their bounds are locked, and the rest is projected again.
        for _ in 0..2 {
            let moves = |i: usize| !self.leaves_bounds(x, i, projected[i]);
            let Some(factor) = self.factor(delta, moves) else {
                projected.fill(0.0);
                return 0.0;
            };
            let mut tool_motion = [0.0; 6];
            for (i, column) in columns(&self.jacobian).enumerate() {
                if moves(i) {
                    add(&mut tool_motion, column, motion[i] * self.per_scale[i]);
                }
            }
            let multipliers = factor.solve(&tool_motion);
            min_singular_value = factor.min_singular_value;
            let mut all_stay = true;
            for (i, column) in columns(&self.jacobian).enumerate() {
                if !self.leaves_bounds(x, i, projected[i]) {
                    projected[i] = motion[i] - self.per_scale[i] * dot(column, &multipliers);
                    all_stay &= !self.leaves_bounds(x, i, projected[i]);
                }
            }
            if all_stay {
                break;
            }
        }
        min_singular_value
    }

    fn leaves_bounds(&self, x: &[f64], i: usize, joint_motion: f64) -> bool {
        x[i] <= self.question.lower[i] && joint_motion < 0.0
            || x[i] >= self.question.upper[i] && joint_motion > 0.0
    }

    /// Change of the residual per radian of a joint (or the metres that weigh as much), metres.
    pub(super) fn column(&self, i: usize) -> Vector6<f64> {
        let column: Vector6<f64> = self.jacobian.fixed_view::<6, 1>(0, i).into();
        column * self.per_scale[i]
    }

    /// Computes a Jacobian at x with the null space of the goal's.
    ///
    /// For the full pose it is the tool's geometric Jacobian, which needs no residual and a third of the instructions.
    pub(super) fn compute_twists(&mut self, arm: &Arm, x: &[f64]) {
        match (&arm.simd_solver, arm.options.goal.is_full_pose()) {
            (Some(simd_solver), true) => {
                let radian = arm.options.metres_per_radian;
                self.invalidate_jacobian();
                simd_solver.write_twists(x, radian, self.jacobian.as_mut_slice());
            }
            _ => {
                self.linearise(x);
            }
        }
    }
}

/// Adds weight × c cᵀ to the lower triangle, which is all that a factorisation reads.
///
/// Index loops: products of small matrices are hundreds of calls in a debug build.
pub(super) fn add_square(normal: &mut Matrix6<f64>, column: &Vector6<f64>, weight: f64) {
    let (entries, column) = (normal.as_mut_slice(), column.as_slice());
    let mut k = 0;
    while k < 6 {
        let weighted_entry = weight * column[k];
        let mut row = k;
        while row < 6 {
            entries[6 * k + row] += weighted_entry * column[row];
            row += 1;
        }
        k += 1;
    }
}

/// Columns of a Jacobian of six rows.
fn columns(jacobian: &DMatrix<f64>) -> impl Iterator<Item = &[f64; 6]> {
    let columns = jacobian.as_slice().chunks_exact(6);
    columns.filter_map(<[f64]>::first_chunk)
}

fn add(sum: &mut [f64; 6], column: &[f64; 6], factor: f64) {
    for (sum, entry) in sum.iter_mut().zip(column) {
        *sum += entry * factor;
    }
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Runs the body for every row, unrolled, so that inner loops have constant lengths.
macro_rules! each_row {
    ($row:ident, $body:block) => {
        each_row!(@ $row, $body, 0 1 2 3 4 5)
    };
    (@ $row:ident, $body:block, $($k:literal)*) => {
        $({ const $row: usize = $k; $body })*
    };
}

impl Factor {
    /// Factors N + δ², with N given by its lower triangle. Rows without a weight are left out.
    fn new(mut normal: [[f64; 6]; 6], delta: f64) -> Option<Self> {
        let trace: f64 = (0..6).map(|k| normal[k][k]).sum();
        let regularisation = REGULARISATION * trace + delta * delta;
        for (k, row) in normal.iter_mut().enumerate() {
            row[k] = match row[k] > 0.0 {
                true => row[k] + regularisation,
                false => trace,
            };
        }
        // The factor replaces the matrix, with the reciprocals of its diagonal.
        each_row!(K, {
            let pivot = normal[K][K] - dot_of_first::<K>(&normal[K], &normal[K]);
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            let diagonal = pivot.sqrt().recip();
            normal[K][K] = diagonal;
            let mut row = K + 1;
            while row < 6 {
                let eliminated = dot_of_first::<K>(&normal[row], &normal[K]);
                normal[row][K] = (normal[row][K] - eliminated) * diagonal;
                row += 1;
            }
        });
        let mut inverse = [[0.0; 6]; 6];
        let mut square = 0.0;
        each_row!(ROW, {
            let diagonal = normal[ROW][ROW];
            let mut sums = [0.0; 6];
            for (coefficient, above) in normal[ROW].iter().zip(&inverse).take(ROW) {
                add(&mut sums, above, *coefficient);
            }
            for (entry, sum) in inverse[ROW].iter_mut().zip(sums).take(ROW) {
                *entry = -diagonal * sum;
            }
            inverse[ROW][ROW] = diagonal;
            square += dot(&inverse[ROW], &inverse[ROW]);
        });
        Some(Self {
            inverse,
            min_singular_value: square.sqrt().recip(),
        })
    }

    /// Returns (N + δ²)⁻¹ b.
    fn solve(&self, b: &[f64; 6]) -> [f64; 6] {
        let mut solved = [0.0; 6];
        for row in &self.inverse {
            add(&mut solved, row, dot(row, b));
        }
        solved
    }
}

fn dot_of_first<const K: usize>(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    (0..K).map(|i| a[i] * b[i]).sum()
}
