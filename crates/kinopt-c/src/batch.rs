//! Batches of targets.

use kinopt::arm::PoseOutcome;

use crate::arm::KinoptArm;
use crate::error::{Failure, KinoptStatus, guard};
use crate::pointer;
use crate::solution::KinoptOutcome;

/// Solves for many targets, faster than one after another.
///
/// `starts` has one configuration for all targets, or one for each, one after another. Configurations are written to `q` and
/// errors to `outcomes`, one for each target. `threads` 0 is all cores; results do not depend on it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_solve_batch(
    arm: *const KinoptArm,
    base_from_tools: *const f64,
    target_count: usize,
    starts: *const f64,
    starts_length: usize,
    threads: usize,
    q: *mut f64,
    q_length: usize,
    outcomes: *mut KinoptOutcome,
    outcome_count: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = &pointer::object(arm, "arm")?.inner;
        let targets = pointer::placements(base_from_tools, target_count, "base_from_tools")?;
        let starts = pointer::array(starts, starts_length, "starts")?;
        let common = (starts.len() == arm.joint_count()).then(|| starts.repeat(target_count));
        let starts = common.as_deref().unwrap_or(starts);
        let q = pointer::array_mut(q, q_length, "q")?;
        let outcomes = pointer::array_mut(outcomes, outcome_count, "outcomes")?;
        let mut found = vec![PoseOutcome::default(); outcomes.len()];
        match threads {
            0 => arm.solve_batch_into_parallel(&targets, starts, q, &mut found)?,
            1 => arm.solve_batch_into(&targets, starts, q, &mut found)?,
            _ => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let pool = pool.map_err(|error| {
                    Failure::invalid(format!("`threads` is {threads}: {error}"))
                })?;
                pool.install(|| arm.solve_batch_into_parallel(&targets, starts, q, &mut found))?;
            }
        }
        for (outcome, found) in outcomes.iter_mut().zip(&found) {
            *outcome = KinoptOutcome {
                reached: found.reached,
                position_error: found.position_error,
                orientation_error: found.orientation_error,
                iterations: found.iterations,
                attempts: found.attempts,
            };
        }
        Ok(())
    })
}
