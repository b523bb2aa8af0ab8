//! The heat equations, factored once and solved for each bone.

use nalgebra::DMatrix;
use nalgebra_sparse::CscMatrix;
use nalgebra_sparse::factorization::CscCholesky;

use super::dissection;
use super::stiffness::Stiffness;
use super::surface::Surface;
use crate::skinning::SkinningError;

/// Cholesky factor of L + A H.
pub(super) struct HeatSystem {
    factor: CscCholesky<f64>,
    /// Equation index of each point.
    equation_of: Vec<usize>,
    column: DMatrix<f64>,
}

impl HeatSystem {
    /// Factors the system of the conductances and of the heat `given` to each point. Every connected piece of the
    /// surface needs a heated point.
    pub(super) fn new(
        surface: &Surface,
        stiffness: &Stiffness,
        given: &[f64],
    ) -> Result<Self, SkinningError> {
        let count = surface.points.len();
        let mut neighbours = vec![Vec::new(); count];
        let mut diagonal = given.to_vec();
        for &(a, b, conduction) in &stiffness.edges {
            neighbours[a].push(b);
            neighbours[b].push(a);
            diagonal[a] += conduction;
            diagonal[b] += conduction;
        }
        let order = dissection::order(&surface.points, &neighbours);
        let mut equation_of = vec![0; count];
        for (equation, &point) in order.iter().enumerate() {
            equation_of[point] = equation;
        }
        let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); count];
        for (&equation, &entry) in equation_of.iter().zip(&diagonal) {
            columns[equation].push((equation, entry));
        }
        for &(a, b, conduction) in &stiffness.edges {
            let [a, b] = [equation_of[a], equation_of[b]];
            columns[a].push((b, -conduction));
            columns[b].push((a, -conduction));
        }
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in &mut columns {
            column.sort_by_key(|(row, _)| *row);
            rows.extend(column.iter().map(|(row, _)| *row));
            values.extend(column.iter().map(|(_, value)| *value));
            starts.push(rows.len());
        }
        let matrix = CscMatrix::try_from_csc_data(count, count, starts, rows, values);
        let matrix = matrix.map_err(|_| SkinningError::Unsolvable)?;
        let factor = CscCholesky::factor(&matrix);
        Ok(Self {
            factor: factor.map_err(|_| SkinningError::Unsolvable)?,
            equation_of,
            column: DMatrix::zeros(count, 1),
        })
    }

    /// The temperature of each point for the given heat at some points.
    pub(super) fn solve(&mut self, heated: &[(usize, f64)]) -> impl Iterator<Item = f64> + '_ {
        self.column.fill(0.0);
        for &(point, heat) in heated {
            self.column[(self.equation_of[point], 0)] += heat;
        }
        self.factor.solve_mut(&mut self.column);
        let (column, equations) = (&self.column, &self.equation_of);
        equations.iter().map(|equation| column[(*equation, 0)])
    }
}
