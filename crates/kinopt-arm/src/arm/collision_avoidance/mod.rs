//! Collision avoidance of an arm, compiled for its chain.

pub(super) mod avoidance;
mod check_time;
pub(super) mod checks;
mod compilation;
mod min_penetration;
mod null_space_avoidance;
pub(super) mod path_steps;
pub(super) mod search;
mod simd_checks;
pub(super) mod sphere_checks;
mod time_left;
pub(super) mod workspace;

use std::sync::Arc;

use self::avoidance::CollisionAvoidance;
use self::checks::with_collision_workspace;
use self::sphere_checks::for_each_colliding;
use super::arm::Arm;
use super::{ArmError, QueryError};
use kinopt_collision::collision::{Checker, World};
use kinopt_solver::search::Collision;

impl Arm {
    /// The same arm with avoidance of collisions with a world and with itself.
    ///
    /// A solution is reached only if all pairs are at least the checker's margin apart, by the exact distances of
    /// shapes. `q_model` is a configuration of the checker's model, which must be the arm's; it gives the positions of
    /// joints outside the arm. The seed atlas is shared, so an arm for a changed world takes microseconds to build.
    ///
    /// If the plain solution collides, further attempts follow, checked eight at a time. The [search](super::Search)
    /// decides which one counts: the first collision-free attempt from the start, or the nearest. If none is free, the
    /// one of least penetration moves along the null space. Pairs that no joint of the arm moves, such as the base on
    /// its table, are checked once, by their shapes. If they collide, no solution is free, and none is searched for.
    ///
    /// Paths, followers and servos stop before a collision. A step is cut short if the motion to its end, with linear
    /// joint interpolation, is not proven [free](Checker::check_motion). Null-space motion may avoid the obstacle instead. A
    /// step cut short is not reached, and its solution names the collision; later steps continue from there. A pair in
    /// contact at the start of a step comes no nearer, and separates when the path leads away
    /// ([`Checker::way_from_contact`]). No step is reached until it has.
    ///
    /// # Errors
    /// Returns an error for a checker of another model, or a configuration of the wrong length or not finite.
    pub fn with_checker(self, checker: &Checker, q_model: &[f64]) -> Result<Self, ArmError> {
        with_checker_after(self, checker, q_model, None)
    }

    /// The same arm in another world, in its present state, with another margin (metres) or the same one.
    ///
    /// The seed atlas is shared.
    ///
    /// # Errors
    /// Returns an error for:
    /// - An arm without a [checker](Self::with_checker).
    /// - A margin that is negative or not finite.
    /// - An obstacle attached to a frame that the robot does not have.
    pub fn with_world(
        &self,
        world: &World,
        margin: impl Into<Option<f64>>,
    ) -> Result<Self, ArmError> {
        let Some(avoidance) = &self.collisions else {
            return Err(ArmError::Conflict(
                "the arm was built without a world or a margin, so its world cannot be replaced",
            ));
        };
        let margin = margin.into().unwrap_or(avoidance.checker.margin());
        let checker = avoidance
            .checker
            .clone()
            .with_world(world)?
            .with_margin(margin)?;
        let changed = self.changed(self.serial.clone(), self.options.clone())?;
        with_checker_after(changed, &checker, &avoidance.rest, Some(avoidance))
    }

    /// Returns true if the arm avoids collisions.
    pub(super) fn avoids_collisions(&self) -> bool {
        self.collisions.is_some()
    }

    /// Pairs that are nearer to each other than the margin at a configuration of the arm, the deepest first.
    ///
    /// # Errors
    /// Returns an error for an arm without a [checker](Self::with_checker), or a configuration of the wrong length or
    /// not finite.
    pub fn collisions(&self, q: &[f64]) -> Result<Vec<Collision>, QueryError> {
        match self.avoids_collisions() {
            true => self.touching(q),
            false => Err(QueryError::NothingToKeepClearOf),
        }
    }

    /// Distance of the closest pair of bodies at a configuration, metres, negative for a penetration. `None` if all
    /// are farther apart than `max_distance`.
    ///
    /// # Errors
    /// Returns the errors of [`collisions`](Self::collisions).
    pub fn clearance(&self, q: &[f64], max_distance: f64) -> Result<Option<f64>, QueryError> {
        self.check_length("q", q.len(), self.joint_count())?;
        self.check_finite("q", q)?;
        let Some(avoidance) = &self.collisions else {
            return Err(QueryError::NothingToKeepClearOf);
        };
        let mut q_model = avoidance.rest.clone();
        self.configuration(q, &mut q_model)?;
        let checker = &avoidance.checker;
        let nearest = checker.nearest(&mut checker.workspace(), &q_model, max_distance)?;
        Ok(nearest.map(|pair| pair.distance))
    }

    /// [`collisions`](Self::collisions), but empty for an arm without a checker.
    pub(crate) fn touching(&self, q: &[f64]) -> Result<Vec<Collision>, QueryError> {
        self.check_length("q", q.len(), self.joint_count())?;
        self.check_finite("q", q)?;
        match &self.collisions {
            Some(avoidance) => avoidance.collisions(self, &mut avoidance.workspace(), q),
            None => Ok(Vec::new()),
        }
    }

    /// Sets `clear` for each configuration in `q`, in sequence, that is proven collision-free by spheres.
    ///
    /// The spheres cover the links, and none is nearer than the margin. Eight configurations are checked per pass, some
    /// twenty times as fast as by [`collisions`](Self::collisions). Spheres may protrude from the shapes, so a
    /// configuration that fails may still be free.
    ///
    /// Link pairs so close that their spheres nearly always overlap, as in a wrist, are checked by their shapes. The
    /// shapes also decide if there are no spheres, or if an obstacle is attached.
    ///
    /// # Errors
    /// Returns an error for an arm without a [checker](Self::with_checker), slices of the wrong length, or a
    /// configuration that is not finite.
    pub fn clear_by_spheres(&self, q: &[f64], clear: &mut [bool]) -> Result<(), QueryError> {
        self.check_length("q", q.len(), self.joint_count() * clear.len())?;
        self.check_finite("q", q)?;
        if !self.avoids_collisions() {
            return Err(QueryError::NothingToKeepClearOf);
        }
        clear.fill(true);
        for_each_colliding(self, q, false, |index| clear[index] = false)
    }

    /// Flags the configurations that are free by their spheres or, if `by_shapes`, by the exact check.
    ///
    /// All are free for an arm without a checker.
    pub(crate) fn are_free(
        &self,
        q: &[f64],
        by_shapes: bool,
        free: &mut Vec<bool>,
    ) -> Result<(), QueryError> {
        free.clear();
        free.resize(q.len() / self.joint_count(), true);
        for_each_colliding(self, q, by_shapes, |index| free[index] = false)
    }

    /// Collision on the motion between two configurations with linear joint interpolation; `None` if it is free.
    pub(crate) fn motion_collision(
        &self,
        from: &[f64],
        to: &[f64],
    ) -> Result<Option<Collision>, QueryError> {
        let Some(avoidance) = &self.collisions else {
            return Ok(None);
        };
        with_collision_workspace(self, avoidance, |_, checks| {
            avoidance.blocked(self, checks, from, to)
        })
    }
}

/// The same arm with a checker, sharing compiled parts of `previous`, of an arm of the same chain.
fn with_checker_after(
    mut arm: Arm,
    checker: &Checker,
    q_model: &[f64],
    previous: Option<&CollisionAvoidance>,
) -> Result<Arm, ArmError> {
    let avoidance = CollisionAvoidance::new(&arm, checker, q_model, previous)?;
    arm.collisions = Some(Arc::new(avoidance));
    // A workspace of another checker is invalid.
    arm.for_each_workspace(|workspace| workspace.collision_workspace = None);
    Ok(arm)
}
