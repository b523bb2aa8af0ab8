//! Describes an arm: base, tip, what is free, and every option with its unit and default.

use std::time::Duration;

use super::arm::Arm;
use super::coordinates::Coordinates;
use super::kinematic_path::{self, Part};
use super::mechanism::Mechanism;
use super::options::{ATTEMPTS, Options, Search};
use super::rate_limits::RateLimits;
use super::serial_chain::{Serial, source_of};
use super::{ArmError, Goal};
use crate::lanes::{LaneOptions, PoseSolver};
use crate::model::{FrameId, FrameRef, JointId, JointRef, Model, ParameterMap, UnknownName};
use crate::problem::NEARBY;
use crate::robot::{Mimic, coupled};
use crate::spatial::Placement;

/// Where an arm begins: the frame that targets are given in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Base<'a> {
    /// The model's world, which needs no frame.
    World,
    /// A frame, by its id or its name.
    Frame(FrameRef<'a>),
}

impl<'a, F: Into<FrameRef<'a>>> From<F> for Base<'a> {
    fn from(frame: F) -> Self {
        Self::Frame(frame.into())
    }
}

/// Collects the options of an [`Arm`]; [`build`](Self::build) checks them and tells the first that is
/// wrong. Frames and joints are given by id or by name.
///
/// Options that have one number a joint take them base to tip, for the free joints only, in the
/// order of [`joints`](Self::joints). Options without a value by default also take an `Option`.
#[derive(Clone, Debug)]
pub struct ArmBuilder<'m> {
    model: &'m Model,
    followers: &'m [Mimic],
    /// One a joint of the model.
    rates: RateLimits<Option<f64>>,
    /// None for the world.
    base: Result<Option<FrameId>, UnknownName>,
    tip: Result<FrameId, UnknownName>,
    /// The first joint that is not there.
    unknown_joint: Option<UnknownName>,
    tip_from_tool: Placement<f64>,
    locked: Vec<(JointId, f64)>,
    only: Option<(Vec<JointId>, Vec<f64>)>,
    weights: Option<Vec<f64>>,
    options: Options,
    atlas: bool,
}

impl Arm {
    /// The arm from `base` to the frame `tip`, with default options: see [`builder`](Self::builder)
    /// for others.
    ///
    /// # Errors
    /// As [`ArmBuilder::build`].
    pub fn new<'a>(
        mechanism: &impl Mechanism,
        base: impl Into<Base<'a>>,
        tip: impl Into<FrameRef<'a>>,
    ) -> Result<Self, ArmError> {
        Self::builder(mechanism, base, tip).build()
    }

    /// Starts the description of the arm from `base` (a frame, or [`Base::World`]) to the frame `tip`.
    /// Any two frames of the tree will do: from the base the way goes up to where both meet and down
    /// to the tip.
    pub fn builder<'m, 'a>(
        mechanism: &'m impl Mechanism,
        base: impl Into<Base<'a>>,
        tip: impl Into<FrameRef<'a>>,
    ) -> ArmBuilder<'m> {
        let model = mechanism.model();
        ArmBuilder {
            model,
            followers: mechanism.followers(),
            rates: RateLimits::of(mechanism),
            base: match base.into() {
                Base::World => Ok(None),
                Base::Frame(frame) => frame.resolve(model).map(Some),
            },
            tip: tip.into().resolve(model),
            unknown_joint: None,
            tip_from_tool: Placement::identity(),
            locked: Vec::new(),
            only: None,
            weights: None,
            options: Options::default(),
            atlas: true,
        }
    }
}

impl ArmBuilder<'_> {
    /// The joint that is meant; the first that is not there is an error when building.
    fn joint<'a>(&mut self, joint: impl Into<JointRef<'a>>) -> Option<JointId> {
        let resolved = joint.into().resolve(self.model);
        let unknown = &mut self.unknown_joint;
        resolved.map_err(|error| unknown.get_or_insert(error)).ok()
    }

    setters! {
        /// A tool on the tip: where it stands in the tip's frame, metres. Default: the tip itself.
        pub fn with_tool(mut self, tip_from_tool: impl Into<Placement<f64>>) {
            self.tip_from_tool = tip_from_tool.into();
        }
        /// How far the tool may be from its target, metres; positive. Default 1e-6.
        pub fn with_position_tolerance(mut self, metres: f64) {
            self.options.position_tolerance = metres;
        }
        /// How far the tool may be turned from its target, radians; positive. Default 1e-6.
        pub fn with_orientation_tolerance(mut self, radians: f64) {
            self.options.orientation_tolerance = radians;
        }
        /// Metres that weigh as much as one radian in the cost, which decides the compromise where a
        /// target is out of reach; positive. Default: a quarter of the arm's length, so that answers do
        /// not depend on the unit of length.
        pub fn with_metres_per_radian(mut self, metres: impl Into<Option<f64>>) {
            self.options.given_metres_per_radian = metres.into();
        }
        /// Which components of the pose count, and how exactly. Default: the full pose.
        pub fn with_goal(mut self, goal: Goal) { self.options.goal = goal }
        /// Which of several solutions is wanted. Default [`Search::Start`].
        pub fn with_search(mut self, search: Search) { self.options.search = search }
        /// What a radian or metre of each joint weighs in joint distances, one positive number a joint.
        /// Default 1 for all. Used by [`Search::Nearest`], [`Search::Distinct`] and the posture.
        pub fn with_joint_weights(mut self, weights: &[f64]) {
            self.weights = Some(weights.to_vec());
        }
        /// How far each joint may move from the start (from the start within its limits), radians or
        /// metres, one number of at least 0 a joint; infinity for a joint that may go anywhere. A hard
        /// bound: where no solution is found within it, the answer ends as
        /// [`CannotContinue`](crate::solver::Termination::CannotContinue) at the nearest place on the
        /// start's own way. Default: no bound.
        pub fn with_max_move(mut self, max_move: &[f64]) {
            self.options.max_move = Some(max_move.to_vec());
        }
        /// A posture to prefer where the pose leaves room, one number a joint, radians or metres,
        /// clamped into the limits: the solution is moved towards it within the null space of the pose,
        /// within limits, and stays within the tolerances. It goes with the searches `Start` and
        /// `First`. Default: none.
        pub fn with_posture(mut self, q_preferred: &[f64]) {
            self.options.posture = Some(q_preferred.to_vec());
        }
        /// No attempt begins after so many iterations of all attempts of a query together, at least 1.
        /// Default: none where [`with_attempts`](Self::with_attempts) was given, 2 600 otherwise.
        pub fn with_iterations(mut self, iterations: impl Into<Option<u32>>) {
            self.options.iterations = iterations.into();
        }
        /// Whether a target that no attempt reaches is answered by the best place that any of them came
        /// to, wherever that is, and a path whose branch ends goes on by a jump to another. Otherwise a
        /// miss stays on the start's own way, and a path on its branch, at the nearest place there.
        /// [`Search::First`] has no start to stay near and always takes the best. Default false.
        pub fn with_global_search_on_miss(mut self, everywhere: bool) {
            self.options.leaps = everywhere;
        }
        /// While following ([`Arm::track`], [`Arm::follower`], [`Arm::servo`]) the freedom that the goal leaves goes
        /// to the posture that the arm began in, or to another that is [asked for](Self::with_posture), and keeps
        /// joints off their limits. This is how strongly: a joint that comes onto its limit is drawn back as if it were so many
        /// radians from that posture, less before, not at all in the inner 60 % of its range; one that begins in the
        /// outer 5 % is drawn out of it. At least 0; 0 leaves limits to the posture. Default 4.
        pub fn with_limit_avoidance(mut self, radians: f64) {
            self.options.limit_avoidance = radians;
        }
        /// A wall-clock limit for each query, looked at between lock-step iterations. Answers then
        /// depend on the machine. Default: none.
        pub fn with_time_limit(mut self, limit: impl Into<Option<Duration>>) {
            self.options.time_limit = limit.into();
        }
        /// The seed of everything random: attempt i starts from (seed, i). Default 0.
        pub fn with_seed(mut self, seed: u64) { self.options.seed = seed }
        /// Whether to build the engine's seed atlas: a few megabytes and tens of milliseconds, for
        /// several times fewer iterations. Default true.
        pub fn with_atlas(mut self, atlas: bool) { self.atlas = atlas }
        /// Most attempts of one query, at least 1: a target that none reaches has so many, unless
        /// [`with_iterations`](Self::with_iterations) or a time limit ends them first. Default: 200, and no
        /// attempt begins after 2 600 iterations.
        pub fn with_attempts(mut self, attempts: impl Into<Option<u32>>) {
            let attempts = attempts.into();
            self.options.attempts = attempts.unwrap_or(ATTEMPTS);
            self.options.attempts_asked = attempts.is_some();
        }
    }

    /// Locks a joint at `value`, radians or metres, within its limits. A value up to 1e-3 outside, as sensors report it, is clamped.
    #[must_use]
    pub fn with_locked<'a>(mut self, joint: impl Into<JointRef<'a>>, value: f64) -> Self {
        let joint = self.joint(joint);
        self.locked.extend(joint.map(|joint| (joint, value)));
        self
    }

    /// Frees only these joints; every other joint is held at its value in `q_model` (shape: the
    /// model's degrees of freedom; [`build`](Self::build) refuses another), by the rule of [`with_locked`](Self::with_locked).
    #[must_use]
    pub fn with_only<'a, J: Into<JointRef<'a>>>(
        mut self,
        joints: impl IntoIterator<Item = J>,
        q_model: &[f64],
    ) -> Self {
        let joints = joints.into_iter();
        let ids = joints.filter_map(|joint| self.joint(joint)).collect();
        self.only = Some((ids, q_model.to_vec()));
        self
    }

    /// The free joints, base to tip, in whose order options have one number a joint.
    ///
    /// # Errors
    /// An unknown frame or joint, with the valid names; locked values outside limits; no free joint.
    pub fn joints(&self) -> Result<Vec<JointId>, ArmError> {
        let (parts, name) = self.way()?;
        let (full, tool) = (self.parameters()?, Placement::identity());
        Ok(Serial::new(self.model, &full, &parts, tool, name)?.joints)
    }

    /// Checks everything and prepares the arm.
    ///
    /// # Errors
    /// An unknown frame or joint, with the valid names; the first option out of its range, by name;
    /// locked values outside limits; no free joint; a joint that moves a loop of the model.
    pub fn build(self) -> Result<Arm, ArmError> {
        let (parts, name) = self.way()?;
        check_tool(&self.tip_from_tool)?;
        let full = self.parameters()?;
        let serial = Serial::new(self.model, &full, &parts, self.tip_from_tool, name)?;
        self.check_loops(&full, &serial)?;
        let coordinates =
            Coordinates::new((self.model, self.base.clone()?), &full, &parts, &serial);
        let options = self.options(&serial)?;
        let lanes = match &serial.chain {
            Some(chain) => Some(PoseSolver::new(chain, self.lane_options(&options))?),
            None => None,
        };
        let rates = self.rates.of_free_joints(self.model, &full, &serial);
        Arm::assemble(serial, options, lanes, coordinates, rates, name.1)
    }

    /// The way from base to tip, and the names of the two.
    fn way(&self) -> Result<(Vec<Part>, (&str, &str)), ArmError> {
        let (base, tip) = (self.base.clone()?, self.tip.clone()?);
        let frame = |id: FrameId| self.model.frames()[id.index()].name.as_str();
        let name = (base.map_or("world", frame), frame(tip));
        Ok((kinematic_path::parts(self.model, base, tip), name))
    }

    /// Refuses joints that would open a loop, be it by those that follow them.
    fn check_loops(&self, full: &ParameterMap, serial: &Serial) -> Result<(), ArmError> {
        for closed in self.model.loops() {
            for id in self.model.loop_joints(closed) {
                let coordinate = self.model.coordinate(id);
                let slope = coordinate.and_then(|c| source_of(full, c).slope());
                let Some((variable, _)) = slope else { continue };
                let leader = self.model.moving_joints()[full.leaders()[variable]];
                if serial.joints.contains(&leader) {
                    return Err(ArmError::InLoop {
                        joint: self.model.joints()[leader.index()].name.clone(),
                        closed: closed.name.clone(),
                    });
                }
            }
        }
        Ok(())
    }

    /// The whole model's map: followers follow, joints that cannot matter keep still.
    fn parameters(&self) -> Result<ParameterMap, ArmError> {
        if let Some(unknown) = &self.unknown_joint {
            return Err(unknown.clone().into());
        }
        let mut map = coupled(self.model, self.followers);
        for &(joint, value) in &self.locked {
            map = map.with_locked(joint, value);
        }
        if let Some((joints, q)) = &self.only {
            map = map.with_only(joints, q);
        }
        Ok(map.build()?)
    }

    /// The options, checked, with what goes by the arm's length and number of joints.
    fn options(&self, serial: &Serial) -> Result<Options, ArmError> {
        let mut options = self.options.clone();
        options.weigh_radians(serial.model.reach());
        let ones = || vec![1.0; serial.joints.len()];
        options.weights = self.weights.clone().unwrap_or_else(ones);
        let name = |id: &JointId| self.model.joints()[id.index()].name.as_str();
        options.check(&serial.joints.iter().map(name).collect::<Vec<_>>())?;
        let bounds = serial.map.lower().iter().zip(serial.map.upper());
        for (value, (lower, upper)) in options.posture.iter_mut().flatten().zip(bounds) {
            *value = value.max(*lower).min(*upper);
        }
        Ok(options)
    }

    fn lane_options(&self, options: &Options) -> LaneOptions {
        LaneOptions {
            position_tolerance: options.position_tolerance,
            orientation_tolerance: options.orientation_tolerance,
            metres_per_radian: options.metres_per_radian,
            axes: options.goal.into(),
            attempts: options.attempts,
            seed: options.seed,
            // Atlas seeds stand anywhere; a bound on moves keeps to the start.
            atlas: self.atlas && options.max_move.is_none(),
            nearby: NEARBY,
            ..LaneOptions::default()
        }
    }
}

/// Whether a tool stands somewhere.
pub(super) fn check_tool(tip_from_tool: &Placement<f64>) -> Result<(), ArmError> {
    let rigid = tip_from_tool.check_rigid(1e-6);
    rigid.map_err(ArmError::Tool)
}
