//! A chain of configurations, each free along some directions, drawn together by weighted steps: the block-tridiagonal least
//! squares, solved by elimination from end to end (Golub & Van Loan 2013, ch. 4.5), within the joints' limits.
//!
//! Of a ring the first knot is the border: the others are a chain, solved for what draws them and for each direction of the first,
//! which then follows from its Schur complement.
//!
//! A knot has as many unknowns as the arm has joints to spare, one or two, and fewer where joints are held: the banded matrix of
//! whole clips, whose blocks are of one order and padded to four, would be mostly padding here.

use crate::buffer::refill;

/// How often joints that would leave their limits are held at them, and the rest is solved anew.
const HOLDINGS: usize = 8;
/// Added to the diagonal, as a share of it.
const DAMPING: f64 = 1e-6;
/// The same of a ring's first knot, with which all of them may drift.
const DAMPING_OF_A_RING: f64 = 1e-3;
/// What a joint may be beyond its limit, and what of a direction does not move a joint, radians or metres.
const NEGLIGIBLE: f64 = 1e-9;
const NO_MOVE: f64 = 1e-6;

/// The system and its solution, whose room is used again.
#[derive(Debug, Default)]
pub(super) struct Tridiagonal {
    n: usize,
    squares: Vec<f64>,
    /// All directions, one after another; where those of each knot begin, and in how many it is still free.
    directions: Vec<f64>,
    firsts: Vec<usize>,
    free: Vec<usize>,
    /// Of the step to each knot; of a ring's first that from the last.
    weights: Vec<f64>,
    /// Of a ring, how far the joints have come when they are back at the first knot.
    turns: Option<Vec<f64>>,
    /// What each joint moves by, and what of that is certain: it leads to the limits at which joints are held.
    moves: Vec<f64>,
    offsets: Vec<f64>,
    diagonal: Vec<f64>,
    /// Of a knot's block above the diagonal, solved by its own.
    above: Vec<f64>,
    /// What draws a knot, and of a ring how the first knot does, direction by direction.
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

    /// Makes a ring of the knots: the step from the last to the first, which is so many turns on then.
    pub(super) fn close(&mut self, turns: &[f64], weight: f64) {
        if let Some(first) = self.weights.first_mut() {
            *first = weight;
        }
        self.turns = Some(turns.to_vec());
    }

    /// Adds a knot: the directions in which it is free, and what the step to it weighs.
    pub(super) fn push(&mut self, q: &[f64], directions: &[f64], weight: f64) {
        debug_assert_eq!(q.len(), self.n);
        self.firsts.push(self.directions.len() / self.n);
        self.free.push(directions.len() / self.n);
        self.directions.extend_from_slice(directions);
        self.weights.push(weight);
    }

    /// What each joint is to move by, knot by knot.
    pub(super) fn moves(&self) -> &[f64] {
        &self.moves
    }

    /// Solves for the moves from q.
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

    /// Holds in each knot the joint that would leave its limits furthest at the limit, if the knot is free to; whether there is none.
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

    /// Moves a joint of a knot by so much, and takes from the knot's directions what would move it: each by a multiple of the one that moves it
    /// most. Whether there is one.
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

    /// One elimination over the directions that are left.
    fn sweep(&mut self, q: &[f64]) {
        let count = self.weights.len();
        let most = self.free.iter().copied().max().unwrap_or(0);
        let ring = self.turns.is_some();
        self.columns = 1 + if ring { self.free[0] } else { 0 };
        // Each knot has room for as many as the freest.
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

    /// Writes a knot's block, less what the one before was eliminated by, and divides by it.
    fn eliminate(&mut self, q: &[f64], knot: usize, most: usize) {
        let (count, columns, own) = (self.weights.len(), self.columns, self.free[knot]);
        let ring = self.turns.is_some();
        self.write_own(q, knot, most);
        // Of a ring the second knot's and the last one's steps to the first.
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
        // What the knot before was eliminated by.
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
        // The block to the right, and the side, by the diagonal's inverse.
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

    /// Writes the diagonal's block of a knot, and the way that its neighbours draw it.
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

    /// The neighbours of a knot, before and after, and what the steps to them weigh.
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

    /// Two directions' product, by the weights of the joints.
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

    /// A knot's unknowns from those of the next.
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

    /// The first knot's unknowns of a ring, when the others are known for each of them.
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

/// A knot's neighbour, and how many rounds on it is.
#[derive(Clone, Copy)]
struct Neighbour {
    knot: usize,
    rounds: f64,
}

/// Solves a small system for several right-hand sides in place, by elimination without pivoting: it is positive definite. Each matrix with its stride,
/// and how many rows (the system's) or columns count.
fn divide(
    (matrix, stride, own): (&mut [f64], usize, usize),
    (right, right_stride, next): (&mut [f64], usize, usize),
    (side, side_stride, columns): (&mut [f64], usize, usize),
) {
    for k in 0..own {
        let pivot = matrix[k * stride + k];
        // Nothing draws it anywhere.
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

    /// A chain in the plane between two fixed ends, whose inner knots must stay above a line: they come to lie on it, evenly.
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
            // Two directions that are neither joint's own.
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

    /// A ring that stands in one knot is the chain from that round to it again: so far as the ring is turned on by, and no further.
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
        // Of the knots of a ring that begins at each, the third stands.
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
                // The first knot of a ring is damped by as much.
                assert!((a - b).abs() < 3.0 * DAMPING_OF_A_RING, "{knot}: {a} {b}");
            }
        }
        assert!(ring.iter().any(|by| by.abs() > 0.05), "{ring:?}");
    }

    /// A knot between two that stand lies where both pull alike, each step by its own weight.
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
