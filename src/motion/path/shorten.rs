//! Shortening of a joint path in the null space of its targets, all knots at once.
//!
//! Every configuration moves in the null space of its own target, q + N z, to minimise Σ wᵢ |q(i+1) − q(i)|². This is a
//! block-tridiagonal system in z. With wᵢ the inverse length of a step, the minimum is the shortest path (Weiszfeld's
//! method). Each configuration is then projected back onto its target. A round is accepted if the path is shorter,
//! joints are within limits, steps are short enough, and nothing collides. The last knot of a cyclic path is the first
//! one again.

use super::PathError;
use super::basis::NullSpace;
use super::knot_configurations::KnotPath;
use super::layers::Growth;
use super::tridiagonal::Tridiagonal;
use crate::arm::Ends;
use crate::spatial::Placement;

/// Longest joint displacement per round, radians.
const LONGEST_MOVE: f64 = 0.25;
/// Smallest step length used in a weight, relative to the mean.
const SHORTEST_SHARE: f64 = 0.1;
/// Relative decrease of the length at which the rounds stop.
const WORTH_WHILE: f64 = 1e-3;

/// Settings of the shortening.
pub(super) struct Shortening<'a, 'b> {
    pub(super) growth: &'a Growth<'b>,
    pub(super) weights: &'a [f64],
    /// Maximum number of rounds.
    pub(super) rounds: usize,
    /// For a cyclic path with a free start, joint displacement over one cycle. The first and the last configuration
    /// then move together.
    pub(super) ring: Option<&'a [f64]>,
}

/// Scratch memory of a round.
#[derive(Default)]
struct ShorteningWorkspace {
    null_space: NullSpace,
    slopes: Vec<f64>,
    trial: Vec<f64>,
    ends: Ends,
    #[cfg(feature = "collision")]
    free: Vec<bool>,
    system: Tridiagonal,
    /// Knots that do not move.
    held: Vec<bool>,
    /// For each knot, whether its last move failed.
    failed: Vec<bool>,
}

impl Shortening<'_, '_> {
    /// Shortens a joint path.
    pub(super) fn run(&self, way: &mut KnotPath) -> Result<(), PathError> {
        let arm = self.growth.arms.own();
        if !arm.is_redundant() || way.reached.len() < 2 {
            return Ok(());
        }
        let mut room = ShorteningWorkspace {
            failed: vec![false; way.reached.len()],
            ..ShorteningWorkspace::default()
        };
        let mut length = self.length(&way.q);
        let mut share = 1.0;
        for _ in 0..self.rounds {
            self.aim(way, &mut room)?;
            let Some(shorter) = self.step(way, share, length, &mut room)? else {
                share *= 0.5;
                if share < 0.2 {
                    break;
                }
                continue;
            };
            let gained = length - shorter;
            length = shorter;
            if gained < WORTH_WHILE * length {
                break;
            }
        }
        Ok(())
    }

    fn length(&self, q: &[f64]) -> f64 {
        length(q, self.weights)
    }

    /// Solves for the displacements of all knots.
    fn aim(&self, way: &KnotPath, room: &mut ShorteningWorkspace) -> Result<(), PathError> {
        let (knots, n) = (self.growth.knots, self.weights.len());
        let arm = self.growth.arms.own();
        let count = way.reached.len();
        room.held.clear();
        room.held.extend(way.reached.iter().map(|reached| !reached));
        let ring = self.ring;
        if ring.is_none() {
            room.held[0] |= self.growth.start.is_some();
            room.held[count - 1] |= self.growth.end.is_some();
        }
        room.slopes.resize(6 * n, 0.0);
        let mean = self.length(&way.q) / (count - 1) as f64;
        let weight = |knot: usize| {
            let length = step_length(way.row(knot - 1, n), way.row(knot, n), self.weights);
            length.max(SHORTEST_SHARE * mean).max(1e-9).recip()
        };
        room.system.begin(n, self.weights);
        let knots_of_its_own = count - usize::from(ring.is_some());
        for knot in 0..knots_of_its_own {
            let q = way.row(knot, n);
            let mut directions: &[f64] = &[];
            if !room.held[knot] && !room.failed[knot] {
                let arm = self.growth.arms.of(knots.tool(knot));
                arm.write_slopes(&knots.targets[knot], q, &mut room.slopes)?;
                room.null_space.of(&room.slopes, arm.scales());
                directions = &room.null_space.directions;
            }
            let weight = if knot == 0 { 0.0 } else { weight(knot) };
            room.system.push(q, directions, weight);
        }
        if let Some(turns) = ring {
            room.system.close(turns, weight(count - 1));
        }
        let limits: Vec<(f64, f64)> = arm.limits().map(|l| (l.lower, l.upper)).collect();
        room.system.solve(&way.q[..knots_of_its_own * n], &limits);
        Ok(())
    }

    /// Moves by a fraction of the displacements and projects onto the targets. Returns the new length if the path is
    /// better.
    fn step(
        &self,
        way: &mut KnotPath,
        share: f64,
        length: f64,
        room: &mut ShorteningWorkspace,
    ) -> Result<Option<f64>, PathError> {
        let (knots, n) = (self.growth.knots, self.weights.len());
        let scales = self.growth.arms.own().scales();
        let moves = room.system.moves();
        let longest = moves.chunks_exact(n).flat_map(|row| row.iter().zip(scales));
        let longest = longest.fold(0.0, |most: f64, (by, scale)| most.max((by * scale).abs()));
        let share = share * (LONGEST_MOVE / longest.max(1e-12)).min(1.0);
        room.trial.clear();
        room.trial
            .extend(way.q.iter().zip(moves).map(|(q, by)| q + share * by));
        if let Some(turns) = self.ring {
            let last = room.trial[..n].iter().zip(turns).map(|(q, turn)| q + turn);
            let last: Vec<f64> = last.collect();
            room.trial.extend(last);
        }
        let limits = self.growth.arms.own().limits();
        for (joint, limits) in limits.enumerate() {
            for row in room.trial.chunks_exact_mut(n) {
                row[joint] = limits.clamp(row[joint]);
            }
        }
        let targets: &[Placement<f64>] = &knots.targets;
        let tool = |knot: usize| knots.tool(knot);
        let arms = self.growth.arms;
        arms.continue_all(tool, targets, &room.trial, &mut room.ends)?;
        let ends = &mut room.ends;
        #[cfg(feature = "collision")]
        arms.own().are_free(&ends.q, false, &mut room.free)?;
        for (knot, outcome) in ends.outcomes.iter().enumerate() {
            #[cfg(feature = "collision")]
            let free = room.free[knot];
            #[cfg(not(feature = "collision"))]
            let free = true;
            let fails = !outcome.reached || !free;
            room.failed[knot] = fails && !room.held[knot];
            if fails || room.held[knot] {
                ends.q[knot * n..(knot + 1) * n].copy_from_slice(way.row(knot, n));
            }
        }
        self.tie(&mut ends.q);
        // Reverts steps that have become too long, with their neighbours.
        let mut settled = false;
        for _ in 0..8 {
            settled = true;
            for knot in 1..way.reached.len() {
                let (from, to) = (
                    &ends.q[(knot - 1) * n..knot * n],
                    &ends.q[knot * n..(knot + 1) * n],
                );
                let (bounds, allowance) = (self.growth.bounds, way.allowance[knot]);
                if way.joined[knot] && !bounds.allow_times(allowance, knots, knot, from, to) {
                    settled = false;
                    let both = (knot - 1) * n..(knot + 1) * n;
                    if ends.q[both.clone()] == way.q[both.clone()] {
                        return Ok(None);
                    }
                    ends.q[both.clone()].copy_from_slice(&way.q[both]);
                    room.failed[knot] = true;
                    // The ends of a cyclic path move together.
                    let last = way.reached.len() - 1;
                    if self.ring.is_some() && (knot == 1 || knot == last) {
                        ends.q[..n].copy_from_slice(way.row(0, n));
                        ends.q[last * n..].copy_from_slice(way.row(last, n));
                        room.failed[0] |= knot == last;
                    }
                }
            }
            if settled {
                break;
            }
        }
        let shorter = self.length(&ends.q);
        if !settled || shorter >= length {
            return Ok(None);
        }
        std::mem::swap(&mut way.q, &mut ends.q);
        Ok(Some(shorter))
    }
}

impl Shortening<'_, '_> {
    /// Sets the last configuration of a cyclic path to the first one plus the displacement over one cycle.
    fn tie(&self, q: &mut [f64]) {
        let Some(turns) = self.ring else {
            return;
        };
        let last = q.len() - turns.len();
        let (before, last) = q.split_at_mut(last);
        for (last, (first, turn)) in last.iter_mut().zip(before.iter().zip(turns)) {
            *last = first + turn;
        }
    }
}

/// Returns the weighted joint length of a path, stored one configuration after another.
pub(super) fn length(q: &[f64], weights: &[f64]) -> f64 {
    let n = weights.len();
    let rows = q.chunks_exact(n).zip(q.chunks_exact(n).skip(1));
    rows.map(|(a, b)| step_length(a, b, weights)).sum()
}

/// Returns the root of the sum of (weight · difference)².
pub(super) fn step_length(a: &[f64], b: &[f64], weights: &[f64]) -> f64 {
    let parts = a.iter().zip(b).zip(weights);
    let squares = parts.map(|((a, b), weight)| (weight * (a - b)) * (weight * (a - b)));
    squares.sum::<f64>().sqrt()
}
