//! Block-tridiagonal least squares for a chain of configurations with free directions, within joint limits.
//!
//! Weighted steps pull neighbouring knots together. The system is solved by elimination from end to end (Golub & Van
//! Loan 2013, ch. 4.5). A closed chain is bordered by its first knot. All other knots are solved as a chain for each
//! direction of the first. Its Schur complement then gives the first knot. Blocks are as large as the redundancy, one
//! or two, so the banded matrix of clips would be mostly padding here.

use crate::buffer::refill;

/// Maximum number of solves, each with further joints locked at their limits.
const HOLDINGS: usize = 8;
/// Damping of the diagonal, relative to its entries.
const DAMPING: f64 = 1e-6;
/// Damping of the first knot of a closed chain, with which all knots could drift.
const DAMPING_OF_A_RING: f64 = 1e-3;
/// Limit violation, and displacement of a joint by a direction, that count as zero, radians or metres.
const NEGLIGIBLE: f64 = 1e-9;
const NO_MOVE: f64 = 1e-6;

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
    turns: Option<Vec<f64>>,
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
        self.turns = None;
    }

    /// Closes the chain by a step from the last knot to the first, which is `turns` further.
    pub(super) fn close(&mut self, turns: &[f64], weight: f64) {
        if let Some(first) = self.weights.first_mut() {
            *first = weight;
        }
        self.turns = Some(turns.to_vec());
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
        for _ in 0..HOLDINGS {
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
        let mut all = true;
        for knot in 0..self.free.len() {
            let own = knot * n..(knot + 1) * n;
            let mut furthest = (NEGLIGIBLE, 0, 0.0);
            let joints = q[own.clone()].iter().zip(&self.moves[own]).zip(limits);
            for (joint, ((q, by), (lower, upper))) in joints.enumerate() {
                for (excess, limit) in [(q + by - upper, upper), (lower - q - by, lower)] {
                    if excess > furthest.0 {
                        furthest = (excess, joint, limit - q);
                    }
                }
            }
            let (excess, joint, to_limit) = furthest;
            if excess > NEGLIGIBLE {
                all &= !self.hold(knot, joint, to_limit);
            }
        }
        all
    }

    /// Moves a joint of a knot by `by`, and removes its motion from the knot's directions by Gaussian elimination.
    ///
    /// Returns false if no direction moves the joint.
    fn hold(&mut self, knot: usize, joint: usize, by: f64) -> bool {
        let n = self.n;
        let first = self.firsts[knot];
        let rows = first..first + self.free[knot];
        let own = &mut self.directions[rows.start * n..rows.end * n];
        let moves = |k: &usize| own[k * n + joint].abs();
        let most = (0..rows.len()).max_by(|a, b| moves(a).total_cmp(&moves(b)));
        let Some(most) = most.filter(|most| moves(most) > NO_MOVE) else {
            return false;
        };
        let last = rows.len() - 1;
        for entry in 0..n {
            own.swap(most * n + entry, last * n + entry);
        }
        let (kept, taken) = own.split_at_mut(last * n);
        let offsets = &mut self.offsets[knot * n..(knot + 1) * n];
        let share = (by - offsets[joint]) / taken[joint];
        for (offset, taken) in offsets.iter_mut().zip(&*taken) {
            *offset += share * taken;
        }
        for direction in kept.chunks_exact_mut(n) {
            let share = direction[joint] / taken[joint];
            for (entry, taken) in direction.iter_mut().zip(&*taken) {
                *entry -= share * taken;
            }
        }
        self.free[knot] = last;
        true
    }

    /// Solves the system over the remaining directions.
    fn sweep(&mut self, q: &[f64]) {
        let count = self.weights.len();
        let most = self.free.iter().copied().max().unwrap_or(0);
        let ring = self.turns.is_some();
        self.columns = 1 + if ring { self.free[0] } else { 0 };
        // All blocks have the size of the largest.
        self.diagonal.resize(most * most, 0.0);
        refill(&mut self.above, count * most * most, 0.0);
        refill(&mut self.side, count * most * self.columns, 0.0);
        let first = usize::from(ring);
        for knot in first..count {
            if self.free[knot] > 0 {
                self.eliminate(q, knot, most);
            }
        }
        for knot in (first..count).rev() {
            self.substitute(knot, most);
        }
        let of_first = match ring {
            true => self.border(q, most),
            false => Vec::new(),
        };
        self.moves.copy_from_slice(&self.offsets);
        for knot in 0..count {
            for k in 0..self.free[knot] {
                let z = match (ring, knot) {
                    (true, 0) => of_first[k],
                    _ => {
                        let side = self.side_of(knot, k, most);
                        let drawn = side[1..].iter().zip(&of_first);
                        side[0] - drawn.map(|(side, z)| side * z).sum::<f64>()
                    }
                };
                let direction = (self.firsts[knot] + k) * self.n;
                let direction = &self.directions[direction..direction + self.n];
                let moves = &mut self.moves[knot * self.n..(knot + 1) * self.n];
                for (by, a) in moves.iter_mut().zip(direction) {
                    *by += z * a;
                }
            }
        }
    }

    /// Computes a knot's block, eliminates the previous knot, and divides by the diagonal block.
    fn eliminate(&mut self, q: &[f64], knot: usize, most: usize) {
        let (count, columns, own) = (self.weights.len(), self.columns, self.free[knot]);
        let ring = self.turns.is_some();
        self.write_own(q, knot, most);
        // In a closed chain, the second and the last knot are coupled to the first.
        for (at, weight) in self.steps(knot).into_iter().flatten() {
            if !(ring && at.knot == 0) {
                continue;
            }
            for k in 0..own {
                for l in 0..self.free[0] {
                    self.side[(knot * most + k) * columns + 1 + l] -=
                        weight * self.metric((knot, k), (0, l));
                }
            }
        }
        // Elimination of the previous knot.
        let before = self.weights[knot];
        let last = match knot {
            0 => 0,
            _ if ring && knot == 1 => 0,
            _ => self.free[knot - 1],
        };
        for k in 0..own {
            for m in 0..last {
                let coupling = -before * self.metric((knot, k), (knot - 1, m));
                for column in 0..columns {
                    self.side[(knot * most + k) * columns + column] -=
                        coupling * self.side[((knot - 1) * most + m) * columns + column];
                }
                for l in 0..own {
                    self.diagonal[k * most + l] -=
                        coupling * self.above[((knot - 1) * most + m) * most + l];
                }
            }
        }
        // The right block and the right-hand sides, multiplied by the inverse diagonal block.
        let next = match knot + 1 < count {
            true => self.free[knot + 1],
            false => 0,
        };
        for k in 0..own {
            for l in 0..next {
                self.above[(knot * most + k) * most + l] =
                    -self.weights[knot + 1] * self.metric((knot, k), (knot + 1, l));
            }
        }
        let right = &mut self.above[knot * most * most..(knot + 1) * most * most];
        let side = &mut self.side[knot * most * columns..(knot + 1) * most * columns];
        divide(
            (&mut self.diagonal, most, own),
            (right, most, next),
            (side, columns, columns),
        );
    }

    /// Writes a knot's diagonal block and the pull of its neighbours.
    fn write_own(&mut self, q: &[f64], knot: usize, most: usize) {
        let n = self.n;
        let mut pull = std::mem::take(&mut self.pull);
        refill(&mut pull, n, 0.0);
        let mut weights = 0.0;
        for (at, weight) in self.steps(knot).into_iter().flatten() {
            weights += weight;
            for (joint, pull) in pull.iter_mut().enumerate() {
                let place = |knot: usize| q[knot * n + joint] + self.offsets[knot * n + joint];
                let turns = self.turns.as_ref().map_or(0.0, |turns| turns[joint]);
                *pull += weight * (place(at.knot) + at.rounds * turns - place(knot));
            }
        }
        for k in 0..self.free[knot] {
            let direction = (self.firsts[knot] + k) * n;
            let direction = &self.directions[direction..direction + n];
            let parts = direction.iter().zip(&pull).zip(&self.squares);
            self.side[(knot * most + k) * self.columns] =
                parts.map(|((a, b), square)| a * b * square).sum();
            for l in 0..self.free[knot] {
                let damping = if k == l { 1.0 + DAMPING } else { 1.0 };
                self.diagonal[k * most + l] = weights * damping * self.metric((knot, k), (knot, l));
            }
        }
        self.pull = pull;
    }

    /// Returns the previous and next neighbours of a knot, with the weights of the steps.
    fn steps(&self, knot: usize) -> [Option<(Neighbour, f64)>; 2] {
        let count = self.weights.len();
        let ring = self.turns.is_some();
        let at = |knot, rounds| Neighbour { knot, rounds };
        let before = match knot {
            0 if ring => Some(at(count - 1, -1.0)),
            0 => None,
            _ => Some(at(knot - 1, 0.0)),
        };
        let after = match knot + 1 < count {
            true => Some((at(knot + 1, 0.0), self.weights[knot + 1])),
            false if ring => Some((at(0, 1.0), self.weights[0])),
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

    fn side_of(&self, knot: usize, k: usize, most: usize) -> &[f64] {
        let first = (knot * most + k) * self.columns;
        &self.side[first..first + self.columns]
    }

    /// Substitutes the unknowns of the next knot.
    fn substitute(&mut self, knot: usize, most: usize) {
        let columns = self.columns;
        let next = match knot + 1 < self.free.len() {
            true => self.free[knot + 1],
            false => 0,
        };
        for k in 0..self.free[knot] {
            for l in 0..next {
                let above = self.above[(knot * most + k) * most + l];
                for column in 0..columns {
                    self.side[(knot * most + k) * columns + column] -=
                        above * self.side[((knot + 1) * most + l) * columns + column];
                }
            }
        }
    }

    /// Solves for the unknowns of the first knot of a closed chain.
    fn border(&mut self, q: &[f64], most: usize) -> Vec<f64> {
        let own = self.free[0];
        self.write_own(q, 0, most);
        for k in 0..own {
            self.diagonal[k * most + k] *= 1.0 + DAMPING_OF_A_RING;
        }
        let mut side: Vec<f64> = (0..own).map(|k| self.side_of(0, k, most)[0]).collect();
        for (at, weight) in self.steps(0).into_iter().flatten() {
            for (k, side) in side.iter_mut().enumerate() {
                for m in 0..self.free[at.knot] {
                    let coupling = -weight * self.metric((0, k), (at.knot, m));
                    let solved = (at.knot * most + m) * self.columns;
                    *side -= coupling * self.side[solved];
                    for l in 0..own {
                        self.diagonal[k * most + l] -= coupling * self.side[solved + 1 + l];
                    }
                }
            }
        }
        divide(
            (&mut self.diagonal, most, own),
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
    (matrix, stride, own): (&mut [f64], usize, usize),
    (right, right_stride, next): (&mut [f64], usize, usize),
    (side, side_stride, columns): (&mut [f64], usize, usize),
) {
    for k in 0..own {
        let pivot = matrix[k * stride + k];
        // A zero pivot means that nothing pulls along this direction.
        let inverse = if pivot > 1e-300 { pivot.recip() } else { 0.0 };
        for row in 0..own {
            if row == k {
                continue;
            }
            let by = matrix[row * stride + k] * inverse;
            for l in k..own {
                matrix[row * stride + l] -= by * matrix[k * stride + l];
            }
            for l in 0..next {
                right[row * right_stride + l] -= by * right[k * right_stride + l];
            }
            for l in 0..columns {
                side[row * side_stride + l] -= by * side[k * side_stride + l];
            }
        }
        for l in 0..next {
            right[k * right_stride + l] *= inverse;
        }
        for l in 0..columns {
            side[k * side_stride + l] *= inverse;
        }
        for l in k..own {
            matrix[k * stride + l] *= inverse;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{DAMPING_OF_A_RING, Tridiagonal};
    use crate::scalar::elementary;

    /// A planar chain between two fixed ends, with inner knots limited to one side of a line: they lie on it, evenly
    /// spaced.
    #[test]
    fn a_joint_at_its_limit_is_held_alone() {
        let count = 8;
        let last = f64::from(count - 1);
        let mut q = Vec::new();
        let mut system = Tridiagonal::default();
        system.begin(2, &[1.0, 1.0]);
        for knot in 0..count {
            let fixed = knot == 0 || knot == count - 1;
            let even = f64::from(knot) / last;
            let own = match fixed {
                true => [even, 0.1],
                false => [even * even, 0.3 + 0.1 * f64::from(knot % 2)],
            };
            // Both directions move both joints.
            let free: &[f64] = if fixed { &[] } else { &[0.8, 0.6, 0.1, 0.9] };
            system.push(&own, free, if knot == 0 { 0.0 } else { 1.0 });
            q.extend(own);
        }
        system.solve(&q, &[(-1.0, 2.0), (0.2, 1.0)]);
        let came = q.iter().zip(system.moves()).map(|(q, by)| q + by);
        let came: Vec<f64> = came.collect();
        for (knot, place) in came.chunks_exact(2).enumerate().skip(1).take(6) {
            let even = knot as f64 / last;
            assert!((place[0] - even).abs() < 1e-4, "{knot}: {place:?}");
            assert!((place[1] - 0.2).abs() < 1e-6, "{knot}: {place:?}");
        }
    }

    /// A closed chain with one fixed knot equals the open chain over one cycle from that knot.
    #[test]
    fn a_ring_is_the_chain_from_where_it_stands() {
        let count = 7;
        let turns = [0.5, -0.25];
        let place = |knot: usize| {
            let knot = knot as f64;
            [
                0.1 * knot + 0.05 * elementary::sin_cos(knot * 1.3).0,
                0.1 * elementary::sin_cos(knot * 0.7).1,
            ]
        };
        let weight = |knot: usize| 1.0 + 0.1 * (knot % count) as f64;
        let free = [0.8, 0.6, 0.1, 0.9];
        // The third knot is fixed, for every first knot.
        let stands = 3;
        let solved = |first: usize, last: usize, is_ring: bool| {
            let (mut q, mut system) = (Vec::new(), Tridiagonal::default());
            system.begin(2, &[1.0, 2.0]);
            for knot in first..=last {
                let own = place(knot % count);
                let round = (knot / count) as f64;
                let own = [own[0] + round * turns[0], own[1] + round * turns[1]];
                let free: &[f64] = if knot % count == stands { &[] } else { &free };
                let weight = if knot == first { 0.0 } else { weight(knot) };
                system.push(&own, free, weight);
                q.extend(own);
            }
            if is_ring {
                system.close(&turns, weight(first));
            }
            system.solve(&q, &[(-9.0, 9.0), (-9.0, 9.0)]);
            system.moves().to_vec()
        };
        let ring = solved(0, count - 1, true);
        let chain = solved(stands, stands + count, false);
        for knot in 0..count {
            let in_chain = (knot + count - stands) % count;
            for joint in 0..2 {
                let (a, b) = (ring[2 * knot + joint], chain[2 * in_chain + joint]);
                // The first knot of a closed chain has additional damping.
                assert!((a - b).abs() < 3.0 * DAMPING_OF_A_RING, "{knot}: {a} {b}");
            }
        }
        assert!(ring.iter().any(|by| by.abs() > 0.05), "{ring:?}");
    }

    /// A free knot between two fixed ones is at their weighted mean.
    #[test]
    fn a_step_draws_by_its_weight() {
        let mut system = Tridiagonal::default();
        system.begin(1, &[1.0]);
        let q = [0.0, 0.9, 1.0];
        let free: [&[f64]; 3] = [&[], &[1.0], &[]];
        for (q, (free, weight)) in q.iter().zip(free.into_iter().zip([0.0, 1.0, 3.0])) {
            system.push(&[*q], free, weight);
        }
        system.solve(&q, &[(-1.0, 2.0)]);
        let came = q[1] + system.moves()[1];
        assert!((came - 0.75).abs() < 1e-5, "{came}");
    }
}
