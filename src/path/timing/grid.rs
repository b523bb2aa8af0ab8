//! Grid along a curve, with the curve's derivatives at its points.

use super::cubic_curve::CubicCurve;

/// Grid points of a curve. Every knot is a grid point, so each cell lies on one cubic piece.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    pub(super) joints: usize,
    /// Curve parameters of the points, ascending.
    pub(super) points: Vec<f64>,
    /// First and second derivatives of the joints, one row per point.
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
}

/// Minimum number of cells per piece, and maximum number in tight bends.
const MIN_CELLS: usize = 3;
const MAX_BEND_CELLS: usize = 64;
/// Largest change of direction in a cell, radians.
const MAX_DIRECTION_CHANGE: f64 = 0.04;

impl Grid {
    /// Divides a curve into cells of at most its length divided by `cells`, and shorter cells in tight bends.
    pub(super) fn new(curve: &CubicCurve, cells: usize) -> Self {
        let n = curve.joints;
        let longest = (curve.end() - curve.start()) / cells as f64;
        let mut grid = Self {
            joints: n,
            ..Self::default()
        };
        for (piece, pair) in curve.knots.windows(2).enumerate() {
            let length = pair[1] - pair[0];
            let bend = [piece, piece + 1].map(|knot| {
                let row = &curve.second_derivatives[knot * n..(knot + 1) * n];
                row.iter().map(|bend| bend * bend).sum::<f64>().sqrt()
            });
            let direction_change = length * bend[0].max(bend[1]);
            let direction_cells =
                ((direction_change / MAX_DIRECTION_CHANGE).ceil() as usize).min(MAX_BEND_CELLS);
            let count = ((length / longest).ceil() as usize)
                .max(MIN_CELLS)
                .max(direction_cells);
            for k in 0..count {
                grid.push(curve, piece, pair[0] + length * (k as f64 / count as f64));
            }
        }
        grid.push(curve, curve.knots.len() - 2, curve.end());
        grid
    }

    fn push(&mut self, curve: &CubicCurve, piece: usize, s: f64) {
        self.points.push(s);
        for jet in curve.jets(piece, s) {
            self.first.push(jet.first);
            self.second.push(jet.second);
        }
    }

    /// Number of cells.
    pub(super) fn cells(&self) -> usize {
        self.points.len() - 1
    }

    /// Length of a cell.
    pub(super) fn step(&self, cell: usize) -> f64 {
        self.points[cell + 1] - self.points[cell]
    }

    /// First and second derivatives of a joint at a point.
    pub(super) fn derivatives(&self, point: usize, joint: usize) -> (f64, f64) {
        let index = point * self.joints + joint;
        (self.first[index], self.second[index])
    }
}
