//! One step of a path after another.
//!
//! A step begins where the last one would go on to: most of the last motion is added once more
//! (scaled by how far the target went), which takes the arm straight through singular
//! configurations where branches meet. Of a redundant arm's motion, what leaves the tool where it is
//! goes to [ease](super::redundancy) instead. The solver corrects the pose.

use super::arm::Arm;
use super::branch::Branch;
use super::redundancy::SHARE;
use super::workspace::Errors;
use super::{QueryError, Reply};
use crate::ik::Solution;
use crate::search::Found;
use crate::solver::Termination;
use crate::spatial::Placement;

/// The share of the last motion that a step begins with. Less than all of it, so that motion in the
/// null space dies away.
const MOMENTUM: f64 = 0.8;
/// A target that goes further than this in a step is followed by small steps: radians.
const FAR: f64 = 0.05;
/// Longest path step that draws to another way, radians.
const LONGEST_PULL: f64 = 0.1;
/// The longest motion to ease in a step, radians.
pub(super) const LONGEST_EASE: f64 = 0.02;
/// A step in which a joint moves further than this is looked at: radians; a slide counts by the
/// metres that weigh as much as a radian.
pub(super) const LONG_STEP: f64 = 0.2;

/// A step in which a joint moves further than 0.2 rad (or slides further than 0.2 times the
/// [metres that weigh as much](super::ArmBuilder::with_metres_per_radian)).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Jump {
    /// Which step: the place of its target in the path; the motion is from the one before.
    pub step: usize,
    /// The joint that moves furthest, by its place in [`Arm::joints`].
    pub joint: usize,
    /// How far it moves, radians; a slide by the metres that weigh as much.
    pub distance: f64,
    /// Whether small steps along the straight way between the two poses lead there: a fast motion
    /// or a coarse path. If not, the branch ended and this is a flip to another, which an arm makes only
    /// where it is [asked](super::ArmBuilder::with_global_search_on_miss) to.
    pub continuous: bool,
}

/// Follows a path whose targets come one at a time: see [`Arm::follower`].
#[derive(Clone, Debug)]
pub struct Follower<'a> {
    arm: &'a Arm,
    /// Where the last step ended, and the one before.
    q: Vec<f64>,
    before: Vec<f64>,
    seed: Vec<f64>,
    /// What a step begins with, radians.
    motion: Vec<f64>,
    branch: Branch,
    target: Option<Placement<f64>>,
    /// How far the target went in the last step, radians.
    path: f64,
    steps: usize,
}

impl Arm {
    /// A follower that stands at `start`. A target that the branch does not reach is answered by the
    /// nearest place on it, and the arm comes back from there as it came: an elbow on the side that it was on,
    /// and a redundant arm's freedom to the posture that it began in (or that was
    /// [asked for](super::ArmBuilder::with_posture)), for which it goes on where its target rests. It never
    /// leaves the branch, unless it is [asked](super::ArmBuilder::with_global_search_on_miss) to, and then says so.
    /// Joints that start outside their limits return first, by at most 0.2 rad a step; no such step is reached.
    /// For velocity limits see [`servo`](Self::servo).
    ///
    /// # Errors
    /// A start of the wrong length or not finite.
    pub fn follower(&self, start: &[f64]) -> Result<Follower<'_>, QueryError> {
        self.check_length("the start", start.len(), self.joint_count())?;
        self.check_query(0, &Placement::identity(), start)?;
        Ok(Follower {
            arm: self,
            q: start.to_vec(),
            before: start.to_vec(),
            seed: start.to_vec(),
            motion: vec![0.0; start.len()],
            branch: Branch::begin(self, start),
            target: None,
            path: 0.0,
            steps: 0,
        })
    }

    /// The joint that moves furthest, and how far, radians (see [`LONG_STEP`] for slides).
    pub(super) fn longest_move(&self, from: &[f64], to: &[f64]) -> (usize, f64) {
        let mut longest = (0, 0.0);
        for (i, ((a, b), scale)) in from.iter().zip(to).zip(&self.scale).enumerate() {
            let moved = (a - b).abs() * scale;
            if moved > longest.1 {
                longest = (i, moved);
            }
        }
        longest
    }

    /// How far apart two poses are, radians, metres counted by the weight of the cost.
    pub(super) fn pose_distance(&self, a: &Placement<f64>, b: &Placement<f64>) -> f64 {
        let way = (a.translation - b.translation) * self.options.metres_per_radian.recip();
        let (r, s) = (&a.rotation, &b.rotation);
        let turn =
            (r.x - s.x).norm_squared() + (r.y - s.y).norm_squared() + (r.z - s.z).norm_squared();
        (way.norm_squared() + 0.5 * turn).sqrt()
    }
}

impl Follower<'_> {
    /// Where the last step ended.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Goes on to the next target. No joint moves further than 0.2 rad (a slide by the metres that weigh
    /// as much) but in a [`Jump`], which is reported: after a target that went far itself, or where jumps
    /// are asked for. Where a step ends short of the nearest place the next goes on. Nothing is
    /// allocated after the first few steps.
    ///
    /// # Errors
    /// As [`Arm::solve`].
    pub fn advance(
        &mut self,
        base_from_tool: impl Into<Placement<f64>>,
        solution: &mut Solution,
    ) -> Result<Option<Jump>, QueryError> {
        let target = base_from_tool.into();
        let arm = self.arm;
        arm.check_query(self.steps, &target, &self.q)?;
        if self.is_outside() {
            self.return_to_limits(&target, solution)?;
            return Ok(self.take(&target, solution, true));
        }
        self.branch.take_target(self.target == Some(target));
        // Out of reach branches meet: the way back is taken with care.
        let careful = self.branch.asks_for_care() && !self.goes_far(&target)?;
        let mut continuous = careful && self.settle(&target, solution)?;
        let settled = continuous || careful && self.branch.is_stretched();
        if !settled {
            continuous = self.try_branch(&target, None, solution)
                || self.goes_far(&target)? && arm.go_far(&target, &self.q, solution)?
                || self.settle(&target, solution)?;
        }
        if !solution.reached && arm.options.leaps {
            arm.leap(&target, &self.q, solution)?;
        }
        #[cfg(feature = "collision")]
        arm.keep_way_clear(&self.q, &target, solution)?;
        Ok(self.take(&target, solution, continuous))
    }

    /// Whether a joint is outside its limits, as it may be where the follower began.
    fn is_outside(&self) -> bool {
        let mut joints = self.arm.limits().zip(&self.q);
        joints.any(|(limits, q)| !limits.contains(*q))
    }

    /// Moves the joints that are outside their limits towards them, by at most [`LONG_STEP`]; the others keep still.
    fn return_to_limits(&mut self, target: &Placement<f64>, solution: &mut Solution) -> Reply<()> {
        let (arm, q) = (self.arm, &self.q);
        arm.with_workspace(|workspace| {
            workspace.aim(target);
            arm.bound_by_limits(workspace);
            for (i, limits) in arm.limits().enumerate() {
                // Less by rounding, so that no step counts as long.
                let most = (1.0 - 1e-9) * LONG_STEP / arm.scale[i];
                workspace.x[i] = q[i] + (limits.clamp(q[i]) - q[i]).clamp(-most, most);
            }
            let mut found = Found::alone(Termination::IterationLimit, 0);
            arm.judge(workspace, &mut found);
            let mut joints = arm.limits().zip(&workspace.x);
            let inside = joints.all(|(limits, x)| limits.contains(*x));
            found.reached &= inside;
            workspace.errors.reached &= inside;
            arm.tell_place(&found, workspace, solution);
        })
    }

    /// Goes on to a target on the own branch, with care; whether that reaches it.
    fn settle(&mut self, target: &Placement<f64>, solution: &mut Solution) -> Reply<bool> {
        self.arm
            .keep_to_branch(target, &self.q, &mut self.branch, solution)?;
        Ok(solution.reached)
    }

    /// Stands where a step ends; the jump that it was.
    fn take(
        &mut self,
        target: &Placement<f64>,
        solution: &Solution,
        continuous: bool,
    ) -> Option<Jump> {
        let (joint, distance) = self.arm.longest_move(&self.q, &solution.q);
        let jump = (distance > LONG_STEP).then_some(Jump {
            step: self.steps,
            joint,
            distance,
            continuous,
        });
        self.stand_at(target, &solution.q);
        if jump.is_some() {
            self.branch.jump_to(&solution.q, solution.reached);
        } else if solution.reached {
            self.branch.arrive_at(self.arm, &solution.q);
        }
        jump
    }

    /// As [`advance`](Self::advance) for the first target of a whole path, to which the arm comes from
    /// wherever it stands.
    pub(super) fn begin(
        &mut self,
        target: Placement<f64>,
        solution: &mut Solution,
    ) -> Reply<Option<Jump>> {
        if !self.goes_far(&target)? {
            return self.advance(target, solution);
        }
        let arm = self.arm;
        let continuous = arm.go_far(&target, &self.q, solution)?;
        #[cfg(feature = "collision")]
        let continuous = continuous && arm.touching(&solution.q)?.is_empty();
        if !continuous {
            arm.answer(&arm.query(&target, &self.q), solution)?;
        }
        Ok(self.take(&target, solution, continuous))
    }

    /// Whether a target is far from the last one, at first from the tool.
    fn goes_far(&self, target: &Placement<f64>) -> Reply<bool> {
        let last = match self.target {
            Some(last) => last,
            None => self.arm.base_from_tool(&self.q)?,
        };
        Ok(self.arm.pose_distance(target, &last) > FAR)
    }

    /// Tries to go on to a target by the step's own attempt alone; whether that reaches it with no
    /// long move. `towards` draws the null space to a configuration, a joint by at most so many
    /// radians a radian of path.
    pub(super) fn try_branch(
        &mut self,
        target: &Placement<f64>,
        towards: Option<(&[f64], f64)>,
        solution: &mut Solution,
    ) -> bool {
        let arm = self.arm;
        let (Some(lanes), true) = (&arm.lanes, arm.follows_by_lanes()) else {
            return false;
        };
        self.fill_seed(target, towards);
        solution.q.resize(arm.joint_count(), 0.0);
        let outcome = lanes.own_attempt(target, &self.seed, arm.deadline(), &mut solution.q);
        let kept = outcome.reached && arm.longest_move(&self.q, &solution.q).1 <= LONG_STEP;
        if kept {
            arm.tell(&arm.found_by(&outcome), Errors::of(&outcome), solution);
        }
        kept
    }

    /// Takes a step's end as the place to go on from.
    pub(super) fn stand_at(&mut self, target: &Placement<f64>, q: &[f64]) {
        let last = self.target.replace(*target);
        self.path = last.map_or(0.0, |last| self.arm.pose_distance(target, &last));
        self.before.copy_from_slice(&self.q);
        self.q.copy_from_slice(q);
        self.steps += 1;
    }

    /// Says how many steps of the path are behind.
    pub(super) fn set_steps(&mut self, steps: usize) {
        self.steps = steps;
    }

    /// Takes another posture to spend the freedom on than where it began.
    pub(super) fn set_ease(&mut self, start: &[f64]) {
        self.branch.set_ease(self.arm, start);
    }

    /// Where the next attempt begins.
    fn fill_seed(&mut self, target: &Placement<f64>, towards: Option<(&[f64], f64)>) {
        self.seed.copy_from_slice(&self.q);
        let Some(last) = &self.target else {
            return;
        };
        let path = self.arm.pose_distance(target, last);
        let share = if self.path > 0.0 {
            MOMENTUM * (path / self.path).min(1.0)
        } else {
            0.0
        };
        let scales = &self.arm.scale;
        let motion = self.q.iter().zip(&self.before).zip(scales);
        for (by, ((q, before), scale)) in self.motion.iter_mut().zip(motion) {
            let last = q - before;
            // A jump is no motion to go on with.
            *by = match last.abs() * scale <= LONG_STEP {
                true => share * last * scale,
                false => 0.0,
            };
        }
        if let Some((wanted, rate)) = towards {
            let rate = rate * path.min(LONGEST_PULL);
            let ways = wanted.iter().zip(&self.q).zip(scales);
            for (by, ((wanted, q), scale)) in self.motion.iter_mut().zip(ways) {
                *by += ((wanted - q) * scale).clamp(-rate, rate);
            }
        } else if self.branch.spends_freedom(self.arm) {
            self.ease_motion(target);
        }
        let map = &self.arm.serial.map;
        let bounds = map.lower().iter().zip(map.upper());
        let ends = self.motion.iter().zip(scales).zip(bounds);
        for (value, ((by, scale), (&lower, &upper))) in self.seed.iter_mut().zip(ends) {
            *value = (*value + by / scale).max(lower).min(upper);
        }
    }

    /// What of the motion leaves the tool where it is goes to ease instead.
    fn ease_motion(&mut self, target: &Placement<f64>) {
        let (arm, q, motion) = (self.arm, &self.q, &mut self.motion);
        let branch = &mut self.branch;
        // Without memory for it the motion is left; the step itself will say so.
        let _ = arm.with_workspace(|workspace| {
            workspace.aim(target);
            arm.bound_by_limits(workspace);
            workspace.take_twists(arm, q);
            let free = workspace.factor_freely(q);
            match &free {
                Some(factor) => workspace.project_freely(factor, motion),
                None => workspace.project_to_null(q, motion, 0.0),
            };
            for (motion, by) in motion.iter_mut().zip(&workspace.projected) {
                *motion -= by;
            }
            branch.aim_at_ease(arm, workspace, q, LONGEST_EASE, SHARE, free.as_ref());
            for (motion, by) in motion.iter_mut().zip(&workspace.projected) {
                *motion += by;
            }
        });
    }
}
