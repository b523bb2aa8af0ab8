//! Arm: its joints, kinematics and workspaces.

use std::sync::{Arc, Mutex, OnceLock};

use super::all_solutions::SixRevolute;
use super::coordinates::Coordinates;
use super::default_start::middle_of;
use super::options::Options;
use super::rate_limits::RateLimits;
use super::seed_table::SeedTable;
use super::serial_chain::Serial;
use super::workspace::ArmWorkspace;
use super::{ArmError, PoseBounds, QueryError};
use crate::simd_ik::{LaneOptions, PoseSolver};
use kinopt_kinematics::Buffer;
use kinopt_kinematics::clock::Instant;
use kinopt_kinematics::kinematics::{ForwardKinematics, Jacobian};
use kinopt_kinematics::model::{JointId, Limits, Source};
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::problem::ReportNames;

/// Inverse kinematics of the tool of a robot arm. It is immutable, `Send` and `Sync`: share it between threads.
///
/// A configuration has one number per free joint between base and tip, in that order ([`joints`](Self::joints)),
/// radians or metres. A mimic joint whose source is outside the chain is represented by its source. Targets are
/// `base_from_tool`, metres.
///
/// Equal queries give bitwise equal results on any number of threads, unless there is a time limit. A joint with a
/// range of a revolution or more ends as near to the start as whole revolutions allow. Whole revolutions are first
/// taken off a start beyond a million radians, where sines lose digits.
#[derive(Clone, Debug)]
pub struct Arm {
    pub(super) serial: Serial,
    pub(super) options: Options,
    pub(super) simd_solver: Option<PoseSolver>,
    pub(super) coordinates: Coordinates,
    pub(super) names: Arc<ReportNames>,
    /// Radians that a radian or metre of each joint counts as.
    pub(super) scale: Vec<f64>,
    pub(super) rates: RateLimits<f64>,
    pub(super) default_start: Vec<f64>,
    /// Sampled configurations of a chain that the SIMD solver does not support, built on first use.
    pub(super) seeds: OnceLock<SeedTable>,
    /// Solver of complete sets, compiled on first use; `None` for arms without one.
    pub(super) six_revolute: OnceLock<Option<Box<SixRevolute>>>,
    /// Collision avoidance, if the arm has a checker.
    #[cfg(feature = "collision")]
    pub(super) collisions:
        Option<std::sync::Arc<super::collision_avoidance::avoidance::CollisionAvoidance>>,
    workspaces: Workspaces,
}

/// Pool of workspaces for queries that the SIMD solver alone does not finish.
#[allow(clippy::vec_box, reason = "kilobytes, moved twice a question")]
#[derive(Debug)]
struct Workspaces(Mutex<Vec<Box<ArmWorkspace>>>);

/// A clone begins with an empty pool.
impl Clone for Workspaces {
    fn clone(&self) -> Self {
        Self(Mutex::default())
    }
}

impl Arm {
    pub(super) fn assemble(
        serial: Serial,
        options: Options,
        simd_solver: Option<PoseSolver>,
        coordinates: Coordinates,
        rates: RateLimits<f64>,
        tip: &str,
    ) -> Result<Self, ArmError> {
        let workspace = ArmWorkspace::new(&serial, &options)?;
        let names = ReportNames {
            tasks: vec![format!("pose of `{tip}`")],
            task_frames: vec![Some(tip.to_owned())],
            ..(**workspace.question.problem.names()).clone()
        };
        Ok(Self {
            rates,
            default_start: (serial.map.lower().iter().zip(serial.map.upper()))
                .map(|(&lower, &upper)| middle_of(Limits::new(lower, upper)))
                .collect(),
            scale: serial.scales(options.metres_per_radian),
            serial,
            options,
            simd_solver,
            coordinates,
            names: Arc::new(names),
            seeds: OnceLock::new(),
            six_revolute: OnceLock::new(),
            #[cfg(feature = "collision")]
            collisions: None,
            workspaces: Workspaces(Mutex::new(vec![Box::new(workspace)])),
        })
    }

    /// The same arm with another chain and other options, which leave joints and names as they are.
    ///
    /// The seed atlas is shared.
    pub(super) fn changed(&self, serial: Serial, options: Options) -> Result<Self, ArmError> {
        let simd_solver = self.simd_solver_for(&serial, &options)?;
        let (coordinates, rates) = (self.coordinates.clone(), self.rates.clone());
        let tip = self.names.task_frames.first().cloned().flatten();
        let tip = tip.unwrap_or_default();
        let changed = Self::assemble(serial, options, simd_solver, coordinates, rates, &tip)?;
        Ok(Self {
            default_start: self.default_start.clone(),
            ..changed
        })
    }

    /// SIMD solver for another chain and other options, which shares the seed atlas.
    fn simd_solver_for(
        &self,
        serial: &Serial,
        options: &Options,
    ) -> Result<Option<PoseSolver>, ArmError> {
        let simd_solver = self.simd_solver.as_ref().zip(serial.chain.as_ref());
        let simd_solver = simd_solver.map(|(simd_solver, chain)| {
            let lane_options = LaneOptions {
                metres_per_radian: options.metres_per_radian,
                axes: options.goal.into(),
                ..simd_solver.options().clone()
            };
            simd_solver.retargeted(chain, lane_options)
        });
        Ok(simd_solver.transpose()?)
    }

    /// Names of the free joints, base to tip: the order of a configuration.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = &str> {
        self.names.variables.iter().map(String::as_str)
    }

    /// Ids of the free joints in the source model, base to tip.
    #[must_use]
    pub fn joint_ids(&self) -> &[JointId] {
        &self.serial.joints
    }

    /// Acceleration limits of the free joints, base to tip, rad/s² or m/s²; infinite for none.
    ///
    /// They come from the robot's [files](kinopt_robot::robot::Robot::acceleration_limit), and include the limits of the
    /// mimic joints that a free joint drives.
    #[must_use]
    pub fn acceleration_limits(&self) -> &[f64] {
        &self.rates.acceleration
    }

    /// Jerk limits of the free joints and of the mimic joints that they drive, base to tip, rad/s³ or m/s³;
    /// infinite for none.
    #[must_use]
    pub fn jerk_limits(&self) -> &[f64] {
        &self.rates.jerk
    }

    /// Goal bounds: the components of a pose that targets constrain.
    #[must_use]
    pub fn goal(&self) -> PoseBounds {
        self.options.goal
    }

    /// Configuration sampled uniformly within the limits, one number per free joint, base to tip, radians or metres.
    /// Equal seeds give equal configurations.
    ///
    /// A missing limit is replaced as in [`Model::random_configuration`](kinopt_kinematics::model::Model). The
    /// configuration may be in collision.
    #[must_use]
    pub fn random_configuration(&self, seed: u64) -> Vec<f64> {
        let mut q = vec![0.0; self.joint_count()];
        self.serial
            .map
            .gather(&self.serial.model.random_configuration(seed), &mut q);
        q
    }

    /// Number of free joints, the length of a configuration.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.serial.joints.len()
    }

    /// Position limits of the free joints, base to tip, radians or metres.
    pub fn limits(&self) -> impl ExactSizeIterator<Item = Limits> + '_ {
        let map = &self.serial.map;
        map.lower()
            .iter()
            .zip(map.upper())
            .map(|(&lower, &upper)| Limits::new(lower, upper))
    }

    /// Velocity limits of the free joints from the robot's file, base to tip, rad/s or m/s; infinite for none.
    ///
    /// The limits of mimic joints count for the joint that drives them.
    #[must_use]
    pub fn velocity_limits(&self) -> &[f64] {
        &self.rates.velocity
    }

    /// Default start configuration: one number per free joint, base to tip, radians or metres.
    ///
    /// It is the middle of each joint's limits, or the value closest to 0 for a joint without a limit on one side. With
    /// [`with_srdf`](Self::with_srdf) it is the state `ready` or `home`. The middle is far from the limits and from the
    /// singularities of a stretched arm.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/franka_panda.urdf")?;
    /// let arm = Arm::new(&robot, "base", "hand")?;
    /// let start = arm.default_start();
    /// assert!(start[3] < -1.4, "the elbow is bent");
    /// let target = arm.base_from_tool(&[0.3, -0.4, 0.2, -1.9, 0.1, 1.6, 0.5])?;
    /// assert!(arm.solve(target, start)?.reached);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn default_start(&self) -> &[f64] {
        &self.default_start
    }

    /// Pose of the tool in the base frame at a configuration.
    ///
    /// # Errors
    /// Returns an error for a configuration of the wrong length or with a value that is not finite.
    pub fn base_from_tool(&self, q: &[f64]) -> Result<Placement<f64>, QueryError> {
        self.check_length("q", q.len(), self.joint_count())?;
        self.check_finite("q", q)?;
        if let Some(chain) = &self.serial.chain {
            return Ok(chain.tip_at(q));
        }
        self.with_workspace(|workspace| workspace.base_from_tool(&self.serial, q))
    }

    /// Writes the arm's joint values into a configuration of the source model (shape: its degrees of freedom).
    ///
    /// Also writes the locked joints between base and tip, and the mimic joints of the arm's joints. Other values stay
    /// unchanged.
    ///
    /// # Errors
    /// Returns an error for slices of the wrong length.
    pub fn configuration(&self, q_arm: &[f64], q_model: &mut [f64]) -> Result<(), QueryError> {
        self.check_lengths(q_arm, q_model)?;
        for (coordinate, source, limits) in &self.coordinates.entries {
            q_model[*coordinate] = match *source {
                Source::Constant(value) => value,
                source => limits.clamp(source.at(q_arm)),
            };
        }
        Ok(())
    }

    /// Reads the arm's joint values from a configuration of the model, into a slice of that length or a `Vec`.
    ///
    /// # Errors
    /// Returns an error for slices of the wrong length, and for joint values that are not finite.
    pub fn joint_values(
        &self,
        q_model: &[f64],
        q_arm: &mut (impl Buffer<f64> + ?Sized),
    ) -> Result<(), QueryError> {
        let q_arm = q_arm.sized(self.joint_count());
        self.check_lengths(q_arm, q_model)?;
        for (value, &coordinate) in q_arm.iter_mut().zip(&self.coordinates.joint_coordinates) {
            *value = q_model[coordinate];
        }
        self.check_finite("q", q_arm)
    }

    fn check_lengths(&self, q_arm: &[f64], q_model: &[f64]) -> Result<(), QueryError> {
        let degrees_of_freedom = self.coordinates.degrees_of_freedom;
        self.check_length("q_arm", q_arm.len(), self.joint_count())?;
        self.check_length("q_model", q_model.len(), degrees_of_freedom)
    }

    /// Compiles the tool's Jacobian: six rows, and one column per free joint, base to tip.
    ///
    /// The rows are the velocity of the tool's origin, m/s, and its angular velocity, rad/s, both in the base's axes. A
    /// column includes the mimic joints of its joint.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/franka_panda.urdf")?;
    /// let arm = Arm::builder(&robot, "base", "flange").build()?;
    /// let mut jacobian = arm.jacobian()?;
    /// let j = jacobian.at(&[0.4, -0.2, 0.1, -1.8, 0.2, 1.7, 0.5])?;
    /// assert_eq!(j.shape(), (6, 7));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// None in practice: the chain was compiled when the arm was built.
    pub fn jacobian(&self) -> Result<Jacobian, QueryError> {
        let serial = &self.serial;
        let tool = [serial.tool];
        let kinematics = ForwardKinematics::under(&serial.model, &serial.map, &tool)?;
        Ok(Jacobian::new(kinematics))
    }

    /// Returns true if the goal may leave a null space.
    pub(super) fn has_null_space(&self) -> bool {
        self.joint_count() > self.options.goal.rows() || self.options.goal.has_bounds()
    }

    pub(super) fn deadline(&self) -> Option<Instant> {
        // A limit beyond the range of the clock counts as none.
        let limit = self.options.time_limit?;
        Instant::now().checked_add(limit)
    }

    /// Changes all workspaces of the pool.
    #[cfg(feature = "collision")]
    pub(super) fn for_each_workspace(&mut self, change: impl FnMut(&mut Box<ArmWorkspace>)) {
        let workspaces = self.workspaces.0.get_mut();
        let workspaces = workspaces.unwrap_or_else(std::sync::PoisonError::into_inner);
        workspaces.iter_mut().for_each(change);
    }

    /// Runs a function with a workspace from the pool, or with a new one.
    pub(super) fn with_workspace<R>(
        &self,
        run: impl FnOnce(&mut ArmWorkspace) -> R,
    ) -> Result<R, QueryError> {
        let lock = || {
            self.workspaces
                .0
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner)
        };
        let pooled = lock().pop();
        let mut workspace = match pooled {
            Some(workspace) => workspace,
            None => Box::new(ArmWorkspace::new(&self.serial, &self.options)?),
        };
        let result = run(&mut workspace);
        lock().push(workspace);
        Ok(result)
    }

    pub(super) fn check_length(
        &self,
        what: &'static str,
        given: usize,
        expected: usize,
    ) -> Result<(), QueryError> {
        if given == expected {
            return Ok(());
        }
        Err(QueryError::Length {
            what,
            given,
            expected,
            joints: self.joint_count(),
        })
    }

    /// Checks one configuration, or several in sequence.
    #[allow(
        clippy::eq_op,
        reason = "what is not finite leaves itself no zero, and all are asked at once"
    )]
    pub(super) fn check_finite(&self, what: &'static str, q: &[f64]) -> Result<(), QueryError> {
        let nonzero_bits = q
            .iter()
            .fold(0, |left, value| left | (value - value).to_bits());
        if nonzero_bits == 0 {
            return Ok(());
        }
        match q.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(index) => Err(QueryError::NotFinite {
                what,
                joint: self.joint_name(index % self.joint_count()),
                value: q[index],
            }),
        }
    }

    fn joint_name(&self, joint: usize) -> String {
        self.names.variables.get(joint).cloned().unwrap_or_default()
    }

    pub(super) fn check_query(
        &self,
        query: Option<usize>,
        target: &Placement<f64>,
        start: &[f64],
    ) -> Result<(), QueryError> {
        if let Some(index) = start.iter().position(|value| !value.is_finite()) {
            return Err(QueryError::StartNotFinite {
                query,
                joint: self.joint_name(index),
                value: start[index],
            });
        }
        // Fast for exact rotations; slightly stricter than the SIMD solver's limit of 1e-6.
        match target.check_rigid(0.9e-6) {
            Ok(()) => Ok(()),
            Err(problem) => Err(QueryError::Target { query, problem }),
        }
    }
}
