//! One step of a path after another.
//!
//! A step begins where the last one would go on to: most of the last motion is added once more
//! (scaled by how far the target went), which takes the arm straight through singular
//! configurations where branches meet, and a little is taken off joints near their limits. The
//! solver corrects the pose and leaves the rest of that motion in the null space (Liégeois 1977,
//! "Automatic supervisory control of the configuration and behavior of multibody mechanisms").

use super::QueryError;
use super::query::Arm;
use super::report::Reply;
use crate::ik::Solution;
use crate::lanes;
use crate::spatial::Placement;

/// The share of the last motion that a step begins with. Less than all of it, so that motion in the
/// null space dies away.
const MOMENTUM: f64 = 0.8;
/// How fast a joint on its limit is pulled towards the middle of its range, radians a radian of
/// path (metres by the weight of the cost).
const CENTRING: f64 = 0.1;
/// Longest path step that pulls, radians.
const LONGEST_PULL: f64 = 0.1;
/// A step in which a joint moves further than this is looked at: radians; a slide counts by the
/// metres that weigh as much as a radian.
pub(super) const LONG_STEP: f64 = 0.2;

/// A step in which a joint moves further than 0.2 rad (or slides further than 0.2 times the
/// [metres that weigh as much](super::ArmBuilder::with_metres_per_radian)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// Which step: the place of its target in the path; the motion is from the one before.
    pub step: usize,
    /// The joint that moves furthest, by its place in [`Arm::joints`].
    pub joint: usize,
    /// How far it moves, radians; a slide by the metres that weigh as much.
    pub distance: f64,
    /// Whether small steps along the straight way between the two poses lead there: a fast motion
    /// or a coarse path. If not, the branch ended and this is a flip to another. Not looked at, and
    /// false, with bounded moves, a posture, or joints that follow others.
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
    target: Option<Placement<f64>>,
    /// How far the target went in the last step, radians.
    path: f64,
    steps: usize,
}

impl Arm {
    /// A follower that stands at `start`. Unlike [`track`](Self::track) it cannot know what comes;
    /// where a branch ends it jumps at once and says so.
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
            target: None,
            path: 0.0,
            steps: 0,
        })
    }

    /// The joint that moves furthest, and how far, radians (see [`LONG_STEP`] for slides).
    pub(super) fn longest_move(&self, from: &[f64], to: &[f64]) -> (usize, f64) {
        let mut longest = (0, 0.0);
        let angles = &self.names.variable_is_angle;
        for (i, ((a, b), is_angle)) in from.iter().zip(to).zip(angles).enumerate() {
            let moved = (a - b).abs();
            let moved = if *is_angle {
                moved
            } else {
                moved / self.options.metres_per_radian
            };
            if moved > longest.1 {
                longest = (i, moved);
            }
        }
        longest
    }

    /// How far apart two poses are, radians, metres counted by the weight of the cost.
    fn pose_distance(&self, a: &Placement<f64>, b: &Placement<f64>) -> f64 {
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

    /// Goes on to the next target. A step in which a joint moves far is told as a [`Jump`]. Nothing
    /// is allocated after the first few steps.
    ///
    /// # Errors
    /// As [`Arm::solve`].
    pub fn advance(
        &mut self,
        base_from_tool: impl Into<Placement<f64>>,
        solution: &mut Solution,
    ) -> Result<Option<Jump>, QueryError> {
        let target = base_from_tool.into();
        self.arm.check_query(self.steps, &target, &self.q)?;
        let mut continuous = self.try_branch(&target, None, solution);
        if !continuous {
            continuous = self.arm.rescue(&target, &self.q, solution)?;
        }
        let (joint, distance) = self.arm.longest_move(&self.q, &solution.q);
        let jump = (distance > LONG_STEP).then_some(Jump {
            step: self.steps,
            joint,
            distance,
            continuous,
        });
        self.stand_at(&target, &solution.q);
        Ok(jump)
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
        let search = lanes::Search::Start;
        let deadline = arm.deadline();
        // A budget of one iteration begins no other attempt.
        let outcome = lanes.solve_checked(
            target,
            &self.seed,
            search,
            1,
            deadline,
            true,
            &mut solution.q,
        );
        let kept = outcome.reached && arm.longest_move(&self.q, &solution.q).1 <= LONG_STEP;
        if kept {
            arm.report(&Reply::of(&outcome), solution);
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
        let pull = CENTRING * path.min(LONGEST_PULL);
        let rate = towards.map_or(0.0, |(_, rate)| rate) * path.min(LONGEST_PULL);
        let map = &self.arm.serial.map;
        let bounds = map.lower().iter().zip(map.upper());
        let motion = self.q.iter().zip(&self.before);
        for (i, ((value, (q, before)), (&lower, &upper))) in
            self.seed.iter_mut().zip(motion).zip(bounds).enumerate()
        {
            let last = q - before;
            // A jump is no motion to go on with.
            if last.abs() <= LONG_STEP {
                *value += share * last;
            }
            if let Some(wanted) = towards.and_then(|(wanted, _)| wanted.get(i)) {
                *value += (wanted - q).clamp(-rate, rate);
            } else {
                let half = 0.5 * (upper - lower);
                if half > 0.0 && half.is_finite() {
                    let u = (q - lower) / half - 1.0;
                    *value -= pull * u * u * u;
                }
            }
            *value = value.max(lower).min(upper);
        }
    }
}
