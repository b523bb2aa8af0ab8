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
use super::layers::LayerGenerator;
use super::tridiagonal::Tridiagonal;
use crate::arm::Ends;
use crate::spatial::Placement;

/// Longest joint displacement per round, radians.
const MAX_JOINT_STEP: f64 = 0.25;
/// Smallest step length used in a weight, relative to the mean.
const MIN_LENGTH_RATIO: f64 = 0.1;
/// Relative decrease of the length at which the rounds stop.
const MIN_RELATIVE_DECREASE: f64 = 1e-3;

/// Settings of the shortening.
pub(super) struct Shortening<'a, 'b> {
    pub(super) generator: &'a LayerGenerator<'b>,
    pub(super) weights: &'a [f64],
    /// Maximum number of rounds.
    pub(super) rounds: usize,
    /// For a cyclic path with a free start, joint displacement over one cycle. The first and the last configuration
    /// then move together.
    pub(super) cycle_displacement: Option<&'a [f64]>,
}

/// Scratch memory of a round.
#[derive(Default)]
struct ShorteningWorkspace {
    null_space: NullSpace,
    jacobian: Vec<f64>,
    trial: Vec<f64>,
    ends: Ends,
    #[cfg(feature = "collision")]
    free: Vec<bool>,
    system: Tridiagonal,
    /// Knots that do not move.
    fixed: Vec<bool>,
    /// For each knot, whether its last move failed.
    failed: Vec<bool>,
}

impl Shortening<'_, '_> {
    /// Shortens a joint path.
    pub(super) fn run(&self, joint_path: &mut KnotPath) -> Result<(), PathError> {
        let arm = self.generator.arms.primary();
        if !arm.is_redundant() || joint_path.reached.len() < 2 {
            return Ok(());
        }
        let mut workspace = ShorteningWorkspace {
            failed: vec![false; joint_path.reached.len()],
            ..ShorteningWorkspace::default()
        };
        let mut length = self.length(&joint_path.q);
        let mut step_scale = 1.0;
        for _ in 0..self.rounds {
            self.solve_displacements(joint_path, &mut workspace)?;
            let Some(shorter) = self.step(joint_path, step_scale, length, &mut workspace)? else {
                step_scale *= 0.5;
                if step_scale < 0.2 {
                    break;
                }
                continue;
            };
            let decrease = length - shorter;
            length = shorter;
            if decrease < MIN_RELATIVE_DECREASE * length {
                break;
            }
        }
        Ok(())
    }

    fn length(&self, q: &[f64]) -> f64 {
        length(q, self.weights)
    }

    /// Solves for the displacements of all knots.
    fn solve_displacements(
        &self,
        joint_path: &KnotPath,
        workspace: &mut ShorteningWorkspace,
    ) -> Result<(), PathError> {
        let (knots, n) = (self.generator.knots, self.weights.len());
        let arm = self.generator.arms.primary();
        let count = joint_path.reached.len();
        workspace.fixed.clear();
        workspace
            .fixed
            .extend(joint_path.reached.iter().map(|reached| !reached));
        let cycle_displacement = self.cycle_displacement;
        if cycle_displacement.is_none() {
            workspace.fixed[0] |= self.generator.start.is_some();
            workspace.fixed[count - 1] |= self.generator.end.is_some();
        }
        workspace.jacobian.resize(6 * n, 0.0);
        let mean = self.length(&joint_path.q) / (count - 1) as f64;
        let weight = |knot: usize| {
            let length = step_length(
                joint_path.row(knot - 1, n),
                joint_path.row(knot, n),
                self.weights,
            );
            length.max(MIN_LENGTH_RATIO * mean).max(1e-9).recip()
        };
        workspace.system.begin(n, self.weights);
        let independent_knots = count - usize::from(cycle_displacement.is_some());
        for knot in 0..independent_knots {
            let q = joint_path.row(knot, n);
            let mut directions: &[f64] = &[];
            if !workspace.fixed[knot] && !workspace.failed[knot] {
                let arm = self.generator.arms.arm(knots.tool(knot));
                arm.write_slopes(&knots.targets[knot], q, &mut workspace.jacobian)?;
                workspace
                    .null_space
                    .compute(&workspace.jacobian, arm.scales());
                directions = &workspace.null_space.directions;
            }
            let weight = if knot == 0 { 0.0 } else { weight(knot) };
            workspace.system.push(q, directions, weight);
        }
        if let Some(displacement) = cycle_displacement {
            workspace.system.close(displacement, weight(count - 1));
        }
        let limits: Vec<(f64, f64)> = arm.limits().map(|l| (l.lower, l.upper)).collect();
        workspace
            .system
            .solve(&joint_path.q[..independent_knots * n], &limits);
        Ok(())
    }

    /// Moves by a fraction of the displacements and projects onto the targets. Returns the new length if the path is
    /// better.
    fn step(
        &self,
        joint_path: &mut KnotPath,
        step_scale: f64,
        length: f64,
        workspace: &mut ShorteningWorkspace,
    ) -> Result<Option<f64>, PathError> {
        let (knots, n) = (self.generator.knots, self.weights.len());
        let scales = self.generator.arms.primary().scales();
        let moves = workspace.system.moves();
        let longest = moves.chunks_exact(n).flat_map(|row| row.iter().zip(scales));
        let longest = longest.fold(0.0, |largest: f64, (delta, scale)| {
            largest.max((delta * scale).abs())
        });
        let step_scale = step_scale * (MAX_JOINT_STEP / longest.max(1e-12)).min(1.0);
        workspace.trial.clear();
        workspace.trial.extend(
            joint_path
                .q
                .iter()
                .zip(moves)
                .map(|(q, delta)| q + step_scale * delta),
        );
        if let Some(displacement) = self.cycle_displacement {
            let last = workspace.trial[..n]
                .iter()
                .zip(displacement)
                .map(|(q, shift)| q + shift);
            let last: Vec<f64> = last.collect();
            workspace.trial.extend(last);
        }
        let limits = self.generator.arms.primary().limits();
        for (joint, limits) in limits.enumerate() {
            for row in workspace.trial.chunks_exact_mut(n) {
                row[joint] = limits.clamp(row[joint]);
            }
        }
        let targets: &[Placement<f64>] = &knots.targets;
        let tool = |knot: usize| knots.tool(knot);
        let arms = self.generator.arms;
        arms.continue_all(tool, targets, &workspace.trial, &mut workspace.ends)?;
        let ends = &mut workspace.ends;
        #[cfg(feature = "collision")]
        arms.primary()
            .are_free(&ends.q, false, &mut workspace.free)?;
        for (knot, outcome) in ends.outcomes.iter().enumerate() {
            #[cfg(feature = "collision")]
            let free = workspace.free[knot];
            #[cfg(not(feature = "collision"))]
            let free = true;
            let fails = !outcome.reached || !free;
            workspace.failed[knot] = fails && !workspace.fixed[knot];
            if fails || workspace.fixed[knot] {
                ends.q[knot * n..(knot + 1) * n].copy_from_slice(joint_path.row(knot, n));
            }
        }
        self.tie_ends(&mut ends.q);
        // Reverts steps that have become too long, with their neighbours.
        let mut settled = false;
        for _ in 0..8 {
            settled = true;
            for knot in 1..joint_path.reached.len() {
                let (from, to) = (
                    &ends.q[(knot - 1) * n..knot * n],
                    &ends.q[knot * n..(knot + 1) * n],
                );
                let (bounds, allowance) = (self.generator.bounds, joint_path.allowance[knot]);
                if joint_path.joined[knot]
                    && !bounds.allows_scaled(allowance, knots, knot, from, to)
                {
                    settled = false;
                    let both = (knot - 1) * n..(knot + 1) * n;
                    if ends.q[both.clone()] == joint_path.q[both.clone()] {
                        return Ok(None);
                    }
                    ends.q[both.clone()].copy_from_slice(&joint_path.q[both]);
                    workspace.failed[knot] = true;
                    // The ends of a cyclic path move together.
                    let last = joint_path.reached.len() - 1;
                    if self.cycle_displacement.is_some() && (knot == 1 || knot == last) {
                        ends.q[..n].copy_from_slice(joint_path.row(0, n));
                        ends.q[last * n..].copy_from_slice(joint_path.row(last, n));
                        workspace.failed[0] |= knot == last;
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
        std::mem::swap(&mut joint_path.q, &mut ends.q);
        Ok(Some(shorter))
    }
}

impl Shortening<'_, '_> {
    /// Sets the last configuration of a cyclic path to the first one plus the displacement over one cycle.
    fn tie_ends(&self, q: &mut [f64]) {
        let Some(displacement) = self.cycle_displacement else {
            return;
        };
        let last = q.len() - displacement.len();
        let (before, last) = q.split_at_mut(last);
        for (last, (first, shift)) in last.iter_mut().zip(before.iter().zip(displacement)) {
            *last = first + shift;
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
