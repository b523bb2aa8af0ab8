//! Workspace of the collision checks of an arm.

use crate::simd_spheres::SphereWorkspaces;
use kinopt_collision::collision::CheckerWorkspace;
use kinopt_kinematics::clock::Instant;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::search::Collision;

/// Workspace of the collision checks.
#[derive(Clone, Debug)]
pub(in crate::arm) struct CollisionWorkspace {
    pub(super) sphere_workspaces: SphereWorkspaces,
    pub(super) exact: CheckerWorkspace,
    pub(super) q_model: Vec<f64>,
    /// Configuration of the whole model at the start of a motion.
    pub(super) q_from: Vec<f64>,
    /// Up to eight configurations, in sequence.
    pub(super) group_configurations: Vec<f64>,
    /// Start configurations of attempts.
    pub(super) seeds: Vec<f64>,
    /// Targets of these attempts.
    pub(super) targets: Vec<Placement<f64>>,
    /// Number of solutions of a query that may still be checked by shapes.
    pub(super) exact_checks_left: usize,
    /// Collisions at the solution so far, if a check of all pairs has them.
    pub(super) contacts: Option<Vec<Collision>>,
    /// Collisions of the last check of all pairs, if it was not cut short.
    pub(super) trial_contacts: Option<Vec<Collision>>,
    /// Until when checks of solutions run: what is cut short counts as touching.
    pub(super) deadline: Option<Instant>,
}
