//! Block-tridiagonal least squares for a chain of configurations with free directions, within joint limits.
//!
//! Weighted steps pull neighbouring knots together. The system is solved by elimination from end to end (Golub & Van
//! Loan 2013, ch. 4.5). A closed chain is bordered by its first knot. All other knots are solved as a chain for each
//! direction of the first. Its Schur complement then gives the first knot. Blocks are as large as the redundancy, one
//! or two, so the banded matrix of clips would be mostly padding here.

use crate::buffer::refill;

/// Maximum number of solves, each with further joints locked at their limits.
const MAX_LOCKING_PASSES: usize = 8;
/// Damping of the diagonal, relative to its entries.
const DAMPING: f64 = 1e-6;
/// Damping of the first knot of a closed chain, with which all knots could drift.
const CLOSED_CHAIN_DAMPING: f64 = 1e-3;
/// Limit violation, and displacement of a joint by a direction, that count as zero, radians or metres.
const LIMIT_TOLERANCE: f64 = 1e-9;
const MIN_JOINT_MOTION: f64 = 1e-6;

/// System and solution, with reusable buffers.
#[derive(Debug, Default)]
pub(super) struct Tridiagonal {
    n: usize,
    squares: Vec<f64>,
    /// All directions, one after another; index of the first and number of free directions of each knot.
    directions: Vec<f64>,
    firsts: Vec<usize>,
    free: Vec<usize>,
    /// Weight of the step to each knot. The first is that of the closing step.
    weights: Vec<f64>,
    /// For a closed chain, joint displacement over one cycle.
    cycle_displacement: Option<Vec<f64>>,
    /// Displacement of each joint, and its fixed part, which moves joints to their limits.
    moves: Vec<f64>,
    offsets: Vec<f64>,
    diagonal: Vec<f64>,
    /// Blocks above the diagonal, multiplied by the inverse diagonal blocks.
    above: Vec<f64>,
    /// Right-hand sides of each knot: its pull, and for a closed chain the coupling to the first knot, per direction.
    side: Vec<f64>,
    columns: usize,
    pull: Vec<f64>,
}

impl Tridiagonal {
    pub(super) fn begin(&mut self, n: usize, weights: &[f64]) {
        self.n = n;
        self.squares.clear();
        self.squares
            .extend(weights.iter().map(|weight| weight * weight));
        self.directions.clear();
        self.firsts.clear();
        self.free.clear();
        self.weights.clear();
        self.cycle_displacement = None;
    }

    /// Closes the chain by a step from the last knot to the first, which is `displacement` further.
    pub(super) fn close(&mut self, displacement: &[f64], weight: f64) {
        if let Some(first) = self.weights.first_mut() {
            *first = weight;
        }
        self.cycle_displacement = Some(displacement.to_vec());
    }

    /// Adds a knot with its free directions and the weight of the step to it.
    pub(super) fn push(&mut self, q: &[f64], directions: &[f64], weight: f64) {
        debug_assert_eq!(q.len(), self.n);
        self.firsts.push(self.directions.len() / self.n);
        self.free.push(directions.len() / self.n);
        self.directions.extend_from_slice(directions);
        self.weights.push(weight);
    }

    /// Displacement of each joint, knot by knot.
    pub(super) fn moves(&self) -> &[f64] {
        &self.moves
    }

    /// Solves for the displacements from q.
    pub(super) fn solve(&mut self, q: &[f64], limits: &[(f64, f64)]) {
        for numbers in [&mut self.moves, &mut self.offsets] {
            refill(numbers, q.len(), 0.0);
        }
        for _ in 0..MAX_LOCKING_PASSES {
            self.sweep(q);
            if self.stay_within(q, limits) {
                break;
            }
        }
    }

    /// Locks in each knot the joint with the largest limit violation at its limit, if a direction moves it. Returns
    /// whether there is none.
    fn stay_within(&mut self, q: &[f64], limits: &[(f64, f64)]) -> bool {
        let n = self.n;
        let mut within = true;
        for knot in 0..self.free.len() {
            let range = knot * n..(knot + 1) * n;
            let mut largest = (LIMIT_TOLERANCE, 0, 0.0);
            let joints = q[range.clone()].iter().zip(&self.moves[range]).zip(limits);
            for (joint, ((q, delta), (lower, upper))) in joints.enumerate() {
                for (excess, limit) in [(q + delta - upper, upper), (lower - q - delta, lower)] {
                    if excess > largest.0 {
                        largest = (excess, joint, limit - q);
                    }
                }
            }
            let (excess, joint, to_limit) = largest;
            if excess > LIMIT_TOLERANCE {
                within &= !self.lock(knot, joint, to_limit);
            }
        }
        within
    }

    /// Moves a joint of a knot by `displacement`, and removes its motion from the knot's directions by Gaussian
    /// elimination.
    ///
    /// Returns false if no direction moves the joint.
    fn lock(&mut self, knot: usize, joint: usize, displacement: f64) -> bool {
        let n = self.n;
        let first = self.firsts[knot];
        let rows = first..first + self.free[knot];
        let directions = &mut self.directions[rows.start * n..rows.end * n];
        let moves = |k: &usize| directions[k * n + joint].abs();
        let pivot = (0..rows.len()).max_by(|a, b| moves(a).total_cmp(&moves(b)));
        let Some(pivot) = pivot.filter(|pivot| moves(pivot) > MIN_JOINT_MOTION) else {
            return false;
        };
        let last = rows.len() - 1;
        for entry in 0..n {
            directions.swap(pivot * n + entry, last * n + entry);
        }
        let (remaining, removed) = directions.split_at_mut(last * n);
        let offsets = &mut self.offsets[knot * n..(knot + 1) * n];
        let factor = (displacement - offsets[joint]) / removed[joint];
        for (offset, removed) in offsets.iter_mut().zip(&*removed) {
            *offset += factor * removed;
        }
        for direction in remaining.chunks_exact_mut(n) {
            let factor = direction[joint] / removed[joint];
            for (entry, removed) in direction.iter_mut().zip(&*removed) {
                *entry -= factor * removed;
            }
        }
        self.free[knot] = last;
        true
    }

    /// Solves the system over the remaining directions.
    fn sweep(&mut self, q: &[f64]) {
        let count = self.weights.len();
        let block_size = self.free.iter().copied().max().unwrap_or(0);
        let ring = self.cycle_displacement.is_some();
        self.columns = 1 + if ring { self.free[0] } else { 0 };
        // All blocks have the size of the largest.
        self.diagonal.resize(block_size * block_size, 0.0);
        refill(&mut self.above, count * block_size * block_size, 0.0);
        refill(&mut self.side, count * block_size * self.columns, 0.0);
        let first = usize::from(ring);
        for knot in first..count {
            if self.free[knot] > 0 {
                self.eliminate(q, knot, block_size);
            }
        }
        for knot in (first..count).rev() {
            self.substitute(knot, block_size);
        }
        let first_unknowns = match ring {
            true => self.border(q, block_size),
            false => Vec::new(),
        };
        self.moves.copy_from_slice(&self.offsets);
        for knot in 0..count {
            for k in 0..self.free[knot] {
                let z = match (ring, knot) {
                    (true, 0) => first_unknowns[k],
                    _ => {
                        let side = self.side_of(knot, k, block_size);
                        let coupled = side[1..].iter().zip(&first_unknowns);
                        side[0] - coupled.map(|(side, z)| side * z).sum::<f64>()
                    }
                };
                let direction = (self.firsts[knot] + k) * self.n;
                let direction = &self.directions[direction..direction + self.n];
                let moves = &mut self.moves[knot * self.n..(knot + 1) * self.n];
                for (displacement, a) in moves.iter_mut().zip(direction) {
                    *displacement += z * a;
                }
            }
        }
    }

    /// Computes a knot's block, eliminates the previous knot, and divides by the diagonal block.
    fn eliminate(&mut self, q: &[f64], knot: usize, block_size: usize) {
        let (count, columns, free_count) = (self.weights.len(), self.columns, self.free[knot]);
        let ring = self.cycle_displacement.is_some();
        self.write_diagonal(q, knot, block_size);
        // In a closed chain, the second and the last knot are coupled to the first.
        for (neighbour, weight) in self.steps(knot).into_iter().flatten() {
            if !(ring && neighbour.knot == 0) {
                continue;
            }
            for k in 0..free_count {
                for l in 0..self.free[0] {
                    self.side[(knot * block_size + k) * columns + 1 + l] -=
                        weight * self.metric((knot, k), (0, l));
                }
            }
        }
        // Elimination of the previous knot.
        let step_weight = self.weights[knot];
        let last = match knot {
            0 => 0,
            _ if ring && knot == 1 => 0,
            _ => self.free[knot - 1],
        };
        for k in 0..free_count {
            for m in 0..last {
                let coupling = -step_weight * self.metric((knot, k), (knot - 1, m));
                for column in 0..columns {
                    self.side[(knot * block_size + k) * columns + column] -=
                        coupling * self.side[((knot - 1) * block_size + m) * columns + column];
                }
                for l in 0..free_count {
                    self.diagonal[k * block_size + l] -=
                        coupling * self.above[((knot - 1) * block_size + m) * block_size + l];
                }
            }
        }
        // The right block and the right-hand sides, multiplied by the inverse diagonal block.
        let next = match knot + 1 < count {
            true => self.free[knot + 1],
            false => 0,
        };
        for k in 0..free_count {
            for l in 0..next {
                self.above[(knot * block_size + k) * block_size + l] =
                    -self.weights[knot + 1] * self.metric((knot, k), (knot + 1, l));
            }
        }
        let right =
            &mut self.above[knot * block_size * block_size..(knot + 1) * block_size * block_size];
        let side = &mut self.side[knot * block_size * columns..(knot + 1) * block_size * columns];
        divide(
            (&mut self.diagonal, block_size, free_count),
            (right, block_size, next),
            (side, columns, columns),
        );
    }

    /// Writes a knot's diagonal block and the pull of its neighbours.
    fn write_diagonal(&mut self, q: &[f64], knot: usize, block_size: usize) {
        let n = self.n;
        let mut pull = std::mem::take(&mut self.pull);
        refill(&mut pull, n, 0.0);
        let mut weights = 0.0;
        for (neighbour, weight) in self.steps(knot).into_iter().flatten() {
            weights += weight;
            for (joint, pull) in pull.iter_mut().enumerate() {
                let position = |knot: usize| q[knot * n + joint] + self.offsets[knot * n + joint];
                let displacement = self
                    .cycle_displacement
                    .as_ref()
                    .map_or(0.0, |displacement| displacement[joint]);
                *pull += weight
                    * (position(neighbour.knot) + neighbour.rounds * displacement - position(knot));
            }
        }
        for k in 0..self.free[knot] {
            let direction = (self.firsts[knot] + k) * n;
            let direction = &self.directions[direction..direction + n];
            let parts = direction.iter().zip(&pull).zip(&self.squares);
            self.side[(knot * block_size + k) * self.columns] =
                parts.map(|((a, b), square)| a * b * square).sum();
            for l in 0..self.free[knot] {
                let damping = if k == l { 1.0 + DAMPING } else { 1.0 };
                self.diagonal[k * block_size + l] =
                    weights * damping * self.metric((knot, k), (knot, l));
            }
        }
        self.pull = pull;
    }

    /// Returns the previous and next neighbours of a knot, with the weights of the steps.
    fn steps(&self, knot: usize) -> [Option<(Neighbour, f64)>; 2] {
        let count = self.weights.len();
        let ring = self.cycle_displacement.is_some();
        let neighbour = |knot, rounds| Neighbour { knot, rounds };
        let before = match knot {
            0 if ring => Some(neighbour(count - 1, -1.0)),
            0 => None,
            _ => Some(neighbour(knot - 1, 0.0)),
        };
        let after = match knot + 1 < count {
            true => Some((neighbour(knot + 1, 0.0), self.weights[knot + 1])),
            false if ring => Some((neighbour(0, 1.0), self.weights[0])),
            false => None,
        };
        [before.map(|before| (before, self.weights[knot])), after]
    }

    /// Returns the weighted inner product of two directions.
    fn metric(&self, a: (usize, usize), b: (usize, usize)) -> f64 {
        let direction = |(knot, k): (usize, usize)| {
            let first = (self.firsts[knot] + k) * self.n;
            &self.directions[first..first + self.n]
        };
        let parts = direction(a).iter().zip(direction(b)).zip(&self.squares);
        parts.map(|((a, b), square)| a * b * square).sum()
    }

    fn side_of(&self, knot: usize, k: usize, block_size: usize) -> &[f64] {
        let first = (knot * block_size + k) * self.columns;
        &self.side[first..first + self.columns]
    }

    /// Substitutes the unknowns of the next knot.
    fn substitute(&mut self, knot: usize, block_size: usize) {
        let columns = self.columns;
        let next = match knot + 1 < self.free.len() {
            true => self.free[knot + 1],
            false => 0,
        };
        for k in 0..self.free[knot] {
            for l in 0..next {
                let above = self.above[(knot * block_size + k) * block_size + l];
                for column in 0..columns {
                    self.side[(knot * block_size + k) * columns + column] -=
                        above * self.side[((knot + 1) * block_size + l) * columns + column];
                }
            }
        }
    }

    /// Solves for the unknowns of the first knot of a closed chain.
    fn border(&mut self, q: &[f64], block_size: usize) -> Vec<f64> {
        let free_count = self.free[0];
        self.write_diagonal(q, 0, block_size);
        for k in 0..free_count {
            self.diagonal[k * block_size + k] *= 1.0 + CLOSED_CHAIN_DAMPING;
        }
        let mut side: Vec<f64> = (0..free_count)
            .map(|k| self.side_of(0, k, block_size)[0])
            .collect();
        for (neighbour, weight) in self.steps(0).into_iter().flatten() {
            for (k, side) in side.iter_mut().enumerate() {
                for m in 0..self.free[neighbour.knot] {
                    let coupling = -weight * self.metric((0, k), (neighbour.knot, m));
                    let solved = (neighbour.knot * block_size + m) * self.columns;
                    *side -= coupling * self.side[solved];
                    for l in 0..free_count {
                        self.diagonal[k * block_size + l] -= coupling * self.side[solved + 1 + l];
                    }
                }
            }
        }
        divide(
            (&mut self.diagonal, block_size, free_count),
            (&mut [], 0, 0),
            (&mut side, 1, 1),
        );
        side
    }
}

/// Neighbour of a knot, and the number of cycles to it.
#[derive(Clone, Copy)]
struct Neighbour {
    knot: usize,
    rounds: f64,
}

/// Solves a small positive definite system in place for several right-hand sides, without pivoting.
///
/// Each matrix comes with its stride and its number of rows (the system's) or columns.
fn divide(
    (matrix, stride, size): (&mut [f64], usize, usize),
    (right, right_stride, next): (&mut [f64], usize, usize),
    (side, side_stride, columns): (&mut [f64], usize, usize),
) {
    for k in 0..size {
        let pivot = matrix[k * stride + k];
        // A zero pivot means that nothing pulls along this direction.
        let inverse = if pivot > 1e-300 { pivot.recip() } else { 0.0 };
        for row in 0..size {
            if row == k {
                continue;
            }
            let factor = matrix[row * stride + k] * inverse;
            for l in k..size {
                matrix[row * stride + l] -= factor * matrix[k * stride + l];
            }
            for l in 0..next {
                right[row * right_stride + l] -= factor * right[k * right_stride + l];
            }
            for l in 0..columns {
                side[row * side_stride + l] -= factor * side[k * side_stride + l];
            }
        }
        for l in 0..next {
            right[k * right_stride + l] *= inverse;
        }
        for l in 0..columns {
            side[k * side_stride + l] *= inverse;
        }
        for l in k..size {
            matrix[k * stride + l] *= inverse;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{CLOSED_CHAIN_DAMPING, Tridiagonal};
    use crate::scalar::elementary;

    /// A planar chain between two fixed ends, with inner knots limited to one side of a line: they lie on it, evenly
    /// spaced.
    #[test]
    fn limited_joint_locks_alone() {
        let count = 8;
        let last = f64::from(count - 1);
        let mut q = Vec::new();
        let mut system = Tridiagonal::default();
        system.begin(2, &[1.0, 1.0]);
        for knot in 0..count {
            let fixed = knot == 0 || knot == count - 1;
            let even = f64::from(knot) / last;
            let configuration = match fixed {
                true => [even, 0.1],
                false => [even * even, 0.3 + 0.1 * f64::from(knot % 2)],
            };
            // Both directions move both joints.
            let free: &[f64] = if fixed { &[] } else { &[0.8, 0.6, 0.1, 0.9] };
            system.push(&configuration, free, if knot == 0 { 0.0 } else { 1.0 });
            q.extend(configuration);
        }
        system.solve(&q, &[(-1.0, 2.0), (0.2, 1.0)]);
        let result = q.iter().zip(system.moves()).map(|(q, delta)| q + delta);
        let result: Vec<f64> = result.collect();
        for (knot, row) in result.chunks_exact(2).enumerate().skip(1).take(6) {
            let even = knot as f64 / last;
            assert!((row[0] - even).abs() < 1e-4, "{knot}: {row:?}");
            assert!((row[1] - 0.2).abs() < 1e-6, "{knot}: {row:?}");
        }
    }

    /// A closed chain with one fixed knot equals the open chain over one cycle from that knot.
    #[test]
    fn closed_chain_equals_open_chain_from_fixed_knot() {
        let count = 7;
        let displacement = [0.5, -0.25];
        let position = |knot: usize| {
            let knot = knot as f64;
            [
                0.1 * knot + 0.05 * elementary::sin_cos(knot * 1.3).0,
                0.1 * elementary::sin_cos(knot * 0.7).1,
            ]
        };
        let weight = |knot: usize| 1.0 + 0.1 * (knot % count) as f64;
        let free = [0.8, 0.6, 0.1, 0.9];
        // The third knot is fixed, for every first knot.
        let fixed_knot = 3;
        let solved = |first: usize, last: usize, is_ring: bool| {
            let (mut q, mut system) = (Vec::new(), Tridiagonal::default());
            system.begin(2, &[1.0, 2.0]);
            for knot in first..=last {
                let configuration = position(knot % count);
                let round = (knot / count) as f64;
                let configuration = [
                    configuration[0] + round * displacement[0],
                    configuration[1] + round * displacement[1],
                ];
                let free: &[f64] = if knot % count == fixed_knot {
                    &[]
                } else {
                    &free
                };
                let weight = if knot == first { 0.0 } else { weight(knot) };
                system.push(&configuration, free, weight);
                q.extend(configuration);
            }
            if is_ring {
                system.close(&displacement, weight(first));
            }
            system.solve(&q, &[(-9.0, 9.0), (-9.0, 9.0)]);
            system.moves().to_vec()
        };
        let ring = solved(0, count - 1, true);
        let chain = solved(fixed_knot, fixed_knot + count, false);
        for knot in 0..count {
            let in_chain = (knot + count - fixed_knot) % count;
            for joint in 0..2 {
                let (a, b) = (ring[2 * knot + joint], chain[2 * in_chain + joint]);
                // The first knot of a closed chain has additional damping.
                assert!(
                    (a - b).abs() < 3.0 * CLOSED_CHAIN_DAMPING,
                    "{knot}: {a} {b}"
                );
            }
        }
        assert!(ring.iter().any(|delta| delta.abs() > 0.05), "{ring:?}");
    }

    /// A free knot between two fixed ones is at their weighted mean.
    #[test]
    fn free_knot_ends_at_weighted_mean() {
        let mut system = Tridiagonal::default();
        system.begin(1, &[1.0]);
        let q = [0.0, 0.9, 1.0];
        let free: [&[f64]; 3] = [&[], &[1.0], &[]];
        for (q, (free, weight)) in q.iter().zip(free.into_iter().zip([0.0, 1.0, 3.0])) {
            system.push(&[*q], free, weight);
        }
        system.solve(&q, &[(-1.0, 2.0)]);
        let result = q[1] + system.moves()[1];
        assert!((result - 0.75).abs() < 1e-5, "{result}");
    }
}
