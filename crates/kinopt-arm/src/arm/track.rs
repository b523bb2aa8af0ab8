//! Tracking of whole paths on one branch, if there is one.

use super::QueryError;
use super::arm::Arm;
use super::distances::{MAX_JOINT_STEP, largest_joint_move};
use super::follower::Follower;
use super::joint_path::JointPath;
use super::step_subdivision::other_solutions;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::{JointJump, Solution};

/// Number of solutions beyond the end of a branch that are tried as starts of a backward path.
const MAX_ALTERNATIVES: usize = 16;
/// Attraction of a backward path to the known one, tried in order, in radians of each joint per radian of path.
///
/// A strong one meets sooner; a weak one avoids limits better.
const ATTRACTIONS: [f64; 3] = [0.3, 0.1, 0.03];
/// Largest number of backward steps in all, as a multiple of the path's length.
const BACKWARD_STEPS_PER_TARGET: usize = 32;
/// Largest difference of a joint at which two paths meet, radians.
const MAX_MEETING_DISTANCE: f64 = 0.25 * MAX_JOINT_STEP;

/// Solutions along the first targets, and their jumps.
#[derive(Default)]
struct Track {
    /// One solution per target, reached or not.
    solutions: Vec<Solution>,
    /// Steps in which a joint moves farther than 0.2 rad, in order.
    jumps: Vec<JointJump>,
}

/// Follows a checked path, from the configuration of a follower.
pub(super) fn follow<'a>(
    arm: &'a Arm,
    follower: &mut Follower<'a>,
    base_from_tools: &[Placement<f64>],
) -> Result<JointPath<Vec<Solution>>, QueryError> {
    let mut track = Track::default();
    track.solutions.reserve(base_from_tools.len());
    let mut backward_steps_left = BACKWARD_STEPS_PER_TARGET * base_from_tools.len();
    let mut is_unreached = false;
    for (step, target) in base_from_tools.iter().enumerate() {
        let mut solution = Solution::default();
        let jump = if step == 0 {
            let jump = follower.begin(*target, &mut solution)?;
            follower.set_nominal_posture(&solution.q);
            jump
        } else {
            follower.advance(*target, &mut solution)?
        };
        let reached = solution.reached;
        track.solutions.push(solution);
        // A branch ends at a jump or at its first unreached target.
        let branch_ends = jump.is_some() || !reached && !is_unreached;
        is_unreached = !reached;
        if branch_ends
            && find_detour(
                arm,
                base_from_tools,
                step,
                &mut track,
                &mut backward_steps_left,
            )?
        {
            *follower = follower_at(arm, base_from_tools, step, &track)?;
            is_unreached = false;
        } else {
            track.jumps.extend(jump);
        }
    }
    let Track { solutions, jumps } = track;
    let rows = solutions.iter().flat_map(|solution| &solution.q);
    let unreached = solutions.iter().enumerate();
    let unreached = unreached.filter(|(_, solution)| !solution.reached);
    Ok(JointPath {
        q: rows.copied().collect(),
        nq: arm.joint_count(),
        jumps,
        unreached: unreached.map(|(row, _)| row).collect(),
        report: solutions,
    })
}

/// Joint path of the arm without its checker, if it reaches all targets and is collision-free.
#[cfg(feature = "collision")]
pub(super) fn unchecked_path_if_free(
    arm: &Arm,
    targets: &[Placement<f64>],
    start: &[f64],
) -> Result<Option<JointPath<Vec<Solution>>>, QueryError> {
    let mut unchecked = arm.clone();
    unchecked.collisions = None;
    let path = follow(&unchecked, &mut unchecked.follower(start)?, targets)?;
    let Some(first) = path.row(0).filter(|_| path.reached()) else {
        return Ok(None);
    };
    // For a start far from the path no motion is checked, as for single solutions.
    let starts_near = largest_joint_move(arm, start, first).1 <= MAX_JOINT_STEP;
    let mut last = if starts_near { start } else { first };
    for row in path.rows() {
        if !is_motion_free(arm, last, row)? {
            return Ok(None);
        }
        last = row;
    }
    Ok(Some(path))
}

/// Looks for another joint path to the end of a branch at `step`. Returns true if there is one, with the new path
/// in the track.
///
/// From solutions at that step it goes back along the path, attracted to the joint path already found, until the
/// two meet.
fn find_detour(
    arm: &Arm,
    targets: &[Placement<f64>],
    step: usize,
    track: &mut Track,
    backward_steps_left: &mut usize,
) -> Result<bool, QueryError> {
    let Some(last) = step.checked_sub(1) else {
        return Ok(false);
    };
    let alternatives = other_solutions(
        arm,
        &targets[step],
        &track.solutions[last].q,
        MAX_ALTERNATIVES,
    )?;
    let first = Some(track.solutions[step].clone()).filter(|first| first.reached);
    for attraction in ATTRACTIONS {
        for alternative in first.iter().chain(&alternatives) {
            let path = backward_path(
                arm,
                targets,
                step,
                alternative,
                attraction,
                track,
                backward_steps_left,
            )?;
            if let Some(path) = path {
                let meeting = step - path.len();
                track.solutions.truncate(meeting + 1);
                track.solutions.extend(path.into_iter().rev());
                track.jumps.retain(|jump| jump.index <= meeting);
                return Ok(true);
            }
        }
    }
    Ok(false)
}

/// Steps from `alternative` back to the meeting with the track; `None` if they do not meet.
fn backward_path(
    arm: &Arm,
    targets: &[Placement<f64>],
    step: usize,
    alternative: &Solution,
    attraction: f64,
    track: &Track,
    backward_steps_left: &mut usize,
) -> Result<Option<Vec<Solution>>, QueryError> {
    let mut follower = arm.follower(&alternative.q)?;
    follower.set_configuration(&targets[step], &alternative.q);
    let mut path = vec![alternative.clone()];
    for (target, track_solution) in targets.iter().zip(&track.solutions).take(step).rev() {
        if *backward_steps_left == 0 {
            break;
        }
        *backward_steps_left -= 1;
        let mut solution = Solution::default();
        if !follower.try_branch(target, Some((&track_solution.q, attraction)), &mut solution) {
            break;
        }
        let is_near =
            largest_joint_move(arm, &track_solution.q, &solution.q).1 <= MAX_MEETING_DISTANCE;
        let next = path.last().map_or(&*alternative.q, |next| &next.q);
        // The path continues from the known one, without a jump.
        let can_join = || largest_joint_move(arm, &track_solution.q, next).1 <= MAX_JOINT_STEP;
        if is_near && can_join() && is_motion_free(arm, &track_solution.q, next)? {
            return Ok(Some(path));
        }
        if !is_motion_free(arm, &solution.q, next)? {
            break;
        }
        follower.set_configuration(target, &solution.q);
        path.push(solution);
    }
    Ok(None)
}

/// Returns true if the motion between two configurations is collision-free.
#[cfg(feature = "collision")]
fn is_motion_free(arm: &Arm, from: &[f64], to: &[f64]) -> Result<bool, QueryError> {
    Ok(arm.motion_collision(from, to)?.is_none())
}

/// Returns true: without collision checks every motion is free.
#[cfg(not(feature = "collision"))]
#[allow(
    clippy::unnecessary_wraps,
    reason = "the signature with collision checks"
)]
fn is_motion_free(_: &Arm, _: &[f64], _: &[f64]) -> Result<bool, QueryError> {
    Ok(true)
}

/// A follower that has made the last two steps of a track.
fn follower_at<'a>(
    arm: &'a Arm,
    targets: &[Placement<f64>],
    step: usize,
    track: &Track,
) -> Result<Follower<'a>, QueryError> {
    let first = step.saturating_sub(2);
    let mut follower = arm.follower(&track.solutions[first].q)?;
    follower.set_nominal_posture(&track.solutions[0].q);
    for (target, solution) in targets[first..=step].iter().zip(&track.solutions[first..]) {
        follower.set_configuration(target, &solution.q);
    }
    follower.set_steps(step + 1);
    Ok(follower)
}
