//! Collision checker of one arm, with its compiled SIMD checks.

use super::check_time::CheckTime;
use super::simd_checks::SimdChecks;
use super::workspace::CollisionWorkspace;
use crate::simd_spheres::SphereWorkspaces;
use kinopt_collision::collision::Checker;

/// Collision checker for the configurations of one arm.
#[derive(Debug)]
pub(in crate::arm) struct CollisionAvoidance {
    pub(super) checker: Checker,
    /// Checker with a larger margin, for steps that are cut short.
    pub(super) cautious: Checker,
    /// Configuration of the whole model, which gives the positions of the joints outside the arm.
    pub(super) rest: Vec<f64>,
    /// True if a pair that no joint of the arm moves is too near, so that nothing is collision-free.
    pub(super) never_free: bool,
    /// SIMD checks, if the chain supports them and there are spheres.
    pub(super) simd_checks: Option<SimdChecks>,
    /// Link pairs too close for spheres, by index in the checker's model; the SIMD checks leave them out.
    pub(super) close_pairs: Vec<[usize; 2]>,
    pub(super) check_time: CheckTime,
}

impl CollisionAvoidance {
    pub(in crate::arm) fn checker(&self) -> &Checker {
        &self.checker
    }

    pub(in crate::arm) fn rest(&self) -> &[f64] {
        &self.rest
    }

    pub(in crate::arm) fn workspace(&self) -> CollisionWorkspace {
        CollisionWorkspace {
            sphere_workspaces: SphereWorkspaces::default(),
            exact: self.checker.workspace(),
            q_model: self.rest.clone(),
            q_from: self.rest.clone(),
            group_configurations: Vec::new(),
            seeds: Vec::new(),
            targets: Vec::new(),
            exact_checks_left: 0,
            contacts: None,
            trial_contacts: None,
            deadline: None,
        }
    }

    /// Returns true if the first check is exact: the spheres are the shapes, or there are no SIMD checks.
    pub(super) fn spheres_decide(&self) -> bool {
        let exact = self
            .checker
            .spheres()
            .is_some_and(|spheres| spheres.max_protrusion() == 0.0);
        self.simd_checks.is_none() || exact
    }
}
