//! Construction of arms: from a model, and from another arm with another tool, goal, search or default start.

use std::time::Duration;

use super::arm::Arm;
use super::arm_model::ArmModel;
use super::builder::{ArmBuilder, Base, check_tool};
#[cfg(feature = "xml")]
use super::default_start::srdf_start;
use super::options::{Options, Search, check_goal};
use super::serial_chain::Serial;
use super::{ArmError, PoseBounds};
use kinopt_kinematics::model::FrameRef;
use kinopt_kinematics::spatial::Placement;

impl Arm {
    /// Builds the arm from `base` to the frame `tip` with default options; see [`builder`](Self::builder) for others.
    ///
    /// # Errors
    /// Returns the errors of [`ArmBuilder::build`].
    pub fn new<'a>(
        arm_model: &impl ArmModel,
        base: impl Into<Base<'a>>,
        tip: impl Into<FrameRef<'a>>,
    ) -> Result<Self, ArmError> {
        Self::builder(arm_model, base, tip).build()
    }

    /// Starts the builder of the arm from `base` (a frame, or [`Base::World`]) to the frame `tip`.
    ///
    /// Any two frames of the tree will do: the chain leads from the base up to the common ancestor and down to the tip.
    pub fn builder<'m, 'a>(
        arm_model: &'m impl ArmModel,
        base: impl Into<Base<'a>>,
        tip: impl Into<FrameRef<'a>>,
    ) -> ArmBuilder<'m> {
        ArmBuilder::new(arm_model, base.into(), tip.into())
    }

    /// The same arm with another tool, given by its placement in the tip's frame, metres; the identity for none.
    ///
    /// All other options stay. Its results are bitwise those of an arm [built](super::ArmBuilder::with_tool) with that
    /// tool. The seed atlas is shared, which makes it about a thousand times as fast to build.
    ///
    /// # Errors
    /// Returns an error for a placement that is not a rigid motion.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::{Arm, PoseBounds};
    /// # use kinopt::robot::Robot;
    /// use kinopt::spatial::{Placement, Vector3};
    ///
    /// let robot = Robot::read("models/universal_ur5e.urdf")?;
    /// let arm = Arm::new(&robot, "base", "flange")?;
    /// let drill = Placement::translation(Vector3::new(0.0, 0.0, 0.12));
    /// let drilling = arm.with_tool(drill)?.with_goal(PoseBounds::free_about(kinopt::arm::Axis::Z))?;
    /// let q = [0.1, -1.2, 1.0, -1.3, -1.5, 0.2];
    /// let flange = arm.base_from_tool(&q)?;
    /// let tip = drilling.base_from_tool(&q)?;
    /// assert!(((flange * drill).translation - tip.translation).norm() < 1e-12);
    /// assert!(drilling.solve(tip, &[0.0, -1.5, 1.5, -1.5, -1.5, 0.0])?.reached);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_tool(&self, tip_from_tool: impl Into<Placement<f64>>) -> Result<Self, ArmError> {
        let tip_from_tool = tip_from_tool.into();
        check_tool(&tip_from_tool)?;
        with_chain(
            self,
            self.serial.with_tool(tip_from_tool)?,
            self.options.clone(),
        )
    }

    /// The same arm with another goal, which shares the seed atlas as [`with_tool`](Self::with_tool) does.
    ///
    /// # Errors
    /// Returns an error for a goal without components, or half widths that are NaN or negative.
    pub fn with_goal(&self, goal: PoseBounds) -> Result<Self, ArmError> {
        check_goal(&goal)?;
        let mut options = self.options.clone();
        options.goal = goal;
        with_chain(self, self.serial.clone(), options)
    }

    /// The same arm with another search, which shares the seed atlas.
    ///
    /// Example: the nearest solution, from an arm that otherwise gives the one from the start.
    ///
    /// # Errors
    /// Returns an error for a search whose numbers are out of range, or that is incompatible with the arm's posture.
    pub fn with_search(&self, search: Search) -> Result<Self, ArmError> {
        let mut options = self.options.clone();
        options.search = search;
        options.check(&self.joints().collect::<Vec<_>>())?;
        with_chain(self, self.serial.clone(), options)
    }

    /// The same arm with another time limit of a query and other largest motions of the joints, which shares the seed
    /// atlas.
    ///
    /// See [`with_time_limit`](ArmBuilder::with_time_limit) and [`with_max_move`](ArmBuilder::with_max_move); `None` is no
    /// bound.
    ///
    /// # Errors
    /// Returns an error for motions that are NaN or negative, or of another number than joints.
    pub fn with_query_bounds(
        &self,
        time_limit: Option<Duration>,
        max_move: Option<&[f64]>,
    ) -> Result<Self, ArmError> {
        let mut options = self.options.clone();
        options.time_limit = time_limit;
        options.max_move = max_move.map(<[f64]>::to_vec);
        options.check(&self.joints().collect::<Vec<_>>())?;
        with_chain(self, self.serial.clone(), options)
    }

    /// Sets the [default start](Self::default_start) to a state of the SRDF file: `ready`, else `home`, in any case.
    ///
    /// The state must have values for joints of the arm. Joints without a value stay at the middle of their limits.
    #[cfg(feature = "xml")]
    #[must_use]
    pub fn with_srdf(mut self, srdf: &kinopt_robot::robot::Srdf) -> Self {
        let joint_coordinates = &self.coordinates.joint_coordinates;
        self.default_start = srdf_start(srdf, joint_coordinates, self.limits());
        self
    }
}

/// The same arm with other options and with the same checker.
pub(super) fn with_options(arm: &Arm, options: Options) -> Result<Arm, ArmError> {
    with_chain(arm, arm.serial.clone(), options)
}

/// The same arm with another chain and other options, and with the same checker.
fn with_chain(arm: &Arm, serial: Serial, mut options: Options) -> Result<Arm, ArmError> {
    options.weigh_radians(serial.model.reach());
    let changed = arm.changed(serial, options)?;
    #[cfg(feature = "collision")]
    let changed = match &arm.collisions {
        Some(avoidance) => changed.with_checker(avoidance.checker(), avoidance.rest())?,
        None => changed,
    };
    Ok(changed)
}
