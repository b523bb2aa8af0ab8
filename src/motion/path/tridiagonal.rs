//! A chain of configurations, each free along some directions, drawn together by weighted steps: the block-tridiagonal least
//! squares, solved by elimination from end to end (Golub & Van Loan 2013, ch. 4.5), within the joints' limits.
//!
//! A knot has as many unknowns as the arm has joints to spare, one or two, and fewer where joints are held: the banded matrix of
//! whole clips, whose blocks are of one order and padded to four, would be mostly padding here.

use crate::buffer::refill;

/// How often joints that would leave their limits are held at them, and the rest is solved anew.
const HOLDINGS: usize = 8;
/// Added to the diagonal, as a share of it.
const DAMPING: f64 = 1e-6;
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
    /// Of the step to each knot.
    weights: Vec<f64>,
    /// What each joint moves by, and what of that is certain: it leads to the limits at which joints are held.
    moves: Vec<f64>,
    offsets: Vec<f64>,
    diagonal: Vec<f64>,
    /// Of a knot's block above the diagonal, solved by its own.
    above: Vec<f64>,
    side: Vec<f64>,
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
        let (n, count) = (self.n, self.weights.len());
        let most = self.free.iter().copied().max().unwrap_or(0);
        // Each knot has room for as many as the freest.
        self.diagonal.resize(most * most, 0.0);
        refill(&mut self.above, count * most * most, 0.0);
        refill(&mut self.side, count * most, 0.0);
        let metric = |a: &[f64], b: &[f64], squares: &[f64]| -> f64 {
            let parts = a.iter().zip(b).zip(squares);
            parts.map(|((a, b), square)| a * b * square).sum()
        };
        let direction = |firsts: &[usize], knot: usize, k: usize| {
            let first = firsts[knot] + k;
            first * n..(first + 1) * n
        };
        let mut pull = vec![0.0; n];
        for knot in 0..count {
            let own = self.free[knot];
            if own == 0 {
                continue;
            }
            let before = if knot > 0 { self.weights[knot] } else { 0.0 };
            let after = self.weights.get(knot + 1).copied().unwrap_or(0.0);
            // The way that its neighbours draw it.
            pull.fill(0.0);
            for (weight, other) in [(before, knot.wrapping_sub(1)), (after, knot + 1)] {
                if weight > 0.0 && other < count {
                    for (joint, pull) in pull.iter_mut().enumerate() {
                        let at = |knot: usize| q[knot * n + joint] + self.offsets[knot * n + joint];
                        *pull += weight * (at(other) - at(knot));
                    }
                }
            }
            for k in 0..own {
                let a = direction(&self.firsts, knot, k);
                let a = &self.directions[a];
                self.side[knot * most + k] = metric(a, &pull, &self.squares);
                for l in 0..own {
                    let b = direction(&self.firsts, knot, l);
                    let damping = if k == l { 1.0 + DAMPING } else { 1.0 };
                    self.diagonal[k * most + l] =
                        (before + after) * damping * metric(a, &self.directions[b], &self.squares);
                }
            }
            // What the knot before was eliminated by.
            let last = match knot {
                0 => 0,
                _ => self.free[knot - 1],
            };
            for k in 0..if last > 0 { own } else { 0 } {
                let a = direction(&self.firsts, knot, k);
                for m in 0..last {
                    let b = direction(&self.firsts, knot - 1, m);
                    let coupling = -before
                        * metric(
                            &self.directions[a.clone()],
                            &self.directions[b],
                            &self.squares,
                        );
                    self.side[knot * most + k] -= coupling * self.side[(knot - 1) * most + m];
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
                let a = direction(&self.firsts, knot, k);
                for l in 0..next {
                    let b = direction(&self.firsts, knot + 1, l);
                    self.above[(knot * most + k) * most + l] = -after
                        * metric(
                            &self.directions[a.clone()],
                            &self.directions[b],
                            &self.squares,
                        );
                }
            }
            let right = &mut self.above[knot * most * most..(knot + 1) * most * most];
            let side = &mut self.side[knot * most..(knot + 1) * most];
            divide(&mut self.diagonal, most, own, right, next, side);
        }
        for knot in (0..count).rev() {
            let own = self.free[knot];
            let next = match knot + 1 < count {
                true => self.free[knot + 1],
                false => 0,
            };
            let moves = knot * n..(knot + 1) * n;
            self.moves[moves.clone()].copy_from_slice(&self.offsets[moves.clone()]);
            for k in 0..own {
                let mut z = self.side[knot * most + k];
                for l in 0..next {
                    z -=
                        self.above[(knot * most + k) * most + l] * self.side[(knot + 1) * most + l];
                }
                self.side[knot * most + k] = z;
                let a = direction(&self.firsts, knot, k);
                for (by, a) in self.moves[moves.clone()]
                    .iter_mut()
                    .zip(&self.directions[a])
                {
                    *by += z * a;
                }
            }
        }
    }
}

/// Solves a small system for several right-hand sides in place, by elimination without pivoting: it is positive definite.
fn divide(
    matrix: &mut [f64],
    stride: usize,
    own: usize,
    right: &mut [f64],
    columns: usize,
    side: &mut [f64],
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
            for l in 0..columns {
                right[row * stride + l] -= by * right[k * stride + l];
            }
            side[row] -= by * side[k];
        }
        for l in 0..columns {
            right[k * stride + l] *= inverse;
        }
        side[k] *= inverse;
        for l in k..own {
            matrix[k * stride + l] *= inverse;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Tridiagonal;

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
