//! Newton step in the null space of some rows, within bounds and linear inequalities.

use nalgebra::DMatrix;

use super::bounded_projection::BoundedProjection;
use super::cholesky;
use super::dense::dot;
use super::held_step::StepBounds;
use kinopt_kinematics::buffer::{refill, vacate};

/// Inequalities rows · Δ ≥ −down for a step Δ, row by row; a row whose `down` is infinite does not count.
#[derive(Clone, Copy)]
#[doc(hidden)]
pub struct Inequalities<'a> {
    pub(crate) rows: &'a DMatrix<f64>,
    pub(crate) down: &'a [f64],
}

/// Newton model ½ wᵀ(ZᵀHZ + μ I)w + gᵀZ w for orthonormal null-space directions Z.
///
/// With ZᵀHZ + μ I = L Lᵀ, u = Lᵀw and e = L⁻¹Zᵀg, the model is ½‖u + e‖² less a constant. The components of the step Z
/// w are L⁻¹zⱼ · u.
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct TangentNewton {
    /// Z, direction by direction.
    pub(crate) directions: Vec<f64>,
    /// ZᵀHZ, row by row.
    hessian: Vec<f64>,
    factor: Vec<f64>,
    pivot_column: Vec<f64>,
    /// Largest |entry| of the diagonal of ZᵀHZ.
    max_stiffness: f64,
    image: Vec<f64>,
    e: Vec<f64>,
    /// L⁻¹zⱼ for each variable, then L⁻¹Zᵀa for the row a of each inequality.
    rows: Vec<f64>,
    /// Indices of these inequalities.
    inequalities: Vec<usize>,
    variables: usize,
    projection: BoundedProjection,
}

impl TangentNewton {
    /// Reserves memory for this many variables.
    pub(crate) fn reserve(&mut self, variables: usize) {
        let square = variables * variables;
        for (vector, capacity) in [
            (&mut self.directions, square),
            (&mut self.hessian, square),
            (&mut self.factor, square),
            (&mut self.rows, square),
            (&mut self.pivot_column, 2 * variables),
            (&mut self.image, variables),
            (&mut self.e, variables),
        ] {
            vacate(vector, capacity);
        }
        self.projection.reserve(variables, variables);
    }

    /// Computes ZᵀHZ; `image` writes the product of H with a direction.
    pub(crate) fn compute_hessian(
        &mut self,
        variables: usize,
        mut image: impl FnMut(&[f64], &mut [f64]),
    ) {
        let count = self.directions.len().checked_div(variables).unwrap_or(0);
        let directions = || self.directions.chunks_exact(variables.max(1));
        let hessian = &mut self.hessian;
        refill(hessian, count * count, 0.0);
        self.image.resize(variables, 0.0);
        for (k, direction) in directions().enumerate() {
            image(direction, &mut self.image);
            for (j, other) in directions().enumerate() {
                hessian[k * count + j] = dot(other, &self.image);
            }
        }
        self.max_stiffness = 0.0;
        for row in 0..count {
            for column in 0..=row {
                let mean = 0.5 * (hessian[row * count + column] + hessian[column * count + row]);
                hessian[row * count + column] = mean;
            }
            self.max_stiffness = self.max_stiffness.max(hessian[row * count + row].abs());
        }
    }

    /// Largest |entry| of the diagonal of ZᵀHZ, the scale of the damping.
    pub(crate) fn max_stiffness(&self) -> f64 {
        self.max_stiffness
    }

    /// Writes the best step for a damping μ and the slope g, within bounds.
    ///
    /// Returns the decrease of the model, or `None` if the model has no minimum.
    pub(crate) fn minimise(
        &mut self,
        damping: f64,
        slope: &[f64],
        bounds: &StepBounds<'_>,
        inequalities: Inequalities<'_>,
        step: &mut [f64],
    ) -> Option<f64> {
        let n = slope.len();
        let count = self.directions.len().checked_div(n).unwrap_or(0);
        self.hessian.clone_into(&mut self.factor);
        for j in 0..count {
            self.factor[j * count + j] += damping;
        }
        if !cholesky::factorise(&mut self.factor, count, &mut self.pivot_column) {
            return None;
        }
        let directions = || self.directions.chunks_exact(n.max(1));
        self.e.clear();
        self.e
            .extend(directions().map(|direction| dot(direction, slope)));
        solve_lower(&self.factor, &mut self.e);
        self.rows.clear();
        for j in 0..n {
            let first = self.rows.len();
            self.rows.extend(directions().map(|direction| direction[j]));
            solve_lower(&self.factor, &mut self.rows[first..]);
        }
        let Inequalities { rows, down } = inequalities;
        self.variables = n;
        self.inequalities.clear();
        let finite = (0..down.len()).filter(|&row| down[row] < f64::INFINITY);
        self.inequalities.extend(finite);
        for &row in &self.inequalities {
            let first = self.rows.len();
            let product = |direction: &[f64]| {
                let entries = rows.row(row);
                let products = entries.iter().zip(direction).map(|(a, z)| a * z);
                products.sum::<f64>()
            };
            self.rows.extend(directions().map(product));
            solve_lower(&self.factor, &mut self.rows[first..]);
        }
        let max_changes = |j: usize| match j.checked_sub(n) {
            None => bounds.space.room(bounds.x, j),
            Some(index) => (down[self.inequalities[index]], f64::INFINITY),
        };
        let count = n + self.inequalities.len();
        let decrease = self
            .projection
            .project(&self.e, &self.rows, count, max_changes);
        let components = step.iter_mut().zip(&self.projection.products);
        for ((step, product), fixed) in components.zip(bounds.fixed) {
            *step = if *fixed { 0.0 } else { *product };
        }
        Some(decrease)
    }

    /// Flags the variables whose bounds hold the last step.
    pub(crate) fn write_held_variables(&self, held: &mut [bool]) {
        held.fill(false);
        for &(j, _) in self.projection.active() {
            if let Some(held) = held.get_mut(j) {
                *held = true;
            }
        }
    }

    /// Indices of the inequalities that hold the last step.
    pub(crate) fn holding_inequalities(&self) -> impl Iterator<Item = usize> {
        let active = self.projection.active().iter();
        active.filter_map(|&(row, _)| {
            let index = row.checked_sub(self.variables)?;
            self.inequalities.get(index).copied()
        })
    }
}

/// Computes L⁻¹ b for an L whose diagonal is stored inverted.
fn solve_lower(factor: &[f64], b: &mut [f64]) {
    let order = b.len();
    for (k, row) in factor.chunks_exact(order.max(1)).enumerate() {
        b[k] = (b[k] - dot(&row[..k], &b[..k])) * row[k];
    }
}
