//! The servo's door: one target a tick, velocity limits and joint limits kept to the bit.
//!
//! A tick moves the joints within the box that their limits and velocity limits leave, to where the
//! pose's cost and a small price on moving are together lowest. That price damps the arm near singular
//! configurations (Wampler 1986, "Manipulator inverse kinematic solutions based on vector formulations
//! and damped least-squares methods"); where the target rests it fades, so that the arm comes to rest at the
//! nearest place and not on a long way there. A tick begins where the arm's [branch](super::branch) leads.

use super::arm::Arm;
use super::branch::Branch;
use super::follower::{LONG_STEP, LONGEST_EASE};
use super::pose_question::PoseQuestion;
use super::settling::Settling;
use super::workspace::{ArmWorkspace, Errors};
use super::{ArmError, QueryError};
use crate::bad_option::{AT_LEAST_0, BadOption, NOT_NEGATIVE};
use crate::ik::Side;
use crate::search::{Collision, within};
use crate::solver::Termination;
use crate::spatial::Placement;

/// Steps of one tick; the next tick goes on from there.
const STEPS: usize = 8;
/// The longest move of a joint without a velocity limit in a tick, radians.
const UNLIMITED_STEP: f64 = 0.5 * LONG_STEP;
/// The damping where nothing else is asked for, radians.
const DAMPING: f64 = 0.01;
/// The damping that is left a tick where the target rests, as a share of the last one's: it calms motion, and
/// would make the arm creep to the nearest place to a target hardly out of reach.
const FADING: f64 = 0.7;
/// The share of a joint's speed that freedom is spent with while the target moves.
const SPEED_OF_EASE: f64 = 0.5;
/// The share of a joint's speed that a stretched arm leans with.
const SPEED_OF_LEANING: f64 = 0.5;

/// How a tick stands to its target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ServoStatus {
    /// Within the tolerances.
    OnTarget,
    /// On its way, at the speed that some joint's velocity limit allows.
    SpeedLimited,
    /// On its way, held back by the damping alone.
    #[default]
    Settling,
    /// At rest at the nearest place of its branch; the target is out of reach there.
    Nearest,
    /// Stopped, as going on would touch something that the arm [keeps clear of](Arm::with_checker); nothing is touched.
    Blocked,
    /// Something still touches that did where the servo began: it comes no nearer, stopped where the target leads farther in, and parts
    /// where targets lead away.
    Touching,
}

/// What holds a joint back in a tick: it would lower the error by going on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum HeldBy {
    /// Its limit on this side.
    Limit(Side),
    /// Its velocity limit towards this side.
    Speed(Side),
}

/// One tick of a [`Servo`]: where the arm stands after it, and the truth about it.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ServoStep<'s> {
    /// The joints, radians or metres, within their limits to the bit.
    pub q: &'s [f64],
    /// How far the joints went in this tick by its time, radians or metres a second.
    pub velocity: &'s [f64],
    /// How it stands to the target.
    pub status: ServoStatus,
    /// Distance of the tool from its target, metres.
    pub position_error: f64,
    /// Angle between the tool and its target, radians.
    pub orientation_error: f64,
    /// What is in the way, or touches where the arm stands, the deepest first; none on target.
    pub collisions: &'s [Collision],
    held: &'s [Option<HeldBy>],
    names: &'s [String],
}

impl<'s> ServoStep<'s> {
    /// The joints that are held back, by name, and by what.
    pub fn held(&self) -> impl Iterator<Item = (&'s str, HeldBy)> + 's {
        let joints = self.names.iter().zip(self.held);
        joints.filter_map(|(name, held)| held.map(|by| (name.as_str(), by)))
    }

    /// Whether the tool is within the tolerances of its target, and nothing touches.
    #[must_use]
    pub fn reached(&self) -> bool {
        self.status == ServoStatus::OnTarget
    }
}

/// Follows targets that come at a fixed rate, with bounded joint speeds: see [`Arm::servo`].
#[derive(Clone, Debug)]
pub struct Servo<'a> {
    arm: &'a Arm,
    workspace: ArmWorkspace,
    time_step: f64,
    /// Radians or metres a second, infinite for a joint without one.
    velocity_limits: Vec<f64>,
    /// m² a rad².
    damping: f64,
    target: Option<Placement<f64>>,
    branch: Branch,
    /// How much of the damping is left.
    fading: f64,
    q: Vec<f64>,
    velocity: Vec<f64>,
    held: Vec<Option<HeldBy>>,
    collisions: Vec<Collision>,
}

impl Arm {
    /// A servo that stands at `start` (projected into the limits) and takes a target every `time_step`
    /// seconds. No tick moves a joint further than its velocity limit times the time step: that of
    /// the robot's file, or [given](Servo::with_velocity_limits); a joint without one moves by at most
    /// 0.1 rad a tick (a slide by the metres that weigh as much). It stays on the branch that it stands on and
    /// settles at the nearest place to a target out of reach, from where an elbow bends back to the side that it was on.
    /// A redundant arm's freedom goes to the posture that it began in, or that was
    /// [asked for](super::ArmBuilder::with_posture), at half its speed while the target moves; where it rests the
    /// arm goes on to there. So it comes back to where it was, if no limit of a joint or of its speed held it: the place
    /// where a stretched arm's two sides meet may move faster than a slow joint can.
    ///
    /// # Errors
    /// A start of the wrong length or not finite; a time step that is no positive number.
    pub fn servo(&self, start: &[f64], time_step: f64) -> Result<Servo<'_>, QueryError> {
        let n = self.joint_count();
        self.check_length("the start", start.len(), n)?;
        self.check_query(0, &Placement::identity(), start)?;
        if !(time_step > 0.0 && time_step.is_finite()) {
            return Err(QueryError::TimeStep(time_step));
        }
        let map = &self.serial.map;
        let ends = map.lower().iter().zip(map.upper());
        let clamped = start.iter().zip(ends);
        let start: Vec<f64> = clamped.map(|(q, (l, u))| q.max(*l).min(*u)).collect();
        let mut servo = Servo {
            arm: self,
            workspace: ArmWorkspace::new(&self.serial, &self.options)?,
            time_step,
            velocity_limits: self.velocity_limits().to_vec(),
            damping: 0.0,
            target: None,
            branch: Branch::begin(self, &start),
            fading: 1.0,
            q: start,
            velocity: vec![0.0; n],
            held: vec![None; n],
            collisions: Vec::new(),
        };
        servo.set_damping(DAMPING);
        Ok(servo)
    }

    /// The velocity limits of the free joints as the robot's file gives them, base to tip, radians or
    /// metres a second; infinite for a joint without one. Joints that follow a free one count too.
    #[must_use]
    pub fn velocity_limits(&self) -> &[f64] {
        &self.rates.velocity
    }
}

impl Servo<'_> {
    /// Other velocity limits, base to tip, radians or metres a second: at least 0, infinite for none.
    ///
    /// # Errors
    /// Another number of them than free joints; one that is negative or NaN.
    pub fn with_velocity_limits(mut self, limits: &[f64]) -> Result<Self, ArmError> {
        if limits.len() != self.q.len() {
            return Err(ArmError::JointCount {
                option: "velocity_limits",
                given: limits.len(),
                joints: self.arm.joints().map(str::to_owned).collect(),
            });
        }
        for &limit in limits {
            BadOption::check("velocity_limits", limit, AT_LEAST_0)?;
        }
        self.velocity_limits.copy_from_slice(limits);
        Ok(self)
    }

    /// How much moving is damped: a motion of the tool that takes the joints this many times as many
    /// radians (the tool's own turn, or its way by the metres that weigh as much) is made at half its
    /// speed, others the less the easier they are. Radians, at least 0; default 0.01. More is calmer near
    /// singular configurations and lags there.
    ///
    /// # Errors
    /// A number that is negative or not finite.
    pub fn with_damping(mut self, radians: f64) -> Result<Self, ArmError> {
        BadOption::check("damping", radians, NOT_NEGATIVE)?;
        self.set_damping(radians);
        Ok(self)
    }

    fn set_damping(&mut self, radians: f64) {
        let metres = radians * self.arm.options.metres_per_radian;
        self.damping = metres * metres;
    }

    getters! {
        /// How fast the free joints may move, base to tip, radians or metres a second; infinite for none.
        pub fn velocity_limits(&self) -> &[f64] = &self.velocity_limits;
        /// Where the arm stands, radians or metres.
        pub fn q(&self) -> &[f64] = &self.q;
    }

    /// One tick towards a target. Nothing is allocated, unless something is in the way.
    ///
    /// # Errors
    /// A target that is not a rigid motion; the arm then stands as it stood.
    pub fn step(
        &mut self,
        base_from_tool: impl Into<Placement<f64>>,
    ) -> Result<ServoStep<'_>, QueryError> {
        let target = base_from_tool.into();
        self.arm.check_query(0, &target, &self.q)?;
        self.workspace.aim(&target);
        self.bound_tick();
        let rests = self.target.replace(target) == Some(target);
        self.branch.take_target(rests);
        self.fill_seed(rests);
        let how = Settling {
            steps: STEPS,
            anchor: self.damping * self.fading,
            deadline: None,
        };
        let (mut ended, _) = self.workspace.settle_near(&how);
        // In flat valleys short steps creep.
        if ended == Termination::IterationLimit && self.branch.rests_long() {
            (ended, _) = self.workspace.settle(None);
        }
        #[cfg(feature = "collision")]
        let touching = self.stop_before_touching()?;
        let errors = self.workspace.judge_x();
        for ((velocity, q), x) in self.velocity.iter_mut().zip(&self.q).zip(&self.workspace.x) {
            *velocity = (x - q) / self.time_step;
        }
        self.q.copy_from_slice(&self.workspace.x);
        self.branch
            .arrive(self.arm, &mut self.workspace, errors.reached);
        let status = self.look(errors, ended);
        #[cfg(feature = "collision")]
        let status = touching.unwrap_or(status);
        self.fading = match rests && status != ServoStatus::SpeedLimited {
            true => self.fading * FADING,
            false => 1.0,
        };
        Ok(ServoStep {
            q: &self.q,
            velocity: &self.velocity,
            status,
            position_error: errors.position,
            orientation_error: errors.orientation,
            collisions: &self.collisions,
            held: &self.held,
            names: &self.arm.names.variables,
        })
    }

    /// Cuts the way to the workspace's x short before something touches; how the tick stands where something is in the way or touches.
    #[cfg(feature = "collision")]
    fn stop_before_touching(&mut self) -> Result<Option<ServoStatus>, QueryError> {
        let (arm, workspace) = (self.arm, &mut self.workspace);
        self.collisions.clear();
        let Some(kept) = &arm.collisions else {
            return Ok(None);
        };
        let room = workspace.clear_room.get_or_insert_with(|| kept.room());
        let way = kept.way_from_contact(arm, room, &self.q, &workspace.x)?;
        let touches = way.begins_touching();
        let Some(by) = way.blocked_by else {
            if touches {
                self.collisions = kept.collisions(arm, room, &workspace.x)?;
            }
            let touching = (!self.collisions.is_empty()).then_some(ServoStatus::Touching);
            return Ok(touching);
        };
        let share = kept.cautious_share(arm, room, &self.q, &workspace.x)?;
        for (x, q) in workspace.x.iter_mut().zip(&self.q) {
            *x = q + share * (*x - q);
        }
        if touches {
            self.collisions = kept.collisions(arm, room, &workspace.x)?;
        }
        let status = match self.collisions.is_empty() {
            true => ServoStatus::Blocked,
            false => ServoStatus::Touching,
        };
        if !self.collisions.iter().any(|own| own.is_of_same_pair(&by)) {
            self.collisions.push(by);
        }
        Ok(Some(status))
    }

    /// The box of a tick: joint limits and velocity limits.
    fn bound_tick(&mut self) {
        let arm = self.arm;
        let map = &arm.serial.map;
        let PoseQuestion { lower, upper, .. } = &mut self.workspace.question;
        for (i, &q) in self.q.iter().enumerate() {
            let most = if self.velocity_limits[i].is_finite() {
                self.velocity_limits[i] * self.time_step
            } else {
                UNLIMITED_STEP / arm.scale[i]
            };
            lower[i] = map.lower()[i].max(within(q, -most));
            upper[i] = map.upper()[i].min(within(q, most));
        }
    }

    /// Where the tick begins: where the branch leads from the last place, at a part of the slowest joint's speed.
    fn fill_seed(&mut self, rests: bool) {
        self.workspace.x.copy_from_slice(&self.q);
        let speeds = self.velocity_limits.iter().zip(&self.arm.scale);
        let slowest = (speeds.filter(|(speed, _)| **speed > 0.0))
            .fold(f64::INFINITY, |least, (speed, scale)| {
                least.min(speed * self.time_step * scale)
            });
        let of_speed = if rests { 1.0 } else { SPEED_OF_EASE };
        let ease = (of_speed * slowest).min(LONGEST_EASE);
        let side = SPEED_OF_LEANING * slowest;
        self.branch.lead(self.arm, &mut self.workspace, ease, side);
    }

    /// What holds the joints, and how the tick stands.
    fn look(&mut self, errors: Errors, ended: Termination) -> ServoStatus {
        let negligible = self.workspace.take_slope();
        let ArmWorkspace {
            x,
            question: PoseQuestion { lower, upper, .. },
            gradient,
            ..
        } = &self.workspace;
        let map = &self.arm.serial.map;
        let mut by_speed = false;
        for (i, held) in self.held.iter_mut().enumerate() {
            let side = if x[i] <= lower[i] && gradient[i] > negligible {
                Some((Side::Lower, map.lower()[i]))
            } else if x[i] >= upper[i] && gradient[i] < -negligible {
                Some((Side::Upper, map.upper()[i]))
            } else {
                None
            };
            *held = side.map(|(side, limit)| match x[i] == limit {
                true => HeldBy::Limit(side),
                false => HeldBy::Speed(side),
            });
            by_speed |= matches!(held, Some(HeldBy::Speed(_)));
        }
        let still = self.velocity.iter().all(|velocity| *velocity == 0.0);
        if errors.reached {
            ServoStatus::OnTarget
        } else if by_speed {
            ServoStatus::SpeedLimited
        } else if still && ended != Termination::NonFinite {
            ServoStatus::Nearest
        } else {
            ServoStatus::Settling
        }
    }
}
