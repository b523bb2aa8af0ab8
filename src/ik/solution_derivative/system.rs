//! Linear system of a solution's changes: constrained rows keep their value, minimised rows stay stationary.
//!
//! With L = ½ ‖r_pulled‖² + λᵀ r_held, its Hessian W and the constrained rows' Jacobian C along the free directions,
//!
//! ```text
//! [W Cᵀ] [dy]     [∂ₚ∇L dp ]
//! [C 0 ] [dλ] = − [∂ₚr_held dp]
//! ```
//!
//! The method is that of Fiacco 1976, "Sensitivity analysis for nonlinear programming using penalty methods". The
//! system is solved in the null space Z of C, dy = −C⁺ ∂ₚr + Z dw. This needs W along Z only (Nocedal & Wright 2006,
//! section 16.2).

use super::kkt_point::{Evaluator, Place};
use crate::buffer::refill;
use crate::solver::{RowSpace, largest};

/// Part of a row outside the span of all other rows, relative to the longest row, below which it is dependent.
const NO_RANK: f64 = 1e-9;
/// Curvature, relative to the squared norm of the longest Jacobian column, below which the cost is flat.
const FLAT: f64 = 1e-9;
/// Largest residual, relative to the longest Jacobian column, for which row curvature is omitted.
const STRAIGHT: f64 = 1e-9;

/// Factored linear system.
#[derive(Clone, Debug, Default)]
pub(super) struct System {
    /// C, row by row; column by column if there are no minimised rows.
    held: Vec<f64>,
    held_space: RowSpace,
    /// Minimised rows of the Jacobian, then one row per curved limit with a positive multiplier, row by row.
    pulled: Vec<f64>,
    /// Z, direction by direction.
    null: Vec<f64>,
    /// Zᵀ W Z.
    reduced: Vec<f64>,
    reduced_space: RowSpace,
    /// True if the Hessian includes row curvature.
    bends: bool,
    free: usize,
    side: Vec<f64>,
    image: Vec<f64>,
    pub(super) directions: [Vec<f64>; 2],
    multipliers: Vec<f64>,
}

impl System {
    /// Factors the constrained rows along the free directions.
    pub(super) fn take_held(&mut self, place: &Place) {
        self.free = place.directions.len();
        let (held, rows) = (&place.roles.held, place.jacobian.nrows());
        let count = held.len();
        refill(&mut self.multipliers, count, 0.0);
        if place.roles.pulled.is_empty() && count > 0 {
            if count == rows {
                return self
                    .held_space
                    .factorise_columns(&place.along, count, NO_RANK);
            }
            self.held.clear();
            for column in place.along.chunks_exact(rows) {
                self.held.extend(held.iter().map(|&row| column[row]));
            }
            return self
                .held_space
                .factorise_columns(&self.held, count, NO_RANK);
        }
        self.held.clear();
        for &row in held {
            self.held.extend(place.row(row));
        }
        let squares = self.held.chunks_exact(self.free.max(1));
        let longest = squares.fold(0.0_f64, |most, row| most.max(inner(row, row)));
        let least = NO_RANK * longest.sqrt();
        self.held_space.factorise(&self.held, self.free, least);
    }

    /// Number of independent constrained rows.
    pub(super) fn rank(&self) -> usize {
        self.held_space.rank()
    }

    pub(super) fn nullity(&self) -> usize {
        self.held_space.nullity()
    }

    /// Writes the residuals of minimised rows and the least-squares multipliers of constrained rows into
    /// `place.counts`.
    pub(super) fn balance(&mut self, place: &mut Place) {
        place.counts.fill(0.0);
        for &row in &place.roles.pulled {
            place.counts[row] = place.r[row];
        }
        if place.roles.held.is_empty() || place.roles.pulled.is_empty() {
            return;
        }
        let rows = place.jacobian.nrows();
        self.side.clear();
        for k in 0..self.free {
            let column = &place.along[k * rows..(k + 1) * rows];
            let terms = column.iter().zip(&place.counts);
            self.side.push(-terms.map(|(j, c)| j * c).sum::<f64>());
        }
        refill(&mut self.multipliers, place.roles.held.len(), 0.0);
        (self.held_space).solve_transposed(&self.side, &mut self.multipliers);
        for (&row, &multiplier) in place.roles.held.iter().zip(&self.multipliers) {
            place.counts[row] = multiplier;
        }
    }

    /// Computes the Hessian of the Lagrangian in the null space of the constrained rows. Returns its rank deficiency.
    pub(super) fn take_hessian(
        &mut self,
        evaluator: &mut Evaluator<'_, '_>,
        place: &mut Place,
    ) -> usize {
        let (free, nullity) = (self.free, self.nullity());
        self.pulled.clear();
        self.null.clear();
        if place.roles.pulled.is_empty() {
            // Curved limits have no multiplier either.
            self.bends = false;
            self.reduced.clear();
            self.reduced_space.factorise(&[], nullity, 0.0);
            return nullity;
        }
        let largest = largest(&place.counts);
        let steepest = place.longest_column();
        self.bends = largest > STRAIGHT * steepest;
        for &row in &place.roles.pulled {
            self.pulled.extend(place.row(row));
        }
        self.add_edges(place);
        self.null.resize(free * nullity, 0.0);
        for (k, direction) in self.null.chunks_exact_mut(free.max(1)).enumerate() {
            self.held_space.null_direction(k, direction);
        }
        // W Z, then Zᵀ W Z.
        refill(&mut self.image, free * nullity, 0.0);
        let [hessian, _] = &mut self.directions;
        for k in 0..nullity {
            let own = k * free..(k + 1) * free;
            let direction = &self.null[own.clone()];
            refill(hessian, free, 0.0);
            multiply(&self.pulled, direction, hessian);
            if self.bends {
                place.add_bend(evaluator, direction, hessian);
            }
            self.image[own].copy_from_slice(hessian);
        }
        refill(&mut self.reduced, nullity * nullity, 0.0);
        for k in 0..nullity {
            for j in 0..=k {
                let [one, other] = [(j, k), (k, j)].map(|(a, b)| {
                    let image = &self.image[a * free..(a + 1) * free];
                    inner(&self.null[b * free..(b + 1) * free], image)
                });
                let mean = 0.5 * (one + other);
                self.reduced[k * nullity + j] = mean;
                self.reduced[j * nullity + k] = mean;
            }
        }
        let least = FLAT * steepest * steepest;
        self.reduced_space.factorise(&self.reduced, nullity, least);
        self.reduced_space.nullity()
    }

    /// Adds the curvature of the cost along curved limits, proportional to their multipliers.
    fn add_edges(&mut self, place: &mut Place) {
        let edges = place
            .bounds
            .iter()
            .filter(|own| own.is_held && own.curvature > 0.0);
        if edges.clone().next().is_none() {
            return;
        }
        let mut slope = std::mem::take(&mut self.side);
        refill(&mut slope, place.x.len(), 0.0);
        place.slope(&mut slope);
        for edge in edges {
            let push = edge.push(&slope);
            if push > 0.0 {
                let mut row = vec![0.0; place.x.len()];
                let by = (push * edge.curvature).sqrt();
                let [first, second] = edge.along();
                row[edge.variable] = by * first;
                row[edge.variable + 1] = by * second;
                let mut reduced = Vec::new();
                place.directions.reduce(1, &row, &mut reduced);
                self.pulled.extend(reduced);
            }
        }
        self.side = slope;
    }

    /// Returns a basis vector of the null space of the constrained rows.
    pub(super) fn null_direction(&self, k: usize) -> &[f64] {
        &self.null[k * self.free..(k + 1) * self.free]
    }

    /// Writes a direction in the null space of the reduced Hessian.
    pub(super) fn flat_direction(&mut self, k: usize, y: &mut Vec<f64>) {
        let nullity = self.nullity();
        refill(&mut self.side, nullity, 0.0);
        self.reduced_space.null_direction(k, &mut self.side);
        refill(y, self.free, 0.0);
        self.add_null(y);
    }

    /// Adds Z w, with w in `side`.
    fn add_null(&self, y: &mut [f64]) {
        for (direction, w) in self.null.chunks_exact(self.free.max(1)).zip(&self.side) {
            for (y, entry) in y.iter_mut().zip(direction) {
                *y += w * entry;
            }
        }
    }

    /// Adds W y.
    pub(super) fn add_hessian(
        &self,
        evaluator: &mut Evaluator<'_, '_>,
        place: &mut Place,
        (y, image): (&[f64], &mut [f64]),
    ) {
        multiply(&self.pulled, y, image);
        if self.bends {
            place.add_bend(evaluator, y, image);
        }
    }

    /// Returns whether the Hessian includes row curvature; otherwise the rates of the rows are sufficient.
    pub(super) fn bends(&self) -> bool {
        self.bends
    }

    /// Writes −C⁺ times the rates of the constrained rows.
    pub(super) fn restore(&mut self, place: &Place, rates: &[f64], y: &mut Vec<f64>) {
        self.multipliers.clear();
        let held = place.roles.held.iter();
        self.multipliers.extend(held.map(|&row| -rates[row]));
        refill(y, self.free, 0.0);
        self.held_space.solve(&self.multipliers, y);
    }

    /// Adds −Z (Zᵀ W Z)⁻¹ Zᵀ of a gradient, if there are minimised rows.
    pub(super) fn add_pull(&mut self, slope: &[f64], factor: f64, y: &mut [f64]) {
        let nullity = self.nullity();
        let null = self.null.chunks_exact(self.free.max(1));
        self.image.clear();
        self.image
            .extend(null.map(|direction| factor * inner(direction, slope)));
        refill(&mut self.side, nullity, 0.0);
        if !self.pulled.is_empty() {
            self.reduced_space.solve(&self.image, &mut self.side);
        }
        self.add_null(y);
    }

    /// Adds (C⁺)ᵀ of a gradient along the directions, by row of all tasks.
    pub(super) fn push_held(&mut self, place: &Place, slope: &[f64], by_row: &mut [f64]) {
        refill(&mut self.multipliers, place.roles.held.len(), 0.0);
        self.held_space
            .solve_transposed(slope, &mut self.multipliers);
        for (&row, multiplier) in place.roles.held.iter().zip(&self.multipliers) {
            by_row[row] += multiplier;
        }
    }
}

/// Adds Mᵀ M y. M is stored row by row.
fn multiply(rows: &[f64], y: &[f64], image: &mut [f64]) {
    for row in rows.chunks_exact(y.len().max(1)) {
        let along = inner(row, y);
        for (image, entry) in image.iter_mut().zip(row) {
            *image += along * entry;
        }
    }
}

pub(super) fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
