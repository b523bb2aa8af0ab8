//! Null-space search for a collision-free configuration.

use super::avoidance::CollisionAvoidance;
use super::workspace::CollisionWorkspace;
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::query::{Query, simd_solver_within};
use crate::arm::workspace::{ArmWorkspace, Errors};

/// Initial and smallest step of the search, radians.
const STEP_RANGE: [f64; 2] = [0.2, 0.001];
/// Largest number of attempts.
const MAX_ATTEMPTS: usize = 40;
/// Cosine above which two directions count as one.
const MIN_SAME_COSINE: f64 = 0.95;

/// Cost of a null-space search.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NullSpaceSteps {
    pub(super) attempts: usize,
    pub(super) iterations: usize,
}

/// Moves the workspace's x along the null space of the goal until it is collision-free. Returns true if that
/// succeeds, and the cost.
///
/// The method is compass search (Kolda, Lewis & Torczon 2003, "Optimization by direct search", algorithm 3). Each
/// step tries both signs of each direction, and takes the first configuration with less penetration. If there is
/// none, the step halves. `min_distance` is the distance of the worst pair at x, metres; `max_attempts` is the
/// largest number of attempts.
pub(super) fn avoid_in_null_space(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    workspace: &mut ArmWorkspace,
    checks: &mut CollisionWorkspace,
    query: &Query<'_>,
    (mut min_distance, max_attempts): (f64, usize),
) -> Result<(bool, NullSpaceSteps), QueryError> {
    let mut steps = NullSpaceSteps::default();
    if !arm.has_null_space() {
        return Ok((false, steps));
    }
    let n = arm.joint_count();
    let (mut centre, mut q) = (workspace.x.clone(), vec![0.0; n]);
    let [mut step, min_step] = STEP_RANGE;
    while step >= min_step {
        workspace.compute_twists(arm, &centre);
        let mut directions: Vec<Vec<f64>> = Vec::new();
        let mut improved = false;
        'directions: for joint in 0..n {
            for displacement in [step, -step] {
                if avoidance.is_late(query) || steps.attempts >= max_attempts.min(MAX_ATTEMPTS) {
                    return Ok((false, steps));
                }
                if !perturb_in_null_space(arm, workspace, &centre, joint, displacement)
                    || directions
                        .iter()
                        .any(|direction| is_along(direction, &workspace.trial, &centre))
                {
                    continue;
                }
                let direction = workspace
                    .trial
                    .iter()
                    .zip(&centre)
                    .map(|(to, centre)| to - centre);
                directions.push(direction.collect());
                let Some(simd_solver) = simd_solver_within(arm, &workspace.bounded_simd_solver)
                else {
                    return Ok((false, steps));
                };
                let (target, deadline) = (workspace.target(), query.deadline);
                let outcome =
                    simd_solver.attempt_from_start(&target, &workspace.trial, deadline, &mut q);
                steps.attempts += 1;
                steps.iterations += outcome.iterations as usize;
                if !outcome.reached {
                    continue;
                }
                let distance = avoidance.min_distance(arm, checks, &q)?;
                if distance > min_distance {
                    (min_distance, improved) = (distance, true);
                    checks.contacts = checks.trial_contacts.take();
                    centre.copy_from_slice(&q);
                    workspace.x.copy_from_slice(&q);
                    workspace.errors = Errors::of(&outcome);
                    break 'directions;
                }
            }
        }
        if min_distance.is_infinite() {
            return Ok((true, steps));
        }
        if !improved {
            step *= 0.5;
        }
    }
    Ok((false, steps))
}

/// Writes a configuration near `from` to the workspace's trial, along the null-space part of a joint's motion.
///
/// The motion is `displacement` radians long (prismatic joints by the metres that weigh as much), clamped to the bounds.
/// The workspace must hold the Jacobian at `from`. Returns false if the joint has no null-space motion.
pub(super) fn perturb_in_null_space(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    from: &[f64],
    joint: usize,
    displacement: f64,
) -> bool {
    // The buffer holds the motion first, so that nothing is allocated.
    let mut motion = std::mem::take(&mut workspace.trial);
    motion.fill(0.0);
    motion[joint] = displacement;
    workspace.project_to_null(from, &motion, 0.0);
    workspace.trial = motion;
    let squares = workspace
        .projected
        .iter()
        .map(|component| component * component);
    let length = squares.sum::<f64>().sqrt();
    if length < 1e-3 * displacement.abs() {
        return false;
    }
    let bounds = workspace
        .question
        .lower
        .iter()
        .zip(&workspace.question.upper);
    let moves = workspace.projected.iter().zip(&arm.scale).zip(bounds);
    for ((trial, from), ((direction, scale), (lower, upper))) in
        workspace.trial.iter_mut().zip(from).zip(moves)
    {
        let moved = from + displacement.abs() * direction / (length * scale);
        *trial = moved.max(*lower).min(*upper);
    }
    true
}

/// Returns true if the direction from `from` to `configuration` is about the known one.
fn is_along(known: &[f64], configuration: &[f64], from: &[f64]) -> bool {
    let (mut product, mut squares) = (0.0, [0.0; 2]);
    for ((known, configuration), from) in known.iter().zip(configuration).zip(from) {
        let difference = configuration - from;
        product += known * difference;
        squares[0] += known * known;
        squares[1] += difference * difference;
    }
    product > MIN_SAME_COSINE * (squares[0] * squares[1]).sqrt()
}
