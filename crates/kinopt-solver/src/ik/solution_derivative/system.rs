//! Linear system of a solution's changes: constrained rows keep their value, minimised rows stay stationary.
//!
//! With L = ½ ‖r_minimised‖² + λᵀ r_constrained, its Hessian W and the constrained rows' Jacobian C along the free
//! directions,
//!
//! ```text
//! [W Cᵀ] [dy]     [∂ₚ∇L dp            ]
//! [C 0 ] [dλ] = − [∂ₚr_constrained dp]
//! ```
//!
//! The method is that of Fiacco 1976, "Sensitivity analysis for nonlinear programming using penalty methods". The
//! system is solved in the null space Z of C, dy = −C⁺ ∂ₚr + Z dw. This needs W along Z only (Nocedal & Wright 2006,
//! section 16.2).

use super::kkt_point::{Evaluator, KktPoint};
use crate::solver::{RowSpace, largest};
use kinopt_kinematics::buffer::refill;

/// Part of a row outside the span of all other rows, relative to the longest row, below which it is dependent.
const RANK_TOLERANCE: f64 = 1e-9;
/// Curvature, relative to the squared norm of the longest Jacobian column, below which the cost is flat.
const CURVATURE_TOLERANCE: f64 = 1e-9;
/// Largest residual, relative to the longest Jacobian column, for which row curvature is omitted.
const MAX_NEGLIGIBLE_RESIDUAL: f64 = 1e-9;

/// Factored linear system.
#[derive(Clone, Debug, Default)]
pub(super) struct System {
    /// C, row by row; column by column if there are no minimised rows.
    constrained: Vec<f64>,
    constrained_space: RowSpace,
    /// Minimised rows of the Jacobian, then one row per curved limit with a positive multiplier, row by row.
    minimised: Vec<f64>,
    /// Z, direction by direction.
    null_space: Vec<f64>,
    /// Zᵀ W Z.
    reduced_hessian: Vec<f64>,
    reduced_hessian_space: RowSpace,
    /// True if the Hessian includes row curvature.
    has_curvature: bool,
    direction_count: usize,
    right_side: Vec<f64>,
    image: Vec<f64>,
    pub(super) directions: [Vec<f64>; 2],
    multipliers: Vec<f64>,
}

impl System {
    /// Factors the constrained rows along the free directions.
    pub(super) fn factorise_constrained(&mut self, point: &KktPoint) {
        self.direction_count = point.directions.len();
        let (constrained, rows) = (&point.roles.constrained, point.jacobian.nrows());
        let count = constrained.len();
        refill(&mut self.multipliers, count, 0.0);
        if point.roles.minimised.is_empty() && count > 0 {
            if count == rows {
                return self.constrained_space.factorise_columns(
                    &point.reduced_jacobian,
                    count,
                    RANK_TOLERANCE,
                );
            }
            self.constrained.clear();
            for column in point.reduced_jacobian.chunks_exact(rows) {
                self.constrained
                    .extend(constrained.iter().map(|&row| column[row]));
            }
            return self.constrained_space.factorise_columns(
                &self.constrained,
                count,
                RANK_TOLERANCE,
            );
        }
        self.constrained.clear();
        for &row in constrained {
            self.constrained.extend(point.row(row));
        }
        let rows_of_constraints = self.constrained.chunks_exact(self.direction_count.max(1));
        let max_squared_norm =
            rows_of_constraints.fold(0.0_f64, |max, row| max.max(inner(row, row)));
        let min_norm = RANK_TOLERANCE * max_squared_norm.sqrt();
        self.constrained_space
            .factorise(&self.constrained, self.direction_count, min_norm);
    }

    /// Number of independent constrained rows.
    pub(super) fn rank(&self) -> usize {
        self.constrained_space.rank()
    }

    pub(super) fn nullity(&self) -> usize {
        self.constrained_space.nullity()
    }

    /// Writes the residuals of minimised rows and the least-squares multipliers of constrained rows into
    /// `point.row_weights`.
    pub(super) fn compute_row_weights(&mut self, point: &mut KktPoint) {
        point.row_weights.fill(0.0);
        for &row in &point.roles.minimised {
            point.row_weights[row] = point.r[row];
        }
        if point.roles.constrained.is_empty() || point.roles.minimised.is_empty() {
            return;
        }
        let rows = point.jacobian.nrows();
        self.right_side.clear();
        for k in 0..self.direction_count {
            let column = &point.reduced_jacobian[k * rows..(k + 1) * rows];
            let terms = column.iter().zip(&point.row_weights);
            self.right_side
                .push(-terms.map(|(j, c)| j * c).sum::<f64>());
        }
        refill(&mut self.multipliers, point.roles.constrained.len(), 0.0);
        (self.constrained_space).solve_transposed(&self.right_side, &mut self.multipliers);
        for (&row, &multiplier) in point.roles.constrained.iter().zip(&self.multipliers) {
            point.row_weights[row] = multiplier;
        }
    }

    /// Computes the Hessian of the Lagrangian in the null space of the constrained rows. Returns its rank deficiency.
    pub(super) fn compute_hessian(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        point: &mut KktPoint,
    ) -> usize {
        let (direction_count, nullity) = (self.direction_count, self.nullity());
        self.minimised.clear();
        self.null_space.clear();
        if point.roles.minimised.is_empty() {
            // Curved limits have no multiplier either.
            self.has_curvature = false;
            self.reduced_hessian.clear();
            self.reduced_hessian_space.factorise(&[], nullity, 0.0);
            return nullity;
        }
        let largest = largest(&point.row_weights);
        let max_column_norm = point.max_column_norm();
        self.has_curvature = largest > MAX_NEGLIGIBLE_RESIDUAL * max_column_norm;
        for &row in &point.roles.minimised {
            self.minimised.extend(point.row(row));
        }
        self.add_limit_curvature(point);
        self.null_space.resize(direction_count * nullity, 0.0);
        for (k, direction) in self
            .null_space
            .chunks_exact_mut(direction_count.max(1))
            .enumerate()
        {
            self.constrained_space.null_direction(k, direction);
        }
        // W Z, then Zᵀ W Z.
        refill(&mut self.image, direction_count * nullity, 0.0);
        let [hessian, _] = &mut self.directions;
        for k in 0..nullity {
            let entries = k * direction_count..(k + 1) * direction_count;
            let direction = &self.null_space[entries.clone()];
            refill(hessian, direction_count, 0.0);
            multiply(&self.minimised, direction, hessian);
            if self.has_curvature {
                point.add_curvature(evaluator, direction, hessian);
            }
            self.image[entries].copy_from_slice(hessian);
        }
        refill(&mut self.reduced_hessian, nullity * nullity, 0.0);
        for k in 0..nullity {
            for j in 0..=k {
                let [upper, lower] = [(j, k), (k, j)].map(|(a, b)| {
                    let image = &self.image[a * direction_count..(a + 1) * direction_count];
                    inner(
                        &self.null_space[b * direction_count..(b + 1) * direction_count],
                        image,
                    )
                });
                let mean = 0.5 * (upper + lower);
                self.reduced_hessian[k * nullity + j] = mean;
                self.reduced_hessian[j * nullity + k] = mean;
            }
        }
        let min_curvature = CURVATURE_TOLERANCE * max_column_norm * max_column_norm;
        self.reduced_hessian_space
            .factorise(&self.reduced_hessian, nullity, min_curvature);
        self.reduced_hessian_space.nullity()
    }

    /// Adds the curvature of the cost along curved limits, proportional to their multipliers.
    fn add_limit_curvature(&mut self, point: &mut KktPoint) {
        let edges = point
            .bounds
            .iter()
            .filter(|bound| bound.is_held && bound.curvature > 0.0);
        if edges.clone().next().is_none() {
            return;
        }
        let mut slope = std::mem::take(&mut self.right_side);
        refill(&mut slope, point.x.len(), 0.0);
        point.slope(&mut slope);
        for edge in edges {
            let push = edge.push(&slope);
            if push > 0.0 {
                let mut row = vec![0.0; point.x.len()];
                let scale = (push * edge.curvature).sqrt();
                let [first, second] = edge.tangent();
                row[edge.variable] = scale * first;
                row[edge.variable + 1] = scale * second;
                let mut reduced = Vec::new();
                point.directions.reduce(1, &row, &mut reduced);
                self.minimised.extend(reduced);
            }
        }
        self.right_side = slope;
    }

    /// Returns a basis vector of the null space of the constrained rows.
    pub(super) fn null_direction(&self, k: usize) -> &[f64] {
        &self.null_space[k * self.direction_count..(k + 1) * self.direction_count]
    }

    /// Writes a direction in the null space of the reduced Hessian.
    pub(super) fn flat_direction(&mut self, k: usize, y: &mut Vec<f64>) {
        let nullity = self.nullity();
        refill(&mut self.right_side, nullity, 0.0);
        self.reduced_hessian_space
            .null_direction(k, &mut self.right_side);
        refill(y, self.direction_count, 0.0);
        self.add_null(y);
    }

    /// Adds Z w, with w in `side`.
    fn add_null(&self, y: &mut [f64]) {
        for (direction, w) in self
            .null_space
            .chunks_exact(self.direction_count.max(1))
            .zip(&self.right_side)
        {
            for (y, entry) in y.iter_mut().zip(direction) {
                *y += w * entry;
            }
        }
    }

    /// Adds W y.
    pub(super) fn add_hessian(
        &self,
        evaluator: &mut Evaluator<'_, '_>,
        point: &mut KktPoint,
        (y, image): (&[f64], &mut [f64]),
    ) {
        multiply(&self.minimised, y, image);
        if self.has_curvature {
            point.add_curvature(evaluator, y, image);
        }
    }

    /// Returns whether the Hessian includes row curvature; otherwise the rates of the rows are sufficient.
    pub(super) fn has_curvature(&self) -> bool {
        self.has_curvature
    }

    /// Writes −C⁺ times the rates of the constrained rows.
    pub(super) fn restore(&mut self, point: &KktPoint, rates: &[f64], y: &mut Vec<f64>) {
        self.multipliers.clear();
        let constrained = point.roles.constrained.iter();
        self.multipliers.extend(constrained.map(|&row| -rates[row]));
        refill(y, self.direction_count, 0.0);
        self.constrained_space.solve(&self.multipliers, y);
    }

    /// Adds −Z (Zᵀ W Z)⁻¹ Zᵀ of a gradient, if there are minimised rows.
    pub(super) fn add_minimising_step(&mut self, slope: &[f64], factor: f64, y: &mut [f64]) {
        let nullity = self.nullity();
        let null = self.null_space.chunks_exact(self.direction_count.max(1));
        self.image.clear();
        self.image
            .extend(null.map(|direction| factor * inner(direction, slope)));
        refill(&mut self.right_side, nullity, 0.0);
        if !self.minimised.is_empty() {
            self.reduced_hessian_space
                .solve(&self.image, &mut self.right_side);
        }
        self.add_null(y);
    }

    /// Adds (C⁺)ᵀ of a gradient along the directions, by row of all tasks.
    pub(super) fn add_constraint_multipliers(
        &mut self,
        point: &KktPoint,
        slope: &[f64],
        by_row: &mut [f64],
    ) {
        refill(&mut self.multipliers, point.roles.constrained.len(), 0.0);
        self.constrained_space
            .solve_transposed(slope, &mut self.multipliers);
        for (&row, multiplier) in point.roles.constrained.iter().zip(&self.multipliers) {
            by_row[row] += multiplier;
        }
    }
}

/// Adds Mᵀ M y. M is stored row by row.
fn multiply(rows: &[f64], y: &[f64], image: &mut [f64]) {
    for row in rows.chunks_exact(y.len().max(1)) {
        let product = inner(row, y);
        for (image, entry) in image.iter_mut().zip(row) {
            *image += product * entry;
        }
    }
}

pub(super) fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
