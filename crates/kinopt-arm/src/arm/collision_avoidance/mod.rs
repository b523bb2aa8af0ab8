//! Collision avoidance of an arm, compiled for its chain.

mod check_time;
mod many_configurations;
mod min_penetration;
mod null_space_avoidance;
mod path_steps;
mod search;
mod sphere_checks;

use std::sync::Arc;

use self::check_time::CheckTime;
use super::arm::Arm;
use super::workspace::ArmWorkspace;
use super::{ArmError, QueryError};
use crate::simd_ik::Chain;
use crate::simd_spheres::{self, Body, BodyChain, Passed, SolidMoved, Solids, SphereWorkspaces};
use kinopt_collision::collision::{Checker, CheckerWorkspace, FIRST_PLANE, SphereModel, World};
use kinopt_kinematics::clock::Instant;
use kinopt_kinematics::clock::deadline::until;
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{FrameId, JointId, Model};
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::search::{BodyKind, Collision};

/// Additional margin of the SIMD checks, metres: they round placements differently from the exact check.
const SLACK: f64 = 1e-9;

/// Collision checker for the configurations of one arm.
#[derive(Debug)]
pub(super) struct CollisionAvoidance {
    checker: Checker,
    /// Checker with a larger margin, for steps that are cut short.
    cautious: Checker,
    /// Configuration of the whole model, which gives the positions of the joints outside the arm.
    rest: Vec<f64>,
    /// True if a pair that no joint of the arm moves is too near, so that nothing is collision-free.
    never_free: bool,
    /// SIMD checks, if the chain supports them and there are spheres.
    simd_checks: Option<SimdChecks>,
    /// Link pairs too close for spheres, by index in the checker's model; the SIMD checks leave them out.
    close_pairs: Vec<[usize; 2]>,
    check_time: CheckTime,
}

/// Spheres and solids for SIMD checks, in the base frame.
#[derive(Debug)]
struct SimdChecks {
    bodies: Arc<BodyChain>,
    solids: Solids,
    base_from_world: Placement<f64>,
}

/// Workspace of the collision checks.
#[derive(Clone, Debug)]
pub(super) struct CollisionWorkspace {
    sphere_workspaces: SphereWorkspaces,
    exact: CheckerWorkspace,
    q_model: Vec<f64>,
    /// Configuration of the whole model at the start of a motion.
    q_from: Vec<f64>,
    /// Up to eight configurations, in sequence.
    group_configurations: Vec<f64>,
    /// Start configurations of attempts.
    seeds: Vec<f64>,
    /// Targets of these attempts.
    targets: Vec<Placement<f64>>,
    /// Number of solutions of a query that may still be checked by shapes.
    exact_checks_left: usize,
    /// Until when checks of solutions run: what is cut short counts as touching.
    deadline: Option<Instant>,
}

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
        self.with_checker_after(checker, q_model, None)
    }

    /// The same arm with a checker, sharing compiled parts of `previous`, of an arm of the same chain.
    fn with_checker_after(
        self,
        checker: &Checker,
        q_model: &[f64],
        previous: Option<&CollisionAvoidance>,
    ) -> Result<Self, ArmError> {
        let mut arm = self;
        let avoidance = CollisionAvoidance::new(&arm, checker, q_model, previous)?;
        arm.collisions = Some(Arc::new(avoidance));
        // A workspace of another checker is invalid.
        arm.for_each_workspace(|workspace| workspace.collision_workspace = None);
        Ok(arm)
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
        let simd_solver = self.simd_solver_for(&self.serial, &self.options)?;
        self.changed(self.serial.clone(), self.options.clone(), simd_solver)?
            .with_checker_after(&checker, &avoidance.rest, Some(avoidance))
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

    /// [`collisions`](Self::collisions), but empty for an arm without a checker.
    pub(crate) fn touching(&self, q: &[f64]) -> Result<Vec<Collision>, QueryError> {
        self.check_length("q", q.len(), self.joint_count())?;
        self.check_finite("q", q)?;
        match &self.collisions {
            Some(avoidance) => avoidance.collisions(self, &mut avoidance.workspace(), q),
            None => Ok(Vec::new()),
        }
    }

    /// Runs a function with a workspace and its buffers for collision checks.
    fn with_collision_workspace<T>(
        &self,
        avoidance: &CollisionAvoidance,
        run: impl FnOnce(&mut ArmWorkspace, &mut CollisionWorkspace) -> Result<T, QueryError>,
    ) -> Result<T, QueryError> {
        self.with_workspace(|workspace| {
            // Taken out and put back, so that nothing is allocated.
            let mut stored = workspace.collision_workspace.take();
            let checks = stored.get_or_insert_with(|| avoidance.workspace());
            checks.deadline = None;
            let result = run(workspace, checks);
            checks.deadline = None;
            workspace.collision_workspace = stored;
            result
        })?
    }
}

impl CollisionAvoidance {
    fn new(
        arm: &Arm,
        checker: &Checker,
        q_model: &[f64],
        previous: Option<&Self>,
    ) -> Result<Self, ArmError> {
        let model = checker.model().model();
        let (given, expected) = (
            model.configuration_len(),
            arm.coordinates.degrees_of_freedom,
        );
        if given != expected {
            return Err(ArmError::ForeignChecker { given, expected });
        }
        let mut rest = q_model.to_vec();
        let mut q = vec![0.0; arm.joint_count()];
        // The lengths were checked above.
        let _ = arm.joint_values(&rest, &mut q[..]);
        let _ = arm.configuration(&q, &mut rest);
        // Clamped to their limits, with the joints that the arm locks.
        let _ = arm.joint_values(&rest, &mut q[..]);
        let placements = ForwardKinematics::<f64>::new(model).place(&rest)?.to_vec();
        let arm_joints = ArmJoints {
            model,
            joints: &arm.serial.joints,
            base: arm.coordinates.base,
        };
        let rest_collisions = checker.collisions(&rest)?;
        let check_time = CheckTime::default();
        check_time.measured(arm, || checker.collisions(&rest))?;
        let never_free = rest_collisions
            .iter()
            .any(|pair| arm_joints.is_fixed(pair, checker));
        let chain = arm.serial.chain.as_ref();
        let updated = previous.and_then(|previous| previous.simd_checks_in(checker, &rest));
        let built = || {
            let (chain, spheres) = chain.zip(checker.spheres())?;
            SimdChecks::new(chain, &q, &placements, &arm_joints, checker, spheres)
        };
        let simd_checks = updated.or_else(built);
        let joints_to =
            |index: usize| arm_joints.joints_to(checker.model().links().get(index).copied());
        let is_movable = |pair: &&[usize; 2]| joints_to(pair[0]) != joints_to(pair[1]);
        Ok(Self {
            close_pairs: (checker.close_pairs().iter().filter(is_movable).copied()).collect(),
            cautious: checker.clone().with_stand_off(path_steps::STAND_OFF),
            checker: checker.clone(),
            rest,
            never_free,
            simd_checks,
            check_time,
        })
    }

    /// SIMD checks for a checker that differs only in its world.
    fn simd_checks_in(&self, checker: &Checker, rest: &[f64]) -> Option<SimdChecks> {
        let is_unchanged = checker.margin() == self.checker.margin() && rest == self.rest;
        let simd_checks = self.simd_checks.as_ref().filter(|_| is_unchanged)?;
        simd_checks.in_world(&self.checker, checker)
    }

    pub(super) fn checker(&self) -> &Checker {
        &self.checker
    }

    pub(super) fn rest(&self) -> &[f64] {
        &self.rest
    }

    pub(super) fn workspace(&self) -> CollisionWorkspace {
        CollisionWorkspace {
            sphere_workspaces: SphereWorkspaces::default(),
            exact: self.checker.workspace(),
            q_model: self.rest.clone(),
            q_from: self.rest.clone(),
            group_configurations: Vec::new(),
            seeds: Vec::new(),
            targets: Vec::new(),
            exact_checks_left: 0,
            deadline: None,
        }
    }

    /// Pairs that are too near at a configuration of the arm.
    pub(in crate::arm) fn collisions(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<Vec<Collision>, QueryError> {
        arm.configuration(q, &mut checks.q_model)?;
        let check = || {
            self.checker
                .collisions_with(&mut checks.exact, &checks.q_model)
        };
        Ok(self.check_time.measured(arm, check)?)
    }

    /// Returns the distance of the nearest pair at a configuration of the arm, metres. It is infinite if all pairs are free,
    /// and negative infinity if the check was cut short.
    fn min_distance(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<f64, QueryError> {
        arm.configuration(q, &mut checks.q_model)?;
        let check = || {
            self.checker
                .collisions_with(&mut checks.exact, &checks.q_model)
        };
        let Some(pairs) = until(checks.deadline, check) else {
            return Ok(f64::NEG_INFINITY);
        };
        Ok(pairs?.first().map_or(f64::INFINITY, |pair| pair.distance))
    }

    /// Returns true if all pairs are far enough apart, by the exact check.
    fn is_free(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<bool, QueryError> {
        arm.configuration(q, &mut checks.q_model)?;
        let check = || self.checker.is_free(&mut checks.exact, &checks.q_model);
        let free = until(checks.deadline, check);
        Ok(free.transpose()?.unwrap_or(false))
    }

    /// Checks a configuration that is not free by spheres by its shapes. Returns false if the first check was exact
    /// already.
    fn is_free_by_shapes(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<bool, QueryError> {
        Ok(!self.spheres_decide() && !self.never_free && self.is_free(arm, checks, q)?)
    }

    /// Returns true if a configuration is free by its spheres, or else by its shapes.
    fn is_clear(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<bool, QueryError> {
        let by_spheres = self.free_by_spheres(arm, checks, q)? & 1 != 0;
        match by_spheres {
            true => self.are_close_pairs_free(arm, checks, q),
            false => self.is_free_by_shapes(arm, checks, q),
        }
    }

    /// Checks the link pairs that are too close for spheres by their shapes, for a configuration free by spheres.
    fn are_close_pairs_free(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<bool, QueryError> {
        if self.close_pairs.is_empty() || self.simd_checks.is_none() {
            return Ok(true);
        }
        arm.configuration(q, &mut checks.q_model)?;
        let (pairs, exact) = (&self.close_pairs, &mut checks.exact);
        Ok(self.checker.are_apart(pairs, exact, &checks.q_model)?)
    }

    /// Bit mask of up to eight configurations that are free by their spheres, except for [close
    /// pairs](Self::are_close_pairs_free).
    ///
    /// Without spheres the shapes decide.
    fn free_by_spheres(
        &self,
        arm: &Arm,
        checks: &mut CollisionWorkspace,
        q: &[f64],
    ) -> Result<u32, QueryError> {
        let n = arm.joint_count();
        if self.never_free {
            return Ok(0);
        }
        let Some(simd_checks) = &self.simd_checks else {
            let mut free = 0;
            for (index, q) in q.chunks_exact(n).enumerate() {
                free |= u32::from(self.is_free(arm, checks, q)?) << index;
            }
            return Ok(free);
        };
        let near_bits = simd_spheres::near(
            &simd_checks.bodies,
            &simd_checks.solids,
            q,
            &mut checks.sphere_workspaces,
        );
        Ok(!near_bits & ((1 << (q.len() / n)) - 1))
    }

    /// Returns true if the first check is exact: the spheres are the shapes, or there are no SIMD checks.
    fn spheres_decide(&self) -> bool {
        let exact = self
            .checker
            .spheres()
            .is_some_and(|spheres| spheres.max_protrusion() == 0.0);
        self.simd_checks.is_none() || exact
    }
}

/// Joints and base of the arm in the checker's model.
struct ArmJoints<'a> {
    model: &'a Model,
    joints: &'a [JointId],
    base: Option<FrameId>,
}

impl ArmJoints<'_> {
    /// Joints of the arm above a frame.
    fn above(&self, frame: Option<FrameId>) -> Vec<JointId> {
        let mut above = Vec::new();
        let mut joint = frame.and_then(|frame| self.model.frames()[frame.index()].joint);
        while let Some(id) = joint {
            above.extend(self.joints.contains(&id).then_some(id));
            joint = self.model.joints()[id.index()].parent;
        }
        above
    }

    /// Number of the arm's joints between its base and a frame.
    fn joints_to(&self, frame: Option<FrameId>) -> usize {
        let (a, b) = (self.above(self.base), self.above(frame));
        let only_in = |a: &[JointId], b: &[JointId]| a.iter().filter(|id| !b.contains(id)).count();
        only_in(&a, &b) + only_in(&b, &a)
    }

    /// Returns true if no joint of the arm moves the two bodies relative to each other.
    fn is_fixed(&self, pair: &Collision, checker: &Checker) -> bool {
        let joints_to = |name: &str, kind: BodyKind| match kind {
            BodyKind::Link => self.joints_to(self.model.frame(name).ok()),
            BodyKind::Obstacle => {
                let obstacle = checker.world().obstacle(name).ok();
                let frame = obstacle.and_then(|obstacle| obstacle.attached.as_deref());
                self.joints_to(frame.and_then(|name| self.model.frame(name).ok()))
            }
        };
        joints_to(&pair.first, pair.first_kind) == joints_to(&pair.second, pair.second_kind)
    }
}

impl SimdChecks {
    /// Returns `None` if the arm moves the world relative to its base, carries an obstacle, or has a link without
    /// spheres.
    fn new(
        chain: &Chain,
        q: &[f64],
        placements: &[Placement<f64>],
        arm_joints: &ArmJoints<'_>,
        checker: &Checker,
        spheres: &SphereModel,
    ) -> Option<Self> {
        if arm_joints.joints_to(None) > 0 || checker.world().attached().next().is_some() {
            return None;
        }
        let base_from_world = match arm_joints.base {
            Some(base) => placements[base.index()].inverse(),
            None => Placement::identity(),
        };
        let bodies = spheres.groups().iter().map(|group| {
            let body = Body {
                joints: arm_joints.joints_to(Some(group.link)),
                bound: group.bound,
                spheres: group.spheres.clone(),
            };
            (body, base_from_world * placements[group.link.index()])
        });
        let bodies: Vec<_> = bodies.collect();
        // Pairs that no joint of the arm moves are checked once, by their shapes.
        let is_movable = |pair: &[usize; 2]| bodies[pair[0]].0.joints != bodies[pair[1]].0.joints;
        // Use the checker's pairs and links: the spheres may be older.
        let model = checker.model();
        let close = checker.close_pairs();
        let close = |pair: &&[FrameId; 2]| close.contains(&pair.map(|link| model.place_of(link)));
        let group_index = |link: &FrameId| spheres.groups().iter().position(|g| g.link == *link);
        if !model.links().iter().all(|link| group_index(link).is_some()) {
            return None;
        }
        let pairs = model.pairs().iter().filter(|pair| !close(pair));
        let pairs = pairs.filter_map(|[a, b]| Some([group_index(a)?, group_index(b)?]));
        let pairs = pairs.filter(is_movable).collect();
        let planes = checker.model().planes().iter().map(|plane| &plane.obstacle);
        let solids = checker.world().numbered();
        let solids = solids.chain((FIRST_PLANE..).zip(planes));
        let solids = solids.map(|(number, o)| (number, &o.shape, base_from_world * o.placement));
        let bodies = BodyChain::new(chain, q, bodies, pairs);
        Some(Self {
            solids: Solids::new(
                solids,
                &bodies,
                allowed_collisions(spheres, checker),
                checker.margin() + SLACK,
            ),
            bodies: Arc::new(bodies),
            base_from_world,
        })
    }

    /// The same in another world; `None` if the arm carries an obstacle there, or all solids must be rebuilt.
    fn in_world(&self, before: &Checker, after: &Checker) -> Option<Self> {
        if after.world().attached().next().is_some() {
            return None;
        }
        let allowed_collisions = allowed_collisions(after.spheres()?, after);
        let changes = before.world().changes(after.world());
        let moved = changes.iter().map(|change| SolidMoved {
            number: change.number,
            before: change.before.map(|obstacle| &obstacle.shape),
            after: (change.after).map(|o| (&o.shape, self.base_from_world * o.placement)),
        });
        let moved: Vec<SolidMoved<'_>> = moved.collect();
        Some(Self {
            solids: self
                .solids
                .changed(&moved, &self.bodies, &allowed_collisions)?,
            bodies: Arc::clone(&self.bodies),
            base_from_world: self.base_from_world,
        })
    }
}

/// Allowed collisions of the bodies of a sphere model.
fn allowed_collisions(spheres: &SphereModel, checker: &Checker) -> Passed {
    let groups = spheres.groups().iter();
    Passed::new(groups.map(|group| checker.passes_of(group.link)))
}
