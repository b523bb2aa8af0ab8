//! Points of sheared bones brought to targets by a solver for rigid ones.
//!
//! Bones below an uneven scale do not turn as rigid bones do. A solve that would move rigid bones by s moves the sheared
//! ones by y = G s, and G is not known. Broyden's method learns its inverse from pairs of s and y: the next solve is for a
//! point from which the shear leads to the target.

use glam::DVec3;

/// Solves of one sheared pose at most. Scales of 1 and 1.5 along a bone's axes take about eight.
const MAX_SOLVES: usize = 40;
/// A solve after which the points are further off than this many times the last distance is undone.
const MAX_GROWTH: f64 = 2.0;
/// Share of a move that is tried where the whole was undone.
const SHORTENED: f64 = 0.5;
/// So many moves undone in a row show that shortening does not help: what the solver moves besides the points shears them.
/// The next solve then starts from the pose further off, or where rigid bones do not reach either, corrections end.
const MAX_UNDONE: usize = 4;
/// A denominator of an update below this share of its factors is taken for zero.
const NEGLIGIBLE: f64 = 1e-3;

/// What a solve led to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Corrected {
    /// The nearest pose yet, from which the next solve starts.
    Nearest,
    /// A pose from which the next solve starts although an earlier one is nearer.
    Onwards,
    /// A pose that is much further off. The next solve starts where this one did.
    Undone,
}

/// The inverse of G for some points, and the positions of those in a pose.
#[derive(Clone, Debug)]
pub(crate) struct ShearCorrection {
    targets: Vec<f64>,
    /// B ≈ G⁻¹, row by row.
    inverse: Vec<f64>,
    /// Positions in the pose that the next solve starts from.
    at: Vec<f64>,
    /// Largest distance of a point from its target in the nearest pose yet.
    off: f64,
    /// s of the move that was proposed last.
    proposed: Vec<f64>,
    /// Share of the next move.
    share: f64,
    solves: usize,
    undone: usize,
}

impl ShearCorrection {
    /// For points at `shown` in a pose, with the bones rigid to first order.
    pub(crate) fn new(targets: &[DVec3], shown: &[DVec3]) -> Self {
        let rows = 3 * targets.len();
        let mut own = Self {
            targets: flat(targets),
            inverse: identity(rows),
            at: flat(shown),
            off: f64::INFINITY,
            proposed: vec![0.0; rows],
            share: 1.0,
            solves: 0,
            undone: 0,
        };
        own.off = largest(&own.missing(&own.at));
        own
    }

    /// Largest distance of a point from its target in the nearest pose yet.
    pub(crate) fn off(&self) -> f64 {
        self.off
    }

    /// Whether no more solves are worth their time.
    pub(crate) fn gives_up(&self) -> bool {
        self.solves >= MAX_SOLVES || self.undone >= MAX_UNDONE
    }

    /// Where the next rigid solve should bring the points.
    pub(crate) fn commands(&mut self) -> Vec<DVec3> {
        let missing = self.missing(&self.at);
        let share = self.share;
        let rows = self.inverse.chunks_exact(missing.len().max(1));
        for (row, proposed) in rows.zip(&mut self.proposed) {
            *proposed = share * dot(row, &missing);
        }
        let commands = self.at.iter().zip(&self.proposed);
        let commands: Vec<f64> = commands.map(|(at, by)| at + by).collect();
        let points = commands.chunks_exact(3);
        points.map(|at| DVec3::new(at[0], at[1], at[2])).collect()
    }

    /// Learns where the points are after a solve for the last commands; `reached` where rigid bones would be at those.
    pub(crate) fn learn(&mut self, shown: &[DVec3], reached: bool) -> Corrected {
        let shown = flat(shown);
        self.solves += 1;
        if reached {
            let pairs = shown.iter().zip(&self.at);
            let moved: Vec<f64> = pairs.map(|(to, from)| to - from).collect();
            self.update(&moved);
        }
        let [before, off] = [&self.at, &shown].map(|at| largest(&self.missing(at)));
        let limit = match reached {
            true if self.undone + 1 == MAX_UNDONE => f64::INFINITY,
            true => MAX_GROWTH * before,
            false => before,
        };
        if off < limit {
            self.at = shown;
            (self.undone, self.share) = (0, 1.0);
            let is_nearest = off < self.off;
            self.off = self.off.min(off);
            return match is_nearest {
                true => Corrected::Nearest,
                false => Corrected::Onwards,
            };
        }
        self.undone += 1;
        self.share *= SHORTENED;
        if !reached {
            self.inverse = identity(self.at.len());
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
        if along.abs() <= NEGLIGIBLE * (dot(s, s) * dot(&by, &by)).sqrt() {
            return;
        }
        let mut sb = vec![0.0; rows];
        for (row, s) in self.inverse.chunks_exact(rows.max(1)).zip(s) {
            for (sum, entry) in sb.iter_mut().zip(row) {
                *sum += s * entry;
            }
        }
        let wrong = s.iter().zip(&by).map(|(s, by)| (s - by) / along);
        for (row, wrong) in self.inverse.chunks_exact_mut(rows.max(1)).zip(wrong) {
            for (entry, sb) in row.iter_mut().zip(&sb) {
                *entry += wrong * sb;
            }
        }
    }

    fn missing(&self, at: &[f64]) -> Vec<f64> {
        let pairs = self.targets.iter().zip(at);
        pairs.map(|(target, at)| target - at).collect()
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

/// The length of the longest of some vectors of three.
fn largest(vectors: &[f64]) -> f64 {
    let lengths = vectors.chunks_exact(3).map(|v| dot(v, v).sqrt());
    lengths.fold(0.0, f64::max)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
