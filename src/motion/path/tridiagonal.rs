//! A chain of configurations, each free along some directions, drawn together by weighted steps: the block-tridiagonal least
//! squares, solved by elimination from end to end (Golub & Van Loan 2013, ch. 4.5), within the joints' limits.

/// How often knots that would leave their limits are held where they come to them, and the rest is solved anew.
const HOLDINGS: usize = 3;
/// Added to the diagonal, as a share of it.
const DAMPING: f64 = 1e-6;

/// The system and its solution, whose room is used again.
#[derive(Debug, Default)]
pub(super) struct Tridiagonal {
    n: usize,
    squares: Vec<f64>,
    /// All directions, one after another; where those of each knot begin, and where the last ones end.
    directions: Vec<f64>,
    firsts: Vec<usize>,
    /// Of the step to each knot.
    weights: Vec<f64>,
    /// What each joint moves by.
    moves: Vec<f64>,
    held: Vec<bool>,
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
        self.firsts.push(0);
        self.weights.clear();
    }

    /// Adds a knot: the directions in which it is free, and what the step to it weighs.
    pub(super) fn push(&mut self, q: &[f64], directions: &[f64], weight: f64) {
        debug_assert_eq!(q.len(), self.n);
        self.directions.extend_from_slice(directions);
        self.firsts.push(self.directions.len() / self.n);
        self.weights.push(weight);
    }

    /// What each joint is to move by, knot by knot.
    pub(super) fn moves(&self) -> &[f64] {
        &self.moves
    }

    /// Solves for the moves from q.
    pub(super) fn solve(&mut self, q: &[f64], limits: &[(f64, f64)]) {
        self.moves.clear();
        self.moves.resize(q.len(), 0.0);
        self.held.clear();
        self.held.resize(self.weights.len(), false);
        for _ in 0..HOLDINGS {
            self.sweep(q);
            if self.stay_within(q, limits) {
                break;
            }
        }
    }

    /// Shortens moves that leave the limits, and holds those knots; whether there is none.
    fn stay_within(&mut self, q: &[f64], limits: &[(f64, f64)]) -> bool {
        let mut all = true;
        let rows = q
            .chunks_exact(self.n)
            .zip(self.moves.chunks_exact_mut(self.n));
        for ((q, moves), held) in rows.zip(&mut self.held) {
            let mut share: f64 = 1.0;
            for ((q, by), (lower, upper)) in q.iter().zip(&*moves).zip(limits) {
                if q + by > *upper {
                    share = share.min((upper - q) / by);
                } else if q + by < *lower {
                    share = share.min((lower - q) / by);
                }
            }
            if share < 1.0 && !*held {
                moves.iter_mut().for_each(|by| *by *= share.max(0.0));
                *held = true;
                all = false;
            }
        }
        all
    }

    /// One elimination; the knots that are held keep the moves that they have.
    fn sweep(&mut self, q: &[f64]) {
        let (n, count) = (self.n, self.weights.len());
        let free = |held: &[bool], firsts: &[usize], knot: usize| match held[knot] {
            true => 0,
            false => firsts[knot + 1] - firsts[knot],
        };
        let most = (0..count).map(|knot| self.firsts[knot + 1] - self.firsts[knot]);
        let most = most.max().unwrap_or(0);
        if most == 0 {
            return;
        }
        // Each knot has room for as many as the freest.
        self.diagonal.resize(most * most, 0.0);
        self.above.clear();
        self.above.resize(count * most * most, 0.0);
        self.side.clear();
        self.side.resize(count * most, 0.0);
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
            let own = free(&self.held, &self.firsts, knot);
            if own == 0 {
                continue;
            }
            let before = if knot > 0 { self.weights[knot] } else { 0.0 };
            let after = self.weights.get(knot + 1).copied().unwrap_or(0.0);
            // The way that its neighbours draw it; of a neighbour that is held with its move.
            pull.fill(0.0);
            for (weight, other) in [(before, knot.wrapping_sub(1)), (after, knot + 1)] {
                if weight > 0.0 && other < count {
                    let keeps = free(&self.held, &self.firsts, other) == 0;
                    for (joint, pull) in pull.iter_mut().enumerate() {
                        let moved = match keeps {
                            true => self.moves[other * n + joint],
                            false => 0.0,
                        };
                        *pull += weight * (q[other * n + joint] + moved - q[knot * n + joint]);
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
                _ => free(&self.held, &self.firsts, knot - 1),
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
                true => free(&self.held, &self.firsts, knot + 1),
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
            let own = free(&self.held, &self.firsts, knot);
            if self.held[knot] {
                continue;
            }
            let next = match knot + 1 < count {
                true => free(&self.held, &self.firsts, knot + 1),
                false => 0,
            };
            let moves = knot * n..(knot + 1) * n;
            self.moves[moves.clone()].fill(0.0);
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
