//! Collision avoidance of a problem by a checker.

use super::continuous_check::RESOLUTION;
use super::{Checker, CheckerWorkspace, Clearance, MotionCheck};
use kinopt_solver::problem::{ClearanceCheck, Collision, CollisionAvoidance};
use kinopt_solver::task::{Quantity, Task};

/// Width of the band beyond the margin in which the clearance residual acts, metres. It makes an approximate solution
/// collision-free.
const CLEARANCE_BAND: f64 = 1e-3;
/// Tolerance of the clearance residual, as a fraction of the band.
const BAND_TOLERANCE: f64 = 0.9;
/// Distance before the margin at which motions stop, metres, so that they can depart again.
const STAND_OFF: f64 = 1e-4;

/// Checks configurations and motions for a [`Problem`](kinopt_solver::Problem) with collision avoidance.
#[derive(Clone, Debug)]
pub struct MotionChecker {
    checker: Checker,
    /// The checker with an additional distance, for truncating motions.
    cautious: Checker,
    workspace: CheckerWorkspace,
}

impl CollisionAvoidance for Checker {
    type Clearance = Clearance;
    type Check = MotionChecker;

    fn configuration_len(&self) -> usize {
        self.model.model().configuration_len()
    }

    fn clearance(&self) -> Task<Clearance> {
        let task = Task::new(Clearance::new(self, self.margin + CLEARANCE_BAND));
        task.tolerance(Quantity::Metres, BAND_TOLERANCE * CLEARANCE_BAND)
    }

    fn check(&self) -> MotionChecker {
        MotionChecker {
            workspace: self.workspace(),
            checker: self.clone(),
            cautious: self.clone().with_stand_off(STAND_OFF),
        }
    }
}

impl ClearanceCheck for MotionChecker {
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision> {
        let collisions = self.checker.collisions_with(&mut self.workspace, q);
        debug_assert!(collisions.is_ok(), "a configuration that does not fit");
        collisions.unwrap_or_default()
    }

    fn is_free(&mut self, q: &[f64]) -> bool {
        let free = self.checker.is_free(&mut self.workspace, q);
        free.unwrap_or(false)
    }

    fn blocked(&mut self, from: &[f64], to: &[f64]) -> Option<Collision> {
        let motion_check = (self.checker).way_from_contact(&mut self.workspace, from, to);
        debug_assert!(motion_check.is_ok(), "a configuration that does not fit");
        let motion_check = motion_check.ok()?;
        match starts_in_penetration(&motion_check) {
            true => {
                let motion_check = self.checker.check_motion(&mut self.workspace, from, to);
                motion_check
                    .ok()
                    .and_then(|motion_check| motion_check.blocked_by)
            }
            false => motion_check.blocked_by,
        }
    }

    fn free_share(&mut self, from: &[f64], to: &[f64]) -> f64 {
        let motion_check = (self.cautious).way_from_contact(&mut self.workspace, from, to);
        match motion_check {
            Ok(motion_check) if !starts_in_penetration(&motion_check) => motion_check.free,
            _ => 0.0,
        }
    }
}

/// True if a body penetrates something and must leave it first. Bodies in support contact penetrate by rounding at
/// most.
fn starts_in_penetration(motion_check: &MotionCheck) -> bool {
    motion_check.initial_penetration > RESOLUTION
}
