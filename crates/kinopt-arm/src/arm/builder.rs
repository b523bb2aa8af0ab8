//! Builder of an arm: base, tip, free joints and options.

use std::time::Duration;

use super::arm::Arm;
use super::arm_model::ArmModel;
use super::coordinates::Coordinates;
use super::kinematic_path::{self, Part};
use super::options::{ATTEMPTS, Options, Search};
use super::rate_limits::RateLimits;
use super::serial_chain::{Serial, source_of};
use super::{ArmError, PoseBounds};
use crate::simd_ik::{LaneOptions, PoseSolver};
use kinopt_kinematics::model::{
    FrameId, FrameRef, Joint, JointId, JointRef, Limits, Model, ParameterMap, UnknownName,
};
use kinopt_kinematics::spatial::Placement;
use kinopt_robot::robot::{Mimic, coupled};
use kinopt_solver::problem::MAX_NEARBY_ERROR;

/// Base of an arm: the frame in which targets are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Base<'a> {
    /// The world of the model.
    World,
    /// A frame, by its id or its name.
    Frame(FrameRef<'a>),
}

impl<'a, F: Into<FrameRef<'a>>> From<F> for Base<'a> {
    fn from(frame: F) -> Self {
        Self::Frame(frame.into())
    }
}

/// Builder of an [`Arm`]; [`build`](Self::build) checks the options and returns the first error.
///
/// Frames and joints are given by id or by name. Options with one number per joint take them base to tip, for the free
/// joints only, in the order of [`joints`](Self::joints). Options without a default value also accept an `Option`.
#[derive(Clone, Debug)]
pub struct ArmBuilder<'m> {
    model: &'m Model,
    mimic_joints: &'m [Mimic],
    /// Limits of each joint of the model.
    rates: RateLimits<Option<f64>>,
    /// `None` is the world.
    base: Result<Option<FrameId>, UnknownName>,
    tip: Result<FrameId, UnknownName>,
    /// First name of a joint that the model does not have.
    unknown_joint: Option<UnknownName>,
    tip_from_tool: Placement<f64>,
    locked: Vec<(JointId, f64)>,
    narrowed: Vec<(JointId, Limits)>,
    only: Option<(Vec<JointId>, Vec<f64>)>,
    weights: Option<Vec<f64>>,
    options: Options,
    atlas: bool,
}

impl<'m> ArmBuilder<'m> {
    /// Builder with default options.
    pub(super) fn new(arm_model: &'m impl ArmModel, base: Base<'_>, tip: FrameRef<'_>) -> Self {
        let model = arm_model.model();
        Self {
            model,
            mimic_joints: arm_model.followers(),
            rates: RateLimits::of(arm_model),
            base: match base {
                Base::World => Ok(None),
                Base::Frame(frame) => frame.resolve(model).map(Some),
            },
            tip: tip.resolve(model),
            unknown_joint: None,
            tip_from_tool: Placement::identity(),
            locked: Vec::new(),
            narrowed: Vec::new(),
            only: None,
            weights: None,
            options: Options::default(),
            atlas: true,
        }
    }
}

impl ArmBuilder<'_> {
    /// Resolves a joint, and keeps the first unknown name as an error for `build`.
    fn joint<'a>(&mut self, joint: impl Into<JointRef<'a>>) -> Option<JointId> {
        let resolved = joint.into().resolve(self.model);
        let unknown = &mut self.unknown_joint;
        resolved.map_err(|error| unknown.get_or_insert(error)).ok()
    }

    /// Sets the placement of a tool in the tip's frame, metres. Default: the identity.
    #[must_use]
    pub fn with_tool(mut self, tip_from_tool: impl Into<Placement<f64>>) -> Self {
        self.tip_from_tool = tip_from_tool.into();
        self
    }

    /// Sets the largest distance of the tool from its target, metres; positive. Default 1e-6.
    #[must_use]
    pub fn with_position_tolerance(mut self, metres: f64) -> Self {
        self.options.position_tolerance = metres;
        self
    }

    /// Sets the largest angle between the tool and its target, radians; positive. Default 1e-6.
    #[must_use]
    pub fn with_orientation_tolerance(mut self, radians: f64) -> Self {
        self.options.orientation_tolerance = radians;
        self
    }

    /// Sets the metres that weigh as much as one radian in the cost; positive.
    ///
    /// The weight decides the compromise for a target out of reach. Default: a quarter of the arm's reach, so that
    /// results do not depend on the unit of length.
    #[must_use]
    pub fn with_metres_per_radian(mut self, metres: impl Into<Option<f64>>) -> Self {
        self.options.given_metres_per_radian = metres.into();
        self
    }

    /// Sets the components of the pose that count, and their bounds. Default: the full pose.
    #[must_use]
    pub fn with_goal(mut self, goal: PoseBounds) -> Self {
        self.options.goal = goal;
        self
    }

    /// Sets the preference among several solutions. Default [`Search::Start`].
    #[must_use]
    pub fn with_search(mut self, search: Search) -> Self {
        self.options.search = search;
        self
    }

    /// Sets the weights of a radian or metre of each joint in joint distances: one positive number per joint.
    ///
    /// Default 1 for all. Used by [`Search::Nearest`], [`Arm::solve_all`] and the posture.
    #[must_use]
    pub fn with_joint_weights(mut self, weights: &[f64]) -> Self {
        self.weights = Some(weights.to_vec());
        self
    }

    /// Sets the largest motion of each joint from the start, radians or metres: one number of at least 0 per joint.
    ///
    /// Infinity leaves a joint unbounded. The motion counts from the start clamped to the limits. If no solution is
    /// found within the bound, the result is the closest pose reached from the start, and ends as
    /// [`CannotContinue`](kinopt_solver::solver::Termination::CannotContinue). Default: no bound.
    #[must_use]
    pub fn with_max_move(mut self, max_move: &[f64]) -> Self {
        self.options.max_move = Some(max_move.to_vec());
        self
    }

    /// Sets a nominal posture for the null space, one number per joint, radians or metres, clamped to the limits.
    ///
    /// The solution moves towards it within the null space of the pose, the limits and the tolerances. It is valid
    /// for the searches `Start` and `First`. Default: none.
    #[must_use]
    pub fn with_posture(mut self, q_preferred: &[f64]) -> Self {
        self.options.posture = Some(q_preferred.to_vec());
        self
    }

    /// Sets the number of iterations of all attempts of a query after which no attempt begins, at least 1.
    ///
    /// Default: none if [`with_attempts`](Self::with_attempts) was given, 2 600 otherwise.
    #[must_use]
    pub fn with_iterations(mut self, iterations: impl Into<Option<u32>>) -> Self {
        self.options.iterations = iterations.into();
        self
    }

    /// Sets whether a query that fails returns the best of all attempts, on any branch. Default false.
    ///
    /// A path whose branch ends then jumps to another branch. Otherwise a failed query returns the closest pose
    /// reached from the start, and a path stays at the closest pose on its branch. [`Search::First`] always returns
    /// the best of all attempts.
    #[must_use]
    pub fn with_global_search_on_miss(mut self, enabled: bool) -> Self {
        self.options.global_search_on_failure = enabled;
        self
    }

    /// Sets the strength of limit avoidance while following, in radians; at least 0. Default 4.
    ///
    /// In [`Arm::track`], [`Arm::follower`] and [`Arm::servo`] the null space goes to a nominal posture: the start,
    /// or the [given one](Self::with_posture). A joint at its limit is pulled back as if it were this far from that
    /// posture. The pull is less before the limit, and none in the inner 60 % of the range. A joint that starts in
    /// the outer 5 % is moved out of it. 0 leaves limits to the posture.
    #[must_use]
    pub fn with_limit_avoidance(mut self, radians: f64) -> Self {
        self.options.limit_avoidance = radians;
        self
    }

    /// Sets a wall-clock limit per query, checked between lock-step iterations. Default: none.
    ///
    /// With a limit, results depend on the machine.
    #[must_use]
    pub fn with_time_limit(mut self, limit: impl Into<Option<Duration>>) -> Self {
        self.options.time_limit = limit.into();
        self
    }

    /// Sets the seed of all random numbers: attempt i is sampled from (seed, i). Default 0.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.options.seed = seed;
        self
    }

    /// Sets whether to build the seed atlas, which makes several times fewer iterations. Default true.
    ///
    /// The atlas takes a few megabytes, and tens of milliseconds to build.
    #[must_use]
    pub fn with_atlas(mut self, atlas: bool) -> Self {
        self.atlas = atlas;
        self
    }

    /// Sets the largest number of attempts of one query, at least 1.
    ///
    /// A failing query makes all of them, unless [`with_iterations`](Self::with_iterations) or a time limit ends it
    /// first. With a [checker](Arm::with_checker) it makes up to twice as many. Default: 200, and no attempt begins
    /// after 2 600 iterations.
    #[must_use]
    pub fn with_attempts(mut self, attempts: impl Into<Option<u32>>) -> Self {
        let attempts = attempts.into();
        self.options.attempts = attempts.unwrap_or(ATTEMPTS);
        self.options.attempts_given = attempts.is_some();
        self
    }

    /// Locks a joint at `value`, radians or metres, within its limits. A value up to 1e-3 outside, as from a sensor, is
    /// clamped.
    #[must_use]
    pub fn with_locked<'a>(mut self, joint: impl Into<JointRef<'a>>, value: f64) -> Self {
        let joint = self.joint(joint);
        self.locked.extend(joint.map(|joint| (joint, value)));
        self
    }

    /// Narrows the position limits of a joint, radians or metres.
    ///
    /// [`build`](Self::build) returns an error for limits that are not within those of the model.
    #[must_use]
    pub fn with_joint_limits<'a>(mut self, joint: impl Into<JointRef<'a>>, limits: Limits) -> Self {
        let joint = self.joint(joint);
        self.narrowed.extend(joint.map(|joint| (joint, limits)));
        self
    }

    /// Frees only these joints; every other joint is locked at its value in `q_model`, as by
    /// [`with_locked`](Self::with_locked).
    ///
    /// Shape of `q_model`: the model's degrees of freedom; otherwise [`build`](Self::build) returns an error.
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

    /// Free joints, base to tip: the order of options with one number per joint.
    ///
    /// # Errors
    /// Returns an error for an unknown frame or joint (with the valid names), locked values outside limits, or no free
    /// joint.
    pub fn joints(&self) -> Result<Vec<JointId>, ArmError> {
        let (parts, name) = self.kinematic_chain()?;
        let (full, tool) = (self.parameters()?, Placement::identity());
        Ok(Serial::new(self.model, &full, &parts, tool, name)?.joints)
    }

    /// Checks the options and builds the arm.
    ///
    /// # Errors
    /// Returns an error for:
    /// - An unknown frame or joint, with the valid names.
    /// - The first option out of its range, by name.
    /// - Locked values outside limits, joint limits outside those of the model, or no free joint.
    /// - A joint that moves a loop of the model.
    pub fn build(self) -> Result<Arm, ArmError> {
        let (parts, name) = self.kinematic_chain()?;
        check_tool(&self.tip_from_tool)?;
        let full = self.parameters()?;
        let serial = Serial::new(self.model, &full, &parts, self.tip_from_tool, name)?;
        self.check_loops(&full, &serial)?;
        let coordinates =
            Coordinates::new((self.model, self.base.clone()?), &full, &parts, &serial);
        let options = self.options(&serial)?;
        let simd_solver = match &serial.chain {
            Some(chain) => Some(PoseSolver::new(chain, self.simd_options(&options))?),
            None => None,
        };
        let rates = self.rates.of_free_joints(self.model, &full, &serial);
        Arm::assemble(serial, options, simd_solver, coordinates, rates, name.1)
    }

    /// Chain from base to tip, and the names of both.
    fn kinematic_chain(&self) -> Result<(Vec<Part>, (&str, &str)), ArmError> {
        let (base, tip) = (self.base.clone()?, self.tip.clone()?);
        let frame_name = |id: FrameId| self.model.frames()[id.index()].name.as_str();
        let name = (base.map_or("world", frame_name), frame_name(tip));
        Ok((kinematic_path::parts(self.model, base, tip), name))
    }

    /// Returns an error if a free joint moves a loop of the model, directly or by its mimic joints.
    fn check_loops(&self, full: &ParameterMap, serial: &Serial) -> Result<(), ArmError> {
        for closed in self.model.loops() {
            for id in self.model.loop_joints(closed) {
                let coordinate = self.model.coordinate(id);
                let slope = coordinate.and_then(|c| source_of(full, c).slope());
                let Some((variable, _)) = slope else { continue };
                let source_joint = self.model.moving_joints()[full.leaders()[variable]];
                if serial.joints.contains(&source_joint) {
                    return Err(ArmError::InLoop {
                        joint: self.model.joints()[source_joint.index()].name.clone(),
                        closed: closed.name.clone(),
                    });
                }
            }
        }
        Ok(())
    }

    /// Parameter map of the whole model, with mimic joints coupled and other joints locked.
    fn parameters(&self) -> Result<ParameterMap, ArmError> {
        if let Some(unknown) = &self.unknown_joint {
            return Err(unknown.clone().into());
        }
        let mut map = coupled(self.model, self.mimic_joints);
        for &(joint, given) in &self.narrowed {
            let Joint { name, limits, .. } = &self.model.joints()[joint.index()];
            let is_within = limits.lower <= given.lower
                && given.lower <= given.upper
                && given.upper <= limits.upper;
            if !is_within {
                return Err(ArmError::JointLimits {
                    joint: name.clone(),
                    given,
                    limits: *limits,
                });
            }
            map = map.with_narrowed(joint, given);
        }
        for &(joint, value) in &self.locked {
            map = map.with_locked(joint, value);
        }
        if let Some((joints, q)) = &self.only {
            map = map.with_only(joints, q);
        }
        Ok(map.build()?)
    }

    /// Checked options, including those that depend on the arm's reach and number of joints.
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

    fn simd_options(&self, options: &Options) -> LaneOptions {
        LaneOptions {
            position_tolerance: options.position_tolerance,
            orientation_tolerance: options.orientation_tolerance,
            metres_per_radian: options.metres_per_radian,
            axes: options.goal.into(),
            attempts: options.attempts,
            seed: options.seed,
            // The atlas's configurations may be anywhere, but a bound on motions keeps to the start.
            atlas: self.atlas && options.max_move.is_none(),
            nearby: MAX_NEARBY_ERROR,
            ..LaneOptions::default()
        }
    }
}

/// Checks that a tool's placement is rigid.
pub(super) fn check_tool(tip_from_tool: &Placement<f64>) -> Result<(), ArmError> {
    let rigid = tip_from_tool.check_rigid(1e-6);
    rigid.map_err(ArmError::Tool)
}
