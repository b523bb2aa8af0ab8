//! Null-space search for a collision-free configuration.

use super::{CollisionAvoidance, CollisionWorkspace};
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::dispatch::Query;
use crate::arm::workspace::{ArmWorkspace, Errors};

/// Initial and smallest step of the search, radians.
const STEPS: [f64; 2] = [0.2, 0.001];
/// Largest number of attempts.
const TRIES: usize = 40;
/// Cosine above which two directions count as one.
const SAME: f64 = 0.95;

/// Cost of a null-space search.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NullSpaceSteps {
    pub(super) attempts: usize,
    pub(super) iterations: usize,
}

impl Arm {
    /// Moves the workspace's x along the null space of the goal until it is collision-free. Returns true if that
    /// succeeds, and the cost.
    ///
    /// The method is compass search (Kolda, Lewis & Torczon 2003, "Optimization by direct search", algorithm 3). Each
    /// step tries both signs of each direction, and takes the first configuration with less penetration. If there is
    /// none, the step halves. `worst` is the distance of the worst pair at x, metres; `most` is the largest number of
    /// attempts.
    pub(super) fn free_along_freedom(
        &self,
        kept: &CollisionAvoidance,
        workspace: &mut ArmWorkspace,
        room: &mut CollisionWorkspace,
        query: &Query<'_>,
        (mut worst, most): (f64, usize),
    ) -> Result<(bool, NullSpaceSteps), QueryError> {
        let mut spent = NullSpaceSteps::default();
        if !self.has_freedom() {
            return Ok((false, spent));
        }
        let n = self.joint_count();
        let (mut at, mut q) = (workspace.x.clone(), vec![0.0; n]);
        let [mut step, shortest] = STEPS;
        while step >= shortest {
            workspace.take_twists(self, &at);
            let mut tried: Vec<Vec<f64>> = Vec::new();
            let mut better = false;
            'directions: for joint in 0..n {
                for by in [step, -step] {
                    if kept.is_late(query, 2) || spent.attempts >= most.min(TRIES) {
                        return Ok((false, spent));
                    }
                    if !self.stand_beside(workspace, &at, joint, by)
                        || tried.iter().any(|way| is_along(way, &workspace.trial, &at))
                    {
                        continue;
                    }
                    let way = workspace.trial.iter().zip(&at).map(|(to, at)| to - at);
                    tried.push(way.collect());
                    let Some(lanes) = self.lanes_within(&workspace.bounded_lanes) else {
                        return Ok((false, spent));
                    };
                    let (target, deadline) = (workspace.target(), query.deadline);
                    let outcome =
                        lanes.attempt_from_start(&target, &workspace.trial, deadline, &mut q);
                    spent.attempts += 1;
                    spent.iterations += outcome.iterations as usize;
                    if !outcome.reached {
                        continue;
                    }
                    let there = kept.worst(self, room, &q)?;
                    if there > worst {
                        (worst, better) = (there, true);
                        at.copy_from_slice(&q);
                        workspace.x.copy_from_slice(&q);
                        workspace.errors = Errors::of(&outcome);
                        break 'directions;
                    }
                }
            }
            if worst.is_infinite() {
                return Ok((true, spent));
            }
            if !better {
                step *= 0.5;
            }
        }
        Ok((false, spent))
    }

    /// Writes a configuration near `from` to the workspace's trial, along the null-space part of a joint's motion.
    ///
    /// The motion is `by` radians long (prismatic joints by the metres that weigh as much), clamped to the bounds. The
    /// workspace must hold the Jacobian at `from`. Returns false if the joint has no null-space motion.
    pub(super) fn stand_beside(
        &self,
        workspace: &mut ArmWorkspace,
        from: &[f64],
        joint: usize,
        by: f64,
    ) -> bool {
        // The buffer holds the motion first, so that nothing is allocated.
        let mut motion = std::mem::take(&mut workspace.trial);
        motion.fill(0.0);
        motion[joint] = by;
        workspace.project_to_null(from, &motion, 0.0);
        workspace.trial = motion;
        let squares = workspace.projected.iter().map(|by| by * by);
        let length = squares.sum::<f64>().sqrt();
        if length < 1e-3 * by.abs() {
            return false;
        }
        let bounds = workspace
            .question
            .lower
            .iter()
            .zip(&workspace.question.upper);
        let moves = workspace.projected.iter().zip(&self.scale).zip(bounds);
        for ((trial, from), ((way, scale), (lower, upper))) in
            workspace.trial.iter_mut().zip(from).zip(moves)
        {
            let moved = from + by.abs() * way / (length * scale);
            *trial = moved.max(*lower).min(*upper);
        }
        true
    }
}

/// Returns true if the direction from `from` to `place` is about the known one.
fn is_along(known: &[f64], place: &[f64], from: &[f64]) -> bool {
    let (mut product, mut squares) = (0.0, [0.0; 2]);
    for ((known, place), from) in known.iter().zip(place).zip(from) {
        let by = place - from;
        product += known * by;
        squares[0] += known * known;
        squares[1] += by * by;
    }
    product > SAME * (squares[0] * squares[1]).sqrt()
}
