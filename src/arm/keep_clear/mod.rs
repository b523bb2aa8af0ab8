//! What an arm keeps clear of, compiled for its chain.

mod along_freedom;
mod by_spheres;
mod check_time;
mod least_deep;
mod many_configurations;
mod path_steps;
mod search;

use std::sync::Arc;

use self::check_time::CheckTime;
use super::arm::Arm;
use super::workspace::ArmWorkspace;
use super::{ArmError, QueryError, Reply};
use crate::clock::Instant;
use crate::clock::cut_short::until;
use crate::collision::in_lanes::{self, Body, BodyChain, Passed, Rooms, SolidMoved, Solids};
use crate::collision::{Checker, CheckerWorkspace, FIRST_PLANE, SphereModel, World};
use crate::kinematics::ForwardKinematics;
use crate::lanes::Chain;
use crate::model::{FrameId, JointId, Model};
use crate::search::{BodyKind, Collision};
use crate::spatial::Placement;

/// Lanes and the exact check place parts by different roundings: so much nearer counts in lanes, metres.
const SLACK: f64 = 1e-9;

/// A checker for the configurations of one arm.
#[derive(Debug)]
pub(super) struct KeepClear {
    checker: Checker,
    /// The same farther off, where steps are to stop.
    cautious: Checker,
    /// A configuration of the whole model: what is not the arm's keeps still there.
    rest: Vec<f64>,
    /// Something is too near that no joint of the arm moves: nothing is free.
    never_free: bool,
    /// Where the chain can be placed in lanes and there are spheres.
    lanes: Option<InLanes>,
    /// Pairs of links that lanes leave out, by their places in the checker's model: they are too close for spheres to tell.
    close_pairs: Vec<[usize; 2]>,
    check_time: CheckTime,
}

/// Spheres and solids in the base's frame.
#[derive(Debug)]
struct InLanes {
    bodies: Arc<BodyChain>,
    solids: Solids,
    base_from_world: Placement<f64>,
}

/// Room for checks.
#[derive(Clone, Debug)]
pub(super) struct ClearRoom {
    rooms: Rooms,
    exact: CheckerWorkspace,
    q_model: Vec<f64>,
    /// Where a way begins.
    q_from: Vec<f64>,
    /// Up to eight configurations.
    several: Vec<f64>,
    /// Where attempts begin, and their targets.
    seeds: Vec<f64>,
    targets: Vec<Placement<f64>>,
    /// How many more solutions of a question may be looked at by their shapes.
    by_shapes: usize,
    /// Until when checks of solutions run: what is cut short counts as touching.
    deadline: Option<Instant>,
}

impl Arm {
    /// The same arm, kept clear of a world and of itself: a solution is reached only if all pairs are at least the checker's
    /// margin apart, by the exact distances of shapes. `q_model` (the length of a configuration of the checker's model, which is the
    /// arm's own) says where the joints that are not the arm's stand meanwhile. The seed atlas is shared, so that an arm
    /// for a world that changed takes microseconds.
    ///
    /// Where the answer of a plain arm touches something, further attempts follow, checked eight at a time, until one is
    /// free, and where none is, the one that touches least is moved along the freedom that the target leaves. Which solution is wanted stays what
    /// the [search](super::Search) says: the first attempt from the start that is free, or the nearest that is. What no joint of the
    /// arm moves, as the base on its table, is judged once, by its shapes: where it touches, no solution is free, and none is searched for.
    ///
    /// Paths, followers and servos stop before they touch: a step is cut short where the way to its end, on which all joints move
    /// evenly, is not surely [free](Checker::way), unless the freedom that a target leaves goes round; its solution is not reached and
    /// says what is in the way. Steps after it go on from there. What touches where a step begins comes no nearer in it, and parts where the
    /// path leads away ([`Checker::way_from_contact`]); no step is reached until it has.
    ///
    /// # Errors
    /// A checker of another model, or a configuration of the wrong length or not finite.
    pub fn with_checker(self, checker: &Checker, q_model: &[f64]) -> Result<Self, ArmError> {
        self.with_checker_after(checker, q_model, None)
    }

    /// The same, sharing what the arm of the same chain that has `before` need not make anew.
    fn with_checker_after(
        self,
        checker: &Checker,
        q_model: &[f64],
        before: Option<&KeepClear>,
    ) -> Result<Self, ArmError> {
        let mut arm = self;
        let kept = KeepClear::new(&arm, checker, q_model, before)?;
        arm.collisions = Some(Arc::new(kept));
        // Room for another checker is none.
        arm.for_each_workspace(|workspace| workspace.clear_room = None);
        Ok(arm)
    }

    /// The same arm in another world, as that stands now, with another margin (metres) or the same; it shares the seed atlas.
    ///
    /// # Errors
    /// An arm without a [checker](Self::with_checker), a margin that is negative or not finite, an obstacle attached to a
    /// frame that the robot does not have.
    pub fn with_world(
        &self,
        world: &World,
        margin: impl Into<Option<f64>>,
    ) -> Result<Self, ArmError> {
        let Some(kept) = &self.collisions else {
            return Err(ArmError::Conflict(
                "the arm was made without a world or a margin to keep clear of, so it has none to exchange",
            ));
        };
        let margin = margin.into().unwrap_or(kept.checker.margin());
        let checker = kept
            .checker
            .clone()
            .with_world(world)?
            .with_margin(margin)?;
        let lanes = self.lanes_for(&self.serial, &self.options)?;
        self.changed(self.serial.clone(), self.options.clone(), lanes)?
            .with_checker_after(&checker, &kept.rest, Some(kept))
    }

    /// Whether the arm was given something to keep clear of.
    pub(super) fn keeps_clear(&self) -> bool {
        self.collisions.is_some()
    }

    /// The pairs that are nearer to each other than the margin at a configuration of the arm, the deepest first.
    ///
    /// # Errors
    /// An arm without a [checker](Self::with_checker), of which it is not known what it touches; a configuration of the wrong length, or
    /// one that is not finite.
    pub fn collisions(&self, q: &[f64]) -> Result<Vec<Collision>, QueryError> {
        match self.keeps_clear() {
            true => self.touching(q),
            false => Err(QueryError::NothingToKeepClearOf),
        }
    }

    /// The same; nothing where there is nothing to keep clear of.
    pub(crate) fn touching(&self, q: &[f64]) -> Result<Vec<Collision>, QueryError> {
        self.check_length("q", q.len(), self.joint_count())?;
        self.check_finite("q", q)?;
        match &self.collisions {
            Some(kept) => kept.collisions(self, &mut kept.room(), q),
            None => Ok(Vec::new()),
        }
    }

    /// Lends a workspace, and the room in it for what is checked.
    fn with_room<T>(
        &self,
        kept: &KeepClear,
        run: impl FnOnce(&mut ArmWorkspace, &mut ClearRoom) -> Reply<T>,
    ) -> Reply<T> {
        self.with_workspace(|workspace| {
            // Taken out and put back, so that nothing is allocated.
            let mut taken = workspace.clear_room.take();
            let room = taken.get_or_insert_with(|| kept.room());
            room.deadline = None;
            let out = run(workspace, room);
            room.deadline = None;
            workspace.clear_room = taken;
            out
        })?
    }
}

impl KeepClear {
    fn new(
        arm: &Arm,
        checker: &Checker,
        q_model: &[f64],
        before: Option<&Self>,
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
        // The lengths were checked.
        let _ = arm.joint_values(&rest, &mut q[..]);
        let _ = arm.configuration(&q, &mut rest);
        // As they stand within their limits, with the joints that the arm has locked.
        let _ = arm.joint_values(&rest, &mut q[..]);
        let placed = ForwardKinematics::<f64>::new(model).place(&rest)?.to_vec();
        let own = Own {
            model,
            joints: &arm.serial.joints,
            base: arm.coordinates.base,
        };
        let at_rest = checker.collisions(&rest)?;
        let check_time = CheckTime::default();
        check_time.measured(arm, || checker.collisions(&rest))?;
        let never_free = at_rest.iter().any(|pair| own.is_fixed(pair, checker));
        let chain = arm.serial.chain.as_ref();
        let changed = before.and_then(|before| before.lanes_in(checker, &rest));
        let anew = || {
            let (chain, spheres) = chain.zip(checker.spheres())?;
            InLanes::new(chain, &q, &placed, &own, checker, spheres)
        };
        let lanes = changed.or_else(anew);
        let joints_to = |place: usize| own.joints_to(checker.model().links().get(place).copied());
        let moves = |pair: &&[usize; 2]| joints_to(pair[0]) != joints_to(pair[1]);
        Ok(Self {
            close_pairs: (checker.close_pairs().iter().filter(moves).copied()).collect(),
            cautious: checker.clone().with_stand_off(path_steps::STAND_OFF),
            checker: checker.clone(),
            rest,
            never_free,
            lanes,
            check_time,
        })
    }

    /// The same lanes for a checker of the same shapes, where only its world is different.
    fn lanes_in(&self, checker: &Checker, rest: &[f64]) -> Option<InLanes> {
        let same = checker.margin() == self.checker.margin() && rest == self.rest;
        let lanes = self.lanes.as_ref().filter(|_| same)?;
        lanes.in_world(&self.checker, checker)
    }

    pub(super) fn checker(&self) -> &Checker {
        &self.checker
    }

    pub(super) fn rest(&self) -> &[f64] {
        &self.rest
    }

    pub(super) fn room(&self) -> ClearRoom {
        ClearRoom {
            rooms: Rooms::default(),
            exact: self.checker.workspace(),
            q_model: self.rest.clone(),
            q_from: self.rest.clone(),
            several: Vec::new(),
            seeds: Vec::new(),
            targets: Vec::new(),
            by_shapes: 0,
            deadline: None,
        }
    }

    /// The pairs that are too near at a configuration of the arm.
    pub(in crate::arm) fn collisions(
        &self,
        arm: &Arm,
        room: &mut ClearRoom,
        q: &[f64],
    ) -> Reply<Vec<Collision>> {
        arm.configuration(q, &mut room.q_model)?;
        let check = || self.checker.collisions_with(&mut room.exact, &room.q_model);
        Ok(self.check_time.measured(arm, check)?)
    }

    /// How far the two are apart that are worst at a configuration of the arm, metres; infinite where all pairs are free, and negative
    /// infinity where the check was cut short.
    fn worst(&self, arm: &Arm, room: &mut ClearRoom, q: &[f64]) -> Reply<f64> {
        arm.configuration(q, &mut room.q_model)?;
        let check = || self.checker.collisions_with(&mut room.exact, &room.q_model);
        let Some(pairs) = until(room.deadline, check) else {
            return Ok(f64::NEG_INFINITY);
        };
        Ok(pairs?.first().map_or(f64::INFINITY, |pair| pair.distance))
    }

    /// Whether all pairs are far enough apart, by the exact check.
    fn is_free(&self, arm: &Arm, room: &mut ClearRoom, q: &[f64]) -> Reply<bool> {
        arm.configuration(q, &mut room.q_model)?;
        let check = || self.checker.is_free(&mut room.exact, &room.q_model);
        let free = until(room.deadline, check);
        Ok(free.transpose()?.unwrap_or(false))
    }

    /// Whether one that is not surely free by its spheres is so by its shapes: never where spheres are all there is to know.
    fn is_free_by_shapes(&self, arm: &Arm, room: &mut ClearRoom, q: &[f64]) -> Reply<bool> {
        Ok(!self.spheres_decide() && !self.never_free && self.is_free(arm, room, q)?)
    }

    /// Whether one configuration is free: by its spheres, or where these do not tell by its shapes.
    fn is_clear(&self, arm: &Arm, room: &mut ClearRoom, q: &[f64]) -> Reply<bool> {
        let by_spheres = self.free_by_spheres(arm, room, q)? & 1 != 0;
        match by_spheres {
            true => self.close_are_apart(arm, room, q),
            false => self.is_free_by_shapes(arm, room, q),
        }
    }

    /// Whether one that is free by its spheres is so by the shapes of those links too that are too close for spheres.
    fn close_are_apart(&self, arm: &Arm, room: &mut ClearRoom, q: &[f64]) -> Reply<bool> {
        if self.close_pairs.is_empty() || self.lanes.is_none() {
            return Ok(true);
        }
        arm.configuration(q, &mut room.q_model)?;
        let (pairs, exact) = (&self.close_pairs, &mut room.exact);
        Ok(self.checker.are_apart(pairs, exact, &room.q_model)?)
    }

    /// Which of up to eight configurations, bit by bit, are free by their spheres but for [close pairs](Self::close_are_apart), or without
    /// spheres by all shapes.
    fn free_by_spheres(&self, arm: &Arm, room: &mut ClearRoom, q: &[f64]) -> Reply<u32> {
        let n = arm.joint_count();
        if self.never_free {
            return Ok(0);
        }
        let Some(lanes) = &self.lanes else {
            let mut free = 0;
            for (place, q) in q.chunks_exact(n).enumerate() {
                free |= u32::from(self.is_free(arm, room, q)?) << place;
            }
            return Ok(free);
        };
        let near = in_lanes::near(&lanes.bodies, &lanes.solids, q, &mut room.rooms);
        Ok(!near & ((1 << (q.len() / n)) - 1))
    }

    /// Whether spheres are all there is to know: they are the shapes, or are all that is looked at.
    fn spheres_decide(&self) -> bool {
        let exact = self
            .checker
            .spheres()
            .is_some_and(|spheres| spheres.overhang() == 0.0);
        self.lanes.is_none() || exact
    }
}

/// The arm in its model.
struct Own<'a> {
    model: &'a Model,
    joints: &'a [JointId],
    base: Option<FrameId>,
}

impl Own<'_> {
    /// The arm's joints above a frame.
    fn above(&self, frame: Option<FrameId>) -> Vec<JointId> {
        let mut above = Vec::new();
        let mut joint = frame.and_then(|frame| self.model.frames()[frame.index()].joint);
        while let Some(id) = joint {
            above.extend(self.joints.contains(&id).then_some(id));
            joint = self.model.joints()[id.index()].parent;
        }
        above
    }

    /// How many of the arm's joints are on the way from its base to a frame.
    fn joints_to(&self, frame: Option<FrameId>) -> usize {
        let (a, b) = (self.above(self.base), self.above(frame));
        let only_in = |a: &[JointId], b: &[JointId]| a.iter().filter(|id| !b.contains(id)).count();
        only_in(&a, &b) + only_in(&b, &a)
    }

    /// Whether no joint of the arm moves two things against each other.
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

impl InLanes {
    /// `None` where the arm moves the world in its base's frame, where it carries an obstacle, which has no spheres, and where a link
    /// has none.
    fn new(
        chain: &Chain,
        q: &[f64],
        placed: &[Placement<f64>],
        own: &Own<'_>,
        checker: &Checker,
        spheres: &SphereModel,
    ) -> Option<Self> {
        if own.joints_to(None) > 0 || checker.world().attached().next().is_some() {
            return None;
        }
        let base_from_world = match own.base {
            Some(base) => placed[base.index()].inverse(),
            None => Placement::identity(),
        };
        let bodies = spheres.groups().iter().map(|group| {
            let body = Body {
                joints: own.joints_to(Some(group.link)),
                bound: group.bound,
                spheres: group.spheres.clone(),
            };
            (body, base_from_world * placed[group.link.index()])
        });
        let bodies: Vec<_> = bodies.collect();
        // Those that no joint of the arm moves against each other are as they are: judged once, by their shapes.
        let counts = |pair: &[usize; 2]| bodies[pair[0]].0.joints != bodies[pair[1]].0.joints;
        // The checker's own pairs and links: spheres may have been made before those were changed.
        let model = checker.model();
        let close = checker.close_pairs();
        let close = |pair: &&[FrameId; 2]| close.contains(&pair.map(|link| model.place_of(link)));
        let place = |link: &FrameId| spheres.groups().iter().position(|g| g.link == *link);
        if !model.links().iter().all(|link| place(link).is_some()) {
            return None;
        }
        let pairs = model.pairs().iter().filter(|pair| !close(pair));
        let pairs = pairs.filter_map(|[a, b]| Some([place(a)?, place(b)?]));
        let pairs = pairs.filter(counts).collect();
        let planes = checker.model().planes().iter().map(|plane| &plane.obstacle);
        let solids = checker.world().numbered();
        let solids = solids.chain((FIRST_PLANE..).zip(planes));
        let solids = solids.map(|(number, o)| (number, &o.shape, base_from_world * o.placement));
        let bodies = BodyChain::new(chain, q, bodies, pairs);
        Some(Self {
            solids: Solids::new(
                solids,
                &bodies,
                passed(spheres, checker),
                checker.margin() + SLACK,
            ),
            bodies: Arc::new(bodies),
            base_from_world,
        })
    }

    /// The same in another world; `None` where the arm carries something there, and where all solids are to be looked at in another way.
    fn in_world(&self, before: &Checker, after: &Checker) -> Option<Self> {
        if after.world().attached().next().is_some() {
            return None;
        }
        let passed = passed(after.spheres()?, after);
        let changes = before.world().changes(after.world());
        let moved = changes.iter().map(|change| SolidMoved {
            number: change.number,
            before: change.before.map(|obstacle| &obstacle.shape),
            after: (change.after).map(|o| (&o.shape, self.base_from_world * o.placement)),
        });
        let moved: Vec<SolidMoved<'_>> = moved.collect();
        Some(Self {
            solids: self.solids.changed(&moved, &self.bodies, &passed)?,
            bodies: Arc::clone(&self.bodies),
            base_from_world: self.base_from_world,
        })
    }
}

/// What the bodies of a sphere model may touch.
fn passed(spheres: &SphereModel, checker: &Checker) -> Passed {
    let groups = spheres.groups().iter();
    Passed::new(groups.map(|group| checker.passes_of(group.link)))
}
