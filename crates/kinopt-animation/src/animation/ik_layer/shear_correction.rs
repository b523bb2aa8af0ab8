//! Correction of sheared bones for a solver of rigid bones.
//!
//! Bones below an uneven scale do not rotate rigidly. A solve that moves points of rigid bones by s moves the sheared
//! points by y = G s with unknown G. Broyden's method estimates G⁻¹ from pairs of s and y. The next solve uses a target
//! that the shear maps to the real one.

use glam::DVec3;

/// Largest number of solves of one sheared pose. Scales of 1 and 1.5 along a bone's axes take about eight.
const MAX_SOLVES: usize = 40;
/// Growth of the distance above which a solve is undone.
const MAX_GROWTH: f64 = 2.0;
/// Fraction of a move that is tried after the whole move was undone.
const SHORTENING_FACTOR: f64 = 0.5;
/// Number of consecutive undone moves after which shortening has no effect, because the solver changes the shear
/// itself. The next solve then starts from the farther pose. If rigid bones do not reach the targets either,
/// corrections end.
const MAX_UNDONE: usize = 4;
/// Fraction of its factors below which a denominator of an update counts as zero.
const MIN_RELATIVE_DENOMINATOR: f64 = 1e-3;

/// Outcome of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[doc(hidden)]
pub enum Corrected {
    /// The nearest pose so far; the next solve starts here.
    Nearest,
    /// A pose from which the next solve starts although an earlier pose is nearer.
    Accepted,
    /// A pose that is much farther; the next solve starts from the previous start.
    Undone,
}

/// Estimate of G⁻¹ for some points, and their positions in a pose.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct ShearCorrection {
    targets: Vec<f64>,
    /// B ≈ G⁻¹, row by row.
    inverse: Vec<f64>,
    /// Positions in the pose from which the next solve starts.
    positions: Vec<f64>,
    /// Largest distance of a point from its target in the nearest pose so far.
    error: f64,
    /// Move s proposed last.
    proposed: Vec<f64>,
    /// Fraction of the next move.
    step_fraction: f64,
    solves: usize,
    undone: usize,
}

impl ShearCorrection {
    /// Correction for points at `posed` in a pose, with rigid bones as the first estimate.
    #[doc(hidden)]
    pub fn new(targets: &[DVec3], posed: &[DVec3]) -> Self {
        let rows = 3 * targets.len();
        let mut correction = Self {
            targets: flat(targets),
            inverse: identity(rows),
            positions: flat(posed),
            error: f64::INFINITY,
            proposed: vec![0.0; rows],
            step_fraction: 1.0,
            solves: 0,
            undone: 0,
        };
        correction.error = largest(&correction.errors(&correction.positions));
        correction
    }

    /// Largest distance of a point from its target in the nearest pose so far.
    #[doc(hidden)]
    pub fn off(&self) -> f64 {
        self.error
    }

    /// Returns true if further solves are not worthwhile.
    #[doc(hidden)]
    pub fn gives_up(&self) -> bool {
        self.solves >= MAX_SOLVES || self.undone >= MAX_UNDONE
    }

    /// Targets of the next rigid solve.
    #[doc(hidden)]
    pub fn commands(&mut self) -> Vec<DVec3> {
        let errors = self.errors(&self.positions);
        let step_fraction = self.step_fraction;
        let rows = self.inverse.chunks_exact(errors.len().max(1));
        for (row, proposed) in rows.zip(&mut self.proposed) {
            *proposed = step_fraction * dot(row, &errors);
        }
        let commands = self.positions.iter().zip(&self.proposed);
        let commands: Vec<f64> = commands.map(|(position, step)| position + step).collect();
        let points = commands.chunks_exact(3);
        points
            .map(|point| DVec3::new(point[0], point[1], point[2]))
            .collect()
    }

    /// Updates the estimate from the positions after the last solve. `reached` is true if rigid bones would be at the
    /// commands.
    #[doc(hidden)]
    pub fn learn(&mut self, posed: &[DVec3], reached: bool) -> Corrected {
        let posed = flat(posed);
        self.solves += 1;
        if reached {
            let pairs = posed.iter().zip(&self.positions);
            let moved: Vec<f64> = pairs.map(|(to, from)| to - from).collect();
            self.update(&moved);
        }
        let [before, error] =
            [&self.positions, &posed].map(|positions| largest(&self.errors(positions)));
        let limit = match reached {
            true if self.undone + 1 == MAX_UNDONE => f64::INFINITY,
            true => MAX_GROWTH * before,
            false => before,
        };
        if error < limit {
            self.positions = posed;
            (self.undone, self.step_fraction) = (0, 1.0);
            let is_nearest = error < self.error;
            self.error = self.error.min(error);
            return match is_nearest {
                true => Corrected::Nearest,
                false => Corrected::Accepted,
            };
        }
        self.undone += 1;
        self.step_fraction *= SHORTENING_FACTOR;
        if !reached {
            self.inverse = identity(self.positions.len());
        }
        Corrected::Undone
    }

    /// B ← B + (s − B y) sᵀB / (sᵀB y).
    fn update(&mut self, moved: &[f64]) {
        let rows = moved.len();
        let s = &self.proposed;
        let by: Vec<f64> = self
            .inverse
            .chunks_exact(rows.max(1))
            .map(|row| dot(row, moved))
            .collect();
        let along = dot(s, &by);
        if along.abs() <= MIN_RELATIVE_DENOMINATOR * (dot(s, s) * dot(&by, &by)).sqrt() {
            return;
        }
        let mut sb = vec![0.0; rows];
        for (row, s) in self.inverse.chunks_exact(rows.max(1)).zip(s) {
            for (sum, entry) in sb.iter_mut().zip(row) {
                *sum += s * entry;
            }
        }
        let coefficient = s.iter().zip(&by).map(|(s, by)| (s - by) / along);
        for (row, coefficient) in self.inverse.chunks_exact_mut(rows.max(1)).zip(coefficient) {
            for (entry, sb) in row.iter_mut().zip(&sb) {
                *entry += coefficient * sb;
            }
        }
    }

    fn errors(&self, positions: &[f64]) -> Vec<f64> {
        let pairs = self.targets.iter().zip(positions);
        pairs.map(|(target, position)| target - position).collect()
    }
}

fn identity(rows: usize) -> Vec<f64> {
    let mut matrix = vec![0.0; rows * rows];
    for entry in matrix.iter_mut().step_by(rows + 1) {
        *entry = 1.0;
    }
    matrix
}

fn flat(points: &[DVec3]) -> Vec<f64> {
    points.iter().flat_map(|point| point.to_array()).collect()
}

/// Largest length of some three-dimensional vectors.
fn largest(vectors: &[f64]) -> f64 {
    let lengths = vectors.chunks_exact(3).map(|v| dot(v, v).sqrt());
    lengths.fold(0.0, f64::max)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
